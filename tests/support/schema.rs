//! As much of JSON Schema as the schemas of this project use. A keyword that is not known is a failure, so that none is
//! passed over in silence.

use serde_json::Value;

/// Returns what of `document` breaks `schema`, each with its place.
pub fn violations(schema: &Value, document: &Value) -> Vec<String> {
    let mut found = Vec::new();
    Validator { root: schema, found: &mut found }.check(schema, document, "");
    found
}

struct Validator<'a> {
    root: &'a Value,
    found: &'a mut Vec<String>,
}

impl Validator<'_> {
    fn check(&mut self, schema: &Value, value: &Value, at: &str) {
        let Some(keywords) = schema.as_object() else {
            let is_allowed = schema.as_bool().expect("a schema is an object or a boolean");
            if !is_allowed {
                self.found.push(format!("{at} may not be there"));
            }
            return;
        };
        for (keyword, rule) in keywords {
            if !self.holds(schema, keyword, rule, value, at) {
                self.found.push(format!("{at}: {value} breaks {keyword} {rule}"));
            }
        }
    }

    /// Checks one keyword; what lies below speaks for itself.
    fn holds(&mut self, schema: &Value, keyword: &str, rule: &Value, value: &Value, at: &str) -> bool {
        match keyword {
            "title" | "description" | "$schema" | "$id" | "$defs" => true,
            "$ref" => {
                let path = rule.as_str().and_then(|path| path.strip_prefix('#')).expect("a reference into the schema");
                let target = self.root.pointer(path).unwrap_or_else(|| panic!("{path} is not there")).clone();
                self.check(&target, value, at);
                true
            }
            "type" => match rule {
                Value::Array(types) => types.iter().any(|name| is_of(name, value)),
                name => is_of(name, value),
            },
            "const" => value == rule,
            "enum" => rule.as_array().is_some_and(|values| values.contains(value)),
            "minimum" => value.as_f64().is_none_or(|number| Some(number) >= rule.as_f64()),
            "minLength" => value.as_str().is_none_or(|text| text.chars().count() as u64 >= rule.as_u64().unwrap_or(0)),
            "minItems" => value.as_array().is_none_or(|items| items.len() as u64 >= rule.as_u64().unwrap_or(0)),
            "uniqueItems" => {
                value.as_array().is_none_or(|items| (1..items.len()).all(|i| !items[..i].contains(&items[i])))
            }
            "pattern" => value.as_str().is_none_or(|text| matches_pattern(rule, text)),
            "required" => {
                let names = rule.as_array().expect("a list of names");
                names.iter().all(|name| value.get(name.as_str().expect("a name")).is_some())
            }
            "items" => {
                let items = value.as_array().map_or(&[][..], Vec::as_slice);
                items.iter().enumerate().for_each(|(i, item)| self.check(rule, item, &format!("{at}/{i}")));
                true
            }
            "properties" => {
                for (name, rule) in rule.as_object().expect("a map of schemas") {
                    if let Some(value) = value.get(name) {
                        self.check(rule, value, &format!("{at}/{name}"));
                    }
                }
                true
            }
            "additionalProperties" => {
                let known = |name: &str| schema.get("properties").is_some_and(|known| known.get(name).is_some());
                for (name, value) in value.as_object().into_iter().flatten().filter(|(name, _)| !known(name)) {
                    self.check(rule, value, &format!("{at}/{name}"));
                }
                true
            }
            _ => panic!("{keyword} is not known here"),
        }
    }
}

fn is_of(name: &Value, value: &Value) -> bool {
    match name.as_str().expect("the name of a type") {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "integer" => value.is_i64() || value.is_u64(),
        "number" => value.is_number(),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        name => panic!("type {name} is not known here"),
    }
}

/// The patterns of the schemas, each as a function.
fn matches_pattern(pattern: &Value, text: &str) -> bool {
    match pattern.as_str().expect("a pattern") {
        "^[EFLW][0-9]{4}$" => {
            text.len() == 5
                && text.starts_with(['E', 'F', 'L', 'W'])
                && text[1..].bytes().all(|byte| byte.is_ascii_digit())
        }
        "^[a-z]+(-[a-z]+)*$" => {
            text.split('-').all(|word| !word.is_empty() && word.bytes().all(|byte| byte.is_ascii_lowercase()))
        }
        pattern => panic!("pattern {pattern} is not known here"),
    }
}
