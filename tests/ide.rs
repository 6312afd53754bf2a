//! What an editor asks, about any text at any place.

#[path = "support/tree.rs"]
mod tree;

use std::path::Path;

use clisc::ide::position::{Position, Unit};
use clisc::ide::{
    Document, colors, completions, folds, hints, hover, names_at, outline, semantic_tokens, signature, surface_at,
    uses_of_surface_at,
};
use clisc::source::Span;
use clisc::syntax::spec::COMMANDS;
use proptest::prelude::*;

fn open(text: &str) -> Document {
    Document::new("a.cli", text.to_owned()).expect("a text below 4 GiB")
}

/// Asks everything about a text, at every place that an editor can name, and checks that the answers lie in it.
fn assert_answers_soundly(text: &str) {
    let document = open(text);
    let lies_inside = |span: Span| assert!(text.get(span.range()).is_some(), "{span:?} in {text:?}");
    for offset in (0..=text.len()).filter(|&offset| text.is_char_boundary(offset)).map(|offset| offset as u32) {
        hover(&document, offset).into_iter().for_each(|hover| lies_inside(hover.span));
        for completion in completions(&document, offset) {
            lies_inside(completion.span);
            assert!(completion.span.start <= offset && offset <= completion.span.end, "{completion:?}");
        }
        if let Some(signature) = signature(&document, offset) {
            assert!(signature.active.is_none_or(|active| active < signature.args.len()));
        }
        let uses = uses_of_surface_at(&document, offset);
        assert_eq!(uses.first().map(|first| first.span), surface_at(&document, offset));
        assert!(uses.iter().skip(1).all(|found| !found.is_surface));
        uses.iter().for_each(|found| lies_inside(found.span));
        names_at(&document, offset).iter().for_each(|names| assert!(names.places.contains(&names.span)));
        assert_place_is_found(&document, offset);
    }
    let whole = Span::new(0, text.len() as u32);
    colors(&document).iter().for_each(|color| lies_inside(color.span));
    hints(&document, whole).iter().for_each(|hint| lies_inside(Span::at(hint.at)));
    let tokens = semantic_tokens(&document, whole);
    tokens.iter().for_each(|token| lies_inside(token.span));
    assert!(tokens.is_sorted_by(|a, b| a.span.end <= b.span.start), "{tokens:?}");
    for symbol in outline(&document) {
        lies_inside(symbol.span);
        assert!(symbol.span.start == symbol.command.start && symbol.command.end <= symbol.span.end);
    }
    let n_lines = document.lines().n_lines() as u32;
    assert!(folds(&document).iter().all(|fold| fold.first < fold.last && fold.last < n_lines));
}

/// Checks that a place leads back to its byte, but between CR and LF, where no place is.
fn assert_place_is_found(document: &Document, offset: u32) {
    let (text, lines) = (document.text(), document.lines());
    for unit in [Unit::Utf8, Unit::Utf16, Unit::Utf32] {
        let position = lines.position(text, offset, unit);
        let found = lines.offset(text, position, unit);
        let is_in_line_end = text[..offset as usize].ends_with('\r') && text[offset as usize..].starts_with('\n');
        assert!(found == offset || is_in_line_end, "{position:?} is {found}, not {offset}, of {text:?}");
    }
}

#[test]
fn every_scene_is_answered() {
    for path in tree::files_below(&Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/commands")) {
        assert_answers_soundly(&std::fs::read_to_string(path).expect("a scene"));
    }
}

#[test]
fn a_place_that_does_not_exist_is_the_nearest() {
    let document = open("fov 60\n");
    for position in [Position { line: 0, column: u32::MAX }, Position { line: u32::MAX, column: u32::MAX }] {
        let offset = document.lines().offset(document.text(), position, Unit::Utf16);
        assert!(offset == 6 || offset == 7);
    }
}

/// Each number of each command has its own page.
#[test]
fn hover_knows_every_argument() {
    for command in &COMMANDS {
        let document = open(command.example);
        let words: Vec<_> = command.example.split_ascii_whitespace().collect();
        let mut at = 0;
        for (word, name) in words.iter().zip(std::iter::once(command.name).chain(command.arg_names())) {
            let start = at + command.example[at..].find(word).expect("a word");
            at = start + word.len();
            let hover = hover(&document, start as u32).expect("a page");
            assert!(hover.markdown.contains(name), "{word}: {}", hover.markdown);
            assert_eq!(hover.span, Span::new(start as u32, at as u32));
        }
    }
}

/// Text of commands, numbers, names and what else may come.
fn any_text() -> impl Strategy<Value = String> {
    let word = prop::sample::select(vec![
        "fov",
        "light",
        "surface",
        "sphere",
        "cylinder",
        "write",
        "sphre",
        "1",
        "-0.5",
        "1e999",
        "nan",
        "a.png",
        "\"a b.png\"",
        "\"",
        "#",
        "# clisc: off",
        "# clisc: on\n",
        "\t",
        "\r",
        "\n",
        "\r\n",
        "\u{A0}",
        "\0",
        "\u{FEFF}",
        "π😀",
        "surface 1 0 0 1 1 1 0 0 0 1 0\n",
        "sphere 0 0 -4 1\n",
        "write a.png\n",
    ]);
    prop::collection::vec((word, prop::sample::select(vec!["", " ", " ", "\n"])), 0..25)
        .prop_map(|pieces| pieces.into_iter().flat_map(|(word, blank)| [word, blank]).collect())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(100) })]

    #[test]
    fn any_text_is_answered(text in any_text()) {
        assert_answers_soundly(&text);
    }
}
