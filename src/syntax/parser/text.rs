//! What is wrong with the text of a source before any of it is a command.

use crate::diag::words::counted;
use crate::diag::{Diagnostic, Edit, Fix, Safety, codes};
use crate::source::{Encoding, Source, Span};
use crate::syntax::token::{Token, TokenKind};

/// The most places of one line that one diagnostic shows.
const MAX_PLACES: usize = 8;

/// Reports a source that is no UTF-8 at all.
pub(super) fn check_encoding(source: &Source) -> Option<Diagnostic> {
    let is_utf16 = source.encoding() == Encoding::Utf16 || looks_like_utf16(source.text());
    is_utf16.then(|| {
        let first = source.text().chars().next().map_or(0, char::len_utf8);
        Diagnostic::new(&codes::INVALID_TEXT, Span::new(0, first as u32), "the file is UTF-16, not UTF-8")
            .label("two bytes for each character from here on")
            .help("save the file as UTF-8; in many editors that is a choice beside the file name")
    })
}

/// Tells whether every other byte at the start is 0, as in UTF-16 without a byte-order mark.
fn looks_like_utf16(text: &str) -> bool {
    const N_LOOKED_AT: usize = 64;
    let head = &text.as_bytes()[..text.len().min(N_LOOKED_AT) & !1];
    let n_zero = |odd: usize| head.iter().skip(odd).step_by(2).filter(|&&byte| byte == 0).count();
    let (even, odd) = (n_zero(0), n_zero(1));
    head.len() >= 4 && even.min(odd) == 0 && even.max(odd) == head.len() / 2
}

/// Reports the bytes that are no UTF-8, once a line.
pub(super) fn check_bytes(source: &Source, acc: &mut Vec<Diagnostic>) {
    let line_of = |span: Span| source.lines().line_of(span.start);
    for runs in source.invalid_utf8().chunk_by(|(a, _), (b, _)| line_of(*a) == line_of(*b)) {
        let Some(((span, bytes), others)) = runs.split_first() else { continue };
        let n_bytes: usize = runs.iter().map(|(_, bytes)| bytes.len()).sum();
        let message = match n_bytes {
            1 => format!("byte 0x{:02X} is not UTF-8", bytes[0]),
            n => format!("{n} bytes from 0x{:02X} on are not UTF-8", bytes[0]),
        };
        let place = format!("at offset {} of the file", span.start);
        let diagnostic =
            Diagnostic::new(&codes::INVALID_TEXT, *span, message).label(place).help(help_for_byte(bytes[0]));
        acc.push(with_places(diagnostic, others.iter().map(|(span, _)| *span)));
    }
}

fn help_for_byte(byte: u8) -> String {
    let save = "save the file as UTF-8";
    windows_1252(byte).map_or_else(
        || save.to_owned(),
        |character| format!("{save}; in Latin-1 (Windows-1252) the byte is `{character}`"),
    )
}

/// Returns the character that `byte` is in Windows-1252, which is Latin-1 and fills its gap from 0x80 to 0x9F.
fn windows_1252(byte: u8) -> Option<char> {
    const GAP: [char; 32] = [
        '€', '\0', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\0', 'Ž', '\0', '\0', '‘', '’', '“', '”',
        '•', '–', '—', '˜', '™', 'š', '›', 'œ', '\0', 'ž', 'Ÿ',
    ];
    let character = if byte < 0xA0 { *GAP.get(usize::from(byte) - 0x80)? } else { char::from(byte) };
    (character != '\0' && !character.is_whitespace() && character != '\u{AD}').then_some(character)
}

/// Reports the foreign characters of one line: one diagnostic for blanks, one for control characters. Those that stand
/// for bytes which were no UTF-8 are reported already.
pub(super) fn check_foreign(source: &Source, foreign: &[Token], acc: &mut Vec<Diagnostic>) {
    let is_invalid = |span: Span| {
        let runs = source.invalid_utf8();
        let next = runs.partition_point(|(run, _)| run.end <= span.start);
        runs.get(next).is_some_and(|(run, _)| run.start < span.end)
    };
    for kind in [TokenKind::Control, TokenKind::ForeignBlank] {
        let mut places = foreign.iter().filter(|token| token.kind == kind).map(|token| token.span);
        if let Some(first) = places.by_ref().find(|&span| !is_invalid(span)) {
            let others: Vec<_> = places.filter(|&span| !is_invalid(span)).collect();
            let (diagnostic, safety) = match kind {
                TokenKind::Control => (control(source, first), Safety::Unsafe),
                _ => (foreign_blank(source, first), Safety::Safe),
            };
            let edits = std::iter::once(first).chain(others.iter().copied());
            let edits = edits.map(|span| Edit::replace(span, stand_in(source.slice(span)))).collect();
            let fix = Fix { title: diagnostic.help.clone().unwrap_or_default(), edits, safety };
            acc.push(with_places(diagnostic.fix(fix), others.into_iter()));
        }
    }
}

fn with_places(diagnostic: Diagnostic, places: impl Iterator<Item = Span>) -> Diagnostic {
    places.take(MAX_PLACES).fold(diagnostic, |diagnostic, span| diagnostic.secondary(span, "here too"))
}

fn control(source: &Source, span: Span) -> Diagnostic {
    let first = source.slice(span).chars().next().unwrap_or('\0');
    let name = match first {
        '\0' => "a NUL byte".to_owned(),
        '\u{1A}' => "the control character U+001A (end of file in DOS)".to_owned(),
        _ => format!("the control character U+{:04X}", u32::from(first)),
    };
    Diagnostic::new(&codes::FOREIGN_CHARACTER, span, format!("{name} cannot stand in a command"))
        .label("does not show on a screen")
        .help("remove it")
}

fn foreign_blank(source: &Source, span: Span) -> Diagnostic {
    let first = source.slice(span).chars().next().unwrap_or('\u{A0}');
    let name = match first {
        '\u{A0}' => "no-break space",
        '\u{202F}' => "narrow no-break space",
        '\u{200B}' => "zero-width space",
        '\u{FEFF}' => "byte-order mark inside the text",
        '\u{3000}' => "ideographic space",
        '\u{2028}' | '\u{2029}' => "Unicode line separator",
        _ => "Unicode blank",
    };
    let message = format!("a {name} (U+{:04X}) where only a space or a tab may stand", u32::from(first));
    let (label, help) = match has_no_width(first) {
        true => ("does not show on a screen", "remove it"),
        false => ("looks like a space, but is none", "write a space in its place"),
    };
    Diagnostic::new(&codes::FOREIGN_CHARACTER, span, message).label(label).help(help)
}

/// Tells whether a foreign character takes no room on a screen.
fn has_no_width(character: char) -> bool {
    matches!(character, '\u{180E}' | '\u{200B}' | '\u{2060}' | '\u{FEFF}') || character.is_control()
}

/// Returns what to write instead of foreign characters: as many spaces as were seen.
fn stand_in(foreign: &str) -> String {
    foreign.chars().filter(|&character| !has_no_width(character)).map(|_| ' ').collect()
}

/// Returns the fix that ends lines with LF where a carriage return stands alone, the first of them at `first`; none when
/// there are more of them than an editor takes well.
fn lone_returns_replaced(source: &Source, first: u32) -> Option<Fix> {
    const MAX_EDITS: usize = 10_000;
    let bytes = source.text().as_bytes();
    let returns = memchr::memchr_iter(b'\r', &bytes[first as usize..]).map(|at| at + first as usize);
    let lone = returns.filter(|&at| bytes.get(at + 1) != Some(&b'\n'));
    let edits: Vec<_> =
        lone.take(MAX_EDITS + 1).map(|at| Edit::replace(Span::new(at as u32, at as u32 + 1), "\n")).collect();
    (edits.len() <= MAX_EDITS).then(|| Fix::safe("end these lines with LF", edits))
}

/// The carriage returns that no line feed follows.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LoneReturns {
    first: Option<Span>,
    n: usize,
}

impl LoneReturns {
    /// Counts those of `self` and, behind them, those of `later`.
    pub(super) fn and(self, later: Self) -> Self {
        Self { first: self.first.or(later.first), n: self.n + later.n }
    }

    /// Counts one more.
    pub(super) fn push(&mut self, span: Span) {
        *self = self.and(Self { first: Some(span), n: 1 });
    }

    /// Reports them once for all: it is one mistake to save a file with such line ends.
    pub(super) fn diagnose(self, source: &Source) -> Option<Diagnostic> {
        let more = match self.n {
            0 | 1 => String::new(),
            n => format!(" ({} in the file)", counted(n, "time")),
        };
        let message = format!("a carriage return without a line feed{more}");
        self.first.map(|first| {
            Diagnostic::new(&codes::FOREIGN_CHARACTER, first, message)
                .label("ends no line")
                .help("save the file with LF or CRLF line ends")
                .fix(lone_returns_replaced(source, first.start))
        })
    }
}
