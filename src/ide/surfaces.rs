//! Surfaces and the objects that use them; names and where they stand.

use crate::ide::document::kind_of;
use crate::ide::{Document, MAX_ANSWERS};
use crate::source::Span;
use crate::syntax::spec::CommandKind;
use crate::syntax::{ast, file_name};

/// A command that sets or uses a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Use {
    /// The command, without its comment.
    pub span: Span,
    /// Whether it is the `surface` itself.
    pub is_surface: bool,
}

const fn is_object(kind: Option<CommandKind>) -> bool {
    matches!(kind, Some(CommandKind::Sphere | CommandKind::Cylinder))
}

fn is_surface(command: &ast::Command<'_>) -> bool {
    kind_of(command) == Some(CommandKind::Surface)
}

/// Returns the command on the line of `offset`.
fn command_at(document: &Document, offset: u32) -> Option<ast::Command<'_>> {
    let lines = document.lines();
    let line = lines.span(document.text(), lines.line_of(offset));
    document.commands_in(Span::new(line.start, line.end.max(line.start + 1))).next()
}

/// Returns the `surface` that the object on the line of `offset` uses, or the `surface` on that line.
#[must_use]
pub fn surface_at(document: &Document, offset: u32) -> Option<Span> {
    let command = command_at(document, offset).filter(|command| is_surface(command) || is_object(kind_of(command)))?;
    let before = document.file().commands().rev().skip_while(|other| other.span.start > command.span.start);
    before.into_iter().find(is_surface).map(|surface| surface.span)
}

/// Returns the `surface` at `offset`, or that of the object there, and every object that uses it.
#[must_use]
pub fn uses_of_surface_at(document: &Document, offset: u32) -> Vec<Use> {
    let Some(surface) = surface_at(document, offset) else { return Vec::new() };
    let behind = document.commands_in(Span::new(surface.end, u32::MAX)).take_while(|command| !is_surface(command));
    let objects = behind.filter(|command| is_object(kind_of(command)));
    let objects = objects.map(|object| Use { span: object.span, is_surface: false });
    std::iter::once(Use { span: surface, is_surface: true }).chain(objects).take(MAX_ANSWERS).collect()
}

/// A file name and every place that writes to it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Names {
    /// The name, without quotes.
    pub name: String,
    /// The place that was asked about, quotes included.
    pub span: Span,
    /// Every place, quotes included.
    pub places: Vec<Span>,
}

/// Returns the file name at `offset`: nothing else in a scene has a name.
#[must_use]
pub fn names_at(document: &Document, offset: u32) -> Option<Names> {
    let source = document.source();
    let written = |command: &ast::Command<'_>| {
        if kind_of(command) == Some(CommandKind::Write) { file_name(source, command.span) } else { None }
    };
    let (name, span) = written(&command_at(document, offset)?)?;
    if !(span.start..=span.end).contains(&offset) {
        return None;
    }
    let same = document.file().commands().filter_map(|command| written(&command)).filter(|(other, _)| *other == name);
    Some(Names { name: name.to_owned(), span, places: same.map(|(_, span)| span).take(MAX_ANSWERS).collect() })
}
