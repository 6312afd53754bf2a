//! The open documents, each with what is known of it as it stands.

use std::cell::{OnceCell, RefCell};
use std::collections::{BTreeSet, HashMap};
use std::path::PathBuf;
use std::time::{Duration, Instant};

use clisc::ide::{Change, Document, Found};
use clisc::lint::Options;
use clisc::source::SourceError;
use lsp_types::{SemanticToken, TextDocumentContentChangeEvent, TextDocumentItem, Uri};

use crate::lsp::address::{file_name, path};
use crate::lsp::capabilities::Client;
use crate::lsp::configs::Configs;
use crate::lsp::convert::from_position;

/// How long nothing is typed before a scene is checked.
const PAUSE: Duration = Duration::from_millis(100);
/// How long a change waits at most, however much is typed.
const MAX_WAIT: Duration = Duration::from_millis(500);

/// An open document.
#[derive(Debug)]
pub struct Open {
    pub uri: Uri,
    /// What the editor calls this state of the text.
    pub version: i32,
    /// What the server calls it: no two states of any text share one.
    pub generation: u64,
    pub client: Client,
    pub document: Document,
    /// The folder whose `clisc.toml` counts, if there is one.
    folder: Option<PathBuf>,
    /// What the rules are asked for.
    pub options: Options,
    /// What is wrong with this state, once it is known.
    pub found: OnceCell<Found>,
    /// The tokens that the editor was sent last, with their name.
    pub sent_tokens: RefCell<Option<(u64, Vec<SemanticToken>)>>,
    /// When this state is to be checked, unless it has been.
    due: Option<Instant>,
    /// When the first change came that no check knows.
    unchecked_since: Option<Instant>,
    /// Whether a check is on its way; of one document there is one at a time.
    pub is_being_checked: bool,
}

impl Open {
    /// Returns what is wrong with the document as it stands.
    pub fn found(&self) -> &Found {
        self.found.get_or_init(|| self.document.diagnostics(&self.options))
    }

    /// Returns the name of the document's file without its ending, if it is a file.
    fn file_stem(&self) -> Option<String> {
        path(&self.uri)?.file_stem().map(|stem| stem.to_string_lossy().into_owned())
    }

    /// Marks the document as being checked.
    pub fn begin_check(&mut self) {
        (self.due, self.unchecked_since, self.is_being_checked) = (None, None, true);
    }
}

/// All open documents, by the text of their addresses.
#[derive(Debug, Default)]
pub struct Documents {
    by_uri: HashMap<String, Open>,
    n_generations: u64,
}

impl Documents {
    /// Opens a document, or opens it anew. `workspace` is the folder of documents that are no files.
    pub fn open(
        &mut self,
        item: TextDocumentItem,
        client: Client,
        workspace: Option<PathBuf>,
        now: Instant,
    ) -> Result<(), SourceError> {
        let document = Document::new(&file_name(&item.uri), item.text)?;
        let folder = path(&item.uri).map_or(workspace, |path| path.parent().map(Into::into));
        self.n_generations += 1;
        let open = Open {
            uri: item.uri.clone(),
            version: item.version,
            generation: self.n_generations,
            client,
            document,
            folder,
            options: Options::default(),
            found: OnceCell::new(),
            sent_tokens: RefCell::default(),
            due: Some(now),
            unchecked_since: Some(now),
            is_being_checked: false,
        };
        self.by_uri.insert(item.uri.as_str().to_owned(), open);
        Ok(())
    }

    /// Carries out changes. A document that is not open is none of ours.
    pub fn change(
        &mut self,
        uri: &Uri,
        version: i32,
        changes: Vec<TextDocumentContentChangeEvent>,
        now: Instant,
    ) -> Result<(), SourceError> {
        let Some(open) = self.by_uri.get_mut(uri.as_str()) else { return Ok(()) };
        self.n_generations += 1;
        (open.version, open.generation) = (version, self.n_generations);
        open.found = OnceCell::new();
        let since = *open.unchecked_since.get_or_insert(now);
        open.due = Some((now + PAUSE).min(since + MAX_WAIT));
        let changes = changes.into_iter().map(|change| Change {
            range: change.range.map(|range| from_position(range.start)..from_position(range.end)),
            text: change.text,
        });
        open.document.change(changes.collect(), open.client.unit)
    }

    /// Lets every document be checked again: something beside it may have changed.
    pub fn recheck(&mut self, now: Instant) {
        self.by_uri.values_mut().for_each(|open| open.due = Some(now));
    }

    /// Returns the folders whose configurations count.
    pub fn folders(&self) -> BTreeSet<PathBuf> {
        self.by_uri.values().filter_map(|open| open.folder.clone()).collect()
    }

    /// Takes configurations, and lets the documents be checked again for which something else holds now.
    pub fn configure(&mut self, configs: &Configs, now: Instant) {
        for open in self.by_uri.values_mut() {
            let stem = open.file_stem();
            let options = open.folder.as_ref().map(|folder| configs.options(folder, stem)).unwrap_or_default();
            if options != open.options {
                self.n_generations += 1;
                open.generation = self.n_generations;
                (open.options, open.found, open.due) = (options, OnceCell::new(), Some(now));
            }
        }
    }

    /// Tells whether no document is open.
    pub fn is_empty(&self) -> bool {
        self.by_uri.is_empty()
    }

    /// Closes a document and tells whether it was open.
    pub fn close(&mut self, uri: &Uri) -> bool {
        self.by_uri.remove(uri.as_str()).is_some()
    }

    pub fn get(&self, uri: &Uri) -> Option<&Open> {
        self.by_uri.get(uri.as_str())
    }

    pub fn get_mut(&mut self, uri: &Uri) -> Option<&mut Open> {
        self.by_uri.get_mut(uri.as_str())
    }

    /// Returns when the next check is due.
    pub fn next_due(&self) -> Option<Instant> {
        self.by_uri.values().filter(|open| !open.is_being_checked).filter_map(|open| open.due).min()
    }

    /// Returns a document whose check is due.
    pub fn due_at(&mut self, now: Instant) -> Option<&mut Open> {
        let is_due = |open: &&mut Open| !open.is_being_checked && open.due.is_some_and(|due| due <= now);
        self.by_uri.values_mut().find(is_due)
    }
}
