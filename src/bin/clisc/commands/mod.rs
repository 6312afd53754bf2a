//! One file a subcommand.

pub mod check;
pub mod explain;
pub mod fmt;
pub mod ir;
pub mod run;
