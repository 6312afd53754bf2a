//! What an editor asks about a scene: a document and a place in, answers out.
//!
//! [`Document`] holds the text while it is edited and reads it again when it is asked; the other files answer one kind of
//! question each, as pure functions of document and place. What commands and numbers are called and mean they take from the
//! command table. Lists are bounded by [`MAX_ANSWERS`], since a scene may have a million lines and no editor shows them.
//!
//! Never here: protocols, columns of an editor beyond [`position`], files, the clock.

mod color;
mod completion;
mod document;
mod found;
mod hints;
mod hover;
mod line;
mod outline;
pub mod position;
mod signature;
mod surfaces;
mod tokens;

pub use color::{ColorPlace, color_text, color_words, colors};
pub use completion::{Completion, CompletionKind, completions};
pub use document::{Change, Document, diagnostics_of};
pub use found::{Found, MAX_SHOWN, Rest};
pub use hints::{Hint, hints};
pub use hover::{Hover, hover};
pub use outline::{Fold, FoldKind, Symbol, folds, outline};
pub use signature::{Signature, signature};
pub use surfaces::{Names, Use, names_at, surface_at, uses_of_surface_at};
pub use tokens::{SemanticKind, SemanticToken, semantic_tokens};

/// The most entries of an answer: more than any editor shows.
pub const MAX_ANSWERS: usize = 10_000;
