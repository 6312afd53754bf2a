//! The grammar and the parser say the same: `grammar/scene.ebnf` is read here and tested in both directions.

mod support;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use clisc::diag::codes;
use clisc::source::Source;
use clisc::syntax::parse;
use clisc::syntax::spec::{Arguments, COMMANDS};
use clisc::testing::Stream;

use crate::support::ebnf::{Automaton, Expr, Grammar, symbols};
use crate::support::lines;

/// Productions that separate arguments, and are none.
const SEPARATORS: [&str; 3] = ["S", "comment", "tail"];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: impl AsRef<Path>) -> String {
    let path = root().join(path);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn grammar() -> Grammar {
    Grammar::read(&read("grammar/scene.ebnf"))
}

/// What the parser says to a text.
#[derive(Debug, PartialEq)]
enum Verdict {
    Scene,
    NoScene(Vec<&'static str>),
    /// What is wrong lies outside the grammar: a number is too large, or the text looks like UTF-16.
    OutsideGrammar,
}

fn parse_verdict(text: &str) -> Verdict {
    let found = parse(&Source::new("test.cli", text)).diagnostics;
    let outside = [codes::NUMBER_OVERFLOW.id, codes::INVALID_TEXT.id];
    match found.iter().map(|diagnostic| diagnostic.code.id).collect::<Vec<_>>() {
        codes if codes.is_empty() => Verdict::Scene,
        codes if codes.iter().any(|code| outside.contains(code)) => Verdict::OutsideGrammar,
        codes => Verdict::NoScene(codes),
    }
}

/// Fails when parser and grammar disagree on a text; returns whether it is a scene.
#[track_caller]
fn assert_agreement(automaton: &Automaton, text: &str) -> bool {
    let is_scene = automaton.accepts(text);
    match parse_verdict(text) {
        Verdict::Scene => assert!(is_scene, "the parser takes what the grammar does not: {text:?}"),
        Verdict::NoScene(codes) => assert!(!is_scene, "the grammar takes what the parser refuses, {codes:?}: {text:?}"),
        Verdict::OutsideGrammar => {}
    }
    is_scene
}

#[test]
fn every_production_is_reached() {
    let grammar = grammar();
    let (mut reached, mut ahead) = (BTreeSet::new(), vec!["scene"]);
    while let Some(name) = ahead.pop() {
        if reached.insert(name) {
            ahead.extend(symbols(grammar.production(name)));
        }
    }
    assert_eq!(reached, grammar.names().collect());
}

#[test]
fn the_automaton_counts_as_the_notation_says() {
    let grammar = Grammar::read("top ::= a+ b* (\"c\" | [d-f] 'gh')? /* none */ [^#x20-]\n a ::= #x61\nb ::= 'b'");
    let automaton = Automaton::new(&grammar, "top");
    for (text, expected) in [
        ("ax", true),
        ("aabbcx", true),
        ("aegh!", true),
        ("x", false),
        ("a", false),
        ("a ", false),
        ("a-", false),
        ("bx", false),
        ("aegx", false),
        ("acdghx", false),
        ("", false),
    ] {
        assert_eq!(automaton.accepts(text), expected, "{text:?}");
    }
    let unused = |texts: &[&str]| {
        let marks = texts.iter().flat_map(|text| automaton.marks(text).expect("a sentence")).collect();
        grammar.unused(&marks).len()
    };
    assert_eq!(unused(&["aabcx"]), 4, "a once, no b, the other branch, none of them");
    assert_eq!(unused(&["aabcx", "aeghx"]), 1, "none of the branches");
    assert_eq!(unused(&["aabcx", "aeghx", "ax"]), 0);
}

#[test]
fn fixtures_use_every_alternative() {
    let grammar = grammar();
    let automaton = Automaton::new(&grammar, "scene");
    // A scene of one line cannot be a fixture: it has no `fov` or no `write`, and is warned of.
    let mut used = automaton.marks("").expect("an empty scene");
    for path in fixtures() {
        let text = read(&path);
        let marks = automaton.marks(&text).unwrap_or_else(|| panic!("{} is no sentence", path.display()));
        assert_eq!(parse_verdict(&text), Verdict::Scene, "{}", path.display());
        used.extend(marks);
    }
    let unused = grammar.unused(&used);
    assert!(unused.is_empty(), "no fixture in tests/fixtures/grammar uses\n  {}", unused.join("\n  "));
}

fn fixtures() -> Vec<PathBuf> {
    let folder = fs::read_dir(root().join("tests/fixtures/grammar")).expect("the fixtures");
    let mut paths: Vec<_> = folder.map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    paths
}

#[test]
fn table_and_grammar_have_the_same_commands() {
    let grammar = grammar();
    let mut listed = symbols(grammar.production("command"));
    listed.retain(|name| !SEPARATORS.contains(name));
    let names: Vec<_> = COMMANDS.iter().map(|command| command.name).collect();
    assert_eq!(listed, names);
    for command in &COMMANDS {
        let production = grammar.production(command.name);
        let Expr::Sequence(parts) = production else { panic!("`{}` is no sequence", command.name) };
        assert!(matches!(&parts[0], Expr::Literal(name) if name == command.name), "{parts:?}");
        let mut args = symbols(production);
        args.retain(|name| !SEPARATORS.contains(name));
        match command.arguments {
            Arguments::Numbers(_) => {
                assert_eq!(args, command.arg_names().collect::<Vec<_>>(), "`{}`", command.name);
                args.iter().for_each(|arg| assert_eq!(symbols(grammar.production(arg)), ["number"], "{arg}"));
            }
            Arguments::FileName(_) => assert_eq!(args, ["quoted-name", "bare-name"]),
        }
    }
}

#[test]
fn generated_sentences_parse() {
    let grammar = grammar();
    let automaton = Automaton::new(&grammar, "scene");
    let mut stream = Stream::new(1);
    let mut n_scenes = 0;
    for _ in 0..3000 {
        let text = grammar.generate("scene", &mut stream);
        assert!(assert_agreement(&automaton, &text), "the automaton refuses a sentence of its grammar: {text:?}");
        n_scenes += usize::from(parse_verdict(&text) == Verdict::Scene);
    }
    assert!(n_scenes > 2500, "only {n_scenes} of the sentences lie within the range of binary64");
}

#[test]
fn mutated_sentences_are_taken_or_refused_by_both() {
    let grammar = grammar();
    let automaton = Automaton::new(&grammar, "scene");
    let mut stream = Stream::new(2);
    let mut n_refused = 0;
    for _ in 0..6000 {
        let mut text: Vec<char> = grammar.generate("line", &mut stream).chars().collect();
        for _ in 0..=stream.below(2) {
            lines::mutate(&mut text, &mut stream);
        }
        n_refused += usize::from(!assert_agreement(&automaton, &text.iter().collect::<String>()));
    }
    assert!((1000..5000).contains(&n_refused), "{n_refused} of 6000 refused: the test sees one side only");
}

#[test]
fn random_lines_are_taken_or_refused_by_both() {
    let automaton = Automaton::new(&grammar(), "scene");
    let mut stream = Stream::new(3);
    let mut n_taken = 0;
    for _ in 0..40_000 {
        let text = lines::at_random(&mut stream, 7);
        n_taken += usize::from(assert_agreement(&automaton, &text));
    }
    assert!(n_taken > 2000, "only {n_taken} of 40000 taken: the test sees one side only");
}

#[test]
fn each_code_point_is_taken_or_refused_by_both() {
    let automaton = Automaton::new(&grammar(), "scene");
    let planes = (0..0x3100).chain(0xFE00..0x1_0010).chain([0x1_F600, 0xE_0020, 0x10_FFFF]);
    for c in planes.filter_map(char::from_u32) {
        for text in [
            format!("{c}fov 60"),
            format!("fov{c}60"),
            format!("fov 60{c}"),
            format!("fov 60#{c}"),
            format!("write {c}a.png"),
            format!("write a{c}.png"),
            format!("write a.png{c}"),
            format!("write \"{c}.png\""),
        ] {
            assert_agreement(&automaton, &text);
        }
    }
}

#[test]
fn examples_on_the_page_are_what_they_claim() {
    let automaton = Automaton::new(&grammar(), "scene");
    let page = read("grammar/README.md");
    let mut n_examples = 0;
    for block in page.split("```").skip(1).step_by(2) {
        let (tag, lines) = block.split_once('\n').expect("a block with a tag");
        for line in lines.lines() {
            let is_scene = assert_agreement(&automaton, line);
            match tag {
                "cli" => assert!(is_scene, "{line:?}"),
                "no scene" => assert!(!is_scene && parse_verdict(line) != Verdict::OutsideGrammar, "{line:?}"),
                _ => panic!("an example is `cli` or `no scene`, not `{tag}`"),
            }
            n_examples += 1;
        }
    }
    assert!(n_examples > 40, "{n_examples} examples");
}

#[test]
fn page_names_every_code_outside_the_grammar() {
    let page = read("grammar/README.md");
    let (_, section) = page.split_once("## What the grammar does not say").expect("the section");
    for code in codes::ALL.iter().filter(|code| !code.id.starts_with("W")) {
        let is_outside = !code.id.starts_with("E01") && !code.id.starts_with("E02") || *code == &codes::NUMBER_OVERFLOW;
        assert_eq!(section.contains(code.id), is_outside, "{}", code.id);
    }
}

#[test]
fn scenes_are_sentences() {
    let automaton = Automaton::new(&grammar(), "scene");
    for folder in ["first-steps", "commands", "shading", "mirrors"] {
        for entry in fs::read_dir(root().join("scenes").join(folder)).expect("a folder of scenes") {
            let path = entry.expect("an entry").path();
            assert!(assert_agreement(&automaton, &read(&path)), "{}", path.display());
        }
    }
}
