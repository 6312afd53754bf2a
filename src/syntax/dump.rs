//! Tokens and tree as text and JSON, stable from run to run.
//!
//! The text is for people and for snapshots: one token or command a line, its place first.

use std::io::{self, Write};

use serde::Serialize;

use crate::source::{Position, Source, Span};
use crate::syntax::ast::{Command, File, Shape};
use crate::syntax::spec::{Arguments, CommandKind};
use crate::syntax::token::Token;
use crate::syntax::{argument_spans, file_name};

/// The version of the shape of the JSON dumps.
const VERSION: u32 = 1;

/// Writes tokens, one a line: place, kind, text with escapes.
///
/// # Errors
/// Those of `out`.
pub fn dump_tokens(source: &Source, tokens: &[Token], out: &mut dyn Write) -> io::Result<()> {
    for token in tokens {
        let (place, kind) = (place(source, token.span), token.kind.name());
        writeln!(out, "{place:>8}  {kind:<13}  {:?}", source.slice(token.span))?;
    }
    Ok(())
}

/// Writes tokens as a JSON document.
///
/// # Errors
/// Those of `out`.
pub fn dump_tokens_json(source: &Source, tokens: &[Token], out: &mut dyn Write) -> io::Result<()> {
    #[derive(Serialize)]
    struct JsonToken<'a> {
        kind: &'static str,
        span: Span,
        start: Position,
        text: &'a str,
    }
    let tokens = tokens.iter().map(|token| JsonToken {
        kind: token.kind.name(),
        span: token.span,
        start: source.lines().position(source.text(), token.span.start),
        text: source.slice(token.span),
    });
    write_list(source, "tokens", tokens, out)
}

/// Writes the commands of a tree, one a line: place, name, arguments with their names.
///
/// # Errors
/// Those of `out`.
pub fn dump_ast(source: &Source, file: &File, out: &mut dyn Write) -> io::Result<()> {
    for command in file.commands() {
        write!(out, "{:>8}  ", place(source, command.span))?;
        match command.shape {
            Shape::Whole(kind) => dump_whole(source, kind, &command, out)?,
            Shape::Bad(Some(kind)) => write!(out, "bad {}: {:?}", kind.name(), shown(source, command.span))?,
            Shape::Bad(None) => write!(out, "bad: {:?}", shown(source, command.span))?,
        }
        writeln!(out)?;
    }
    Ok(())
}

fn dump_whole(source: &Source, kind: CommandKind, command: &Command<'_>, out: &mut dyn Write) -> io::Result<()> {
    let spec = kind.spec();
    write!(out, "{}", spec.name)?;
    match spec.arguments {
        Arguments::Numbers(args) => {
            args.iter().zip(command.numbers).try_for_each(|(arg, number)| write!(out, " {}={number:?}", arg.name))
        }
        Arguments::FileName(_) => {
            let name = file_name(source, command.span).map_or("", |(name, _)| name);
            write!(out, " name={name:?}")
        }
    }
}

/// Writes the commands of a tree as a JSON document.
///
/// # Errors
/// Those of `out`.
pub fn dump_ast_json(source: &Source, file: &File, out: &mut dyn Write) -> io::Result<()> {
    #[derive(Serialize)]
    struct JsonCommand<'a> {
        kind: Option<CommandKind>,
        bad: bool,
        span: Span,
        start: Position,
        #[serde(skip_serializing_if = "Option::is_none")]
        name: Option<(&'a str, Span)>,
        arguments: Vec<JsonArgument>,
    }
    #[derive(Serialize)]
    struct JsonArgument {
        name: &'static str,
        value: f64,
        span: Span,
    }
    let commands = file.commands().map(|command| {
        let (kind, bad) = match command.shape {
            Shape::Whole(kind) => (Some(kind), false),
            Shape::Bad(kind) => (kind, true),
        };
        let numbers = kind.map_or(&[][..], |kind| kind.spec().numbers()).iter().zip(command.numbers);
        let arguments = numbers.zip(argument_spans(source, command.span));
        JsonCommand {
            kind,
            bad,
            span: command.span,
            start: source.lines().position(source.text(), command.span.start),
            name: (command.shape == Shape::Whole(CommandKind::Write))
                .then(|| file_name(source, command.span))
                .flatten(),
            arguments: arguments.map(|((arg, &value), span)| JsonArgument { name: arg.name, value, span }).collect(),
        }
    });
    write_list(source, "commands", commands, out)
}

/// Writes a document with one list, an item a line.
fn write_list(
    source: &Source,
    key: &str,
    items: impl Iterator<Item = impl Serialize>,
    out: &mut dyn Write,
) -> io::Result<()> {
    write!(out, "{{\n  \"version\": {VERSION},\n  \"path\": ")?;
    serde_json::to_writer(&mut *out, source.name())?;
    write!(out, ",\n  \"{key}\": [")?;
    for (i, item) in items.enumerate() {
        out.write_all(if i == 0 { b"\n    " } else { b",\n    " })?;
        serde_json::to_writer(&mut *out, &item)?;
    }
    writeln!(out, "\n  ]\n}}")
}

/// Returns `line:column` of the start of a span.
fn place(source: &Source, span: Span) -> String {
    let Position { line, column } = source.lines().position(source.text(), span.start);
    format!("{line}:{column}")
}

/// Returns the text of a span, cut off when it is long.
fn shown(source: &Source, span: Span) -> String {
    const MAX_CHARS: usize = 80;
    let text = source.slice(span);
    match text.char_indices().nth(MAX_CHARS) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}
