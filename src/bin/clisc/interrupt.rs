//! Ctrl-C and SIGTERM.

use std::process;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::Context;
use clisc::exec::CancellationToken;

/// Whether an image is being made, so that there is something to cancel.
static RENDERING: AtomicBool = AtomicBool::new(false);

/// The exit code of an interrupted process: 128 and the number of SIGINT.
pub const EXIT_CODE: u8 = 130;

/// Returns the token that a signal sets. A signal ends the process at once when nothing is being rendered, and so does
/// the second one: the first may wait for its band.
pub fn token() -> anyhow::Result<CancellationToken> {
    let token = CancellationToken::new();
    let shared = token.clone();
    let on_signal = move || {
        if shared.cancel() || !RENDERING.load(Ordering::SeqCst) {
            #[expect(clippy::exit, reason = "a signal handler has nowhere to return to")]
            process::exit(EXIT_CODE.into());
        }
    };
    ctrlc::set_handler(on_signal).context("cannot listen to signals")?;
    Ok(token)
}

/// Runs `f`, during which a signal cancels and does not kill.
pub fn while_rendering<T>(f: impl FnOnce() -> T) -> T {
    RENDERING.store(true, Ordering::SeqCst);
    let result = f();
    RENDERING.store(false, Ordering::SeqCst);
    result
}
