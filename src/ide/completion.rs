//! What may be written next.

use std::collections::HashMap;

use crate::diag::Code;
use crate::ide::document::kind_of;
use crate::ide::line::{LineAt, arg_spec};
use crate::ide::{Document, color_words};
use crate::lint::all_codes;
use crate::source::Span;
use crate::syntax::spec::{Arguments, COMMANDS, CommandSpec, Group};
use crate::syntax::{TokenKind, argument_spans, directive};

/// How many commands around the place are looked at for values.
const N_LOOKED_AT: usize = 2000;
/// How many values are offered.
const MAX_VALUES: usize = 30;

/// Something to write.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Completion {
    /// What the list shows.
    pub label: String,
    /// What it is.
    pub kind: CompletionKind,
    /// A few words beside the label.
    pub detail: String,
    /// What it means.
    pub doc: String,
    /// What is replaced.
    pub span: Span,
    /// What is written.
    pub text: String,
    /// The same with a place to fill in for each argument, as snippets have them: `${1:x}`.
    pub snippet: Option<String>,
}

/// What a completion is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CompletionKind {
    /// A command.
    Command,
    /// Numbers.
    Value,
    /// Three numbers that are a colour.
    Color,
    /// The name of an image.
    FileName,
    /// A comment that speaks to clisc.
    Directive,
}

/// Returns what may stand at `offset`, the likeliest first.
#[must_use]
pub fn completions(document: &Document, offset: u32) -> Vec<Completion> {
    let line = LineAt::new(document, offset);
    if line.is_in_comment() {
        let rules = rules(document, &line);
        return if rules.is_empty() { directives(document, &line) } else { rules };
    }
    let Some(index) = line.arg_index() else {
        let span = line.word().unwrap_or(Span::at(offset));
        return COMMANDS.iter().map(|command| command_completion(command, span)).collect();
    };
    let Some(command) = line.command(document) else { return Vec::new() };
    let span = line.word().unwrap_or(Span::at(offset));
    match command.arguments {
        Arguments::FileName(_) if index == 0 => file_names(document, span),
        Arguments::FileName(_) => Vec::new(),
        Arguments::Numbers(_) => values(document, command, index, rest_of_group(&line, command, index, span)),
    }
}

fn command_completion(command: &'static CommandSpec, span: Span) -> Completion {
    let mut snippet = command.name.to_owned();
    for (i, name) in command.arg_names().enumerate() {
        let begins_group = command.grouped().any(|(numbers, _)| numbers.start == i);
        snippet.push_str(if i > 0 && begins_group { "   " } else { " " });
        snippet.push_str(&format!("${{{}:{name}}}", i + 1));
    }
    Completion {
        label: command.name.to_owned(),
        kind: CompletionKind::Command,
        detail: command.usage(),
        doc: format!("{}\n\nSuch as `{}`", command.doc, command.example),
        span,
        text: format!("{} ", command.name),
        snippet: Some(snippet),
    }
}

/// Returns what a value in place of the word below `span` replaces: of a line that has all its numbers, the rest of the
/// group, so that as many come as go.
fn rest_of_group(line: &LineAt, command: &CommandSpec, index: usize, span: Span) -> Span {
    let args = line.args();
    let is_whole = args.len() == command.numbers().len() && args.get(index) == Some(&span);
    let group = command.grouped().find(|(numbers, _)| is_whole && numbers.contains(&index));
    group.map_or(span, |(numbers, _)| span.to(args[numbers.end - 1]))
}

/// Returns the values that other commands of this kind have from argument `index` to the end of its group, the most
/// frequent first.
fn values(document: &Document, command: &'static CommandSpec, index: usize, span: Span) -> Vec<Completion> {
    let Some((numbers, group)) = command.grouped().find(|(numbers, _)| numbers.contains(&index)) else {
        return Vec::new();
    };
    let mut counts: HashMap<String, (usize, usize)> = HashMap::new();
    let lines = document.lines();
    let own_line = lines.line_of(span.start);
    let first = span.start.saturating_sub((N_LOOKED_AT * 40) as u32);
    let others = document.commands_in(Span::new(first, u32::MAX)).take(N_LOOKED_AT).filter(|other| {
        kind_of(other) == Some(command.kind) && !other.numbers.is_empty() && lines.line_of(other.span.start) != own_line
    });
    for (order, other) in others.enumerate() {
        let args = argument_spans(document.source(), other.span);
        let words: Vec<_> = args[index..numbers.end].iter().map(|arg| document.source().slice(*arg)).collect();
        counts.entry(words.join(" ")).or_insert((0, order)).0 += 1;
    }
    let mut values: Vec<_> = counts.into_iter().collect();
    values.sort_by_key(|(_, (n, order))| (std::cmp::Reverse(*n), *order));
    let is_whole = index == numbers.start;
    values
        .into_iter()
        .take(MAX_VALUES)
        .map(|(text, (n, _))| {
            value_completion(text, n, group, is_whole, arg_spec(command, index).map_or("", |arg| arg.doc), span)
        })
        .collect()
}

fn value_completion(text: String, n: usize, group: &Group, is_whole: bool, doc: &str, span: Span) -> Completion {
    let channels: Vec<f64> = text.split(' ').filter_map(|word| word.parse().ok()).collect();
    let used = if n == 1 { "used once".to_owned() } else { format!("used {n} times") };
    let (kind, detail) = match channels[..] {
        [r, g, b] if group.is_color && is_whole => {
            (CompletionKind::Color, format!("{}, {used}", color_words([r, g, b])))
        }
        _ => (CompletionKind::Value, used),
    };
    let doc = if is_whole { group.name.to_owned() } else { doc.to_owned() };
    Completion { label: text.clone(), kind, detail, doc, span, text, snippet: None }
}

/// Offers the name of the scene itself for its image.
fn file_names(document: &Document, span: Span) -> Vec<Completion> {
    let name = document.source().name().rsplit(['/', '\\']).next().unwrap_or_default();
    let stem = name.strip_suffix(".cli").filter(|stem| !stem.is_empty()).unwrap_or("picture");
    let needs_quotes = stem.contains(char::is_whitespace) || stem.starts_with('#');
    let text = if needs_quotes { format!("\"{stem}.png\"") } else { format!("{stem}.png") };
    let doc = "The image, named after the scene".to_owned();
    vec![Completion {
        label: text.clone(),
        kind: CompletionKind::FileName,
        detail: String::new(),
        doc,
        span,
        text,
        snippet: None,
    }]
}

/// Offers the rules that a comment can allow, where the place is in its list.
fn rules(document: &Document, line: &LineAt) -> Vec<Completion> {
    let Some(comment) = line.tokens.iter().find(|token| token.kind == TokenKind::Comment) else { return Vec::new() };
    let written = document.source().slice(Span::new(comment.span.start, line.offset));
    let Some(list) = directive(written).and_then(|text| text.strip_prefix("allow(")) else { return Vec::new() };
    if list.contains(')') {
        return Vec::new();
    }
    let n_word = list.len() - list.rfind([',', ' ']).map_or(0, |before| before + 1);
    let n_word = if written.ends_with([' ', '\t']) { 0 } else { n_word };
    let span = Span::new(line.offset - n_word as u32, line.offset);
    let rules = all_codes().filter_map(|code| code.name.map(|name| (code, name)));
    let completion = |(code, name): (&Code, &str)| Completion {
        label: name.to_owned(),
        kind: CompletionKind::Directive,
        detail: code.id.to_owned(),
        doc: code.title.to_owned(),
        span,
        text: name.to_owned(),
        snippet: None,
    };
    rules.map(completion).collect()
}

/// Offers comments that speak to clisc, on a line that has nothing else.
fn directives(document: &Document, line: &LineAt) -> Vec<Completion> {
    let comment = Span::new(line.span.start, line.offset);
    let written = document.source().slice(comment).trim_start_matches([' ', '\t']);
    if !written.starts_with('#') {
        return Vec::new();
    }
    let span = Span::new(line.offset - written.len() as u32, line.span.end);
    [
        ("# clisc: off", "leave the text below as it is when formatting"),
        ("# clisc: on", "format again from here on"),
        ("# clisc: allow()", "do not report what the rules in the list find in the command below"),
    ]
    .into_iter()
    .filter(|(text, _)| text.replace(' ', "").starts_with(&written.replace(' ', "")))
    .map(|(text, doc)| Completion {
        label: text.to_owned(),
        kind: CompletionKind::Directive,
        detail: String::new(),
        doc: doc.to_owned(),
        span,
        text: text.to_owned(),
        snippet: None,
    })
    .collect()
}
