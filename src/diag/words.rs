//! The small change of messages: quotes, lists and counts in words.

use std::borrow::Cow;

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
        Some((end, _)) => format!("{}…", visible(&text[..end])),
        None => visible(text).into_owned(),
    }
}

/// Tells whether a character does not show as one: a control character, one that turns the direction of the text around,
/// one without width, or a blank other than the space.
#[must_use]
pub fn is_unseen(character: char) -> bool {
    let is_blank = character.is_whitespace() && character != ' ';
    character.is_control()
        || is_blank
        || matches!(
            character,
            // Characters that Unicode lets a program leave out when it shows text.
            '\u{AD}' | '\u{34F}' | '\u{61C}' | '\u{115F}' | '\u{1160}' | '\u{17B4}' | '\u{17B5}' | '\u{180B}'..='\u{180F}'
                | '\u{200B}'..='\u{200F}' | '\u{202A}'..='\u{202E}' | '\u{2060}'..='\u{206F}' | '\u{3164}'
                | '\u{FE00}'..='\u{FE0F}' | '\u{FEFF}' | '\u{FFA0}' | '\u{FFF0}'..='\u{FFF8}'
                | '\u{1BCA0}'..='\u{1BCA3}' | '\u{1D173}'..='\u{1D17A}' | '\u{E0000}'..='\u{E0FFF}'
            // Marks of annotations, and a letter without any dot.
                | '\u{FFF9}'..='\u{FFFB}' | '\u{2800}'
        )
}

/// Returns a text in which characters that do not show are named, as `<U+200B>`.
#[must_use]
pub fn visible(text: &str) -> Cow<'_, str> {
    if !text.contains(is_unseen) {
        return text.into();
    }
    let shown = |character: char| match is_unseen(character) {
        true => format!("<U+{:04X}>", u32::from(character)),
        false => character.to_string(),
    };
    text.chars().map(shown).collect::<String>().into()
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
        assert_eq!(quoted("a\u{202E}gnp.png\t"), "`a<U+202E>gnp.png<U+0009>`");
        assert_eq!(visible("é ŝ 文 😀"), "é ŝ 文 😀");
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
