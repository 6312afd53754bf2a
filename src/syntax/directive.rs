//! Comments that speak to clisc.

use crate::source::{Source, Span};
use crate::syntax::lexer::{lex_line, lines};
use crate::syntax::token::TokenKind;

/// A comment that speaks to clisc.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Directive<'s> {
    /// The comment, from its `#` to its last character that is no blank.
    pub comment: Span,
    /// What it tells: see [`directive`].
    pub text: &'s str,
    /// Whether it stands behind a command, or behind what should have been one.
    pub is_behind_command: bool,
}

/// Returns the comments of a scene that speak to clisc, in order.
#[must_use]
pub fn directives(source: &Source) -> Vec<Directive<'_>> {
    let mut found = Vec::new();
    let mut end = 0;
    for hit in memchr::memmem::find_iter(source.text().as_bytes(), "clisc:") {
        if hit < end {
            continue;
        }
        let line = source.lines().line_span(source.text(), source.lines().line_of(hit as u32));
        end = line.end as usize;
        for line in lines(source.slice(line), line.start) {
            found.extend(directive_of(source, line.text, line.start));
        }
    }
    found
}

fn directive_of<'s>(source: &'s Source, line: &str, start: u32) -> Option<Directive<'s>> {
    let (mut comment, mut is_behind_command) = (None, false);
    lex_line(line, start, |token| {
        is_behind_command |= token.kind.is_significant();
        if token.kind == TokenKind::Comment {
            comment = Some(token.span);
        }
    });
    let comment = comment?;
    let text = source.slice(comment).trim_ascii_end();
    let comment = Span::new(comment.start, comment.start + text.len() as u32);
    Some(Directive { comment, text: directive(text)?, is_behind_command })
}

/// Returns what a comment tells clisc: what follows `clisc:` if it begins with that. `comment` begins with its `#`.
///
/// ```
/// # use clisc::syntax::directive;
/// assert_eq!(directive("# clisc: off"), Some("off"));
/// assert_eq!(directive("#clisc:on "), Some("on"));
/// assert_eq!(directive("# see clisc: off"), None);
/// ```
#[must_use]
pub fn directive(comment: &str) -> Option<&str> {
    comment.strip_prefix('#')?.trim_ascii_start().strip_prefix("clisc:").map(str::trim_ascii)
}
