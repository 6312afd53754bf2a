//! Questions whose answers change the text.

use clisc::diag::fix::apply;
use clisc::diag::{Diagnostic, Edit, Fix, Safety};
use clisc::exec::refuse_name;
use clisc::format::{Piece, changes, changes_in, format};
use clisc::ide;
use clisc::lint::safe_fixes;
use clisc::source::{Source, Span};
use clisc::syntax::{file_name, parse};
use lsp_server::{ErrorCode, ResponseError};
use lsp_types::{
    CodeAction, CodeActionKind, CodeActionOrCommand, CodeActionParams, DocumentFormattingParams,
    DocumentRangeFormattingParams, PrepareRenameResponse, RenameParams, TextDocumentPositionParams, TextEdit,
    WorkspaceEdit,
};

use crate::lsp::capabilities::FIX_ALL;
use crate::lsp::convert::Places;
use crate::lsp::documents::Open;
use crate::lsp::server::failure;

type Answer<T> = Result<T, ResponseError>;

pub fn formatting(open: &Open, _: DocumentFormattingParams) -> Answer<Option<Vec<TextEdit>>> {
    let source = open.document.source();
    let changes = changes(source);
    if changes.len() > ide::MAX_ANSWERS {
        let text = String::from_utf8_lossy(&format(source)).into_owned();
        return Ok(Some(vec![Places::new(open).text_edit(Span::new(0, source.text().len() as u32), text)]));
    }
    Ok(Some(text_edits(open, &changes)))
}

pub fn range_formatting(open: &Open, params: DocumentRangeFormattingParams) -> Answer<Option<Vec<TextEdit>>> {
    let source = open.document.source();
    let span = Places::new(open).span(params.range);
    let line_of = |offset| source.lines().line_of(offset);
    // A range that ends where a line begins does not mean that line.
    let last = line_of(if span.is_empty() { span.end } else { span.end - 1 });
    Ok(Some(text_edits(open, &changes_in(source, line_of(span.start)..last + 1))))
}

fn text_edits(open: &Open, changes: &[Piece<'_>]) -> Vec<TextEdit> {
    let places = Places::new(open);
    let edit = |change: &Piece<'_>| {
        let new = String::from_utf8_lossy(&change.new);
        let (span, new) = narrowed(open.document.source(), change.old, &new);
        places.text_edit(span, new)
    };
    changes.iter().map(edit).collect()
}

/// Returns a replacement without what both texts begin and end with, so that cursors and marks stay where they are.
fn narrowed<'n>(source: &Source, old: Span, new: &'n str) -> (Span, &'n str) {
    let text = source.slice(old);
    let n_before = common(text.chars(), new.chars());
    let (text, new) = (&text[n_before..], &new[n_before..]);
    let n_behind = common(text.chars().rev(), new.chars().rev());
    let span = Span::new(old.start + n_before as u32, old.end - n_behind as u32);
    (span, &new[..new.len() - n_behind])
}

/// Returns how many bytes of characters the two share.
fn common(a: impl Iterator<Item = char>, b: impl Iterator<Item = char>) -> usize {
    a.zip(b).take_while(|(a, b)| a == b).map(|(a, _)| a.len_utf8()).sum()
}

/// Offers every fix of what touches the range, and all safe ones at once.
pub fn code_actions(open: &Open, params: CodeActionParams) -> Answer<Option<Vec<CodeActionOrCommand>>> {
    if !open.client.has_code_actions {
        return Ok(None);
    }
    let wants = |kind: &CodeActionKind| {
        let is_wider = |wanted: &CodeActionKind| {
            kind.as_str().strip_prefix(wanted.as_str()).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        };
        params
            .context
            .only
            .as_ref()
            .is_none_or(|only| only.iter().any(|wanted| wanted.as_str().is_empty() || is_wider(wanted)))
    };
    let range = Places::new(open).span(params.range);
    let mut actions = Vec::new();
    if wants(&CodeActionKind::QUICKFIX) {
        for found in open.found().listed.iter().filter(|found| touches(found, range)) {
            actions.extend(found.fixes.iter().map(|fix| quick_fix(open, found, fix)));
            actions.extend(allow(open, found));
        }
    }
    let fix_all = CodeActionKind::new(FIX_ALL);
    if wants(&fix_all) {
        actions.extend(fix_all_action(open, fix_all));
    }
    Ok(Some(actions.into_iter().map(CodeActionOrCommand::CodeAction).collect()))
}

fn touches(found: &Diagnostic, range: Span) -> bool {
    let mut places = std::iter::once(&found.primary).chain(&found.secondary).map(|label| label.span);
    places.any(|span| span.start <= range.end && range.start <= span.end)
}

fn quick_fix(open: &Open, found: &Diagnostic, fix: &Fix) -> CodeAction {
    CodeAction {
        title: fix.title.clone(),
        kind: Some(CodeActionKind::QUICKFIX),
        diagnostics: Some(vec![Places::new(open).diagnostic(found)]),
        edit: Some(edit_of(open, &fix.edits)),
        is_preferred: (fix.safety == Safety::Safe).then_some(true),
        ..CodeAction::default()
    }
}

/// Offers a comment that allows a finding, above its line. An error cannot be allowed.
fn allow(open: &Open, found: &Diagnostic) -> Option<CodeAction> {
    let name = found.code.name.filter(|_| !found.code.id.starts_with('E'))?;
    let comment = format!("# clisc: allow({name})");
    let edit = Edit::insert_line_before(open.document.source(), found.primary.span.start, &comment);
    Some(CodeAction {
        is_preferred: None,
        ..quick_fix(open, found, &Fix::guess(format!("allow it here: `{comment}`"), vec![edit]))
    })
}

/// Offers all safe fixes that do not touch each other, if there are any.
fn fix_all_action(open: &Open, kind: CodeActionKind) -> Option<CodeAction> {
    let fixes: Vec<&Fix> = safe_fixes(&open.found().listed).map(|(_, fix)| fix).collect();
    let fixed = apply(open.document.text(), fixes.iter().copied());
    let applied = fixes.iter().zip(fixed.is_applied).filter(|(_, is_applied)| *is_applied);
    let edits: Vec<Edit> = applied.flat_map(|(fix, _)| fix.edits.clone()).collect();
    (!edits.is_empty()).then(|| CodeAction {
        title: "carry out every safe fix".to_owned(),
        kind: Some(kind),
        edit: Some(edit_of(open, &edits)),
        ..CodeAction::default()
    })
}

fn edit_of(open: &Open, edits: &[Edit]) -> WorkspaceEdit {
    let places = Places::new(open);
    places.workspace_edit(edits.iter().map(|edit| places.text_edit(edit.span, &edit.replacement)).collect())
}

/// Tells what would be renamed: a file name, for nothing else has a name.
pub fn prepare_rename(open: &Open, params: TextDocumentPositionParams) -> Answer<Option<PrepareRenameResponse>> {
    let places = Places::new(open);
    let names = ide::names_at(&open.document, places.offset(params.position));
    Ok(names.map(|names| PrepareRenameResponse::RangeWithPlaceholder {
        range: places.range(names.span),
        placeholder: names.name,
    }))
}

/// Renames an image wherever it is written.
pub fn rename(open: &Open, params: RenameParams) -> Answer<Option<WorkspaceEdit>> {
    let places = Places::new(open);
    let names = ide::names_at(&open.document, places.offset(params.text_document_position.position));
    let refused = |message: &str| failure(ErrorCode::RequestFailed, message);
    let names = names.ok_or_else(|| refused("only the name of an image can be changed: nothing else has one"))?;
    let name = written_name(&params.new_name)
        .ok_or_else(|| refused("the name of an image ends in `.png` and stays below the output folder"))?;
    Ok(Some(places.workspace_edit(names.places.into_iter().map(|span| places.text_edit(span, &name)).collect())))
}

/// Returns a file name as a scene writes it, in quotes where they are needed; none if no scene can.
fn written_name(name: &str) -> Option<String> {
    let name = name.strip_prefix('"').and_then(|name| name.strip_suffix('"')).unwrap_or(name);
    let can_be = |written: &String| {
        let source = Source::new("", format!("write {written}\n"));
        let parsed = parse(&source);
        let read = parsed.file.commands().next().and_then(|command| file_name(&source, command.span));
        parsed.diagnostics.is_empty() && parsed.file.n_commands() == 1 && read.is_some_and(|(read, _)| read == name)
    };
    let written = [name.to_owned(), format!("\"{name}\"")].into_iter().find(can_be)?;
    refuse_name(name).is_none().then_some(written)
}
