//! Laws of the language wing, for any bytes whatever.
//!
//! Each function panics when its law is broken; property tests and fuzz targets feed them.

use crate::compile::with_edition;
use crate::diag::render::{Color, render_human, render_json, render_short};
use crate::diag::{Code, Diagnostic, Severity, fix};
use crate::lower::lower;
use crate::source::Source;
use crate::syntax::{Parse, Runs, ast, lex, parse, parse_in_chunks};
use crate::{Compilation, MAX_LISTED, Times, compile, compile_in_chunks};

/// Makes a source of a few bytes.
fn source(bytes: &[u8]) -> Source {
    Source::from_bytes("test.cli", bytes.to_vec()).expect("a source below 4 GiB")
}

/// Checks that the tokens tile the source: side by side they give its bytes back, and none is empty.
///
/// # Panics
/// When they do not.
pub fn assert_tokens_tile(bytes: &[u8]) {
    let source = source(bytes);
    let mut end = 0;
    for token in lex(&source) {
        assert_eq!(token.span.start, end, "a gap or an overlap before {token:?}");
        assert!(!token.span.is_empty(), "{token:?} is empty");
        assert!(source.text().is_char_boundary(token.span.end as usize), "{token:?} cuts a character in two");
        end = token.span.end;
    }
    assert_eq!(end as usize, bytes.len(), "the last token does not reach the end");
    assert_eq!(*source.original_bytes(), *bytes, "the source does not keep its bytes");
}

/// Checks that the commands of a scene lie in order and that their numbers are finite.
///
/// # Panics
/// When it is not so.
pub fn assert_parses_soundly(bytes: &[u8]) {
    let whole = parse(&source(bytes));
    let mut n_commands = 0;
    let mut end = 0;
    for command in whole.file.commands() {
        assert!(command.span.start >= end && !command.span.is_empty(), "{command:?} lies before {end}");
        assert!(command.numbers.iter().all(|number| number.is_finite()), "{command:?} is not finite");
        n_commands += 1;
        end = command.span.end;
    }
    assert_eq!(whole.file.n_commands(), n_commands);
}

/// Checks that parsing and compiling give the same twice, stage by stage and in chunks of any size, and that parsing does
/// without the short way.
///
/// # Panics
/// When they do not.
pub fn assert_ways_agree(bytes: &[u8]) {
    let source = source(bytes);
    let whole = parse(&source);
    assert_eq!(parse(&source), whole, "parsed twice");
    for chunk_bytes in [1, 7, 64] {
        assert_eq!(parse_in_chunks(&source, chunk_bytes), whole, "parsed in chunks of {chunk_bytes}");
    }
    assert_short_way_leads_to(&source, &whole.file);
    assert_stages_make(&source, &compile(&source));
}

/// Checks that tokens and grammar make the same of every line as the short way for plain lines.
fn assert_short_way_leads_to(source: &Source, short: &ast::File) {
    let mut long = Parse::default();
    for run in Runs::new(source).without_short_way() {
        long.append(run);
    }
    assert_eq!(&long.file, short, "parsed without the short way");
    // Equal numbers may still differ in the sign of a zero.
    let bits = |file: &ast::File| -> Vec<u64> {
        file.commands().flat_map(|command| command.numbers.iter().map(|number| number.to_bits())).collect()
    };
    assert_eq!(bits(&long.file), bits(short), "the bits of the numbers without the short way");
}

/// Checks that the scene compiles to diagnostics that are in order and lie in the text, and that a scene without errors
/// makes a valid program.
///
/// # Panics
/// When one of that is not so.
pub fn assert_compiles_soundly(bytes: &[u8]) {
    let source = source(bytes);
    let compilation = compile(&source);
    let found = &compilation.diagnostics;
    assert!(found.is_sorted_by_key(|diagnostic| diagnostic.primary.span.start), "out of order: {found:#?}");
    found.iter().for_each(|diagnostic| assert_is_sound(&source, diagnostic));
    if !compilation.has_errors() {
        let violations = crate::ir::validate(compilation.program).err();
        assert_eq!(violations, None, "the language let pass what the door refuses");
    }
}

/// Checks that the diagnostics of a scene can be drawn, in each format.
///
/// # Panics
/// When one of them can't.
pub fn assert_draws_soundly(bytes: &[u8]) {
    let source = source(bytes);
    let found = &compile(&source).diagnostics;
    let mut out = Vec::new();
    for color in [Color::Never, Color::Always] {
        render_human(&source, found, color, &mut out).expect("written to memory");
    }
    render_short(&source, found, &mut out).expect("written to memory");
    let mut json = Vec::new();
    render_json(&source, found, &mut json).expect("written to memory");
    serde_json::from_slice::<serde_json::Value>(&json).expect("one JSON document");
}

/// Checks that the stages one by one, and in chunks of any size, make what they make together.
fn assert_stages_make(source: &Source, compilation: &Compilation) {
    let parse = parse(source);
    let lowered = lower(source, &parse.file);
    let mut found = parse.diagnostics;
    found.extend(lowered.diagnostics);
    found.sort_by_key(|diagnostic| diagnostic.primary.span.start);
    let n_errors = found.iter().filter(|diagnostic| diagnostic.is_error()).count();
    let n_warnings = found.len() - n_errors;
    let (program, times) = (lowered.program, Times::default());
    let staged = Compilation { program, diagnostics: found, n_errors, n_warnings, times };
    let staged = with_edition(source, staged, &mut Some);
    for chunk_bytes in [1, 64] {
        let in_chunks = compile_in_chunks(source, chunk_bytes);
        assert_eq!(in_chunks.program, staged.program, "compiled in chunks of {chunk_bytes}");
        assert_eq!(in_chunks.diagnostics, compilation.diagnostics, "compiled in chunks of {chunk_bytes}");
    }
    assert_eq!(compilation.program, staged.program, "compiled as a whole");
    if staged.diagnostics.len() <= MAX_LISTED {
        assert_eq!(compilation.diagnostics, staged.diagnostics, "compiled as a whole");
    }
    let n_unlisted: usize =
        [Severity::Error, Severity::Warning].map(|severity| compilation.n_unlisted(severity)).iter().sum();
    assert_eq!(compilation.diagnostics.len() + n_unlisted, staged.diagnostics.len());
}

fn assert_is_sound(source: &Source, diagnostic: &Diagnostic) {
    for label in std::iter::once(&diagnostic.primary).chain(&diagnostic.secondary) {
        assert!(source.text().get(label.span.range()).is_some(), "{label:?} lies outside the text");
        assert!(!label.message.is_empty(), "a label says nothing: {diagnostic:#?}");
    }
    for offered in &diagnostic.fixes {
        assert!(!offered.title.is_empty() && !offered.edits.is_empty(), "a fix does nothing: {diagnostic:#?}");
        assert_eq!(fix::apply(source.text(), [offered]).is_applied, [true], "a fix does not fit: {offered:#?}");
    }
    let message = &diagnostic.message;
    // A point behind a digit is part of a number of the scene, `-2.`, and no stop.
    let has_stop = message.strip_suffix('.').is_some_and(|rest| !rest.ends_with(|c: char| c.is_ascii_digit()));
    assert!(!message.is_empty() && !has_stop, "{message:?}");
    assert!(message.chars().count() < 200, "a message is for people: {message:?}");
}

/// A page of `clisc explain`, taken apart.
#[derive(Clone, Debug, PartialEq)]
pub struct Explanation {
    /// The first line, without `#`.
    pub title: String,
    /// A scene that has what the code stands for.
    pub failing: Vec<u8>,
    /// The same scene without it.
    pub repaired: Vec<u8>,
    /// Whether it takes a run to find it.
    pub needs_run: bool,
}

/// Takes the page of a code apart. In its scenes `\xNN` stands for a byte.
///
/// # Panics
/// When the page has not the shape that every page has.
#[must_use]
pub fn explanation(code: &Code) -> Explanation {
    let page = code.page();
    let title = page.lines().next().and_then(|line| line.strip_prefix("# ")).expect("a title");
    let fences: Vec<_> = page.split("```").collect();
    let [_, failing, _, repaired, _] = fences[..] else { panic!("{}: two fenced scenes, no more", code.id) };
    let (tag, _) = failing.split_once('\n').expect("a fenced scene");
    let scene = |fenced: &str| {
        let text = fenced.strip_prefix(tag).and_then(|text| text.strip_prefix('\n')).expect("both scenes have one tag");
        unescape(text)
    };
    assert!(matches!(tag, "cli" | "cli run"), "{}: unknown tag {tag:?}", code.id);
    Explanation { title: title.to_owned(), failing: scene(failing), repaired: scene(repaired), needs_run: tag != "cli" }
}

fn unescape(text: &str) -> Vec<u8> {
    let mut pieces = text.split("\\x");
    let mut bytes = pieces.next().unwrap_or_default().as_bytes().to_vec();
    for piece in pieces {
        let (digits, rest) = piece.split_at(2);
        bytes.push(u8::from_str_radix(digits, 16).expect("two hexadecimal digits"));
        bytes.extend_from_slice(rest.as_bytes());
    }
    bytes
}
