//! What README and the other pages say is true: their commands succeed, their options exist, their links lead somewhere.

mod support;
#[path = "support/tree.rs"]
mod tree;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use clisc::syntax::spec::COMMANDS;

use crate::support::{Call, Folder};

/// Pages of which every command is run.
const RUN: [&str; 3] = ["README.md", "CONTRIBUTING.md", "docs/ci.md"];

/// Commands that these pages show and no test can run: those that build, and so would run the tests in the tests.
const BUILDS: [&str; 4] =
    ["cargo test", "cargo test --test semantics", "cargo build", "cargo install --locked --path ."];

/// How a page calls the program before it is installed.
const UNINSTALLED: &str = "cargo run --release -- ";

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: impl AsRef<Path>) -> String {
    let path = root().join(path);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Returns the fenced blocks of a page in this language.
fn blocks<'p>(page: &'p str, language: &str) -> Vec<&'p str> {
    let fence = format!("```{language}\n");
    page.split(&fence).skip(1).map(|rest| rest.split("```").next().expect("a block")).collect()
}

/// Returns the arguments of a call of the program; `None` for another command.
fn arguments(line: &str) -> Option<Vec<&str>> {
    let rest = line.strip_prefix("clisc ").or_else(|| line.strip_prefix(UNINSTALLED))?;
    Some(rest.split_whitespace().take_while(|word| *word != "#").collect())
}

/// A folder with a copy of `scenes/`.
fn folder_with_scenes() -> Folder {
    let folder = Folder::new();
    for path in tree::files_below(&root().join("scenes")) {
        let name = path.strip_prefix(root()).expect("a path below").to_str().expect("text").to_owned();
        folder.put(&name, fs::read(&path).expect("a file"));
    }
    folder
}

#[test]
fn commands_of_the_pages_succeed_and_leave_the_tree_clean() {
    let folder = folder_with_scenes();
    let before: BTreeMap<_, _> = tracked(&folder);
    for page in RUN {
        let text = read(page);
        let lines: Vec<_> =
            blocks(&text, "sh").into_iter().flat_map(str::lines).filter(|line| !line.is_empty()).collect();
        assert!(!lines.is_empty(), "{page}");
        for line in lines {
            match arguments(line) {
                Some(args) => {
                    let call = folder.clisc(&args);
                    assert_eq!(call.code, Some(0), "{page}: {line}\n{}{}", call.stdout, call.stderr);
                }
                None => assert!(BUILDS.contains(&line), "{page}: a command that no test knows: {line}"),
            }
        }
    }
    assert_eq!(before, tracked(&folder), "the scenes stay as they are, and what is made is in `out`");
    assert!(read(".gitignore").lines().any(|line| line == "/out/"), "`out` is ignored");
}

/// Returns the files of a folder, those below `out` aside.
fn tracked(folder: &Folder) -> BTreeMap<String, Vec<u8>> {
    let names = folder.listing().into_iter().filter(|name| !name.ends_with('/') && !name.starts_with("out/"));
    names.map(|name| (name.clone(), folder.bytes(&name))).collect()
}

/// `.ci/run` takes the first command from there.
#[test]
fn the_first_screen_of_the_readme_renders_and_tests() {
    let readme = read("README.md");
    let screen: Vec<_> = readme.lines().take(40).collect();
    assert!(screen.contains(&"cargo test"), "{screen:#?}");
    let renders = format!("{UNINSTALLED}run scenes/first-steps/first.cli ");
    assert!(screen.iter().any(|line| line.starts_with(&renders)), "{screen:#?}");
}

#[test]
fn the_readme_begins_with_a_scene_and_its_picture() {
    let scene = read("scenes/first-steps/first.cli");
    let commands: Vec<_> = scene.lines().filter(|line| !line.is_empty() && !line.starts_with('#')).collect();
    assert_eq!(commands.len(), 8);
    let readme = read("README.md");
    assert_eq!(blocks(&readme, "cli").first().expect("a scene").trim_end(), commands.join("\n"));

    let folder = folder_with_scenes();
    let call = folder.clisc(&["run", "scenes/first-steps/first.cli", "--out-dir", "out"]);
    assert_eq!(call.code, Some(0), "{}", call.stderr);
    let picture = fs::read(root().join("docs/images/first.png")).expect("the picture");
    assert!(folder.bytes("out/first.png") == picture, "docs/images/first.png is another picture");
}

#[test]
fn what_the_readme_shows_of_a_call_is_what_it_prints() {
    let readme = read("README.md");
    let folder = folder_with_scenes();
    let mut n_calls = 0;
    for block in blocks(&readme, "text") {
        let Some((line, shown)) = block.strip_prefix("$ ").and_then(|rest| rest.split_once('\n')) else { continue };
        let Call { stdout, .. } = folder.clisc(&arguments(line).expect("a call of clisc"));
        assert_eq!(stdout.trim_end(), shown.trim_end(), "{line}");
        n_calls += 1;
    }
    assert!(n_calls > 0);
}

#[test]
fn the_readme_has_every_command_of_the_language() {
    let readme = read("README.md");
    for command in &COMMANDS {
        let names: Vec<_> = command.arg_names().collect();
        let row = format!("| `{}` | `{}` |", command.name, names.join(" "));
        assert!(readme.contains(&row), "no {row}");
    }
}

/// Every page, and what else tells a machine how to call the program.
fn texts() -> Vec<PathBuf> {
    let mut paths: Vec<_> = [".pre-commit-hooks.yaml", "action.yml", "README.md", "CHANGELOG.md", "CONTRIBUTING.md"]
        .map(|name| root().join(name))
        .to_vec();
    for folder in ["docs", "grammar", "scenes", "fuzz", "editors/vscode", ".github", "src/diag/explain"] {
        let is_text = |path: &PathBuf| {
            let is_made =
                path.components().any(|part| part.as_os_str() == "node_modules" || part.as_os_str() == "target");
            !is_made && path.extension().is_some_and(|ending| ending == "md" || ending == "yml")
        };
        // A published package lacks some of them.
        let folder = root().join(folder);
        paths.extend(folder.is_dir().then(|| tree::files_below(&folder)).into_iter().flatten().filter(is_text));
    }
    paths
}

/// Returns the command and the long options of each call of the program in a text.
fn calls(text: &str) -> Vec<(String, Vec<String>)> {
    let mut calls = Vec::new();
    for line in text.lines() {
        for (at, _) in line.match_indices("clisc ") {
            let call = &line[at + "clisc ".len()..];
            // Up to what ends a call: the end of its quotation, a comment, or another command.
            let call = call.split(['`', '#', '|', ';', '>']).next().expect("a part");
            let mut words = call.split_whitespace();
            let Some(command) = words.next() else { continue };
            let is_long = |word: &&str| word.starts_with("--") && word.len() > 2;
            let name =
                |word: &str| word.split(['=', '"', '\'', ',', ')', '.', ':', ']']).next().unwrap_or(word).to_owned();
            calls.push((command.to_owned(), words.filter(is_long).map(name).collect()));
        }
    }
    calls
}

#[test]
fn options_that_the_pages_name_exist() {
    let folder = Folder::new();
    let commands = ["check", "lint", "run", "ir", "fmt", "lsp", "bench", "explain", "completions", "man"];
    let help: BTreeMap<_, _> =
        commands.iter().map(|command| (*command, folder.clisc(&[command, "--help"]).stdout)).collect();
    let mut faults = Vec::new();
    let mut n_options = 0;
    for path in texts() {
        for (command, options) in calls(&read(&path)) {
            let Some(help) = help.get(&*command) else { continue };
            for option in options {
                n_options += 1;
                let is_listed = help.split(|c: char| !c.is_alphanumeric() && c != '-').any(|word| word == option);
                if !is_listed {
                    faults.push(format!("{}: clisc {command} {option}", path.display()));
                }
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(n_options > 30, "{n_options}");
}

/// Hooks and action call commands that exist; the test above looks at their options.
#[test]
fn hooks_call_commands() {
    let text = read(".pre-commit-hooks.yaml");
    let hooks: Vec<_> = text.lines().filter_map(|line| line.trim().strip_prefix("entry: clisc ")).collect();
    assert_eq!(hooks, ["check", "lint", "fmt"]);
    let page = read("docs/ci.md");
    for hook in hooks {
        assert!(text.contains(&format!("- id: clisc-{hook}\n")), "{hook}");
        assert!(page.contains(&format!("- id: clisc-{hook}\n")), "{hook}");
    }
}

/// The page on CI names the inputs that the action has.
#[test]
fn inputs_of_the_action_are_those_of_the_page() {
    let action = read("action.yml");
    let (_, rest) = action.split_once("inputs:\n").expect("inputs");
    let (inputs, _) = rest.split_once("\nruns:").expect("steps");
    let inputs: Vec<_> = inputs.lines().filter(|line| line.starts_with("  ") && !line.starts_with("   ")).collect();
    assert!(inputs.len() > 2, "{inputs:?}");
    for input in inputs {
        assert!(read("docs/ci.md").contains(&format!("        {}", input.trim_start())), "docs/ci.md lacks {input}");
    }
}

#[test]
fn links_of_the_pages_lead_somewhere() {
    let mut faults = Vec::new();
    for path in texts() {
        let text = read(&path);
        let prose: String = text.split("```").step_by(2).collect();
        for (_, target) in prose.match_indices("](").map(|(at, _)| prose.split_at(at + 2)) {
            let target = target.split(')').next().expect("a target");
            let file = target.split('#').next().expect("a part");
            let is_elsewhere = target.contains("://") || target.starts_with("mailto:");
            // Of what is not in a package nothing is said.
            let is_there = path.parent().expect("a folder").join(file).exists();
            if !is_elsewhere && !file.is_empty() && !is_there {
                faults.push(format!("{}: {target}", path.display()));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
