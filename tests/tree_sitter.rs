//! The tree that editors see is the parser's: `grammar/tree-sitter-clisc` and `src/syntax` read every text alike.

mod support;

#[path = "support/tree.rs"]
mod tree;

use std::collections::BTreeSet;
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

use clisc::diag::codes;
use clisc::source::Source;
use clisc::syntax::ast::Shape;
use clisc::syntax::spec::COMMANDS;
use clisc::syntax::{Parse, Token, TokenKind, argument_spans, lex, parse};
use clisc::testing::Stream;
use tree_sitter::{Node, Parser, Query, QueryCursor, StreamingIterator, Tree};

use crate::support::ebnf::Grammar;
use crate::support::lines;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Returns what tree-sitter makes of a text.
fn tree_of(text: &str) -> Tree {
    let mut parser = Parser::new();
    parser.set_language(&tree_sitter_clisc::LANGUAGE.into()).expect("a language of a version that tree-sitter knows");
    parser.parse(text, None).expect("nothing stops the parser")
}

/// A command without a mistake: its name, its place, the names and places of its arguments.
type Command = (String, Range<usize>, Vec<(String, Range<usize>)>);

/// What a reader says of a text.
#[derive(Debug, Default, PartialEq)]
struct Reading {
    /// The lines with a mistake, from 0.
    bad_lines: BTreeSet<usize>,
    /// The commands of the other lines.
    commands: Vec<Command>,
}

/// Returns what the parser says; `None` when what is wrong lies outside the grammar, in the encoding or the size of a
/// number, or where it says once for all what is wrong with many lines, lone carriage returns.
fn read_by_parser(source: &Source) -> Option<Reading> {
    let Parse { file, diagnostics } = parse(source);
    let outside = [codes::NUMBER_OVERFLOW.id, codes::INVALID_TEXT.id];
    let has_lone_return = lex(source).iter().any(|token| token.kind == TokenKind::LoneReturn);
    if has_lone_return || diagnostics.iter().any(|diagnostic| outside.contains(&diagnostic.code.id)) {
        return None;
    }
    let line_of = |offset| source.lines().line_of(offset);
    let mut reading = Reading::default();
    reading.bad_lines.extend(diagnostics.iter().map(|diagnostic| line_of(diagnostic.primary.span.start)));
    for command in file.commands() {
        let Shape::Whole(kind) = command.shape else { continue };
        if reading.bad_lines.contains(&line_of(command.span.start)) {
            continue;
        }
        let names = kind.spec().arg_names().map(str::to_owned);
        let places = argument_spans(source, command.span).into_iter().map(|span| span.range());
        reading.commands.push((kind.name().to_owned(), command.span.range(), names.zip(places).collect()));
    }
    Some(reading)
}

/// Returns what the tree says.
fn read_by_tree(source: &Source, tree: &Tree) -> Reading {
    let mut reading = Reading::default();
    let line_of = |offset: usize| source.lines().line_of(offset as u32);
    let mut ahead = vec![tree.root_node()];
    while let Some(node) = ahead.pop() {
        if node.kind() == "malformed" {
            reading.bad_lines.extend(line_of(node.start_byte())..=line_of(node.end_byte() - 1));
        }
        ahead.extend(children(node));
    }
    let is_command = |node: &Node<'_>| COMMANDS.iter().any(|command| command.name == node.kind());
    let is_good = |node: &Node<'_>| !reading.bad_lines.contains(&line_of(node.start_byte()));
    let commands = children(tree.root_node()).into_iter().filter(|node| is_command(node) && is_good(node));
    reading.commands = commands.map(|node| (node.kind().to_owned(), node.byte_range(), arguments(node))).collect();
    reading
}

fn children(node: Node<'_>) -> Vec<Node<'_>> {
    node.children(&mut node.walk()).collect()
}

/// Returns the children of a node that have a field, with its name.
fn fields(node: Node<'_>) -> impl Iterator<Item = (&str, Node<'_>)> {
    (0..node.child_count()).filter_map(move |i| Some((node.field_name_for_child(i)?, node.child(i)?)))
}

/// Returns the names and places of a command's arguments, by the names of the command table.
fn arguments(command: Node<'_>) -> Vec<(String, Range<usize>)> {
    let mut arguments = Vec::new();
    for (field, node) in fields(command) {
        if node.child_count() == 0 {
            let name = if field == "name" { "name.png" } else { field };
            arguments.push((name.to_owned(), node.byte_range()));
        }
        for (part, node) in fields(node) {
            let name = match field {
                "ambient" | "diffuse" | "specular" => format!("C{}{part}", &field[..1]),
                _ => part.to_owned(),
            };
            arguments.push((name, node.byte_range()));
        }
    }
    arguments
}

/// Fails when parser and tree disagree on a text; returns whether both have read it.
#[track_caller]
fn assert_agreement(source: &Source) -> bool {
    let tree = tree_of(source.text());
    assert!(!tree.root_node().has_error(), "{}: {:?}", source.name(), source.text());
    let Some(expected) = read_by_parser(source) else { return false };
    let found = read_by_tree(source, &tree);
    assert_eq!(found, expected, "{}: {:?}\n{}", source.name(), source.text(), tree.root_node().to_sexp());
    true
}

/// Every scene of the project, good or bad, and those of the course where they are at hand.
fn corpus() -> Vec<PathBuf> {
    let folders = ["tests/fixtures", "scenes", "fuzz/seeds", "../shared/course"].map(|folder| root().join(folder));
    let mut paths: Vec<_> =
        folders.iter().filter(|folder| folder.is_dir()).flat_map(|folder| tree::files_below(folder)).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "cli"));
    paths
}

fn source_of(path: &Path) -> Source {
    let bytes = fs::read(path).expect("a readable file");
    Source::from_bytes(path.display().to_string(), bytes).expect("a scene below 4 GiB")
}

#[test]
fn tree_and_parser_agree_on_every_scene() {
    let corpus = corpus();
    let n_read = corpus.iter().filter(|path| assert_agreement(&source_of(path))).count();
    let n_outside = corpus.len() - n_read;
    assert!(n_read > 70 && n_outside < 15, "{n_read} scenes read, {n_outside} left out");
}

#[test]
fn tree_and_parser_agree_on_random_lines() {
    let mut stream = Stream::new(4);
    let (mut n_read, mut n_good) = (0, 0);
    for _ in 0..20_000 {
        let source = Source::new("random", lines::at_random(&mut stream, 25));
        n_read += usize::from(assert_agreement(&source));
        n_good += usize::from(parse(&source).diagnostics.is_empty());
    }
    assert!(n_read > 10_000 && n_good > 1_000, "{n_read} read, {n_good} of them good");
}

#[test]
fn a_mistake_in_the_tree_never_reaches_beyond_its_line() {
    let grammar = Grammar::read(&fs::read_to_string(root().join("grammar/scene.ebnf")).expect("the grammar"));
    let mut stream = Stream::new(5);
    let mut n_read = 0;
    for _ in 0..2000 {
        let mut text = String::new();
        for _ in 0..2 + stream.below(12) {
            let mut line: Vec<char> = grammar.generate("line", &mut stream).chars().collect();
            (0..stream.below(3)).for_each(|_| lines::mutate(&mut line, &mut stream));
            text.extend(line);
            text.push_str(if stream.below(4) == 0 { "\r\n" } else { "\n" });
        }
        n_read += usize::from(assert_agreement(&Source::new("mutated", text)));
    }
    assert!(n_read > 500, "{n_read} read");
}

#[test]
fn words_are_coloured_by_what_they_are_to_the_lexer() {
    let language = tree_sitter_clisc::LANGUAGE.into();
    let query = Query::new(&language, tree_sitter_clisc::HIGHLIGHTS_QUERY).expect("a query of this grammar");
    Query::new(&language, tree_sitter_clisc::INJECTIONS_QUERY).expect("a query of this grammar");
    let mut n_words = 0;
    for path in corpus() {
        let source = source_of(&path);
        let Some(Reading { bad_lines, .. }) = read_by_parser(&source) else { continue };
        let is_good = |start: usize| !bad_lines.contains(&source.lines().line_of(start as u32));
        let found = highlights(&query, &source).into_iter().filter(|(place, _)| is_good(place.start));
        let expected = lex(&source).into_iter().filter_map(|token| Some((token.span.range(), color_of(token)?)));
        let expected: Vec<_> = expected.filter(|(place, _)| is_good(place.start)).collect();
        n_words += expected.len();
        assert_eq!(found.collect::<Vec<_>>(), expected, "{}", path.display());
    }
    assert!(n_words > 2000, "{n_words} words");
}

/// Returns the places and names of what a query captures, in order.
fn highlights<'q>(query: &'q Query, source: &Source) -> Vec<(Range<usize>, &'q str)> {
    let tree = tree_of(source.text());
    let mut cursor = QueryCursor::new();
    let mut captures = cursor.captures(query, tree.root_node(), source.text().as_bytes());
    let mut highlights = Vec::new();
    while let Some((found, index)) = captures.next() {
        let capture = found.captures()[*index];
        highlights.push((capture.node.byte_range(), query.capture_names()[capture.index as usize]));
    }
    highlights
}

/// Returns the capture for a token of a good line; none when it has no colour.
fn color_of(token: Token) -> Option<&'static str> {
    match token.kind {
        TokenKind::Comment => Some("comment"),
        TokenKind::Word => Some("keyword"),
        TokenKind::Number => Some("number"),
        TokenKind::Path | TokenKind::Quoted => Some("string.special.path"),
        TokenKind::Bom | TokenKind::Newline | TokenKind::Blank => None,
        TokenKind::OpenQuote | TokenKind::ForeignBlank | TokenKind::LoneReturn | TokenKind::Control => Some("error"),
    }
}

#[test]
fn grammar_and_table_have_the_same_commands() {
    for command in &COMMANDS {
        let source = Source::new("example", command.example);
        let reading = read_by_tree(&source, &tree_of(source.text()));
        let [(name, _, arguments)] = &reading.commands[..] else { panic!("{}: {reading:?}", command.example) };
        assert_eq!(name, command.name);
        assert!(arguments.iter().map(|(name, _)| name.as_str()).eq(command.arg_names()), "{arguments:?}");
    }
}
