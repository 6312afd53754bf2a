//! One case under callgrind.

use std::process::Command;

/// The argument by which this program is told to run one case.
pub const CASE_FLAG: &str = "--case";

/// Counts the instructions that a case takes, without its preparation.
///
/// # Errors
/// When valgrind is missing, or the case fails under it.
pub fn count(case: &str) -> Result<u64, String> {
    let folder = tempfile::tempdir().map_err(|error| format!("no temporary folder: {error}"))?;
    let counts = folder.path().join("counts");
    let this = std::env::current_exe().map_err(|error| format!("this program is nowhere: {error}"))?;
    let mut valgrind = Command::new("valgrind");
    valgrind
        .args(["--tool=callgrind", "--collect-atstart=no", "--quiet"])
        .arg(format!("--toggle-collect=*{}*", super::cases::MEASURED))
        .arg(format!("--callgrind-out-file={}", counts.display()))
        .arg(this)
        .args([CASE_FLAG, case]);
    let output = valgrind.output().map_err(|error| format!("valgrind does not start ({error}); it is a package"))?;
    if !output.status.success() {
        return Err(format!("{case} fails under valgrind:\n{}", String::from_utf8_lossy(&output.stderr)));
    }
    let counts = std::fs::read_to_string(&counts).map_err(|error| format!("{case}: no counts: {error}"))?;
    total(&counts).ok_or_else(|| format!("{case}: the counts have no total above 0"))
}

/// Reads the total off a file of callgrind.
fn total(counts: &str) -> Option<u64> {
    let totals = counts.lines().find_map(|line| line.strip_prefix("totals: "))?;
    totals.trim().parse().ok().filter(|total| *total > 0)
}
