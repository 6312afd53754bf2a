//! `clisc explain`.

use std::fmt::Write;
use std::process::ExitCode;

use clisc::diag::Code;
use clisc::format::NOT_CANONICAL;
use clisc::lint;

use crate::args::ExplainArgs;
use crate::outcome::Outcome;
use crate::print;
use crate::topics::{self, Topic};

/// Explains a code, a rule, a command or a topic, or lists them all.
pub fn run(args: &ExplainArgs) -> anyhow::Result<ExitCode> {
    let Some(name) = args.name.as_deref().map(str::trim) else {
        print::to_stdout(&list())?;
        return Ok(Outcome::Fine.into());
    };
    if let Some(code) = find(name) {
        print::to_stdout(&code.page())?;
    } else if let Some(topic) = topics::find(name) {
        print::to_stdout(&topic.page())?;
    } else {
        let nearest = nearest(name).map_or_else(String::new, |nearest| format!("; did you mean {nearest}?"));
        anyhow::bail!("there is no code, rule, command or topic `{name}`{nearest} (`clisc explain` lists them all)");
    }
    Ok(Outcome::Fine.into())
}

/// Returns the code with this id or name, of whichever command.
fn find(id: &str) -> Option<&'static Code> {
    lint::find(id).or_else(|| Some(&NOT_CANONICAL).filter(|code| code.id.eq_ignore_ascii_case(id)))
}

/// Returns what is spelt nearly so, if anything is.
fn nearest(name: &str) -> Option<String> {
    let lower = name.to_lowercase();
    let is_near = |topic: &Topic| {
        let distance = strsim::osa_distance(&lower, &topic.name());
        distance <= topic.name().len() / 3
    };
    // Names of topics hold no digits, codes do: at most one of the two is near.
    lint::nearest(name).map(Code::label).or_else(|| topics::all().find(is_near).map(Topic::name))
}

fn list() -> String {
    let mut list = "Codes and rules:\n\n".to_owned();
    for code in lint::all_codes().chain([&NOT_CANONICAL]) {
        let name = code.name.map_or_else(String::new, |name| format!(" ({name})"));
        let _ = writeln!(list, "{}  {:7}  {}{name}", code.id, code.severity.word(), code.title);
    }
    let (commands, others): (Vec<Topic>, Vec<Topic>) = topics::all().partition(|topic| topic.is_command());
    for (title, topics) in [("Commands of the language", commands), ("Topics: what a scene means", others)] {
        let _ = writeln!(list, "\n{title}:\n");
        for topic in topics {
            let _ = writeln!(list, "{:10}  {}", topic.name(), topic.summary());
        }
    }
    list + "\nclisc explain NAME prints the page of one, such as E0203, no-fov, sphere or shading.\n"
}
