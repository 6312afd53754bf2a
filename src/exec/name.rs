//! Where a scene may write: below one folder, wherever that is.
//!
//! A name is judged as text here, the same on every system, so that a scene that is refused on one is refused on all.
//! Links can only be found by the sink that has the folder.

use std::path::PathBuf;

use crate::diag::{Diagnostic, Fix, Safety, codes};
use crate::ir::{Command, Program};

/// Why a scene may not write to a name.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Refusal {
    /// It starts at the root of a file system or with a drive.
    Absolute,
    /// A part of it is `..`.
    Climbs,
    /// A link on its way leads out of the folder.
    LinkLeadsOut {
        /// The place it leads to.
        to: PathBuf,
    },
}

impl std::fmt::Display for Refusal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Absolute => write!(f, "is absolute"),
            Self::Climbs => write!(f, "climbs with `..`"),
            Self::LinkLeadsOut { to } => write!(f, "leads out of the output folder, to `{}`", to.display()),
        }
    }
}

impl Refusal {
    /// Says at the name in the source why that `write` is refused.
    ///
    /// # Panics
    /// When the command is no `write`.
    #[must_use]
    pub fn diagnostic(&self, program: &Program, command_idx: usize) -> Diagnostic {
        let Command::Write(name) = &program.commands[command_idx] else { panic!("only a `write` has a name") };
        const STAY_BELOW: &str = "name a file in the output folder or below it";
        let place = program.origins.command(command_idx);
        let (code, label, help, fix) = match self {
            Self::Absolute => {
                let below = below_root(name);
                let offer = refuse_name(below).is_none() && !below.is_empty();
                let repair = if below.contains([' ', '\t']) { format!("\"{below}\"") } else { below.to_owned() };
                let help = if offer { format!("write `{repair}`") } else { STAY_BELOW.to_owned() };
                let fix = offer.then(|| Fix::write(Safety::Unsafe, place, repair));
                (&codes::ABSOLUTE_NAME, "starts outside the output folder", help, fix)
            }
            Self::Climbs => (&codes::PARENT_FOLDER, "leaves its folder", STAY_BELOW.to_owned(), None),
            Self::LinkLeadsOut { .. } => (
                &codes::LINK_LEADS_OUT,
                "passes a link",
                "remove the link, or choose the folder it leads to with `--out-dir`".to_owned(),
                None,
            ),
        };
        Diagnostic::new(code, place, format!("the file name `{name}` {self}"))
            .label(label)
            .help(help)
            .fix(fix)
            .note("a scene writes only below the folder of `--out-dir`")
    }
}

/// Finds the names that a program may not write to, as far as their text tells: one diagnostic for each, in order.
#[must_use]
pub fn refused_names(program: &Program) -> Vec<Diagnostic> {
    let refused = |(idx, command): (usize, &Command)| match command {
        Command::Write(name) => refuse_name(name).map(|refusal| refusal.diagnostic(program, idx)),
        _ => None,
    };
    program.commands.iter().enumerate().filter_map(refused).collect()
}

/// Tells why a scene may not write to `name`, as far as its text tells.
#[must_use]
pub fn refuse_name(name: &str) -> Option<Refusal> {
    if starts_at_root(name) {
        return Some(Refusal::Absolute);
    }
    name.split(is_separator).any(|part| part == "..").then_some(Refusal::Climbs)
}

/// Tells whether a name starts at a root: `/a`, `\a`, `\\server\a`, `C:\a`, and `C:a`, which is relative to a drive.
fn starts_at_root(name: &str) -> bool {
    let has_drive = matches!(name.as_bytes(), [drive, b':', ..] if drive.is_ascii_alphabetic());
    has_drive || name.starts_with(is_separator)
}

/// Returns what is left of an absolute name without its root.
fn below_root(name: &str) -> &str {
    let mut rest = name;
    while starts_at_root(rest) {
        rest = if rest.starts_with(is_separator) { &rest[1..] } else { &rest[2..] };
    }
    rest
}

/// Both separators count on every system.
fn is_separator(c: char) -> bool {
    c == '/' || c == '\\'
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_stays_below_or_is_refused() {
        for name in ["a.png", "a/b.png", "./a.png", "a//b.png", "..a.png", "a../b...png", "ab:c.png", ".../a.png"] {
            assert_eq!(refuse_name(name), None, "{name}");
        }
        for name in ["/a.png", "//a/b.png", r"\a.png", r"\\server\share\a.png", r"C:\a.png", "c:/a.png", "C:a.png"] {
            assert_eq!(refuse_name(name), Some(Refusal::Absolute), "{name}");
        }
        for name in ["../a.png", "a/../b.png", "a/..", r"..\a.png", r"a\..\..\b.png", r"a/..\b.png", "./../a.png"] {
            assert_eq!(refuse_name(name), Some(Refusal::Climbs), "{name}");
        }
    }

    #[test]
    fn an_absolute_name_is_offered_without_its_root() {
        let help = |name: &str| {
            let program = Program { commands: vec![Command::Write(name.into())], ..Program::default() };
            Refusal::Absolute.diagnostic(&program, 0).help.unwrap()
        };
        for (name, below) in [("/tmp/a.png", "tmp/a.png"), (r"C:\x\a.png", r"x\a.png"), (r"\\s\a.png", r"s\a.png")] {
            assert_eq!(help(name), format!("write `{below}`"));
        }
        assert_eq!(help("/../a.png"), "name a file in the output folder or below it");
    }
}
