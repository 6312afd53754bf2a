//! The sections of `grammar/semantics.md`, one a topic, as `clisc explain` prints them.
//!
//! The page is read here and stands nowhere else. A section begins with its heading, and ends before the next one of any
//! level. Its name is the first word of the heading, in lower case.

use std::fmt::Write;

use clisc::syntax::spec;

const PAGE: &str = include_str!("../../../grammar/semantics.md");

/// Other words for a topic.
const OTHER_NAMES: [(&str, &str); 36] = [
    ("ambient", "surface"),
    ("antialiasing", "samples"),
    ("cap", "cylinder"),
    ("caps", "cylinder"),
    ("clamping", "pixels"),
    ("colour", "pixels"),
    ("color", "pixels"),
    ("coordinates", "camera"),
    ("depth", "levels"),
    ("diffuse", "shading"),
    ("epsilon", "hits"),
    ("eye", "camera"),
    ("floating-point", "arithmetic"),
    ("formula", "shading"),
    ("gamma", "pixels"),
    ("highlight", "shading"),
    ("image", "camera"),
    ("krefl", "levels"),
    ("lights", "light"),
    ("mirror", "levels"),
    ("mirrors", "levels"),
    ("normal", "normals"),
    ("part", "parts"),
    ("phong", "shading"),
    ("pixel", "pixels"),
    ("program", "scene"),
    ("quantisation", "pixels"),
    ("quantization", "pixels"),
    ("ray", "camera"),
    ("reflection", "levels"),
    ("rim", "cylinder"),
    ("rounding", "pixels"),
    ("shadow", "shadows"),
    ("shininess", "surface"),
    ("specular", "shading"),
    ("tangent", "ties"),
];

/// One section of the page.
#[derive(Clone, Copy, Debug)]
pub struct Topic {
    heading: &'static str,
    /// The text below the heading, in Markdown.
    body: &'static str,
}

/// Returns every topic, in the order of the page.
pub fn all() -> impl Iterator<Item = Topic> {
    let after_title = PAGE.split_once('\n').map_or("", |(_, rest)| rest);
    sections(after_title).map(|(heading, body)| Topic { heading, body })
}

/// Cuts a text at its headings; what stands before the first is left out.
fn sections(mut rest: &'static str) -> impl Iterator<Item = (&'static str, &'static str)> {
    std::iter::from_fn(move || {
        let start = rest.find("\n##")? + 1;
        let (heading, behind) = rest[start..].split_once('\n')?;
        let end = behind.find("\n##").map_or(behind.len(), |end| end + 1);
        let body = &behind[..end];
        // The line end before the next heading is what it is found by.
        rest = &behind[end.saturating_sub(1)..];
        Some((heading.trim_start_matches('#').trim(), body.trim_matches('\n')))
    })
}

/// Returns the topic of this name, or of another word for it, in letters of either case.
pub fn find(name: &str) -> Option<Topic> {
    let lower = name.to_lowercase();
    let other = OTHER_NAMES.iter().find(|(word, _)| *word == lower).map(|(_, name)| *name);
    all().find(|topic| topic.name() == lower || Some(&*topic.name()) == other)
}

impl Topic {
    /// Returns the word by which it is asked for.
    pub fn name(self) -> String {
        self.heading.split_whitespace().next().unwrap_or_default().to_lowercase()
    }

    /// Tells whether it is about one command of the language.
    pub fn is_command(self) -> bool {
        spec::find(self.heading).is_some()
    }

    /// Returns a line on it: what a command does, or the first sentence of the section.
    pub fn summary(self) -> String {
        if let Some(command) = spec::find(self.heading) {
            return command.doc.to_owned();
        }
        let paragraph = self.body.split("\n\n").find(|paragraph| !paragraph.starts_with("![")).unwrap_or_default();
        let text = paragraph.split_whitespace().collect::<Vec<_>>().join(" ");
        text.split_once(". ").map_or_else(|| text.clone(), |(sentence, _)| format!("{sentence}."))
    }

    /// Returns the section as text for a terminal, with the names of those that it refers to.
    pub fn page(self) -> String {
        let mut page = format!("# {}\n\n", self.heading);
        let mut others: Vec<String> = Vec::new();
        let is_shown = |line: &&str| !line.starts_with("![") && !line.starts_with("<!--");
        let mut blank_before = true;
        for line in self.body.lines().filter(is_shown) {
            // Where a picture is left out, two blank lines would meet.
            if !(line.is_empty() && blank_before) {
                page += &without_links(line, &mut others);
                page.push('\n');
            }
            blank_before = line.is_empty();
        }
        if let Some(command) = spec::find(self.heading) {
            let _ = write!(page, "\nAn example:\n\n    {}\n", command.example);
        }
        others.retain(|other| *other != self.name());
        if !others.is_empty() {
            let _ = write!(page, "\nSee also: clisc explain {}\n", others.join(", "));
        }
        page
    }
}

/// Returns a line with the text of its links only. The targets of those that lead to a section of the page are added to `others`.
fn without_links(line: &str, others: &mut Vec<String>) -> String {
    let mut text = String::new();
    let mut rest = line;
    while let Some((before, label, target, behind)) = next_link(rest) {
        text += before;
        text += label;
        if let Some(section) = target.strip_prefix('#')
            && !others.iter().any(|other| other == section)
        {
            others.push(section.to_owned());
        }
        rest = behind;
    }
    text + rest
}

/// Finds the first `[label](target)`, and what stands before and behind it.
fn next_link(text: &str) -> Option<(&str, &str, &str, &str)> {
    let middle = text.find("](")?;
    let start = text[..middle].rfind('[')?;
    let end = middle + text[middle..].find(')')?;
    Some((&text[..start], &text[start + 1..middle], &text[middle + 2..end], &text[end + 1..]))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn every_name_is_there_once() {
        let names: Vec<_> = all().map(Topic::name).collect();
        assert_eq!(names.iter().collect::<BTreeSet<_>>().len(), names.len(), "{names:?}");
        for (word, name) in OTHER_NAMES {
            assert!(names.iter().any(|topic| topic == name), "{word} leads to {name}");
            assert!(!names.iter().any(|topic| topic == word), "{word} is a topic itself");
        }
        assert!(OTHER_NAMES.is_sorted_by_key(|(word, _)| word.replace("color", "colour-")), "sorted");
    }

    #[test]
    fn every_command_has_a_section() {
        for command in &spec::COMMANDS {
            let topic = find(command.name).unwrap_or_else(|| panic!("no section on `{}`", command.name));
            assert!(topic.is_command());
            let usage = command.usage();
            assert!(topic.body.replace('\n', " ").contains(&format!("`{usage}`")), "not `{usage}`: {}", topic.body);
        }
    }

    /// The sections with their headings are the page, so that none of its text is lost.
    #[test]
    fn sections_tile_the_page() {
        let told: usize = all().map(|topic| topic.body.split_whitespace().count()).sum();
        let (_, sections) = PAGE.split_once("\n## ").expect("a first section");
        let headings = PAGE.lines().filter(|line| line.starts_with("##"));
        let in_headings: usize = headings.map(|line| line.split_whitespace().count()).sum();
        // The marks of the first heading were cut off.
        assert_eq!(told + in_headings, sections.split_whitespace().count() + 1);
    }

    #[test]
    fn summaries_fit_a_line() {
        for topic in all() {
            let summary = topic.summary();
            assert!(summary.ends_with('.') && summary.chars().count() < 76, "{}: {summary}", topic.heading);
        }
    }

    #[test]
    fn links_lead_somewhere_and_are_printed_as_text() {
        for topic in all() {
            let mut others = Vec::new();
            let page: Vec<_> = topic.body.lines().map(|line| without_links(line, &mut others)).collect();
            assert!(others.iter().all(|other| find(other).is_some()), "{}: {others:?}", topic.heading);
            let leftover = page.iter().find(|line| line.contains("](") && !line.starts_with("!"));
            assert_eq!(leftover, None, "{}", topic.heading);
        }
        let mut others = Vec::new();
        assert_eq!(without_links("see [a b](#c), [d](e.md)", &mut others), "see a b, d");
        assert_eq!(others, ["c"]);
    }
}
