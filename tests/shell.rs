//! What a shell is given: completions, manual pages, the version.

mod support;

use crate::support::Folder;

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
