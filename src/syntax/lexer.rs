//! Text in, tokens out; the tokens tile the text.
//!
//! A scene is lexed line by line. A line is lexed by logos, by one of two rule sets: the plain one, and behind the word
//! `write` that of file names, in which `7.png`, `-out.png` and `a#b.png` are one token each.

use std::ops::Range;

use logos::Logos;

use crate::source::{Source, Span};
use crate::syntax::token::{Token, TokenKind};

/// The command behind which a file name stands.
const WRITE: &str = "write";

/// The byte-order mark, in UTF-8.
const BOM: &str = "\u{FEFF}";

/// The rules of a line up to its end or to the word `write`.
#[derive(Logos, Clone, Copy, Debug, PartialEq)]
enum Plain {
    #[regex(r"[ \t]+")]
    Blank,
    #[regex(r"#[^\n]*", allow_greedy = true)]
    Comment,
    #[regex(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?", priority = 9)]
    Number,
    // Everything but controls, blanks, foreign blanks and `#`.
    #[regex(r"[^\x00-\x20#\x7F-\u{A0}\u{1680}\u{180E}\u{2000}-\u{200B}\u{2028}\u{2029}\u{202F}\u{205F}\u{2060}\u{3000}\u{FEFF}]+", priority = 2)]
    Word,
    #[regex(r"[\u{A0}\u{1680}\u{180E}\u{2000}-\u{200B}\u{2028}\u{2029}\u{202F}\u{205F}\u{2060}\u{3000}\u{FEFF}]+")]
    ForeignBlank,
    #[regex(r"[\x00-\x08\x0A-\x1F\x7F-\u{9F}]+")]
    Control,
}

/// The rules behind the word `write`.
#[derive(Logos, Clone, Copy, Debug, PartialEq)]
enum Name {
    #[regex(r"[ \t]+")]
    Blank,
    #[regex(r"#[^\n]*", allow_greedy = true, priority = 9)]
    Comment,
    #[regex(r#""[^"\x00-\x08\x0A-\x1F\x7F-\u{9F}]*""#, priority = 9)]
    Quoted,
    #[regex(r#""[^"\x00-\x08\x0A-\x1F\x7F-\u{9F}]*"#, priority = 5)]
    OpenQuote,
    // Begins with nothing that begins another token; then everything but controls and blanks.
    #[regex(r#"[^"\x00-\x20#\x7F-\u{A0}\u{1680}\u{180E}\u{2000}-\u{200B}\u{2028}\u{2029}\u{202F}\u{205F}\u{2060}\u{3000}\u{FEFF}][^\x00-\x20\x7F-\u{9F}]*"#, priority = 2)]
    Path,
    #[regex(r"[\u{A0}\u{1680}\u{180E}\u{2000}-\u{200B}\u{2028}\u{2029}\u{202F}\u{205F}\u{2060}\u{3000}\u{FEFF}]+")]
    ForeignBlank,
    #[regex(r"[\x00-\x08\x0A-\x1F\x7F-\u{9F}]+")]
    Control,
}

impl From<Plain> for TokenKind {
    fn from(plain: Plain) -> Self {
        match plain {
            Plain::Blank => Self::Blank,
            Plain::Comment => Self::Comment,
            Plain::Number => Self::Number,
            Plain::Word => Self::Word,
            Plain::ForeignBlank => Self::ForeignBlank,
            Plain::Control => Self::Control,
        }
    }
}

impl From<Name> for TokenKind {
    fn from(name: Name) -> Self {
        match name {
            Name::Blank => Self::Blank,
            Name::Comment => Self::Comment,
            Name::Quoted => Self::Quoted,
            Name::OpenQuote => Self::OpenQuote,
            Name::Path => Self::Path,
            Name::ForeignBlank => Self::ForeignBlank,
            Name::Control => Self::Control,
        }
    }
}

/// Lexes a whole scene.
#[must_use]
pub fn lex(source: &Source) -> Vec<Token> {
    let mut tokens = Vec::new();
    for line in lines(source.text(), 0) {
        lex_line(line.text, line.start, |token| tokens.push(token));
        tokens.extend(line.end);
    }
    tokens
}

/// Lexes one line of a scene. `line` is its place without its end.
#[must_use]
pub fn lex_one(source: &Source, line: Span) -> Vec<Token> {
    let mut tokens = Vec::new();
    lex_line(source.slice(line), line.start, |token| tokens.push(token));
    tokens
}

/// A piece of text up to a line end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Line<'s> {
    /// The text without the line end.
    pub(super) text: &'s str,
    /// The place of `text` in the source.
    pub(super) start: u32,
    /// The line end, a newline or a lone carriage return; the last line has none.
    pub(super) end: Option<Token>,
}

/// Returns the lines of `text`, which lies at `start` in its source. A lone carriage return ends a line like a newline:
/// it is an error, but what follows it can be read.
pub(super) fn lines(text: &str, start: u32) -> impl Iterator<Item = Line<'_>> {
    let mut ends = memchr::memchr2_iter(b'\n', b'\r', text.as_bytes());
    let mut from = Some(0);
    std::iter::from_fn(move || {
        let line_start = from?;
        let line = |to, end| Line { text: &text[line_start..to], start: start + line_start as u32, end };
        let Some(end) = ends.next() else {
            from = None;
            return Some(line(text.len(), None));
        };
        let kind_and_len = match text.as_bytes()[end..] {
            [b'\r', b'\n', ..] => {
                ends.next();
                (TokenKind::Newline, 2)
            }
            [b'\r', ..] => (TokenKind::LoneReturn, 1),
            _ => (TokenKind::Newline, 1),
        };
        let (kind, n_bytes) = kind_and_len;
        from = Some(end + n_bytes);
        let at = start + end as u32;
        Some(line(end, Some(Token { kind, span: Span::new(at, at + n_bytes as u32) })))
    })
}

/// Lexes one line without its end. `start` is its place in the source: a byte-order mark is one only at place 0.
pub(super) fn lex_line(text: &str, start: u32, mut push: impl FnMut(Token)) {
    match text.strip_prefix(BOM) {
        Some(rest) if start == 0 => {
            let n_bytes = BOM.len() as u32;
            push(Token { kind: TokenKind::Bom, span: Span::new(0, n_bytes) });
            lex_plain(rest, n_bytes, push);
        }
        _ => lex_plain(text, start, push),
    }
}

/// Lexes the text of a line by the plain rules, until a first word `write` asks for the others.
fn lex_plain(text: &str, start: u32, mut push: impl FnMut(Token)) {
    let mut emit = |kind, range: Range<usize>| {
        push(Token { kind, span: Span::new(start + range.start as u32, start + range.end as u32) });
    };
    let mut rules = Plain::lexer(text);
    let mut is_first = true;
    while let Some(rule) = rules.next() {
        let kind = rule.map_or(TokenKind::Control, TokenKind::from);
        emit(kind, rules.span());
        if is_first && kind == TokenKind::Word && rules.slice() == WRITE {
            return lex_file_name(rules.morph(), emit);
        }
        is_first &= !kind.is_significant();
    }
}

/// Lexes the rest of a line behind the word `write`.
fn lex_file_name(mut rules: logos::Lexer<'_, Name>, mut emit: impl FnMut(TokenKind, Range<usize>)) {
    while let Some(rule) = rules.next() {
        emit(rule.map_or(TokenKind::Control, TokenKind::from), rules.span());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use TokenKind::*;

    /// Lexes `text` and returns kinds with texts, blanks left out.
    fn kinds(text: &str) -> Vec<(TokenKind, String)> {
        let source = Source::new("test", text);
        let tokens = lex(&source).into_iter().filter(|token| token.kind != Blank);
        tokens.map(|token| (token.kind, source.slice(token.span).to_owned())).collect()
    }

    fn check(text: &str, expected: &[(TokenKind, &str)]) {
        let expected: Vec<_> = expected.iter().map(|&(kind, text)| (kind, text.to_owned())).collect();
        assert_eq!(kinds(text), expected, "{text:?}");
    }

    #[test]
    fn numbers_end_where_a_word_does_not() {
        for number in ["4", ".5", "1.", "-0.25", "+1e-3", "1E5", "007", "1e999"] {
            check(number, &[(Number, number)]);
        }
        for word in
            [".", "+", "-", "1e", "1e+", "1.2.3", "7.x", "0x10", "1_000", "inf", "nan", "--4", "1,5", "\u{2212}4"]
        {
            check(word, &[(Word, word)]);
        }
        check("4#x", &[(Number, "4"), (Comment, "#x")]);
    }

    #[test]
    fn names_are_lexed_behind_write_alone() {
        check("write 7.png", &[(Word, "write"), (Path, "7.png")]);
        check("write -out.png#a # b", &[(Word, "write"), (Path, "-out.png#a"), (Comment, "# b")]);
        check("write \"a b#.png\"#", &[(Word, "write"), (Quoted, "\"a b#.png\""), (Comment, "#")]);
        check("write \"a b.png", &[(Word, "write"), (OpenQuote, "\"a b.png")]);
        check("write#x", &[(Word, "write"), (Comment, "#x")]);
        check("sphere write 7", &[(Word, "sphere"), (Word, "write"), (Number, "7")]);
        check(
            "write a\nwrite\n7",
            &[(Word, "write"), (Path, "a"), (Newline, "\n"), (Word, "write"), (Newline, "\n"), (Number, "7")],
        );
    }

    #[test]
    fn foreign_characters_stand_alone() {
        check("1\u{A0}2", &[(Number, "1"), (ForeignBlank, "\u{A0}"), (Number, "2")]);
        check("write\u{A0}a\u{A0}b.png", &[(Word, "write"), (ForeignBlank, "\u{A0}"), (Path, "a\u{A0}b.png")]);
        check("1\0\u{1B}x", &[(Number, "1"), (Control, "\0\u{1B}"), (Word, "x")]);
        check("# \0 \u{A0}", &[(Comment, "# \0 \u{A0}")]);
    }

    #[test]
    fn line_ends() {
        check(
            "\u{FEFF}a\r\nb\rc\n",
            &[
                (Bom, "\u{FEFF}"),
                (Word, "a"),
                (Newline, "\r\n"),
                (Word, "b"),
                (LoneReturn, "\r"),
                (Word, "c"),
                (Newline, "\n"),
            ],
        );
        check("a\n\u{FEFF}b", &[(Word, "a"), (Newline, "\n"), (ForeignBlank, "\u{FEFF}"), (Word, "b")]);
    }

    #[test]
    fn a_token_of_ten_megabytes_needs_no_deep_stack() {
        for unit in [" ", "#", "7", "x", ".", "\u{A0}", "\0", "write \"", "é"] {
            let text = unit.repeat(10_000_000 / unit.len());
            let total: usize = lex(&Source::new("test", text.clone())).iter().map(|token| token.span.len()).sum();
            assert_eq!(total, text.len());
        }
        let name = format!("write {}", "a".repeat(10_000_000));
        assert_eq!(lex(&Source::new("test", name)).len(), 3);
    }
}
