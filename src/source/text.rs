//! One scene file as text.

use std::borrow::Cow;
use std::sync::OnceLock;

use crate::source::{LineIndex, Span};

/// The byte that stands for a byte that was no UTF-8: SUBSTITUTE, one byte wide so that no span moves.
const SUBSTITUTE: u8 = 0x1A;

/// How the bytes of a source were written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// UTF-8, with or without a byte-order mark, possibly with stray bytes in it.
    Utf8,
    /// UTF-16 by its byte-order mark; none of it can be read as a scene.
    Utf16,
}

/// Bytes that cannot become a source at all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SourceError {
    /// The text is longer than a 32-bit span can say.
    TooLarge {
        /// Its length in bytes.
        n_bytes: usize,
    },
}

impl std::fmt::Display for SourceError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::TooLarge { n_bytes } => {
                write!(f, "a scene of {n_bytes} bytes is too large: at most {} can be read", u32::MAX - 1)
            }
        }
    }
}

impl std::error::Error for SourceError {}

/// One scene file: its name, its text, and where the text was no UTF-8.
#[derive(Debug)]
pub struct Source {
    name: String,
    text: String,
    encoding: Encoding,
    /// Runs of bytes that were no UTF-8, in order; each is as many SUBSTITUTE characters in `text`.
    invalid: Vec<(Span, Vec<u8>)>,
    lines: OnceLock<LineIndex>,
}

impl Source {
    /// Makes a source from text that is known to be UTF-8. `name` is what messages call it.
    ///
    /// # Panics
    /// When the text is longer than 4 GiB; use [`Source::from_bytes`] for input of unknown size.
    #[must_use]
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Self {
        Self::from_bytes(name, text.into().into_bytes()).expect("a text below 4 GiB")
    }

    /// Makes a source from the bytes of a file, whatever they are.
    ///
    /// # Errors
    /// [`SourceError::TooLarge`] from 4 GiB on.
    pub fn from_bytes(name: impl Into<String>, bytes: Vec<u8>) -> Result<Self, SourceError> {
        if bytes.len() >= u32::MAX as usize {
            return Err(SourceError::TooLarge { n_bytes: bytes.len() });
        }
        let encoding = match bytes.as_slice() {
            [0xFF, 0xFE, ..] | [0xFE, 0xFF, ..] => Encoding::Utf16,
            _ => Encoding::Utf8,
        };
        let (text, invalid) = match String::from_utf8(bytes) {
            Ok(text) => (text, Vec::new()),
            Err(error) => substitute_invalid(error.into_bytes()),
        };
        Ok(Self { name: name.into(), text, encoding, invalid, lines: OnceLock::new() })
    }

    /// Returns the name that messages use.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Gives the text back.
    #[must_use]
    pub fn into_text(self) -> String {
        self.text
    }

    /// Returns the text; byte offsets in it are those of the file.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Returns the text below `span`.
    #[must_use]
    pub fn slice(&self, span: Span) -> &str {
        &self.text[span.range()]
    }

    /// Returns how the file was written.
    #[must_use]
    pub fn encoding(&self) -> Encoding {
        self.encoding
    }

    /// Returns the runs of bytes that were no UTF-8, with those bytes, in order.
    #[must_use]
    pub fn invalid_utf8(&self) -> &[(Span, Vec<u8>)] {
        &self.invalid
    }

    /// Returns the bytes of the file as they came.
    #[must_use]
    pub fn original_bytes(&self) -> Cow<'_, [u8]> {
        if self.invalid.is_empty() {
            return Cow::Borrowed(self.text.as_bytes());
        }
        let mut bytes = self.text.clone().into_bytes();
        for (span, original) in &self.invalid {
            bytes[span.range()].copy_from_slice(original);
        }
        Cow::Owned(bytes)
    }

    /// Returns the line starts, found at the first call.
    #[must_use]
    pub fn lines(&self) -> &LineIndex {
        self.lines.get_or_init(|| LineIndex::new(&self.text))
    }
}

/// Replaces each byte that is no UTF-8 by SUBSTITUTE and lists the runs of them.
fn substitute_invalid(mut bytes: Vec<u8>) -> (String, Vec<(Span, Vec<u8>)>) {
    let mut invalid: Vec<(Span, Vec<u8>)> = Vec::new();
    let mut start = 0;
    while let Err(error) = std::str::from_utf8(&bytes[start..]) {
        let bad = start + error.valid_up_to();
        let end = error.error_len().map_or(bytes.len(), |n| bad + n);
        match invalid.last_mut() {
            Some((span, run)) if span.end as usize == bad => {
                span.end = end as u32;
                run.extend_from_slice(&bytes[bad..end]);
            }
            _ => invalid.push((Span::new(bad as u32, end as u32), bytes[bad..end].to_vec())),
        }
        bytes[bad..end].fill(SUBSTITUTE);
        start = end;
    }
    let text = String::from_utf8(bytes).expect("every invalid byte was replaced");
    (text, invalid)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invalid_bytes_keep_their_places() {
        let bytes = b"a\xFC\xFFb\xC3\xA9\xE2\x82".to_vec();
        let source = Source::from_bytes("x", bytes.clone()).unwrap();
        assert_eq!(source.text(), "a\u{1A}\u{1A}bé\u{1A}\u{1A}");
        let spans: Vec<_> = source.invalid_utf8().iter().map(|(span, _)| *span).collect();
        assert_eq!(spans, [Span::new(1, 3), Span::new(6, 8)]);
        assert_eq!(*source.original_bytes(), bytes[..]);
    }
}
