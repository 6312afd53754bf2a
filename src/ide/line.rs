//! The line at a place, taken apart.

use crate::ide::Document;
use crate::source::Span;
use crate::syntax::spec::{self, ArgSpec, Arguments, CommandSpec};
use crate::syntax::{Token, TokenKind, lex_one};

/// A line and the place on it that is asked about.
#[derive(Debug)]
pub(super) struct LineAt {
    /// The line, without its end.
    pub(super) span: Span,
    /// The place that is asked about.
    pub(super) offset: u32,
    /// Its tokens, those that tile it.
    pub(super) tokens: Vec<Token>,
}

impl LineAt {
    /// Takes the line at `offset` apart.
    pub(super) fn new(document: &Document, offset: u32) -> Self {
        let lines = document.lines();
        let span = lines.span(document.text(), lines.line_of(offset));
        Self { span, offset, tokens: lex_one(document.source(), span) }
    }

    /// Returns the words, the first of which is the name of the command.
    fn words(&self) -> impl Iterator<Item = Token> {
        self.tokens.iter().filter(|token| token.kind.is_significant()).copied()
    }

    /// Returns the word that would be the name of the command.
    pub(super) fn name(&self) -> Option<Span> {
        self.words().next().map(|token| token.span)
    }

    /// Returns the command, if its name is one.
    pub(super) fn command(&self, document: &Document) -> Option<&'static CommandSpec> {
        spec::find(document.source().slice(self.name()?))
    }

    /// Returns the places of the arguments.
    pub(super) fn args(&self) -> Vec<Span> {
        self.words().skip(1).map(|token| token.span).collect()
    }

    /// Tells whether the place lies in a comment.
    pub(super) fn is_in_comment(&self) -> bool {
        self.tokens.iter().any(|token| token.kind == TokenKind::Comment && token.span.start < self.offset)
    }

    /// Returns the word at the place, or that ends there.
    pub(super) fn word(&self) -> Option<Span> {
        self.words().map(|token| token.span).find(|word| word.start <= self.offset && self.offset <= word.end)
    }

    /// Returns the index of the argument at the place, or of the one that would be written there. None at the name.
    pub(super) fn arg_index(&self) -> Option<usize> {
        self.name().filter(|name| name.end < self.offset)?;
        Some(self.args().iter().filter(|arg| arg.end < self.offset).count())
    }
}

/// Returns the entry of an argument in the command table.
pub(super) fn arg_spec(command: &'static CommandSpec, index: usize) -> Option<&'static ArgSpec> {
    match command.arguments {
        Arguments::Numbers(args) => args.get(index),
        Arguments::FileName(arg) => (index == 0).then_some(arg),
    }
}
