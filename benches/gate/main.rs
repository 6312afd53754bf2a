//! Has a hot path become slower? Counts the instructions of each case under callgrind and holds them against the limits
//! in `benches/gate.json`.
//!
//! A count does not feel what else the machine does, so a gate can be narrow where a timed one could not.
//! What it depends on is written down or fixed: the compiler and the release profile (the limits name the compiler they
//! are from); the vector instructions (valgrind shows every program the same processor with AVX2 and without AVX-512, so
//! the AVX2 paths are counted, everywhere); the threads (each case runs on one). [`MARGIN`] is for what remains, such as
//! the C library. It does not see caches, mispredicted branches, threads that wait, or what AVX-512 does: those are for
//! `cargo bench --bench speed` and `benches/compare.py`.
//!
//! `cargo bench --bench gate` compares and fails when a count is above its limit; `CLISC_BLESS=1` before it writes the
//! counts of today as limits, to be committed with the change that explains them. It needs valgrind.
//!
//! Not built on gungraun, which counts in the same way: its runner takes two minutes of processor time to build, on
//! every fresh machine anew, and this gate is to be over by then.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a program for people and CI")]

mod callgrind;
mod cases;
#[path = "../support/input.rs"]
mod input;
mod limits;

use std::collections::BTreeMap;
use std::process::ExitCode;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;

use crate::cases::CASES;
use crate::limits::Limits;

/// How far a count may lie above its limit, as a share of it.
const MARGIN: f64 = 0.03;

fn main() -> ExitCode {
    let mut args = std::env::args().skip(1);
    let result = match args.next().as_deref() {
        Some(callgrind::CASE_FLAG) => cases::run(&args.next().unwrap_or_default()),
        // What cargo adds, or nothing.
        _ => compare(),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("gate: {message}");
            ExitCode::FAILURE
        }
    }
}

/// Counts every case and compares, or blesses.
fn compare() -> Result<(), String> {
    let counts = count_all()?;
    if std::env::var_os("CLISC_BLESS").is_some_and(|value| value == "1") {
        return Limits::of_today(counts)?.save();
    }
    let limits = Limits::load()?;
    let verdicts = limits.judge(&counts);
    println!("{:32} {:>15} {:>15} {:>9}", "instructions of", "limit", "counted", "change");
    verdicts.iter().for_each(|verdict| println!("{verdict}"));
    let n_faults = verdicts.iter().filter(|verdict| verdict.is_fault(MARGIN)).count();
    if n_faults == 0 {
        return Ok(());
    }
    Err(format!(
        "{n_faults} of {} cases lie more than {:.0} % above their limit, or have only one of the two; the limits are of \
         {}, this is {}. If that is meant: CLISC_BLESS=1 cargo bench --bench gate",
        verdicts.len(),
        MARGIN * 100.0,
        limits.compiler,
        limits::compiler()?
    ))
}

/// Counts the instructions of every case, as many at a time as there are cores.
fn count_all() -> Result<BTreeMap<String, u64>, String> {
    let next = AtomicUsize::new(0);
    let counts = Mutex::new(Ok(BTreeMap::new()));
    let count_some = || {
        while let Some(case) = CASES.get(next.fetch_add(1, Ordering::Relaxed)) {
            let counted = callgrind::count(case.name);
            let mut counts = counts.lock().unwrap_or_else(PoisonError::into_inner);
            match (counted, &mut *counts) {
                (Ok(count), Ok(counts)) => drop(counts.insert(case.name.to_owned(), count)),
                (Err(message), all) => *all = Err(message),
                (Ok(_), Err(_)) => {}
            }
        }
    };
    thread::scope(|scope| {
        for _ in 0..thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(count_some);
        }
    });
    counts.into_inner().unwrap_or_else(PoisonError::into_inner)
}
