//! The executor: a valid program in, images in a sink out.
//!
//! [`execute`] walks the command list; each `write` is traced and encoded in bands of rows by all threads, and the bands
//! are written in order, so that memory does not grow with the image. What a later `write` shares with an earlier one is
//! not traced again, as far as it is small enough to be kept. Where images go ([`Sink`]), who watches
//! ([`Observer`]) and what ends it early ([`CancellationToken`]) are parameters: a command line, a test and a web page
//! drive the same code. Every name is looked at before anything is rendered.
//!
//! Never here: files, the clock, threads of its own (it works in the current rayon pool).

mod budget;
mod cancel;
mod colors;
mod earlier;
mod exactly;
mod in_order;
mod limit;
mod name;
mod observe;
mod painter;
mod pieces;
mod proof;
mod sink;
mod stream;
mod unproved;
mod write;

pub use cancel::CancellationToken;
pub use exactly::{exact_settings, render_whole};
pub use name::{Refusal, refuse_name, refused_names};
pub use observe::{Event, Observer, Origin, WriteReport};
pub use proof::Proof;
pub use sink::{ImageRequest, MemoryFile, MemorySink, Sink, SinkError, Step};
pub use unproved::Unproved;

use std::io;

use crate::diag::Diagnostic;
use crate::exec::earlier::Earlier;
use crate::exec::write::Write;
use crate::ir::{Command, Registers, SceneView, Valid};
use crate::plan::Settings;

/// How to execute a program.
#[derive(Clone, Copy)]
pub struct Options<'a> {
    /// What every render is asked for.
    pub settings: &'a Settings,
    /// Is told what happens, and has the clock.
    pub observer: &'a dyn Observer,
    /// Ends the execution early.
    pub cancellation: &'a CancellationToken,
}

/// Why a program was not executed to its end. Images committed before stay.
#[derive(Debug)]
#[non_exhaustive]
pub enum ExecError {
    /// The scene may not write where it wants to; nothing was rendered. Holds a diagnostic for each such name.
    Refused(Vec<Diagnostic>),
    /// The sink cannot take an image.
    Sink(SinkError),
    /// The file of the image with this name cannot be written.
    Write {
        /// The name as in the source.
        name: String,
        /// Why not.
        source: io::Error,
    },
    /// The token was set.
    Cancelled,
}

impl std::fmt::Display for ExecError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Refused(diagnostics) => write!(f, "{} names of images are refused", diagnostics.len()),
            Self::Sink(error) => error.fmt(f),
            Self::Write { name, .. } => write!(f, "cannot write `{name}`"),
            Self::Cancelled => write!(f, "cancelled"),
        }
    }
}

impl std::error::Error for ExecError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Refused(_) | Self::Cancelled => None,
            Self::Sink(error) => error.source(),
            Self::Write { source, .. } => Some(source),
        }
    }
}

/// Carries out every command of a program, in order; returns what each `write` took.
///
/// # Errors
/// See [`ExecError`]. The image that was being written is abandoned.
pub fn execute<S: Sink>(program: &Valid, options: Options<'_>, sink: &mut S) -> Result<Vec<WriteReport>, ExecError> {
    let refused = check_names(program, sink)?;
    if !refused.is_empty() {
        return Err(ExecError::Refused(refused));
    }
    let mut reports = Vec::new();
    let mut registers = Registers::default();
    let mut earlier = Earlier::new(program, options.settings);
    for (idx, command) in program.commands.iter().enumerate() {
        registers.step(command);
        if let Command::Write(name) = command {
            let view = SceneView::new(program, registers);
            let write = Write { program, command_idx: idx, write_idx: reports.len(), name, options };
            reports.push(write.run(view, &mut earlier, sink)?);
        }
    }
    Ok(reports)
}

/// Finds the names that the program may not write to, without rendering: one diagnostic for each, in order.
///
/// # Errors
/// When the sink could not take one of the others, as far as that can be known.
pub fn check_names<S: Sink>(program: &Valid, sink: &mut S) -> Result<Vec<Diagnostic>, ExecError> {
    let mut refused = Vec::new();
    for (idx, command) in program.commands.iter().enumerate() {
        let Command::Write(name) = command else { continue };
        let checked = match refuse_name(name) {
            Some(refusal) => Err(SinkError::Refused(refusal)),
            None => sink.check(name),
        };
        match checked {
            Ok(()) => {}
            Err(SinkError::Refused(refusal)) => refused.push(refusal.diagnostic(program, idx)),
            Err(error) => return Err(ExecError::Sink(error)),
        }
    }
    Ok(refused)
}
