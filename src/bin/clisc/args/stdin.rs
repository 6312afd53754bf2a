//! What standard input is called.

use std::path::{Path, PathBuf};

use clap::Args;

/// What standard input is called.
#[derive(Args, Debug)]
pub struct StdinArgs {
    /// The file that standard input stands for: messages name it, and its folder says which clisc.toml counts.
    #[arg(long, value_name = "FILE")]
    stdin_filename: Option<PathBuf>,
}

impl StdinArgs {
    /// Returns the file that standard input stands for, if it was named.
    pub fn filename(&self) -> Option<&Path> {
        self.stdin_filename.as_deref()
    }
}
