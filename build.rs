//! Tells the program from which commit it is built, for `clisc --version`, and how to link it so that it starts quickly.
//!
//! The commit is asked of git, or read from what `cargo package` leaves in a published package. Without either the version
//! is told alone. Whether the tree was changed since the commit is not told: that would build everything anew each time.
//!
//! A released program needs nothing of a dynamic linker, whose work takes as long as a small image: three libraries are
//! mapped and bound, and five thousand addresses corrected. So it is linked statically, where that is known to work:
//! on x86-64 Linux with glibc, if the static libraries are there. What `-C target-feature=+crt-static` does cannot be
//! asked for here, because cargo would build procedural macros with it, and they have to be dynamic.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

/// How many digits of a commit are told; enough to be unique in any repository of this kind.
const DIGITS: usize = 12;

/// The libraries that rustc asks the linker for, each with the static ones that hold the same.
const LIBRARIES: [(&str, &[&str]); 7] = [
    ("gcc_s", &["libgcc_eh.a", "libgcc.a", "libc.a"]),
    ("c", &["libc.a"]),
    ("m", &["libm.a"]),
    ("dl", &["libdl.a"]),
    ("pthread", &["libpthread.a"]),
    ("rt", &["librt.a"]),
    ("util", &["libutil.a"]),
];

/// Set to `dynamic`, the program is linked like any other.
const LINK: &str = "CLISC_LINK";

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed={LINK}");
    if is_linked_statically() {
        link_statically();
    }
    if let Some(commit) = of_git().or_else(of_package) {
        println!("cargo::rustc-env=CLISC_COMMIT={}", &commit[..DIGITS.min(commit.len())]);
    }
}

/// Returns the commit of the repository whose top level is this package; of no other, in which the sources may merely lie.
fn of_git() -> Option<String> {
    let top = git(&["rev-parse", "--show-toplevel"])?;
    if fs::canonicalize(top).ok()? != fs::canonicalize(env!("CARGO_MANIFEST_DIR")).ok()? {
        return None;
    }
    // The log of HEAD grows with each commit and checkout. Cargo would take a missing file for one that always changes.
    let log = PathBuf::from(git(&["rev-parse", "--git-path", "logs/HEAD"])?);
    if log.exists() {
        println!("cargo::rerun-if-changed={}", log.display());
    }
    git(&["rev-parse", "HEAD"])
}

/// Returns what git answers; `None` where it has no answer, or is missing.
fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok().filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
}

/// Returns the commit that a published package was made of.
fn of_package() -> Option<String> {
    let info = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(".cargo_vcs_info.json")).ok()?;
    let (_, behind) = info.split_once("\"sha1\"")?;
    behind.split('"').nth(1).map(str::to_owned)
}

/// Tells whether the program is a release for this machine, of a kind of which static linking is known to work.
fn is_linked_statically() -> bool {
    let is = |name: &str, value: &str| env::var(name).is_ok_and(|found| found == value);
    let is_known = is("CARGO_CFG_TARGET_ARCH", "x86_64") && is("CARGO_CFG_TARGET_OS", "linux");
    let is_glibc = is("CARGO_CFG_TARGET_ENV", "gnu") && env::var("TARGET") == env::var("HOST");
    is_known && is_glibc && is("PROFILE", "release") && !is(LINK, "dynamic") && has_libraries()
}

/// Tells whether the linker knows every static library: some systems have packages of their own for them.
fn has_libraries() -> bool {
    let linker = env::var("RUSTC_LINKER").unwrap_or_else(|_| "cc".to_owned());
    let is_there = |library: &&str| {
        let output = Command::new(&linker).arg(format!("-print-file-name={library}")).output();
        // An unknown library is answered by its bare name.
        output.is_ok_and(|output| Path::new(String::from_utf8_lossy(&output.stdout).trim()).is_absolute())
    };
    LIBRARIES.iter().flat_map(|(_, libraries)| *libraries).all(is_there)
}

/// Puts scripts that name the static libraries where the linker looks for the dynamic ones first.
fn link_statically() {
    let folder = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets it")).join("libraries");
    let write = |(name, libraries): (&str, &[&str])| {
        fs::write(folder.join(format!("lib{name}.so")), format!("GROUP({})", libraries.join(" ")))
    };
    let written = fs::create_dir_all(&folder).and_then(|()| LIBRARIES.into_iter().try_for_each(write));
    if written.is_ok() {
        println!("cargo::rustc-link-arg-bins=-L{}", folder.display());
        // Told `-static`, gcc would link a prologue that registers unwind tables, to be read whole at the first error.
        println!("cargo::rustc-link-arg-bins=-Wl,--no-dynamic-linker");
        println!("cargo::rustc-link-arg-bins=-no-pie");
    }
}
