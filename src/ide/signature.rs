//! Which argument comes next.

use std::ops::Range;

use crate::ide::Document;
use crate::ide::hover::limits;
use crate::ide::line::{LineAt, arg_spec};

/// A command as one writes it, with the argument at hand.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Signature {
    /// The command with the names of its arguments.
    pub label: String,
    /// What it does.
    pub doc: &'static str,
    /// For each argument its bytes in the label (all ASCII), and what it means.
    pub args: Vec<(Range<usize>, String)>,
    /// The argument at hand; behind the last one none is.
    pub active: Option<usize>,
}

/// Returns the command at `offset` and which of its arguments stands there or would; none in a scene of another edition.
#[must_use]
pub fn signature(document: &Document, offset: u32) -> Option<Signature> {
    let line = LineAt::new(document, offset);
    if line.is_in_comment() {
        return None;
    }
    let command = line.command(document).filter(|_| !document.is_of_other_edition())?;
    let index = line.arg_index()?;
    let mut label = command.name.to_owned();
    let mut args = Vec::new();
    for (i, name) in command.arg_names().enumerate() {
        label.push(' ');
        let start = label.len();
        label.push_str(name);
        let doc = arg_spec(command, i).map(|arg| [arg.doc, &limits(arg)].join("; ")).unwrap_or_default();
        args.push((start..label.len(), doc.trim_end_matches("; ").to_owned()));
    }
    let active = Some(index).filter(|index| *index < args.len());
    Some(Signature { label, doc: command.doc, args, active })
}
