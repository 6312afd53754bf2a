//! Where a scene may write: below one folder, wherever that is.
//!
//! A name is judged as text here, the same on every system, so that a scene that is refused on one is refused on all.
//! Links can only be found by the sink that has the folder.

use std::path::PathBuf;

use crate::diag::{Code, Diagnostic, Fix, Safety, codes, words};
use crate::ir::{Command, Program};
use crate::source::Span;

/// Why a scene may not write to a name.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Refusal {
    /// It starts at the root of a file system.
    Absolute,
    /// It starts with a drive of Windows, `C:a`.
    Drive,
    /// A part of it is `..`.
    Climbs,
    /// It holds a character that does not show, or that turns the text around.
    Unseen {
        /// The first such character.
        character: char,
        /// How many bytes of the name stand before it.
        offset: usize,
    },
    /// A link on its way leads out of the folder.
    LinkLeadsOut {
        /// The place it leads to.
        to: PathBuf,
    },
    /// The file is there already, and it may not be written.
    ReadOnly {
        /// What messages call it.
        path: PathBuf,
    },
}

impl std::fmt::Display for Refusal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Absolute => write!(f, "is absolute"),
            Self::Drive => write!(f, "starts with a drive of Windows"),
            Self::Climbs => write!(f, "climbs with `..`"),
            Self::Unseen { character, .. } => {
                write!(f, "holds a character that does not show, U+{:04X}", u32::from(*character))
            }
            Self::LinkLeadsOut { to } => write!(f, "leads out of the output folder, to `{}`", to.display()),
            Self::ReadOnly { .. } => write!(f, "is that of a read-only file"),
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
        let whole = program.origins.command(command_idx);
        let Told { code, place, label, help, repair } = match self {
            Self::Absolute => {
                let repair = Some(below_root(name).to_owned()).filter(|below| is_good(below));
                Told {
                    repair,
                    ..Told::new(&codes::ABSOLUTE_NAME, whole, "starts outside the output folder", STAY_BELOW)
                }
            }
            Self::Drive => {
                let repair = Some(name.replacen(':', "-", 1)).filter(|name| is_good(name));
                Told { repair, ..Told::new(&codes::ABSOLUTE_NAME, whole, "Windows reads this as a drive", STAY_BELOW) }
            }
            Self::Climbs => Told::new(&codes::PARENT_FOLDER, whole, "leaves its folder", STAY_BELOW),
            Self::Unseen { character, offset } => {
                let place = place_in(whole, name, *offset, character.len_utf8());
                let repair = Some(name.replace(words::is_unseen, "")).filter(|name| is_good(name));
                let told = Told::new(&codes::UNSEEN_CHARACTER, place, "this character does not show", "remove it");
                Told { repair, ..told }
            }
            Self::LinkLeadsOut { .. } => {
                let help = "remove the link, or choose the folder it leads to with `--out-dir`";
                Told::new(&codes::LINK_LEADS_OUT, whole, "passes a link", help)
            }
            Self::ReadOnly { path } => {
                let help = format!("make `{}` writable, or choose another folder with `--out-dir`", path.display());
                Told::new(&codes::READ_ONLY, whole, "is left as it is", &help)
            }
        };
        let repair = repair.map(|name| if name.contains(' ') { format!("\"{name}\"") } else { name });
        let help = repair.as_deref().map_or(help, words::proposed);
        let note = match self {
            Self::ReadOnly { .. } => "a file that may not be written is not replaced either",
            _ => "a scene writes only below the folder of `--out-dir`",
        };
        Diagnostic::new(code, place, format!("the file name {} {self}", words::quoted(name)))
            .label(label)
            .help(help)
            .fix(repair.map(|repair| Fix::write(Safety::Unsafe, whole, repair)))
            .note(note)
    }
}

/// What a diagnostic says of a refusal.
struct Told {
    code: &'static Code,
    place: Span,
    label: &'static str,
    help: String,
    /// A name that would do.
    repair: Option<String>,
}

impl Told {
    fn new(code: &'static Code, place: Span, label: &'static str, help: &str) -> Self {
        Self { code, place, label, help: help.to_owned(), repair: None }
    }
}

const STAY_BELOW: &str = "name a file in the output folder or below it";

/// Tells whether a name may be proposed.
fn is_good(name: &str) -> bool {
    !name.is_empty() && refuse_name(name).is_none()
}

/// Returns the place of a part of a name, given the place of the whole, quotes included.
fn place_in(whole: Span, name: &str, offset: usize, n_bytes: usize) -> Span {
    let n_quotes = whole.len().saturating_sub(name.len());
    let start = whole.start + (n_quotes / 2 + offset) as u32;
    if n_quotes > 2 { whole } else { Span::new(start, start + n_bytes as u32) }
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
    if let Some((offset, character)) = name.char_indices().find(|(_, character)| words::is_unseen(*character)) {
        return Some(Refusal::Unseen { character, offset });
    }
    if name.starts_with(is_separator) || (has_drive(name) && name[2..].starts_with(is_separator)) {
        return Some(Refusal::Absolute);
    }
    if has_drive(name) {
        return Some(Refusal::Drive);
    }
    name.split(is_separator).any(|part| part == "..").then_some(Refusal::Climbs)
}

/// Tells whether a name starts with a drive: `C:\a`, and `C:a`, which is relative to what was last used on it.
fn has_drive(name: &str) -> bool {
    matches!(name.as_bytes(), [drive, b':', ..] if drive.is_ascii_alphabetic())
}

/// Returns what is left of an absolute name without its root.
fn below_root(name: &str) -> &str {
    let mut rest = name;
    loop {
        rest = match rest {
            _ if rest.starts_with(is_separator) => &rest[1..],
            _ if has_drive(rest) => &rest[2..],
            _ => return rest,
        };
    }
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
        for name in ["/a.png", "//a/b.png", r"\a.png", r"\\server\share\a.png", r"C:\a.png", "c:/a.png"] {
            assert_eq!(refuse_name(name), Some(Refusal::Absolute), "{name}");
        }
        for name in ["C:a.png", "t:30.png", "c:a/../b.png"] {
            assert_eq!(refuse_name(name), Some(Refusal::Drive), "{name}");
        }
        for (name, offset) in [("a\u{200B}.png", 1), ("\u{202E}gnp.a.png", 0), ("é\tb.png", 2), ("a.png\u{A0}", 5)] {
            let unseen = |found| matches!(found, Some(Refusal::Unseen { offset: at, .. }) if at == offset);
            assert!(unseen(refuse_name(name)), "{name:?}");
        }
        for name in ["../a.png", "a/../b.png", "a/..", r"..\a.png", r"a\..\..\b.png", r"a/..\b.png", "./../a.png"] {
            assert_eq!(refuse_name(name), Some(Refusal::Climbs), "{name}");
        }
    }

    #[test]
    fn a_name_that_would_do_is_offered() {
        let help = |name: &str| {
            let program = Program { commands: vec![Command::Write(name.into())], ..Program::default() };
            refuse_name(name).unwrap().diagnostic(&program, 0).help.unwrap()
        };
        for (name, below) in [
            ("/tmp/a.png", "tmp/a.png"),
            (r"C:\x\a.png", r"x\a.png"),
            (r"\\s\a.png", r"s\a.png"),
            ("t:30.png", "t-30.png"),
            ("a\u{202E}b.png", "ab.png"),
        ] {
            assert_eq!(help(name), format!("write `{below}`"));
        }
        assert_eq!(help("/../a.png"), "name a file in the output folder or below it");
    }
}
