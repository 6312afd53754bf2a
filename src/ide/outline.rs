//! The scene at a glance: its commands as a tree, and what can be folded away.

use crate::ide::document::kind_of;
use crate::ide::{Document, MAX_ANSWERS};
use crate::source::Span;
use crate::syntax::directive;
use crate::syntax::spec::CommandKind;

/// A command in the outline.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Symbol {
    /// What it is.
    pub kind: CommandKind,
    /// What follows its name.
    pub detail: String,
    /// It and, of a surface, the objects below it.
    pub span: Span,
    /// The command itself.
    pub command: Span,
    /// The objects that use a surface, as far as nothing else stands between them.
    pub children: Vec<Symbol>,
}

/// Returns the commands, objects below their surface; at most [`MAX_ANSWERS`] in all.
#[must_use]
pub fn outline(document: &Document) -> Vec<Symbol> {
    /// The longest detail, in characters.
    const MAX_DETAIL: usize = 80;
    let mut symbols: Vec<Symbol> = Vec::new();
    for command in document.file().commands().take(MAX_ANSWERS) {
        let Some(kind) = kind_of(&command) else { continue };
        let words = document.source().slice(command.span).split_ascii_whitespace().skip(1);
        let detail = words.collect::<Vec<_>>().join(" ").chars().take(MAX_DETAIL).collect();
        let symbol = Symbol { kind, detail, span: command.span, command: command.span, children: Vec::new() };
        let is_object = matches!(kind, CommandKind::Sphere | CommandKind::Cylinder);
        match symbols.last_mut() {
            Some(surface) if is_object && surface.kind == CommandKind::Surface => {
                surface.span = surface.span.to(symbol.span);
                surface.children.push(symbol);
            }
            _ => symbols.push(symbol),
        }
    }
    symbols
}

/// Lines that can be folded away, counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fold {
    /// The line that stays.
    pub first: u32,
    /// The last line that goes.
    pub last: u32,
    /// What it is.
    pub kind: FoldKind,
}

/// What is folded away.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FoldKind {
    /// Comments, one below the other.
    Comment,
    /// A surface and the objects below it.
    Surface,
    /// What stands in a fence.
    Fence,
}

/// Returns what can be folded, in the order of the first lines.
#[must_use]
pub fn folds(document: &Document) -> Vec<Fold> {
    let lines = document.lines();
    let surfaces = outline(document).into_iter().filter(|symbol| !symbol.children.is_empty()).map(|symbol| Fold {
        first: lines.line_of(symbol.span.start),
        last: lines.line_of(symbol.span.end),
        kind: FoldKind::Surface,
    });
    let mut folds: Vec<_> = surfaces.chain(comment_folds(document)).filter(|fold| fold.first < fold.last).collect();
    folds.sort_by_key(|fold| (fold.first, fold.last));
    folds.truncate(MAX_ANSWERS);
    folds
}

/// Returns comments below each other, and fences.
fn comment_folds(document: &Document) -> Vec<Fold> {
    let (mut folds, mut comments, mut fence) = (Vec::new(), None, None);
    let (text, lines) = (document.text(), document.lines());
    let n_lines = lines.n_lines() as u32;
    for line in 0..n_lines {
        let body = text[lines.span(text, line).range()].trim_matches([' ', '\t']);
        match body.starts_with('#').then(|| directive(body)) {
            Some(Some("off")) => _ = fence.get_or_insert(line),
            Some(Some("on")) => {
                folds.extend(fence.take().map(|first| Fold { first, last: line, kind: FoldKind::Fence }));
            }
            Some(_) => {
                comments.get_or_insert(line);
                continue;
            }
            None => {}
        }
        folds.extend(comments.take().map(|first| Fold { first, last: line - 1, kind: FoldKind::Comment }));
    }
    let last = n_lines - 1;
    folds.extend(comments.map(|first| Fold { first, last, kind: FoldKind::Comment }));
    folds.extend(fence.map(|first| Fold { first, last, kind: FoldKind::Fence }));
    folds
}
