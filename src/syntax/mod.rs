//! The language: text in, tokens and a tree out.
//!
//! Never here: what a command means for the scene (see `lower`), opening files, drawing diagnostics.

pub mod ast;
mod lexer;
mod parser;
pub mod spec;
mod token;

pub use lexer::lex;
pub use parser::{Parse, argument_spans, file_name, parse, parse_in_chunks};
pub use token::{Token, TokenKind};
