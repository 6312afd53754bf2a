//! What the text is made of.

use crate::source::Span;

/// The kinds of token. Blanks, comments and line ends are tokens too, so that the tokens of a scene tile its text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum TokenKind {
    /// The byte-order mark at the start of a file.
    Bom,
    /// LF or CRLF.
    Newline,
    /// Spaces and tabs.
    Blank,
    /// From `#` to the end of the line.
    Comment,
    /// A run of other characters: a command's name, or a number gone wrong.
    Word,
    /// A number as section 1 of the language has it, whatever its size.
    Number,
    /// A file name without quotes.
    Path,
    /// A file name in double quotes.
    Quoted,
    /// A quote that the line does not close.
    OpenQuote,
    /// Blanks of other scripts and systems, such as the no-break space. No scene may hold one outside comments and names.
    ForeignBlank,
    /// A carriage return that no line feed follows. No scene may hold one; the next line begins behind it.
    LoneReturn,
    /// Other control characters, and bytes that were no UTF-8. No scene may hold one outside comments.
    Control,
}

impl TokenKind {
    /// Returns the name that dumps show.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bom => "bom",
            Self::Newline => "newline",
            Self::Blank => "blank",
            Self::Comment => "comment",
            Self::Word => "word",
            Self::Number => "number",
            Self::Path => "path",
            Self::Quoted => "quoted",
            Self::OpenQuote => "open-quote",
            Self::ForeignBlank => "foreign-blank",
            Self::LoneReturn => "lone-return",
            Self::Control => "control",
        }
    }

    /// Tells whether the token means something to the parser: it is a name, an argument or one that went wrong.
    #[must_use]
    pub const fn is_significant(self) -> bool {
        match self {
            Self::Word | Self::Number | Self::Path | Self::Quoted | Self::OpenQuote => true,
            Self::Bom
            | Self::Newline
            | Self::Blank
            | Self::Comment
            | Self::ForeignBlank
            | Self::LoneReturn
            | Self::Control => false,
        }
    }

    /// Tells whether no scene may hold the token where it stands.
    #[must_use]
    pub const fn is_foreign(self) -> bool {
        matches!(self, Self::ForeignBlank | Self::LoneReturn | Self::Control)
    }
}

/// A token: its kind and its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Token {
    /// What it is.
    pub kind: TokenKind,
    /// Where it is; never empty.
    pub span: Span,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_token_is_twelve_bytes() {
        assert_eq!(size_of::<Token>(), 12);
    }
}
