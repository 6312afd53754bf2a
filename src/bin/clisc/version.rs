//! What `clisc --version` says.

use std::sync::LazyLock;

use clisc::trace::kernels::Backend;

use crate::args::backend::{by_variable, names_available};

static LONG: LazyLock<String> = LazyLock::new(|| {
    let commit = option_env!("CLISC_COMMIT").map_or_else(String::new, |commit| format!(" ({commit})"));
    let target = format!("{}, {}", std::env::consts::ARCH, std::env::consts::OS);
    let in_use = match by_variable() {
        Ok(choice) => format!("in use: {}", Backend::chosen(choice).name()),
        Err(error) => error.to_string(),
    };
    let names = names_available().join(", ");
    format!("{}{commit}\nbackends: {names} ({target}); {in_use}", env!("CARGO_PKG_VERSION"))
});

/// Returns version, commit (where it is known), the backends of this machine, and which of them is used unless an option
/// chooses.
///
/// The first line is enough to find the sources, the second to explain a difference in speed; pixels depend on neither.
pub fn long() -> &'static str {
    &LONG
}
