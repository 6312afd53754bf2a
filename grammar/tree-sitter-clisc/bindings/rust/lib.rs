//! The tree-sitter grammar of `.cli` scenes: [`LANGUAGE`] is what `tree_sitter::Parser::set_language` takes, and
//! the queries are what editors ask of the tree.

use tree_sitter_language::LanguageFn;

unsafe extern "C" {
    fn tree_sitter_clisc() -> *const ();
}

/// The language of `.cli` scenes.
// SAFETY: src/parser.c, which tree-sitter has generated, defines this function with this signature; it returns a table
// that lives as long as the program.
pub const LANGUAGE: LanguageFn = unsafe { LanguageFn::from_raw(tree_sitter_clisc) };

/// What is a keyword, a number, a comment.
pub const HIGHLIGHTS_QUERY: &str = include_str!("../../queries/highlights.scm");

/// What another language reads: comments, by that of comments.
pub const INJECTIONS_QUERY: &str = include_str!("../../queries/injections.scm");

/// The kinds of node and their fields, as tree-sitter describes them.
pub const NODE_TYPES: &str = include_str!("../../src/node-types.json");
