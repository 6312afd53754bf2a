//! The file of the limits.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde::{Deserialize, Serialize};

/// `benches/gate.json`.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    /// The compiler that the counts are from, as it names itself.
    pub compiler: String,
    /// For each case the count when it was blessed.
    instructions: BTreeMap<String, u64>,
}

/// What there is to say of one case.
#[derive(Debug)]
pub struct Verdict {
    /// Its name.
    pub name: String,
    /// Its limit; `None` when it is new.
    pub limit: Option<u64>,
    /// Its count; `None` when there is no such case.
    pub counted: Option<u64>,
}

impl Verdict {
    /// Returns by which share the count lies above its limit.
    fn change(&self) -> Option<f64> {
        let (limit, counted) = self.limit.zip(self.counted)?;
        Some(counted as f64 / limit as f64 - 1.0)
    }

    /// Tells whether the count lies above its limit by more than `margin`, a share of it, or one of the two is missing.
    pub fn is_fault(&self, margin: f64) -> bool {
        self.change().is_none_or(|change| change > margin)
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [limit, counted] =
            [self.limit, self.counted].map(|count| count.map_or_else(|| "none".to_owned(), |count| count.to_string()));
        let change = self.change().map_or_else(String::new, |change| format!("{:+.2} %", change * 100.0));
        write!(f, "{:32} {limit:>15} {counted:>15} {change:>9}", self.name)
    }
}

impl Limits {
    /// Reads the file.
    ///
    /// # Errors
    /// When it is not there or not in shape.
    pub fn load() -> Result<Self, String> {
        let text = std::fs::read(path()).map_err(|error| format!("{}: {error}", path().display()))?;
        serde_json::from_slice(&text).map_err(|error| format!("{}: {error}", path().display()))
    }

    /// Makes limits of counts.
    ///
    /// # Errors
    /// When the compiler does not say its name.
    pub fn of_today(instructions: BTreeMap<String, u64>) -> Result<Self, String> {
        Ok(Self { compiler: compiler()?, instructions })
    }

    /// Writes the file.
    ///
    /// # Errors
    /// When that fails.
    pub fn save(&self) -> Result<(), String> {
        let text = serde_json::to_string_pretty(self).map_err(|error| error.to_string())? + "\n";
        std::fs::write(path(), text).map_err(|error| format!("{}: {error}", path().display()))
    }

    /// Holds counts against the limits: one verdict a name, in order.
    pub fn judge(&self, counts: &BTreeMap<String, u64>) -> Vec<Verdict> {
        let names: BTreeSet<_> = self.instructions.keys().chain(counts.keys()).collect();
        let verdicts = names.into_iter().map(|name| {
            let [limit, counted] = [&self.instructions, counts].map(|counts| counts.get(name).copied());
            Verdict { name: name.clone(), limit, counted }
        });
        verdicts.collect()
    }
}

/// Asks the compiler for its name.
///
/// # Errors
/// When it does not answer.
pub fn compiler() -> Result<String, String> {
    let output = Command::new("rustc").arg("--version").output().map_err(|error| format!("no rustc: {error}"))?;
    Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

fn path() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/gate.json")
}
