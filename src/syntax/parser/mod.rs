//! Lines in, tree out.
//!
//! A scene is parsed a line at a time: the first word picks an entry of the command table, and the [`grammar`] of its
//! arguments says yes or no at full speed. A line that is refused is read a second time, by the same grammar with rich
//! errors, to find out what to say about it. So damage cannot spread from line to line, and large scenes are cut into
//! chunks of whole lines that are parsed side by side.

mod errors;
mod foreign;
mod grammar;
mod names;
mod numeral;
mod path;
mod plain;
mod text;

use std::ops::Range;

use rayon::prelude::*;

use crate::diag::Diagnostic;
use crate::source::{Source, Span};
use crate::syntax::ast::{self, Shape};
use crate::syntax::lexer::{Line, lex_line, lines};
use crate::syntax::parser::errors::BadCommand;
use crate::syntax::parser::plain::{PlainLine, PlainLines};
use crate::syntax::parser::text::LoneReturns;
use crate::syntax::spec::{self, Arguments, CommandKind, CommandSpec, MAX_NUMBERS};
use crate::syntax::token::{Token, TokenKind};

/// How much text one thread takes at a time: its tree stays in the cache until it is lowered.
const CHUNK_BYTES: usize = 1 << 16;

/// How many chunks make a run.
const CHUNKS_PER_RUN: usize = 32;

/// A tree and what was found wrong on the way to it.
#[derive(Debug, Default, PartialEq)]
pub struct Parse {
    /// The tree; there always is one.
    pub file: ast::File,
    /// In the order of the text.
    pub diagnostics: Vec<Diagnostic>,
}

impl Parse {
    /// Adds the lines that follow.
    pub fn append(&mut self, later: Self) {
        self.file.append(later.file);
        self.diagnostics.extend(later.diagnostics);
    }
}

/// Parses a scene. A line that is no command becomes a bad node and a diagnostic, and spoils no other line.
#[must_use]
pub fn parse(source: &Source) -> Parse {
    parse_in_chunks(source, CHUNK_BYTES)
}

/// Does the work of [`parse`] in chunks of about `chunk_bytes`; the result is the same for any size.
#[must_use]
pub fn parse_in_chunks(source: &Source, chunk_bytes: usize) -> Parse {
    let mut whole = Parse::default();
    let mut runs = Runs::in_chunks(source, chunk_bytes);
    for run in &mut runs {
        whole.append(run);
    }
    whole.diagnostics.extend(runs.finish());
    whole.diagnostics.sort_by_key(|diagnostic| diagnostic.primary.span.start);
    whole
}

/// Parses a scene a run of whole lines at a time, so that the tree of a large one need never be there as a whole.
///
/// The trees and diagnostics of the runs, one behind the other, and those of [`Runs::finish`] are those of [`parse`].
#[derive(Debug)]
pub struct Runs<'s> {
    source: &'s Source,
    chunk_bytes: usize,
    /// Where the next run starts; none behind the last.
    next: Option<usize>,
    lone_returns: LoneReturns,
    takes_short_way: bool,
}

impl<'s> Runs<'s> {
    /// Begins at the start of the scene.
    #[must_use]
    pub fn new(source: &'s Source) -> Self {
        Self::in_chunks(source, CHUNK_BYTES)
    }

    /// Does the work of [`Runs::new`] in chunks of about `chunk_bytes`.
    #[must_use]
    pub fn in_chunks(source: &'s Source, chunk_bytes: usize) -> Self {
        Self {
            source,
            chunk_bytes: chunk_bytes.max(1),
            next: Some(0),
            lone_returns: LoneReturns::default(),
            takes_short_way: true,
        }
    }

    /// Parses every line by way of tokens and grammar; the result is the same.
    #[must_use]
    pub fn without_short_way(self) -> Self {
        Self { takes_short_way: false, ..self }
    }

    /// Tells whether the last run has been parsed.
    #[must_use]
    pub fn is_at_end(&self) -> bool {
        self.next.is_none()
    }

    /// Reports what only the whole text shows, in order.
    ///
    /// # Panics
    /// When a run has not been parsed.
    #[must_use]
    pub fn finish(self) -> Vec<Diagnostic> {
        assert!(self.is_at_end(), "a run is left");
        let mut diagnostics = Vec::new();
        if text::check_encoding(self.source).is_none() {
            text::check_bytes(self.source, &mut diagnostics);
            diagnostics.extend(self.lone_returns.diagnose(self.source));
        }
        diagnostics
    }

    /// Cuts the next run behind newlines into spans of at least `chunk_bytes`, the last of all excepted.
    fn next_chunks(&mut self) -> Vec<Span> {
        let text = self.source.text().as_bytes();
        let mut chunks = Vec::new();
        while let Some(start) = self.next.filter(|_| chunks.len() < CHUNKS_PER_RUN) {
            let least = (start + self.chunk_bytes - 1).min(text.len());
            let newline = memchr::memchr(b'\n', &text[least..]);
            let end = newline.map_or(text.len(), |newline| least + newline + 1);
            self.next = (end < text.len()).then_some(end);
            chunks.push(Span::new(start as u32, end as u32));
        }
        chunks
    }
}

impl Iterator for Runs<'_> {
    type Item = Parse;

    fn next(&mut self) -> Option<Parse> {
        if self.next == Some(0)
            && let Some(diagnostic) = text::check_encoding(self.source)
        {
            self.next = None;
            return Some(unreadable(self.source, diagnostic));
        }
        let (source, takes_short_way) = (self.source, self.takes_short_way);
        let parse = |span: Span| {
            let mut chunk = Chunk::new(source, span);
            if takes_short_way {
                chunk.parse()
            } else {
                chunk.parse_by_tokens()
            }
            chunk
        };
        let chunks = self.next_chunks();
        let chunks: Vec<_> = match chunks[..] {
            [] => return None,
            [span] => vec![parse(span)],
            _ => chunks.into_par_iter().map(parse).collect(),
        };
        let mut run = Parse::default();
        for chunk in chunks {
            run.diagnostics.extend(chunk.diagnostics);
            run.file.push(chunk.part);
            self.lone_returns = self.lone_returns.and(chunk.lone_returns);
        }
        Some(run)
    }
}

/// Returns the places of the arguments of the command below `command`.
#[must_use]
pub fn argument_spans(source: &Source, command: Span) -> Vec<Span> {
    let mut spans = Vec::new();
    lex_line(source.slice(command), command.start, |token| {
        if token.kind.is_significant() {
            spans.push(token.span);
        }
    });
    spans.split_off(spans.len().min(1))
}

/// Returns the file name of the `write` below `command`, without quotes, and its place, quotes included.
#[must_use]
pub fn file_name(source: &Source, command: Span) -> Option<(&str, Span)> {
    let span = *argument_spans(source, command).first()?;
    Some((path::unquoted(source, span), span))
}

/// Makes the tree of a source of which no line can be read: as far as anyone knows it says all that is needed.
fn unreadable(source: &Source, diagnostic: Diagnostic) -> Parse {
    let mut part = ast::Part::default();
    part.push(Span::new(0, source.text().len() as u32), Shape::Bad(Some(CommandKind::Write)), &[]);
    let mut file = ast::File::default();
    file.push(part);
    Parse { file, diagnostics: vec![diagnostic] }
}

/// A run of lines and what has been made of them.
struct Chunk<'s> {
    source: &'s Source,
    /// The lines.
    span: Span,
    part: ast::Part,
    diagnostics: Vec<Diagnostic>,
    lone_returns: LoneReturns,
    /// The significant tokens of the line at hand; kept from line to line to save allocations.
    tokens: Vec<Token>,
    /// Its foreign tokens.
    foreign: Vec<Token>,
}

impl<'s> Chunk<'s> {
    fn new(source: &'s Source, span: Span) -> Self {
        Self {
            source,
            span,
            part: ast::Part::for_text(span.len()),
            diagnostics: Vec::new(),
            lone_returns: LoneReturns::default(),
            tokens: Vec::new(),
            foreign: Vec::new(),
        }
    }

    /// Parses each line the short way if it is plain, otherwise by way of tokens and grammar.
    fn parse(&mut self) {
        let Range { start, end } = self.span.range();
        let mut lines = PlainLines::new(&self.source.text()[..end], start);
        while lines.at() < end {
            let start = lines.at();
            match lines.read() {
                Some(PlainLine::Empty) => {}
                Some(PlainLine::Command { spec, span, numbers }) => {
                    self.part.push(span, Shape::Whole(spec.kind), &numbers[..spec.numbers().len()]);
                }
                None => lines.resume_at(self.parse_line_at(start)),
            }
        }
    }

    /// Parses each line by way of tokens and grammar.
    fn parse_by_tokens(&mut self) {
        let Range { mut start, end } = self.span.range();
        while start < end {
            start = self.parse_line_at(start);
        }
    }

    /// Parses the line that starts at `start` by way of tokens and grammar; returns where the next one starts.
    fn parse_line_at(&mut self, start: usize) -> usize {
        let rest = Span::new(start as u32, self.span.end);
        let line = lines(self.source.slice(rest), rest.start).next().expect("a text has a line");
        self.parse_line(&line);
        line.end.map_or(rest.end, |end| end.span.end) as usize
    }

    fn parse_line(&mut self, line: &Line<'s>) {
        self.tokens.clear();
        self.foreign.clear();
        lex_line(line.text, line.start, |token| {
            if token.kind.is_significant() {
                self.tokens.push(token);
            } else if token.kind.is_foreign() {
                self.foreign.push(token);
            }
        });
        if let Some(end) = line.end.filter(|end| end.kind == TokenKind::LoneReturn) {
            self.lone_returns.push(end.span);
        }
        if !self.foreign.is_empty() || !self.parse_good_line() {
            self.parse_bad_line();
        }
    }

    /// Parses the line if nothing is wrong with it, and tells whether that is so.
    fn parse_good_line(&mut self) -> bool {
        let [name, args @ ..] = self.tokens.as_slice() else { return true };
        let Some(spec) = spec::find(self.source.slice(name.span)) else { return false };
        let Some(numbers) = read_arguments(self.source, &spec.arguments, args) else { return false };
        let span = args.last().map_or(name.span, |last| name.span.to(last.span));
        self.part.push(span, Shape::Whole(spec.kind), &numbers[..spec.numbers().len()]);
        true
    }

    /// Reports what is wrong with the line and makes the best of it.
    fn parse_bad_line(&mut self) {
        text::check_foreign(self.source, &self.foreign, &mut self.diagnostics);
        let [name, args @ ..] = self.tokens.as_slice() else { return };
        let spec = spec::find(self.source.slice(name.span));
        let has_control = self.foreign.iter().any(|token| token.kind == TokenKind::Control);
        let intended = match spec {
            // The rest of such a line is not worth a guess: its words are torn apart.
            _ if has_control => spec.map(|spec| spec.kind),
            Some(spec) => {
                let n_before = self.diagnostics.len();
                check_command(self.source, spec, name, args, &mut self.diagnostics);
                if self.diagnostics.len() == n_before && self.parse_good_line() {
                    return;
                }
                Some(spec.kind)
            }
            None => {
                let (diagnostic, intended) = names::diagnose(self.source, name, args);
                self.diagnostics.push(diagnostic);
                intended
            }
        };
        self.push_bad_line(intended);
    }

    /// Adds a bad node for the command that the line was meant to be, and one for each command that stands on the line
    /// behind it, where the line's one diagnostic has said that it does not belong: what they set counts as set, so that
    /// no later line is blamed for them.
    fn push_bad_line(&mut self, intended: Option<CommandKind>) {
        let (mut intended, mut start) = (intended, 0);
        for end in 1..=self.tokens.len() {
            let next = self.tokens.get(end);
            let joined = next.and_then(|token| spec::find(self.source.slice(token.span))).map(|spec| spec.kind);
            if next.is_none() || joined.is_some() {
                let span = self.tokens[start].span.to(self.tokens[end - 1].span);
                self.part.push(span, Shape::Bad(intended), &[]);
                (intended, start) = (joined, end);
            }
        }
    }
}

/// Returns the numbers among the arguments if all arguments are as they should be.
pub(super) fn read_arguments(source: &Source, arguments: &Arguments, args: &[Token]) -> Option<[f64; MAX_NUMBERS]> {
    if !grammar::accepts(arguments, args) {
        return None;
    }
    let mut numbers = [0.0; MAX_NUMBERS];
    match arguments {
        Arguments::Numbers(_) => {
            for (number, arg) in numbers.iter_mut().zip(args) {
                *number = source.slice(arg.span).parse().ok().filter(|number: &f64| number.is_finite())?;
            }
        }
        Arguments::FileName(_) => {
            args.first().filter(|name| path::is_png(path::unquoted(source, name.span)))?;
        }
    }
    Some(numbers)
}

/// Appends what is wrong with a command whose name is known.
fn check_command(source: &Source, spec: &'static CommandSpec, name: &Token, args: &[Token], acc: &mut Vec<Diagnostic>) {
    let args = prepare_arguments(source, spec, args);
    let is_name = |arg: &Token| arg.kind == TokenKind::Word && spec::find(source.slice(arg.span)).is_some();
    let n_own = args.iter().position(is_name).unwrap_or(args.len());
    let next_name = args.get(n_own).map(|next| next.span);
    let n_before = acc.len();
    let command = BadCommand { source, spec, name: name.span, args: &args[..n_own], next_name };
    errors::check_arguments(&command, acc);
    if let (Arguments::FileName(_), [only], true) = (&spec.arguments, command.args, acc.len() == n_before)
        && !path::is_png(path::unquoted(source, only.span))
    {
        acc.push(path::not_a_png(source, only));
    }
}

/// Returns the arguments as a person sees them: a sign and the number behind it are one, and a number out of the range of
/// binary64 is none.
fn prepare_arguments(source: &Source, spec: &CommandSpec, args: &[Token]) -> Vec<Token> {
    let mut prepared: Vec<Token> = Vec::with_capacity(args.len());
    for arg in args {
        let text = source.slice(arg.span);
        let is_unsigned = text.starts_with(|first: char| first == '.' || first.is_ascii_digit());
        match prepared.last_mut() {
            Some(sign) if is_unsigned && numeral::is_sign(source.slice(sign.span)) => {
                sign.span = sign.span.to(arg.span)
            }
            _ if matches!(spec.arguments, Arguments::FileName(_)) || numeral::is_number(text) => prepared.push(*arg),
            _ => prepared.push(Token { kind: TokenKind::Word, span: arg.span }),
        }
    }
    prepared
}
