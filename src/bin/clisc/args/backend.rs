//! Which instructions of the machine trace an image.

use std::env;

use anyhow::bail;
use clap::{Args, ValueEnum};
use clisc::plan::BackendChoice;
use clisc::trace::kernels::Backend;

/// The variable that chooses where no option does.
const VARIABLE: &str = "CLISC_BACKEND";

/// Which instructions of the machine trace an image.
#[derive(Args, Clone, Copy, Debug)]
pub struct BackendArgs {
    /// What instructions of the machine to use, for comparison: no byte of an image depends on it. CLISC_BACKEND chooses
    /// where this option does not.
    #[arg(long, value_enum, value_name = "NAME", ignore_case = true)]
    backend: Option<BackendArg>,
}

/// A backend by its name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum BackendArg {
    /// The fastest that the machine has; the default.
    #[default]
    Auto,
    /// AVX-512: eight numbers at once, or sixteen of binary32.
    Avx512,
    /// AVX2: four numbers at once, or eight.
    Avx2,
    /// One number after the other.
    Scalar,
}

impl From<BackendArg> for BackendChoice {
    fn from(backend: BackendArg) -> Self {
        match backend {
            BackendArg::Auto => Self::Auto,
            BackendArg::Avx512 => Self::Avx512,
            BackendArg::Avx2 => Self::Avx2,
            BackendArg::Scalar => Self::Scalar,
        }
    }
}

impl BackendArgs {
    /// Returns the backend that the option chooses, or else the variable, or else the machine.
    ///
    /// # Errors
    /// When the machine does not have it, or the variable names none.
    pub fn choice(self) -> anyhow::Result<BackendChoice> {
        match self.backend {
            Some(backend) => available(backend.into(), ""),
            None => by_variable(),
        }
    }
}

/// Returns the backend that the variable chooses; where it is not set or empty, the machine chooses.
///
/// # Errors
/// When the machine does not have it, or the variable names none.
pub fn by_variable() -> anyhow::Result<BackendChoice> {
    let value = env::var_os(VARIABLE).unwrap_or_default();
    let value = value.to_string_lossy();
    if value.is_empty() {
        return Ok(BackendChoice::Auto);
    }
    match BackendArg::from_str(&value, true) {
        Ok(backend) => available(backend.into(), ", which CLISC_BACKEND asks for"),
        Err(_) => bail!("{VARIABLE} is `{value}`, not auto, avx512, avx2 or scalar"),
    }
}

/// Returns the choice if the machine has it. `by` says who made it.
fn available(choice: BackendChoice, by: &str) -> anyhow::Result<BackendChoice> {
    let backend = Backend::chosen(choice);
    if !backend.is_available() {
        bail!("this machine has no {}{by}; it has {}", backend.name(), names_available().join(", "));
    }
    Ok(choice)
}

/// Returns the names of the backends of this machine, the fastest first.
pub fn names_available() -> Vec<&'static str> {
    let available = Backend::ALL.into_iter().rev().filter(|backend| backend.is_available());
    available.map(Backend::name).collect()
}
