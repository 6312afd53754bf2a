//! Laws of formatting, for any bytes whatever.

use crate::compile;
use crate::diag::Diagnostic;
use crate::format::{changes, format};
use crate::source::Source;
use crate::syntax::{TokenKind, lex, parse};

/// Checks that formatting keeps the program to the bit, every comment in order and every line with an error, that doing it
/// twice changes nothing more, and that its changes are those that it makes.
///
/// # Panics
/// When one of that is not so.
pub fn assert_formats_soundly(bytes: &[u8]) {
    let old = Source::from_bytes("test.cli", bytes.to_vec()).expect("a source below 4 GiB");
    let formatted = format(&old);
    let new = Source::from_bytes("test.cli", formatted.clone()).expect("a source below 4 GiB");
    let shown = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    assert_eq!(shown(&format(&new)), shown(&formatted), "formatted twice");
    assert!(format(&new) == formatted, "formatted twice");
    assert_same_program(&old, &new);
    assert_eq!(comments(&old), comments(&new), "the comments");
    assert_eq!(lines_with_errors(&old), lines_with_errors(&new), "the lines with errors");
    assert!(with_changes(&old) == formatted, "the changes are not what changes");
    let ends = formatted.is_empty() || formatted.ends_with(b"\n") || formatted == "\u{FEFF}".as_bytes();
    let cannot_end = formatted.ends_with(b"\r") || formatted == bytes;
    assert!(ends || cannot_end, "the last line has no end");
}

fn assert_same_program(old: &Source, new: &Source) {
    let [(old_program, old_codes), (new_program, new_codes)] = [old, new].map(|source| {
        let compilation = compile(source);
        let codes: Vec<_> = compilation.diagnostics.iter().map(|found| found.code.id).collect();
        (compilation.program, codes)
    });
    assert_eq!(old_codes, new_codes, "the codes of what is found");
    assert_eq!(old_program, new_program, "the program");
    // Equal numbers may still differ in the sign of a zero.
    let [old_bits, new_bits] = [old, new].map(|source| {
        let file = parse(source).file;
        file.commands().flat_map(|command| command.numbers.iter().map(|number| number.to_bits())).collect::<Vec<_>>()
    });
    assert_eq!(old_bits, new_bits, "the bits of the numbers");
}

/// Returns the comments, without the blanks at their end.
fn comments(source: &Source) -> Vec<&str> {
    let tokens = lex(source).into_iter().filter(|token| token.kind == TokenKind::Comment);
    tokens.map(|token| source.slice(token.span).trim_end_matches([' ', '\t'])).collect()
}

/// Returns the lines that have an error, without their ends.
fn lines_with_errors(source: &Source) -> Vec<Vec<u8>> {
    let bytes = source.original_bytes();
    let line_of = |found: &Diagnostic| {
        let span = source.lines().line_span(source.text(), source.lines().line_of(found.primary.span.start));
        bytes[span.range()].to_vec()
    };
    compile(source).diagnostics.iter().filter(|found| found.is_error()).map(line_of).collect()
}

/// Carries the changes out.
fn with_changes(source: &Source) -> Vec<u8> {
    let original = source.original_bytes();
    let (mut bytes, mut end) = (Vec::new(), 0);
    for change in changes(source) {
        bytes.extend_from_slice(&original[end..change.old.start as usize]);
        bytes.extend_from_slice(&change.new);
        end = change.old.end as usize;
    }
    bytes.extend_from_slice(&original[end..]);
    bytes
}
