//! What each token is, for an editor that colours by meaning.

use crate::ide::Document;
use crate::ide::line::LineAt;
use crate::source::Span;
use crate::syntax::TokenKind;
use crate::syntax::spec;

/// The most tokens of an answer, some twenty thousand lines: editors ask for whole scenes and take apart what they get.
const MAX_TOKENS: usize = 100_000;

/// What a token is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SemanticKind {
    /// The name of a command.
    Keyword,
    /// A number.
    Number,
    /// A file name.
    String,
    /// A comment.
    Comment,
}

impl SemanticKind {
    /// Every kind, in order.
    pub const ALL: [Self; 4] = [Self::Keyword, Self::Number, Self::String, Self::Comment];
}

/// A token and what it is; it lies on one line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SemanticToken {
    /// Where it is.
    pub span: Span,
    /// What it is.
    pub kind: SemanticKind,
}

/// Returns the tokens of the lines that `span` touches, in order, as far as an editor can use them. What went wrong has no
/// kind.
#[must_use]
pub fn semantic_tokens(document: &Document, span: Span) -> Vec<SemanticToken> {
    let (lines, text) = (document.lines(), document.text());
    let mut tokens = Vec::new();
    for line in lines.line_of(span.start)..=lines.line_of(span.end) {
        if tokens.len() >= MAX_TOKENS {
            break;
        }
        let line = LineAt::new(document, lines.start(text, line));
        let name = line.name();
        tokens.extend(line.tokens.iter().filter_map(|token| {
            let kind = match token.kind {
                TokenKind::Word if Some(token.span) == name => {
                    spec::find(document.source().slice(token.span)).map(|_| SemanticKind::Keyword)?
                }
                TokenKind::Number => SemanticKind::Number,
                TokenKind::Path | TokenKind::Quoted => SemanticKind::String,
                TokenKind::Comment => SemanticKind::Comment,
                TokenKind::Bom
                | TokenKind::Newline
                | TokenKind::Blank
                | TokenKind::Word
                | TokenKind::OpenQuote
                | TokenKind::ForeignBlank
                | TokenKind::LoneReturn
                | TokenKind::Control => return None,
            };
            Some(SemanticToken { span: token.span, kind })
        }));
    }
    tokens
}
