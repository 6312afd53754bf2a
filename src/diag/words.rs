//! The small change of messages: quotes, lists and counts in words.

/// The most characters of a word of a scene that a message quotes.
const MAX_QUOTED: usize = 40;
/// The most characters of a line that a help proposes.
const MAX_PROPOSED: usize = 200;

/// Returns a word of a scene in backticks, cut off when it is long.
#[must_use]
pub fn quoted(word: &str) -> String {
    in_backticks(word, MAX_QUOTED)
}

/// Returns a word of a scene as it is, cut off when it is long.
#[must_use]
pub fn shortened(word: &str) -> String {
    cut(word, MAX_QUOTED)
}

/// Returns the help to write `text` in place of what stands there.
#[must_use]
pub fn proposed(text: &str) -> String {
    format!("write {}", in_backticks(text, MAX_PROPOSED))
}

fn in_backticks(text: &str, max_chars: usize) -> String {
    format!("`{}`", cut(text, max_chars))
}

fn cut(text: &str, max_chars: usize) -> String {
    match text.char_indices().nth(max_chars) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

/// Returns the items as `a, b, c`.
#[must_use]
pub fn listed<'a>(items: impl IntoIterator<Item = &'a str>) -> String {
    items.into_iter().collect::<Vec<_>>().join(", ")
}

/// Returns the items, each in backticks, as "`a`, `b` and `c`".
#[must_use]
pub fn named<'a>(items: impl IntoIterator<Item = &'a str>) -> String {
    let items: Vec<_> = items.into_iter().map(quoted).collect();
    match items.split_last() {
        Some((last, rest @ [_, ..])) => format!("{} and {last}", rest.join(", ")),
        Some((only, [])) => only.clone(),
        None => String::new(),
    }
}

/// Returns "1 number", "4 numbers", "no number".
#[must_use]
pub fn counted(n: usize, noun: &str) -> String {
    match n {
        0 => format!("no {noun}"),
        1 => format!("1 {noun}"),
        _ => format!("{n} {noun}s"),
    }
}

/// Returns "first" for 1 and so on.
#[must_use]
pub fn ordinal(n: usize) -> String {
    const WORDS: [&str; 11] =
        ["first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth", "eleventh"];
    n.checked_sub(1).and_then(|i| WORDS.get(i)).map_or_else(|| format!("{n}th"), |&word| word.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words() {
        assert_eq!(quoted("radius"), "`radius`");
        assert_eq!(quoted(&"é".repeat(41)), format!("`{}…`", "é".repeat(40)));
        assert_eq!(named([]), "");
        assert_eq!(named(["x"]), "`x`");
        assert_eq!(named(["x", "y", "z"]), "`x`, `y` and `z`");
        assert_eq!(
            (counted(0, "light"), counted(1, "light"), counted(2, "light")),
            ("no light".into(), "1 light".into(), "2 lights".into())
        );
        assert_eq!((ordinal(3), ordinal(12)), ("third".into(), "12th".into()));
    }
}
