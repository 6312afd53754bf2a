//! The language: text in, tokens and a tree out.
//!
//! Never here: what a command means for the scene (see `lower`), opening files, drawing diagnostics.

pub mod ast;
mod directive;
mod dump;
pub mod editions;
mod lexer;
mod parser;
pub mod spec;
mod token;

pub use directive::{Directive, directive, directives};
pub use dump::{dump_ast, dump_ast_json, dump_tokens, dump_tokens_json};
pub use lexer::{lex, lex_one};
pub use parser::{Parse, Runs, argument_spans, file_name, parse, parse_in_chunks};
pub use token::{Token, TokenKind};
