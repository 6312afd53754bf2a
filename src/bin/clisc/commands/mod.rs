//! One file a subcommand.

pub mod bench;
pub mod check;
pub mod completions;
pub mod explain;
pub mod fmt;
pub mod ir;
pub mod lint;
pub mod lsp;
pub mod man;
pub mod run;
