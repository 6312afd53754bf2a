//! Places, diagnostics and edits as the protocol has them.

use clisc::diag::words::counted;
use clisc::diag::{Diagnostic, Severity};
use clisc::ide::position::Position;
use clisc::ide::{Document, Found, Rest};
use clisc::source::Span;
use lsp_types::{
    DiagnosticRelatedInformation, DiagnosticSeverity, DiagnosticTag, Documentation, Location, MarkupContent,
    MarkupKind, NumberOrString, OneOf, OptionalVersionedTextDocumentIdentifier, TextDocumentEdit, TextEdit,
    WorkspaceEdit,
};

use crate::lsp::documents::Open;

/// Returns a place as the library has it.
pub fn from_position(position: lsp_types::Position) -> Position {
    Position { line: position.line, column: position.character }
}

/// An open document and what is agreed with the editor, for turning places.
#[derive(Clone, Copy, Debug)]
pub struct Places<'d> {
    document: &'d Document,
    open: &'d Open,
}

impl<'d> Places<'d> {
    pub fn new(open: &'d Open) -> Self {
        Self { document: &open.document, open }
    }

    /// Returns the byte that an editor means.
    pub fn offset(&self, position: lsp_types::Position) -> u32 {
        self.document.lines().offset(self.document.text(), from_position(position), self.open.client.unit)
    }

    /// Returns the bytes that an editor means.
    pub fn span(&self, range: lsp_types::Range) -> Span {
        let (start, end) = (self.offset(range.start), self.offset(range.end));
        Span::new(start.min(end), start.max(end))
    }

    pub fn position(&self, offset: u32) -> lsp_types::Position {
        let Position { line, column } =
            self.document.lines().position(self.document.text(), offset, self.open.client.unit);
        lsp_types::Position::new(line, column)
    }

    pub fn range(&self, span: Span) -> lsp_types::Range {
        lsp_types::Range::new(self.position(span.start), self.position(span.end))
    }

    pub fn location(&self, span: Span) -> Location {
        Location::new(self.open.uri.clone(), self.range(span))
    }

    pub fn text_edit(&self, span: Span, text: impl Into<String>) -> TextEdit {
        TextEdit::new(self.range(span), text.into())
    }

    /// Returns an edit of the open document.
    pub fn workspace_edit(&self, edits: Vec<TextEdit>) -> WorkspaceEdit {
        let uri = self.open.uri.clone();
        if self.open.client.has_versioned_edits {
            let text_document = OptionalVersionedTextDocumentIdentifier { uri, version: Some(self.open.version) };
            let edits = edits.into_iter().map(OneOf::Left).collect();
            let changes = lsp_types::DocumentChanges::Edits(vec![TextDocumentEdit { text_document, edits }]);
            return WorkspaceEdit { document_changes: Some(changes), ..WorkspaceEdit::default() };
        }
        #[expect(clippy::mutable_key_type, reason = "the protocol's own type; no key is changed")]
        let changes = [(uri, edits)].into();
        WorkspaceEdit { changes: Some(changes), ..WorkspaceEdit::default() }
    }

    /// Returns the diagnostics of the document: the gravest, and one that counts the others.
    pub fn diagnostics(&self, found: &Found) -> Vec<lsp_types::Diagnostic> {
        let (shown, rest) = found.shown();
        shown.into_iter().map(|found| self.diagnostic(found)).chain(rest.map(|rest| self.rest(rest))).collect()
    }

    /// Returns the diagnostic that stands for those that are not shown.
    fn rest(&self, rest: Rest) -> lsp_types::Diagnostic {
        let counts = [(rest.n_errors, "error"), (rest.n_warnings, "warning")];
        let counts: Vec<_> = counts.into_iter().filter(|(n, _)| *n > 0).map(|(n, noun)| counted(n, noun)).collect();
        lsp_types::Diagnostic {
            range: self.range(rest.at),
            severity: Some(severity(rest.severity)),
            source: Some("clisc".to_owned()),
            message: format!("… and {} more: {}", rest.n_errors + rest.n_warnings, counts.join(", ")),
            ..lsp_types::Diagnostic::default()
        }
    }

    /// Returns a diagnostic; its help is part of the message, since editors have no other place for it.
    pub fn diagnostic(&self, found: &Diagnostic) -> lsp_types::Diagnostic {
        let help = found.help.as_ref().map_or_else(String::new, |help| format!("\nhelp: {help}"));
        let related = found.secondary.iter().map(|label| DiagnosticRelatedInformation {
            location: self.location(label.span),
            message: label.message.clone(),
        });
        let related = Some(related.collect::<Vec<_>>());
        let is_needless = found.code.id == clisc::diag::codes::BEHIND_LAST_WRITE.id;
        lsp_types::Diagnostic {
            range: self.range(found.primary.span),
            severity: Some(severity(found.severity())),
            code: Some(NumberOrString::String(found.code.id.to_owned())),
            source: Some("clisc".to_owned()),
            message: found.message.clone() + &help,
            related_information: related.filter(|related| self.open.client.has_related_places && !related.is_empty()),
            tags: is_needless.then(|| vec![DiagnosticTag::UNNECESSARY]),
            ..lsp_types::Diagnostic::default()
        }
    }
}

/// Returns Markdown, or what an editor that knows none shows.
pub fn markup(text: String, has_markdown: bool) -> MarkupContent {
    let kind = if has_markdown { MarkupKind::Markdown } else { MarkupKind::PlainText };
    MarkupContent { kind, value: text }
}

/// Returns a text beside an entry of a list.
pub fn documentation(text: String) -> Option<Documentation> {
    (!text.is_empty())
        .then_some(Documentation::MarkupContent(MarkupContent { kind: MarkupKind::PlainText, value: text }))
}

/// Returns a severity as the protocol has it.
const fn severity(severity: Severity) -> DiagnosticSeverity {
    match severity {
        Severity::Error => DiagnosticSeverity::ERROR,
        Severity::Warning => DiagnosticSeverity::WARNING,
    }
}
