//! What `clisc --version` says.

use std::sync::LazyLock;

use clisc::trace::kernels::Backend;

static LONG: LazyLock<String> = LazyLock::new(|| {
    let commit = option_env!("CLISC_COMMIT").map_or_else(String::new, |commit| format!(" ({commit})"));
    let available = Backend::ALL.into_iter().rev().filter(|backend| backend.is_available());
    let names: Vec<&str> = available.map(Backend::name).collect();
    let target = format!("{}, {}", std::env::consts::ARCH, std::env::consts::OS);
    format!("{}{commit}\nbackends: {} ({target}; the first is used)", env!("CARGO_PKG_VERSION"), names.join(", "))
});

/// Returns version, commit (where it is known) and the backends of this machine, the one in use first.
///
/// The first line is enough to find the sources, the second to explain a difference in speed; pixels depend on neither.
pub fn long() -> &'static str {
    &LONG
}
