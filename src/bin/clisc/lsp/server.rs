//! The conversation: messages in, answers out, one after the other.

use std::collections::VecDeque;
use std::io::{self, BufReader, BufWriter, Stdout, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::Context;
use clisc::ide::{Found, diagnostics_of};
use clisc::source::Source;
use lsp_server::{ErrorCode, Message, Notification, Request, RequestId, Response, ResponseError};
use lsp_types::notification::{self, Notification as _};
use lsp_types::request::{self, Request as _};
use lsp_types::{Diagnostic, InitializeResult, PublishDiagnosticsParams, Range, ServerInfo, Uri};
use serde::de::DeserializeOwned;
use serde_json::Value;

use crate::lsp::capabilities::{Client, offered, watchers, workspace_folders};
use crate::lsp::client_process::ClientProcess;
use crate::lsp::configs::Configs;
use crate::lsp::convert::Places;
use crate::lsp::documents::{Documents, Open};
use crate::lsp::transport::{self, Frame};
use crate::lsp::{actions, address, handlers, tokens};

/// How often the server looks after what nobody may tell it: that the editor has died, that a `clisc.toml` has changed.
const LOOK_EVERY: Duration = Duration::from_secs(3);

/// What an editor is told in place of findings when a check fails.
const CHECK_FAILED: &str = "clisc could not check this scene; what it wrote to standard error has more";

/// The stack of a check, in bytes: as much as a main thread has.
const CHECK_STACK: usize = 8 << 20;

/// What reaches the server.
enum Incoming {
    /// From the editor.
    Frame(Frame),
    /// A request that the editor no longer wants an answer to.
    Cancelled(RequestId),
    /// From a check: what is wrong with a state of a document; nothing where the check itself failed.
    Found { uri: Uri, generation: u64, found: Option<Found> },
    /// The editor is gone.
    End,
}

/// How far the conversation is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    BeforeInitialize,
    Running,
    ShutDown,
}

/// Serves the editor on standard input and output until it leaves; tells whether it said goodbye.
///
/// # Errors
/// When standard output cannot be written.
pub fn serve() -> anyhow::Result<bool> {
    let (sender, receiver) = channel();
    let from_editor = sender.clone();
    thread::spawn(move || {
        let mut input = BufReader::new(io::stdin().lock());
        while let Ok(Some(frame)) = transport::read(&mut input) {
            if from_editor.send(Incoming::Frame(frame)).is_err() {
                return;
            }
        }
        let _ = from_editor.send(Incoming::End);
    });
    let mut server = Server {
        stage: Stage::BeforeInitialize,
        client: Client::default(),
        process: None,
        workspace: Vec::new(),
        documents: Documents::default(),
        configs: Configs::default(),
        next_look: Instant::now() + LOOK_EVERY,
        sender,
        out: BufWriter::new(io::stdout()),
    };
    match server.run(&receiver) {
        // An editor that is gone reads nothing.
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(false),
        ended => ended.context("cannot write to the editor"),
    }
}

struct Server {
    stage: Stage,
    client: Client,
    /// The process of the editor, if it has told.
    process: Option<ClientProcess>,
    /// The folders that the editor has open.
    workspace: Vec<PathBuf>,
    documents: Documents,
    configs: Configs,
    next_look: Instant,
    /// Given to checks, so that they can tell what they found.
    sender: Sender<Incoming>,
    out: BufWriter<Stdout>,
}

impl Server {
    /// Takes what comes until the editor leaves; tells whether it said goodbye.
    fn run(&mut self, receiver: &Receiver<Incoming>) -> io::Result<bool> {
        let mut queue = VecDeque::new();
        loop {
            receiver.try_iter().for_each(|incoming| enqueue(incoming, &mut queue));
            if Instant::now() >= self.next_look && self.look_around()? {
                return Ok(self.stage == Stage::ShutDown);
            }
            self.begin_due_checks()?;
            let next = match queue.pop_front() {
                Some(next) => next,
                None => match self.wait(receiver) {
                    Ok(incoming) => incoming,
                    Err(RecvTimeoutError::Timeout) => continue,
                    Err(RecvTimeoutError::Disconnected) => return Ok(false),
                },
            };
            if let Some(said_goodbye) = self.take(next)? {
                return Ok(said_goodbye);
            }
        }
    }

    /// Waits for what comes next, until a check is due, or until it is time to look around.
    fn wait(&self, receiver: &Receiver<Incoming>) -> Result<Incoming, RecvTimeoutError> {
        let has_to_look = self.process.is_some() || !self.documents.is_empty();
        let next_look = has_to_look.then_some(self.next_look);
        match self.documents.next_due().into_iter().chain(next_look).min() {
            Some(due) => receiver.recv_timeout(due.saturating_duration_since(Instant::now())),
            None => receiver.recv().map_err(RecvTimeoutError::from),
        }
    }

    /// Looks for what nobody may have told: takes changed configurations, and tells whether the editor is gone.
    fn look_around(&mut self) -> io::Result<bool> {
        self.next_look = Instant::now() + LOOK_EVERY;
        if let Some(process) = self.process.filter(|process| !process.is_alive()) {
            crate::print::to_stderr(&format!("error: {process}, which the editor called its own, has ended\n"));
            return Ok(true);
        }
        self.read_configs()?;
        Ok(false)
    }

    /// Reads the configurations of all open documents, and tells what is wrong with them.
    fn read_configs(&mut self) -> io::Result<()> {
        let changed = self.configs.read(self.documents.folders(), self.client.unit);
        self.documents.configure(&self.configs, Instant::now());
        for (path, fault) in changed {
            let Some(uri) = address::uri(&path) else { continue };
            self.tell(PublishDiagnosticsParams { uri, diagnostics: fault.into_iter().collect(), version: None })?;
        }
        Ok(())
    }

    /// Takes one thing; when it is the last, tells whether the editor said goodbye.
    fn take(&mut self, incoming: Incoming) -> io::Result<Option<bool>> {
        match incoming {
            Incoming::Frame(Frame::Message(Message::Request(request))) => {
                let id = request.id.clone();
                let answer = catch_unwind(AssertUnwindSafe(|| self.answer(request))).unwrap_or_else(|_| {
                    Err(failure(ErrorCode::InternalError, "a bug in clisc; standard error has more"))
                });
                self.send(Message::Response(Response { id, response_result: answer }))?;
            }
            Incoming::Frame(Frame::Message(Message::Notification(notification))) => {
                if notification.method == notification::Exit::METHOD {
                    return Ok(Some(self.stage == Stage::ShutDown));
                }
                if self.stage == Stage::Running {
                    self.note(notification)?;
                }
            }
            // An editor that does not watch files is asked for nothing else.
            Incoming::Frame(Frame::Message(Message::Response(_))) => {}
            Incoming::Frame(Frame::Malformed(answer)) => {
                transport::write(&mut self.out, answer.to_string().as_bytes())?
            }
            Incoming::Cancelled(id) => {
                let error = failure(ErrorCode::RequestCanceled, "cancelled");
                self.send(Message::Response(Response { id, response_result: Err(error) }))?;
            }
            Incoming::Found { uri, generation, found } => self.publish(&uri, generation, found)?,
            Incoming::End => return Ok(Some(self.stage == Stage::ShutDown)),
        }
        Ok(None)
    }

    fn send(&mut self, message: Message) -> io::Result<()> {
        message.write(&mut self.out)?;
        self.out.flush()
    }

    /// Answers a request.
    fn answer(&mut self, request: Request) -> Result<Value, ResponseError> {
        match (self.stage, request.method.as_str()) {
            (Stage::BeforeInitialize, request::Initialize::METHOD) => self.initialize(&request.params),
            (Stage::BeforeInitialize, _) => Err(failure(ErrorCode::ServerNotInitialized, "`initialize` comes first")),
            (Stage::ShutDown, _) => Err(failure(ErrorCode::InvalidRequest, "the server has been shut down")),
            (Stage::Running, request::Initialize::METHOD) => {
                Err(failure(ErrorCode::InvalidRequest, "`initialize` comes once"))
            }
            (Stage::Running, request::Shutdown::METHOD) => {
                self.stage = Stage::ShutDown;
                Ok(Value::Null)
            }
            (Stage::Running, _) => self.answer_about_document(request),
        }
    }

    fn initialize(&mut self, params: &Value) -> Result<Value, ResponseError> {
        self.client = Client::new(params);
        (self.process, self.workspace) = (ClientProcess::new(params), workspace_folders(params));
        self.stage = Stage::Running;
        let server_info = ServerInfo { name: "clisc".to_owned(), version: Some(env!("CARGO_PKG_VERSION").to_owned()) };
        to_value(InitializeResult { capabilities: offered(&self.client), server_info: Some(server_info) })
    }

    fn answer_about_document(&self, Request { method, params, .. }: Request) -> Result<Value, ResponseError> {
        match method.as_str() {
            request::HoverRequest::METHOD => self.ask::<request::HoverRequest>(params, handlers::hover),
            request::Completion::METHOD => self.ask::<request::Completion>(params, handlers::completion),
            request::SignatureHelpRequest::METHOD => {
                self.ask::<request::SignatureHelpRequest>(params, handlers::signature_help)
            }
            request::GotoDefinition::METHOD => self.ask::<request::GotoDefinition>(params, handlers::definition),
            request::References::METHOD => self.ask::<request::References>(params, handlers::references),
            request::DocumentHighlightRequest::METHOD => {
                self.ask::<request::DocumentHighlightRequest>(params, handlers::highlights)
            }
            request::DocumentSymbolRequest::METHOD => {
                self.ask::<request::DocumentSymbolRequest>(params, handlers::document_symbols)
            }
            request::FoldingRangeRequest::METHOD => {
                self.ask::<request::FoldingRangeRequest>(params, handlers::folding_ranges)
            }
            request::InlayHintRequest::METHOD => self.ask::<request::InlayHintRequest>(params, handlers::inlay_hints),
            request::DocumentColor::METHOD => self.ask::<request::DocumentColor>(params, handlers::document_colors),
            request::ColorPresentationRequest::METHOD => {
                self.ask::<request::ColorPresentationRequest>(params, handlers::color_presentations)
            }
            request::Formatting::METHOD => self.ask::<request::Formatting>(params, actions::formatting),
            request::RangeFormatting::METHOD => self.ask::<request::RangeFormatting>(params, actions::range_formatting),
            request::CodeActionRequest::METHOD => self.ask::<request::CodeActionRequest>(params, actions::code_actions),
            request::PrepareRenameRequest::METHOD => {
                self.ask::<request::PrepareRenameRequest>(params, actions::prepare_rename)
            }
            request::Rename::METHOD => self.ask::<request::Rename>(params, actions::rename),
            request::SemanticTokensFullRequest::METHOD => {
                self.ask::<request::SemanticTokensFullRequest>(params, tokens::full)
            }
            request::SemanticTokensFullDeltaRequest::METHOD => {
                self.ask::<request::SemanticTokensFullDeltaRequest>(params, tokens::delta)
            }
            request::SemanticTokensRangeRequest::METHOD => {
                self.ask::<request::SemanticTokensRangeRequest>(params, tokens::range)
            }
            _ => Err(failure(ErrorCode::MethodNotFound, &format!("there is no `{method}` here"))),
        }
    }

    /// Lets a handler answer about the document that the parameters name.
    fn ask<R: request::Request>(
        &self,
        params: Value,
        handle: impl FnOnce(&Open, R::Params) -> Result<R::Result, ResponseError>,
    ) -> Result<Value, ResponseError> {
        let uri = params.pointer("/textDocument/uri").cloned().unwrap_or_default();
        let uri: Uri = from_value(uri)?;
        let params: R::Params = from_value(params)?;
        let not_open = || failure(ErrorCode::InvalidParams, &format!("`{}` is not open", uri.as_str()));
        let open = self.documents.get(&uri).ok_or_else(not_open)?;
        to_value(handle(open, params)?)
    }

    /// Takes a notification. What is not understood is not answered, as the protocol has it, but told of on standard error.
    fn note(&mut self, Notification { method, params }: Notification) -> io::Result<()> {
        let noted = match method.as_str() {
            notification::Initialized::METHOD => return self.ask_for_watchers(),
            notification::DidOpenTextDocument::METHOD => from_value::<lsp_types::DidOpenTextDocumentParams>(params)
                .and_then(|params| {
                    let workspace = self.workspace.first().cloned();
                    let opened = self.documents.open(params.text_document, self.client, workspace, Instant::now());
                    opened.map_err(|error| failure(ErrorCode::InvalidParams, &error.to_string()))
                }),
            notification::DidChangeTextDocument::METHOD => from_value::<lsp_types::DidChangeTextDocumentParams>(params)
                .and_then(|params| {
                    let document = params.text_document;
                    let changed =
                        self.documents.change(&document.uri, document.version, params.content_changes, Instant::now());
                    changed.map_err(|error| failure(ErrorCode::InvalidParams, &error.to_string()))
                }),
            notification::DidCloseTextDocument::METHOD => {
                match from_value::<lsp_types::DidCloseTextDocumentParams>(params) {
                    Ok(params) => return self.close(params.text_document.uri),
                    Err(error) => Err(error),
                }
            }
            notification::DidChangeConfiguration::METHOD | notification::DidChangeWatchedFiles::METHOD => {
                self.documents.recheck(Instant::now());
                Ok(())
            }
            notification::DidChangeWorkspaceFolders::METHOD => {
                from_value::<lsp_types::DidChangeWorkspaceFoldersParams>(params).map(|params| {
                    let path = |folder: &lsp_types::WorkspaceFolder| address::path(&folder.uri);
                    let removed: Vec<_> = params.event.removed.iter().filter_map(path).collect();
                    self.workspace.retain(|folder| !removed.contains(folder));
                    self.workspace.extend(params.event.added.iter().filter_map(path));
                })
            }
            _ => Ok(()),
        };
        if let Err(error) = noted {
            crate::print::to_stderr(&format!("error: `{method}`: {}\n", error.message));
        }
        Ok(())
    }

    /// Asks an editor that can to tell when a `clisc.toml` changes.
    fn ask_for_watchers(&mut self) -> io::Result<()> {
        if !self.client.has_watchers {
            return Ok(());
        }
        let id = RequestId::from("clisc/watch".to_owned());
        self.send(Message::Request(Request::new(id, request::RegisterCapability::METHOD.to_owned(), watchers())))
    }

    /// Closes a document and takes back what was told of it.
    fn close(&mut self, uri: Uri) -> io::Result<()> {
        if self.documents.close(&uri) {
            self.tell(PublishDiagnosticsParams { uri, diagnostics: Vec::new(), version: None })?;
            self.read_configs()?;
        }
        Ok(())
    }

    fn tell(&mut self, params: PublishDiagnosticsParams) -> io::Result<()> {
        let method = notification::PublishDiagnostics::METHOD.to_owned();
        self.send(Message::Notification(Notification::new(method, params)))
    }

    /// Begins the checks that are due, each on a thread of its own.
    fn begin_due_checks(&mut self) -> io::Result<()> {
        if self.documents.due_at(Instant::now()).is_some() {
            self.read_configs()?;
        }
        while let Some(open) = self.documents.due_at(Instant::now()) {
            open.begin_check();
            let (uri, generation, sender) = (open.uri.clone(), open.generation, self.sender.clone());
            let failed = Incoming::Found { uri: uri.clone(), generation, found: None };
            let source = Source::new(open.document.source().name(), open.document.text());
            let options = open.options.clone();
            let check = move || {
                let found = catch_unwind(|| diagnostics_of(&source, &options)).ok();
                // The server may be gone by now.
                let _ = sender.send(Incoming::Found { uri, generation, found });
            };
            if let Err(error) = thread::Builder::new().stack_size(CHECK_STACK).spawn(check) {
                crate::print::to_stderr(&format!("error: cannot start a thread: {error}\n"));
                let _ = self.sender.send(failed);
            }
        }
        Ok(())
    }

    /// Tells what a check has found, if it is about the document as it stands.
    fn publish(&mut self, uri: &Uri, generation: u64, found: Option<Found>) -> io::Result<()> {
        let Some(open) = self.documents.get_mut(uri) else { return Ok(()) };
        open.is_being_checked = false;
        if open.generation != generation {
            return Ok(());
        }
        let version = Some(open.version);
        let diagnostics = match found {
            Some(found) => Places::new(open).diagnostics(open.found.get_or_init(|| found)),
            None => vec![Diagnostic::new_simple(Range::default(), CHECK_FAILED.to_owned())],
        };
        self.tell(PublishDiagnosticsParams { uri: uri.clone(), diagnostics, version })
    }
}

/// Adds what comes to what waits. A request that is cancelled while it waits is not answered otherwise.
fn enqueue(incoming: Incoming, queue: &mut VecDeque<Incoming>) {
    if let Incoming::Frame(Frame::Message(Message::Notification(note))) = &incoming
        && note.method == notification::Cancel::METHOD
    {
        let Ok(id) = from_value::<RequestId>(note.params.get("id").cloned().unwrap_or_default()) else { return };
        let is_it = |waiting: &&mut Incoming| matches!(waiting, Incoming::Frame(Frame::Message(Message::Request(request))) if request.id == id);
        if let Some(waiting) = queue.iter_mut().find(is_it) {
            *waiting = Incoming::Cancelled(id);
        }
        return;
    }
    queue.push_back(incoming);
}

/// Makes the error of a request.
pub fn failure(code: ErrorCode, message: &str) -> ResponseError {
    ResponseError { code: code as i32, message: message.to_owned(), data: None }
}

fn from_value<T: DeserializeOwned>(value: Value) -> Result<T, ResponseError> {
    serde_json::from_value(value).map_err(|error| failure(ErrorCode::InvalidParams, &error.to_string()))
}

fn to_value(value: impl serde::Serialize) -> Result<Value, ResponseError> {
    serde_json::to_value(value).map_err(|error| failure(ErrorCode::InternalError, &error.to_string()))
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_request_that_waits_can_be_cancelled() {
        let request = |id: i32| Message::Request(Request::new(RequestId::from(id), "clisc/x".to_owned(), Value::Null));
        let cancel =
            |id: Value| Message::Notification(Notification::new("$/cancelRequest".to_owned(), json!({ "id": id })));
        let mut queue = VecDeque::new();
        for message in [request(1), request(2), cancel(json!(2)), cancel(json!(9)), cancel(json!([])), request(3)] {
            enqueue(Incoming::Frame(Frame::Message(message)), &mut queue);
        }
        let waiting: Vec<_> = queue
            .iter()
            .map(|incoming| match incoming {
                Incoming::Frame(Frame::Message(Message::Request(request))) => (request.id.to_string(), false),
                Incoming::Cancelled(id) => (id.to_string(), true),
                _ => panic!("a cancellation is no work"),
            })
            .collect();
        assert_eq!(waiting, [("1".to_owned(), false), ("2".to_owned(), true), ("3".to_owned(), false)]);
    }
}
