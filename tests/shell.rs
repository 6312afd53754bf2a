//! What a shell is given: completions, manual pages, the version.

mod support;

use crate::support::{Folder, scene};

/// The commands of the program, as its help lists them.
fn commands(folder: &Folder) -> Vec<String> {
    let help = folder.clisc(&["--help"]).stdout;
    let (_, behind) = help.split_once("Commands:\n").expect("a list of commands");
    let (list, _) = behind.split_once("\n\n").expect("an end of the list");
    let names = list.lines().filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    let names: Vec<String> = names.filter_map(|line| line.split_whitespace().next()).map(str::to_owned).collect();
    assert!(names.iter().any(|name| name == "run"), "{help}");
    names.into_iter().filter(|name| name != "help").collect()
}

#[test]
fn completions_of_every_shell_know_every_command() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let call = folder.clisc(&["completions", shell]);
        assert_eq!(call.code, Some(0), "{}", call.stderr);
        for command in commands(&folder) {
            assert!(call.stdout.contains(&command), "{shell} does not know `{command}`");
        }
        assert!(call.stdout.contains("out-dir"), "{shell}: options of a command");
    }
    assert_eq!(folder.clisc(&["completions", "cmd"]).code, Some(2));
}

/// A syntax error would show each time that somebody opens a shell.
#[test]
#[cfg(unix)]
fn bash_reads_its_completions() {
    let folder = Folder::new();
    folder.put("clisc.bash", folder.clisc(&["completions", "bash"]).stdout);
    let line =
        "source clisc.bash && COMP_WORDS=(clisc ru) COMP_CWORD=1 && _clisc clisc ru clisc && echo ${COMPREPLY[@]}";
    let output = std::process::Command::new("bash").args(["-c", line]).current_dir(folder.at("")).output();
    let output = output.expect("a machine with bash");
    assert_eq!(String::from_utf8_lossy(&output.stdout), "run\n", "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn there_is_a_page_for_every_command() {
    let folder = Folder::new();
    let call = folder.clisc(&["man", "--out-dir", "pages/man1"]);
    assert_eq!((call.code, call.stdout.as_str(), call.stderr.as_str()), (Some(0), "", ""));
    let mut expected = vec!["pages/".to_owned(), "pages/man1/".to_owned(), "pages/man1/clisc.1".to_owned()];
    expected.extend(commands(&folder).iter().map(|name| format!("pages/man1/clisc-{name}.1")));
    expected.sort();
    assert_eq!(folder.listing(), expected);
    let page = String::from_utf8(folder.bytes("pages/man1/clisc-run.1")).expect("text");
    assert!(page.contains(".TH clisc-run 1") && page.contains("Examples:"), "{page}");
    assert_eq!(folder.clisc(&["man", "run"]).stdout, page);
}

#[test]
fn a_page_that_is_not_there_is_refused_with_those_that_are() {
    let call = Folder::new().clisc(&["man", "render"]);
    assert_eq!((call.code, call.stdout.as_str()), (Some(2), ""));
    assert!(call.stderr.contains("there is no command `render`") && call.stderr.contains("run"), "{}", call.stderr);
}

#[test]
fn the_version_names_the_backends() {
    let folder = Folder::new();
    let version = env!("CARGO_PKG_VERSION");
    assert_eq!(folder.clisc(&["-V"]).stdout, format!("clisc {version}\n"));
    let long = folder.clisc(&["--version"]).stdout;
    assert!(long.starts_with(&format!("clisc {version}")) && long.contains("\nbackends: "), "{long}");
    assert!(long.contains("scalar"), "{long}");
}

/// Texts fill the lines they have, and no option is called after its type.
#[test]
fn help_is_wrapped_to_the_width_and_its_values_have_names() {
    let folder = Folder::new();
    for command in commands(&folder) {
        for width in [60, 100, 140] {
            let output = folder.command(&[&command, "--help"]).env("COLUMNS", width.to_string()).output();
            let help = String::from_utf8(output.expect("a command that starts").stdout).expect("text");
            let lines: Vec<&str> = help.lines().collect();
            for pair in lines.windows(2).filter(|pair| pair.iter().all(|line| line.starts_with(char::is_alphanumeric)))
            {
                let word = pair[1].split(' ').next().expect("a word");
                assert!(
                    pair[0].chars().count() + 1 + word.len() > width,
                    "{command}, {width}: {}\n{}",
                    pair[0],
                    pair[1]
                );
            }
            assert!(lines.iter().all(|line| line.chars().count() <= width), "{command}, {width}: {help}");
        }
        let help = folder.clisc(&[&command, "--help"]).stdout;
        for vague in ["<SIZE>", "<PART>", "<PRECISION>", "<SAMPLE_AT>", "<EMIT>", "<WxH>"] {
            assert!(!help.contains(vague), "{command}: {vague}");
        }
    }
}

#[test]
#[cfg(target_os = "linux")]
fn what_cannot_be_printed_is_a_fault() {
    use std::process::{Command, Stdio};

    let folder = Folder::with_scene(&scene("a.png"));
    let full = || std::fs::File::options().write(true).open("/dev/full").expect("a device that is always full");
    let call = |args: &[&str], stdout: Stdio, stderr: Stdio| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_clisc"));
        command.current_dir(folder.at(".")).args(args).stdout(stdout).stderr(stderr);
        command.output().expect("a command that starts")
    };
    for args in [
        &["--help"][..],
        &["-h"],
        &["help"],
        &["run", "--help"],
        &["--version"],
        &["-V"],
        &["completions", "zsh"],
        &["man"],
        &["man", "run"],
        &["explain"],
        &["explain", "E0203"],
        &["ir", "a.cli"],
        &["check", "a.cli", "--format", "json"],
        &["run", "a.cli", "--size", "4x4"],
    ] {
        let output = call(args, full().into(), Stdio::piped());
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{args:?}: {stderr}");
        assert!(stderr.contains("error: cannot write to standard output"), "{args:?}: {stderr}");
        let output = call(args, Stdio::null(), Stdio::piped());
        assert_eq!(output.status.code(), Some(0), "{args:?}");
    }
    // What nobody could be told of is not fine.
    for args in [&["check", "a.cli"][..], &["fmt", "--check", "a.cli"], &["run"]] {
        assert_eq!(call(args, Stdio::null(), full().into()).status.code(), Some(2), "{args:?}");
    }
}

#[test]
fn a_forgotten_command_is_offered() {
    let folder = Folder::with_scene(&scene("a.png"));
    for (word, what) in [("a.cli", "a scene"), ("missing.cli", "a scene"), (".", "a folder")] {
        let call = folder.clisc(&[word, "--size", "4x4"]);
        assert_eq!((call.code, call.stdout.as_str()), (Some(2), ""));
        for words in [format!("`{word}` is {what}"), format!("clisc run {word} "), format!("clisc check {word} ")] {
            assert!(call.stderr.contains(&words), "{words}: {}", call.stderr);
        }
    }
    let call = folder.clisc(&["chek", "a.cli"]);
    assert!(call.code == Some(2) && call.stderr.contains("'check'"), "{}", call.stderr);
    assert_eq!(folder.listing(), ["a.cli"]);
}
