//! `write`.

use std::collections::HashMap;
use std::sync::Arc;

use crate::diag::words::{counted, quoted};
use crate::diag::{Diagnostic, Edit, Fix, codes};
use crate::ir::Command;
use crate::lower::Lowering;
use crate::source::{Source, Span};
use crate::syntax::spec::CommandKind;
use crate::syntax::{ast, file_name};

/// What has been written so far, and since.
#[derive(Debug, Default)]
pub(super) struct Writes<'s> {
    /// The first command of the scene.
    first_command: Option<Span>,
    /// The last command of the scene so far.
    last_command: Option<Span>,
    last_write: Option<Span>,
    /// The first command behind the last write, and how many there are.
    behind: Option<(Span, usize)>,
    has_fov: bool,
    has_missed_fov: bool,
    /// The places of the names so far; a name counts without its `./`.
    names: HashMap<Vec<&'s str>, Span>,
}

impl Writes<'_> {
    /// Takes note of any command.
    pub(super) fn see(&mut self, kind: Option<CommandKind>, span: Span) {
        self.first_command.get_or_insert(span);
        self.last_command = Some(span);
        if kind == Some(CommandKind::Write) {
            self.last_write = Some(span);
            self.behind = None;
        } else if kind.is_some() {
            self.behind.get_or_insert((span, 0)).1 += 1;
        }
    }

    /// Takes note of a `fov`.
    pub(super) fn see_fov(&mut self) {
        self.has_fov = true;
    }
}

pub(super) fn lower_write(lowering: &mut Lowering<'_>, command: &ast::Command<'_>, is_sound: bool) {
    if !is_sound {
        return;
    }
    let Some((name, span)) = file_name(lowering.source, command.span) else { return };
    check_fov(lowering.source, &mut lowering.writes, command.span, &mut lowering.diagnostics);
    check_name(&mut lowering.writes, name, span, &mut lowering.diagnostics);
    lowering.emit(Command::Write(Arc::from(name)), span);
}

/// Reports the first write before which no `fov` stands.
fn check_fov(source: &Source, writes: &mut Writes<'_>, span: Span, acc: &mut Vec<Diagnostic>) {
    if writes.has_fov || writes.has_missed_fov {
        return;
    }
    writes.has_missed_fov = true;
    let top = writes.first_command.unwrap_or(span).start;
    let fov = vec![Edit::insert_line_before(source, top, "fov 60")];
    acc.push(
        Diagnostic::new(&codes::NO_FOV, span, "a `write` with no `fov` before it")
            .label("is rendered with a field of view of 60 degrees")
            .help("add `fov 60`, or another angle, before it")
            .fix(Fix::safe("add `fov 60` at the top", fov)),
    );
}

/// Reports a name that an earlier write has: its image would be overwritten.
fn check_name<'s>(writes: &mut Writes<'s>, name: &'s str, span: Span, acc: &mut Vec<Diagnostic>) {
    let folders = name.split('/').filter(|part| !part.is_empty() && *part != ".").collect();
    if let Some(earlier) = writes.names.insert(folders, span) {
        acc.push(
            Diagnostic::new(&codes::WRITTEN_TWICE, span, format!("{} is written twice", quoted(name)))
                .label("overwrites the earlier image")
                .secondary(earlier, "written here before")
                .help("give each image a name of its own"),
        );
    }
}

/// Reports a scene without a write, or one that goes on behind the last.
pub(super) fn check(source: &Source, writes: &Writes<'_>, acc: &mut Vec<Diagnostic>) {
    let Some(last_write) = writes.last_write else {
        acc.push(no_write(source, writes));
        return;
    };
    if let Some((span, n)) = writes.behind {
        let message = match n {
            1 => "a command behind the last `write` has no effect".to_owned(),
            n => format!("{} behind the last `write` have no effect", counted(n, "command")),
        };
        acc.push(
            Diagnostic::new(&codes::BEHIND_LAST_WRITE, span, message)
                .label(if n == 1 { "has no effect" } else { "the first of them" })
                .secondary(last_write, "the last image is made here")
                .help("move the `write` to the end, or remove what follows it"),
        );
    }
}

fn no_write(source: &Source, writes: &Writes<'_>) -> Diagnostic {
    let (span, label) = match writes.last_command {
        Some(span) => (span, "the last command"),
        None => (Span::at(0), "no command at all"),
    };
    Diagnostic::new(&codes::NO_WRITE, span, "the scene has no `write`: it makes no image")
        .label(label)
        .help("end the scene with a `write`, such as `write picture.png`")
        .fix(Fix::guess("add a `write` at the end", vec![Edit::append_line(source, "write picture.png")]))
}
