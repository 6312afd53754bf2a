//! Ctrl-C and SIGTERM.
//!
//! A signal sets flags, which is all that its handler may safely do; no thread waits for it, because starting one takes
//! longer than a small image.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::Context;
use clisc::exec::CancellationToken;
use signal_hook::{consts, flag};

/// The exit code of an interrupted process: 128 and the number of SIGINT.
pub const EXIT_CODE: u8 = 130;

/// The signals that ask a process to end: from a terminal, from a program, from a terminal that is closed.
#[cfg(unix)]
const SIGNALS: [i32; 3] = [consts::SIGINT, consts::SIGTERM, consts::SIGHUP];
#[cfg(not(unix))]
const SIGNALS: [i32; 2] = [consts::SIGINT, consts::SIGTERM];

/// What a signal does: it cancels what is being rendered, and ends the process when that is asked for already or when
/// nothing is being rendered.
#[derive(Debug)]
pub struct Interrupts {
    cancelled: Arc<AtomicBool>,
    /// Whether the next signal ends the process at once.
    is_deadly: Arc<AtomicBool>,
}

impl Interrupts {
    /// Listens to signals from now on.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn listen() -> anyhow::Result<Self> {
        let interrupts = Self { cancelled: Arc::default(), is_deadly: Arc::new(AtomicBool::new(true)) };
        for signal in SIGNALS {
            interrupts.listen_to(signal).context("cannot listen to signals")?;
        }
        Ok(interrupts)
    }

    /// Sets what one signal does, in this order: end the process if it may, cancel, let the next one be deadly.
    fn listen_to(&self, signal: i32) -> std::io::Result<()> {
        flag::register_conditional_shutdown(signal, EXIT_CODE.into(), Arc::clone(&self.is_deadly))?;
        flag::register(signal, Arc::clone(&self.cancelled))?;
        flag::register(signal, Arc::clone(&self.is_deadly))?;
        Ok(())
    }

    /// Returns the token that a signal sets.
    pub fn token(&self) -> CancellationToken {
        Arc::clone(&self.cancelled).into()
    }

    /// Runs `f`, during which the first signal cancels and does not kill; the second need not wait for its band.
    pub fn while_rendering<T>(&self, f: impl FnOnce() -> T) -> T {
        self.is_deadly.store(false, Ordering::SeqCst);
        let result = f();
        self.is_deadly.store(true, Ordering::SeqCst);
        result
    }
}
