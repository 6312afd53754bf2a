//! Formatting: the canonical form, and its laws on random scenes, on every file here and, where they are, the originals.

#[path = "support/tree.rs"]
mod tree;

use std::path::Path;

use clisc::format::{NOT_CANONICAL, changes_in, findings, format};
use clisc::source::Source;
use clisc::syntax::spec::COMMANDS;
use clisc::testing::{assert_formats_soundly, explanation};
use proptest::prelude::*;

/// Formats a text, with its laws.
fn formatted(text: impl AsRef<[u8]>) -> String {
    assert_formats_soundly(text.as_ref());
    let source = Source::from_bytes("test.cli", text.as_ref().to_vec()).expect("a source below 4 GiB");
    String::from_utf8_lossy(&format(&source)).into_owned()
}

#[track_caller]
fn check_format(text: &str, expected: &str) {
    assert_eq!(formatted(text), expected);
}

/// Checks that a text is in canonical form already.
#[track_caller]
fn check_kept(text: &str) {
    check_format(text, text);
}

#[test]
fn like_commands_of_a_paragraph_stand_below_each_other() {
    check_format(
        "  surface .1 0 0 .8 .25 .2 .5 .5 .5 8 0\nsphere 0 -1.5 -10. 1\nsphere\t-3 0.25 -9 .125\n\
         surface 1e-3 0 0 1 1 1 0 0 0 100 0.5\ncylinder 1 +0 -4 -1 1\n\nsphere 100 0 -4 1\n",
        "surface  0.1  0 0   0.8 0.25 0.2   0.5 0.5 0.5     8   0\n\
         sphere    0 -1.5  -10.0   1\n\
         sphere   -3  0.25  -9     0.125\n\
         surface  1e-3 0 0   1   1    1     0   0   0     100   0.5\n\
         cylinder 1   +0 -4   -1 1\n\
         \n\
         sphere 100 0 -4   1\n",
    );
}

#[test]
fn every_example_of_the_command_table_is_in_form() {
    for command in COMMANDS {
        let needs_surface = matches!(command.name, "sphere" | "cylinder");
        let surface = if needs_surface { "surface 0 0 0   1 1 1   0 0 0   1   0\n\n" } else { "" };
        check_kept(&format!("{surface}{}\n", command.example));
    }
}

#[test]
fn digits_stay_as_they_are_written() {
    check_format("light 0.10 007 1.50 +1E5 -.0 5.e-3", "light 0.10 007 1.50   +1E5 -0.0 5.0e-3\n");
}

#[test]
fn comments_stay_on_their_line() {
    check_format(
        "  # head \t\nfov 60#a\nbackground 0 0 0 #  b  \n   # alone\nlight 1 1 1 0 0 5 # c\nlight 1 1 1 0 10.5 5 # d\n\
         light 1 1 1 0 0 5.25\n# tail",
        "# head\nfov        60  #a\nbackground 0 0 0  #  b\n# alone\n\
         light      1 1 1   0  0   5  # c\nlight      1 1 1   0 10.5 5  # d\nlight      1 1 1   0  0   5.25\n# tail\n",
    );
}

#[test]
fn a_comment_below_another_stays_below_it() {
    check_format(
        "fov 60\t\t# one\n\t\t# two\n      # not below\n\t\t# nor this\n",
        "fov 60  # one\n        # two\n# not below\n# nor this\n",
    );
    check_format(
        "write \"a b.png\" # one\n                # two\n",
        "write \"a b.png\"  # one\n                 # two\n",
    );
}

#[test]
fn blank_lines_are_single_and_the_last_line_ends() {
    check_format("\n \n# a\n\n\t\n\n# b\n\n", "# a\n\n# b\n");
    check_format("fov 60", "fov 60\n");
    for (nothing, expected) in
        [("", ""), ("\n\n", ""), (" \t", ""), ("\u{FEFF}", "\u{FEFF}"), ("\u{FEFF}\n", "\u{FEFF}")]
    {
        check_format(nothing, expected);
    }
}

#[test]
fn line_ends_are_crlf_when_all_are() {
    check_format("fov  60\r\n\r\n\r\n# a\r\n", "fov 60\r\n\r\n# a\r\n");
    check_format("fov  60\r\n# a", "fov 60\r\n# a\r\n");
    check_format("fov  60\r\n# a\nfoo  1\r\n", "fov 60\n# a\nfoo  1\n");
    check_format("\u{FEFF} fov  60\r\n", "\u{FEFF}fov 60\r\n");
}

#[test]
fn lone_returns_stay_where_they_are() {
    check_kept("fov  60\rlight  1\r# x\n");
    check_format("# a \nfov  60\r", "# a\nfov  60\r");
    // A line end of LF alone would make one line end of two characters that are none.
    check_format("# a \nfov  60\r\r\n# b\r\n", "# a\nfov  60\r\r\n# b\n");
}

#[test]
fn a_line_with_an_error_is_left_alone_and_moves_no_other() {
    for line in [
        "\tsphere 0 0  -4 ",
        " shpere 0 0 -4  1 # x",
        "sphere  0 0 -4 -1",
        "cylinder  1 0 0 2 1",
        "fov\t180",
        "write  ../a.png",
        "write  \"a.png",
        "sphere 0\u{A0}0 -4  1",
        "sphere  100000000000 0 0 1e999",
        "# \0  x",
    ] {
        let scene = |sphere: &str| format!("surface 1 1 1   1 1 1   1 1 1   1   1\n\n{line}\n{sphere}\n");
        check_format(&scene(" sphere 0 0 -4 1"), &scene("sphere 0 0 -4   1"));
    }
    check_format("sphere  0 0 -4 1\n fov  60\n", "sphere  0 0 -4 1\nfov 60\n");
    assert_eq!(formatted(b"fov  60 # \xFC\n fov 60\n"), "fov  60 # \u{FFFD}\nfov 60\n");
}

/// What stands at the start of a file may mean something there.
#[test]
fn an_error_does_not_vanish_at_the_start_of_the_file() {
    check_kept("\n\u{FEFF}fov 60\n");
    check_kept("\n\n\u{FEFF}fov 60\n");
    check_kept("\t#\0x\0y\0\n");
    assert_formats_soundly(b"\n\xFF\xFEf\0o\0");
}

#[test]
fn utf_16_is_left_alone() {
    for text in ["\u{FEFF}fov  60\n\n\n", "fov  60\n\n\n# and more text than is looked at"] {
        let bytes: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        assert_formats_soundly(&bytes);
        let source = Source::from_bytes("test.cli", bytes.clone()).expect("a source below 4 GiB");
        assert!(format(&source) == bytes);
    }
}

#[test]
fn a_fence_keeps_a_table() {
    check_format(
        "fov  60\n  # clisc: off\nlight 1 1 1    0  0 5 \n\n\n   # fov 1\n\t#clisc:on\nlight 1 1 1    0  0 5\n",
        "fov   60\n# clisc: off\nlight 1 1 1    0  0 5 \n\n\n   # fov 1\n#clisc:on\nlight 1 1 1   0 0 5\n",
    );
    check_kept("# clisc: off\nfov  60\n\n\n");
    check_format("# clisc: off\n fov  60", "# clisc: off\n fov  60\n");
    check_format("fov  60 # clisc: off\nfov  60\n", "fov 60  # clisc: off\nfov 60\n");
}

#[test]
fn an_overlong_number_moves_no_other() {
    let long = format!("0.{}", "1".repeat(40));
    check_format(
        &format!("background 1 0.25 {long} # a\nbackground 0.5 1 0.5 # b\n"),
        &format!("background 1   0.25 {long}  # a\nbackground 0.5 1    0.5  # b\n"),
    );
    let huge = "7".repeat(500_000);
    let scene = format!("background 0 0 0.{huge} # a\n") + &"background 0 0 0 # b\n".repeat(1000);
    assert!(formatted(scene).len() < 600_000);
}

#[test]
fn a_range_takes_its_columns_from_the_whole_paragraph() {
    let source = Source::new("test.cli", "light 1 1 1 0 0 5\nlight 1 1 1 10 0 5\nlight 1 1 1 0 0 5\n");
    let changes = changes_in(&source, 2..3);
    let [change] = &changes[..] else { panic!("{changes:?}") };
    assert_eq!((change.old.start, &*change.new), (37, b"light 1 1 1    0 0 5\n".as_slice()));
    assert_eq!(changes_in(&source, 3..9), []);
    assert_eq!(changes_in(&source, 0..3).len(), 3);
}

#[test]
fn every_file_here_keeps_the_laws() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut n_files = 0;
    for folder in ["scenes", "tests/fixtures", "fuzz/seeds", "../shared/course"] {
        let folder = root.join(folder);
        let files = if folder.exists() { tree::files_below(&folder) } else { Vec::new() };
        for path in files.iter().filter(|path| path.extension().is_some_and(|ending| ending == "cli")) {
            assert_formats_soundly(&std::fs::read(path).expect("a readable file"));
            n_files += 1;
        }
    }
    assert!(n_files > 80, "{n_files} files");
}

#[test]
fn every_scene_is_in_form() {
    let scenes = tree::files_below(&Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes"));
    for path in scenes.iter().filter(|path| path.extension().is_some_and(|ending| ending == "cli")) {
        let bytes = std::fs::read(path).expect("a readable file");
        let source = Source::from_bytes("test.cli", bytes.clone()).expect("a source below 4 GiB");
        assert!(format(&source) == bytes, "{} is not formatted; run `clisc fmt scenes`", path.display());
    }
}

#[test]
fn findings_have_a_page_and_a_fix() {
    let page = explanation(&NOT_CANONICAL);
    assert_eq!(page.title, format!("{}: {}", NOT_CANONICAL.id, NOT_CANONICAL.title));
    assert_eq!(formatted(&page.failing).as_bytes(), page.repaired);
    let source = Source::from_bytes("test.cli", page.failing).expect("a source below 4 GiB");
    let found = findings(&source);
    let fixed = clisc::diag::fix::apply(source.text(), found.iter().flat_map(|finding| &finding.fixes));
    assert_eq!(fixed.text.as_bytes(), page.repaired);
    assert_eq!(findings(&Source::new("test.cli", fixed.text)), []);
}

/// Scenes of whole commands in any layout, comments in all places, and some lines that are none.
fn any_tree() -> impl Strategy<Value = String> {
    let number = prop_oneof![
        8 => "[+-]?[0-9]{1,4}(\\.[0-9]{0,5})?",
        4 => "[+-]?[0-9]{0,2}\\.[0-9]{1,3}([eE][+-]?[0-9]{1,2})?",
        1 => "[0-9]{28,36}(\\.[0-9]{0,4})?",
    ];
    let blank = prop::sample::select(vec![" ", "  ", "\t", " \t  "]);
    let comment =
        prop::sample::select(vec!["", "", "", " # a", "#b#", "\t\t#  c  ", " # clisc: off", " # \t\0", " # \u{FEFF}"]);
    let end =
        prop::sample::select(vec!["\n", "\n", "\n", "\n", "\r\n", "\n\n", " \n \t\n\n", "\r", "\r\r\n", " 1\n", ""]);
    let command = prop::sample::select(COMMANDS.iter().collect::<Vec<_>>());
    let name = prop::sample::select(vec!["a.png", "\"a b\t.png\"", "b#c.png", "../a.png"]);
    let args = (prop::collection::vec((blank.clone(), number), 11), name);
    let command = (prop::sample::select(vec!["", "", " ", "\t"]), command, args, comment, end.clone()).prop_map(
        |(indent, command, (numbers, name), comment, end)| {
            let numbers = numbers.iter().take(command.numbers().len());
            let mut args: String = numbers.flat_map(|(blank, number)| [*blank, number.as_str()]).collect();
            if command.numbers().is_empty() {
                args = format!(" {name} ");
            }
            format!("{indent}{}{args}{comment}{end}", command.name)
        },
    );
    let other = prop::sample::select(vec![
        "# alone\n",
        "\t\t# below\n",
        "        # below\r\n",
        "# clisc: off\n",
        " # clisc: on\n",
        "\n",
        "  \n",
        "foo 1\n",
        "\u{FEFF}\n",
        "sphere 1 \u{A0}2\n",
        "# \0\n",
        "surface 1 1 1 1 1 1 1 1 1 1 1\n",
    ])
    .prop_map(str::to_owned);
    let line = prop_oneof![3 => command, 1 => other];
    (prop::bool::weighted(0.1), prop::collection::vec(line, 0..20))
        .prop_map(|(has_bom, lines)| if has_bom { "\u{FEFF}" } else { "" }.to_owned() + &lines.concat())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_tree_keeps_the_laws(text in any_tree()) {
        assert_formats_soundly(text.as_bytes());
    }

    #[test]
    fn any_bytes_keep_the_laws(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        assert_formats_soundly(&bytes);
    }

    /// Nothing but the words is left to say how a scene looks.
    #[test]
    fn blanks_between_words_do_not_matter(lines in any_table(), other in any_table()) {
        let lines: Vec<_> = lines.into_iter().map(|(words, _)| words).collect();
        let blanks = other.into_iter().map(|(_, blanks)| blanks).chain(std::iter::repeat(vec!["\t "; 13]));
        let scene = |lines: &mut dyn Iterator<Item = String>| {
            "surface 0 0 0   1 1 1   0 0 0   1   0\n\n".to_owned() + &lines.collect::<String>()
        };
        let squeezed = scene(&mut lines.iter().map(|words| words.join(" ") + "\n"));
        let spread = scene(&mut lines.iter().zip(blanks).map(|(words, blanks)| {
            words.iter().zip(blanks).flat_map(|(word, blank)| [blank, word]).collect::<String>() + "\n"
        }));
        prop_assert_eq!(formatted(spread), formatted(squeezed));
    }
}

/// The words of sound commands, and blanks to stand between them.
fn any_table() -> impl Strategy<Value = Vec<(Vec<String>, Vec<&'static str>)>> {
    let command =
        prop::sample::select(COMMANDS.iter().filter(|command| command.name != "cylinder").collect::<Vec<_>>());
    let numbers = prop::collection::vec("[1-9]{0,2}\\.[0-9]{0,2}[1-9]", 11);
    let line = (command, numbers, prop::bool::ANY).prop_map(|(command, numbers, has_comment)| {
        let args = match command.numbers().len() {
            0 => vec!["a.png".to_owned()],
            n => numbers[..n].to_vec(),
        };
        let comment = has_comment.then(|| "# a  b".to_owned());
        std::iter::once(command.name.to_owned()).chain(args).chain(comment).collect()
    });
    let blanks = prop::collection::vec(prop::sample::select(vec![" ", "   ", "\t"]), 13);
    prop::collection::vec((line, blanks), 0..12)
}
