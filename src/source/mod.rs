//! Source text: bytes in, text with places out.
//!
//! A [`Source`] owns one scene file as text; every later stage speaks of it in [`Span`]s of bytes. Bytes that are no
//! UTF-8 are replaced one for one, so that spans keep their meaning, and are listed for the parser to report.
//!
//! Never here: opening files, deciding what an encoding fault means for the scene (see `syntax`).

mod line_index;
mod span;
mod text;

pub use line_index::{LineIndex, Position};
pub use span::Span;
pub use text::{Encoding, Source, SourceError};
