//! What the editor can do, and what the server offers.

use std::path::PathBuf;

use clisc::ide::SemanticKind;
use clisc::ide::position::Unit;
use lsp_types::notification::{self, Notification as _};
use lsp_types::{
    CodeActionKind, CodeActionOptions, CodeActionProviderCapability, ColorProviderCapability, CompletionOptions,
    FoldingRangeProviderCapability, HoverProviderCapability, OneOf, PositionEncodingKind, RenameOptions,
    SemanticTokenType, SemanticTokensFullOptions, SemanticTokensLegend, SemanticTokensOptions, ServerCapabilities,
    SignatureHelpOptions, TextDocumentSyncCapability, TextDocumentSyncKind, TextDocumentSyncOptions,
    WorkDoneProgressOptions, WorkspaceFoldersServerCapabilities, WorkspaceServerCapabilities,
};
use serde_json::{Value, json};

use crate::config::FILE_NAME;
use crate::lsp::address::path;

/// The kind of the action that carries out every safe fix at once.
pub const FIX_ALL: &str = "source.fixAll.clisc";

/// What the editor has said that it can do; an older one says less.
#[derive(Clone, Copy, Debug, Default)]
pub struct Client {
    /// What its columns count.
    pub unit: Unit,
    /// Whether a completion may have places to fill in.
    pub has_snippets: bool,
    /// Whether a hover may hold Markdown.
    pub has_markdown: bool,
    /// Whether an outline may be a tree.
    pub has_tree_symbols: bool,
    /// Whether an edit may say which version it is about.
    pub has_versioned_edits: bool,
    /// Whether an action may be more than a command.
    pub has_code_actions: bool,
    /// Whether a diagnostic may name other places.
    pub has_related_places: bool,
    /// Whether it watches files when it is asked to.
    pub has_watchers: bool,
}

impl Client {
    /// Reads what the editor has said. Only what is looked for has to be well formed.
    pub fn new(params: &Value) -> Self {
        let at = |path: &str| params.pointer(&format!("/capabilities/{path}"));
        let is = |path: &str| at(path).and_then(Value::as_bool).unwrap_or(false);
        let named = |path: &str| at(path).and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_str);
        let mut encodings = named("general/positionEncodings");
        Self {
            unit: encodings.find_map(unit_of).unwrap_or_default(),
            has_snippets: is("textDocument/completion/completionItem/snippetSupport"),
            has_markdown: named("textDocument/hover/contentFormat").any(|format| format == "markdown"),
            has_tree_symbols: is("textDocument/documentSymbol/hierarchicalDocumentSymbolSupport"),
            has_versioned_edits: is("workspace/workspaceEdit/documentChanges"),
            has_code_actions: at("textDocument/codeAction/codeActionLiteralSupport").is_some(),
            has_related_places: is("textDocument/publishDiagnostics/relatedInformation"),
            has_watchers: is("workspace/didChangeWatchedFiles/dynamicRegistration"),
        }
    }
}

/// Returns the folders that are open in the editor, as far as they are files. Older editors open one at most.
pub fn workspace_folders(params: &Value) -> Vec<PathBuf> {
    let path_of = |uri: &Value| path(&uri.as_str()?.parse().ok()?);
    let folders = params.get("workspaceFolders").and_then(Value::as_array);
    let folders: Vec<_> = folders.into_iter().flatten().filter_map(|folder| path_of(folder.get("uri")?)).collect();
    if !folders.is_empty() {
        return folders;
    }
    let root_path = || params.get("rootPath").and_then(Value::as_str).map(PathBuf::from);
    params.get("rootUri").and_then(path_of).or_else(root_path).into_iter().collect()
}

/// Returns what asks an editor to watch every `clisc.toml`.
pub fn watchers() -> Value {
    json!({ "registrations": [{
        "id": "clisc/clisc.toml",
        "method": notification::DidChangeWatchedFiles::METHOD,
        "registerOptions": { "watchers": [{ "globPattern": format!("**/{FILE_NAME}") }] },
    }] })
}

/// Returns the encoding of this name, if it is one.
fn unit_of(name: &str) -> Option<Unit> {
    match name {
        "utf-8" => Some(Unit::Utf8),
        "utf-16" => Some(Unit::Utf16),
        "utf-32" => Some(Unit::Utf32),
        _ => None,
    }
}

/// Returns what the server offers to an editor.
pub fn offered(client: &Client) -> ServerCapabilities {
    let encoding = match client.unit {
        Unit::Utf8 => PositionEncodingKind::UTF8,
        Unit::Utf16 => PositionEncodingKind::UTF16,
        Unit::Utf32 => PositionEncodingKind::UTF32,
    };
    ServerCapabilities {
        position_encoding: Some(encoding),
        text_document_sync: Some(TextDocumentSyncCapability::Options(TextDocumentSyncOptions {
            open_close: Some(true),
            change: Some(TextDocumentSyncKind::INCREMENTAL),
            ..TextDocumentSyncOptions::default()
        })),
        hover_provider: Some(HoverProviderCapability::Simple(true)),
        completion_provider: Some(CompletionOptions {
            trigger_characters: Some(vec![" ".to_owned(), "#".to_owned()]),
            ..CompletionOptions::default()
        }),
        signature_help_provider: Some(SignatureHelpOptions {
            trigger_characters: Some(vec![" ".to_owned(), "\t".to_owned()]),
            ..SignatureHelpOptions::default()
        }),
        definition_provider: Some(OneOf::Left(true)),
        references_provider: Some(OneOf::Left(true)),
        document_highlight_provider: Some(OneOf::Left(true)),
        document_symbol_provider: Some(OneOf::Left(true)),
        code_action_provider: Some(CodeActionProviderCapability::Options(CodeActionOptions {
            code_action_kinds: Some(vec![CodeActionKind::QUICKFIX, CodeActionKind::new(FIX_ALL)]),
            ..CodeActionOptions::default()
        })),
        document_formatting_provider: Some(OneOf::Left(true)),
        document_range_formatting_provider: Some(OneOf::Left(true)),
        rename_provider: Some(OneOf::Right(RenameOptions {
            prepare_provider: Some(true),
            work_done_progress_options: WorkDoneProgressOptions::default(),
        })),
        color_provider: Some(ColorProviderCapability::Simple(true)),
        folding_range_provider: Some(FoldingRangeProviderCapability::Simple(true)),
        inlay_hint_provider: Some(OneOf::Left(true)),
        semantic_tokens_provider: Some(semantic_tokens().into()),
        workspace: Some(WorkspaceServerCapabilities {
            workspace_folders: Some(WorkspaceFoldersServerCapabilities {
                supported: Some(true),
                change_notifications: Some(OneOf::Left(true)),
            }),
            file_operations: None,
        }),
        ..ServerCapabilities::default()
    }
}

fn semantic_tokens() -> SemanticTokensOptions {
    let token_types = SemanticKind::ALL.map(|kind| match kind {
        SemanticKind::Keyword => SemanticTokenType::KEYWORD,
        SemanticKind::Number => SemanticTokenType::NUMBER,
        SemanticKind::String => SemanticTokenType::STRING,
        SemanticKind::Comment => SemanticTokenType::COMMENT,
    });
    SemanticTokensOptions {
        legend: SemanticTokensLegend { token_types: token_types.into(), token_modifiers: Vec::new() },
        range: Some(true),
        full: Some(SemanticTokensFullOptions::Delta { delta: Some(true) }),
        ..SemanticTokensOptions::default()
    }
}
