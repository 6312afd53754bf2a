//! Reading scenes.

use std::io::{self, Read};
use std::path::Path;

use anyhow::Context;
use clisc::source::Source;

/// What messages call standard input.
const STDIN_NAME: &str = "<stdin>";

/// Reads a scene file; `-` is standard input.
///
/// # Errors
/// When it cannot be read or is too large for a scene; the message names it.
pub fn read(path: &Path) -> anyhow::Result<Source> {
    if path == Path::new("-") {
        let mut bytes = Vec::new();
        io::stdin().lock().read_to_end(&mut bytes).context("cannot read standard input")?;
        return Ok(Source::from_bytes(STDIN_NAME, bytes)?);
    }
    let name = path.display();
    let bytes = std::fs::read(path).with_context(|| format!("cannot read `{name}`"))?;
    Source::from_bytes(name.to_string(), bytes).with_context(|| format!("cannot read `{name}`"))
}
