//! `clisc explain`.

use std::process::ExitCode;

use clisc::diag::{Code, codes};
use clisc::format::NOT_CANONICAL;

use crate::args::ExplainArgs;
use crate::outcome::Outcome;
use crate::print;

/// Explains a code, or lists them all.
pub fn run(args: &ExplainArgs) -> anyhow::Result<ExitCode> {
    let Some(id) = &args.code else {
        print::to_stdout(&list())?;
        return Ok(Outcome::Fine.into());
    };
    let Some(code) = find(id.trim()) else {
        let nearest = codes::nearest(id.trim()).map_or_else(String::new, |code| format!("; did you mean {}?", code.id));
        anyhow::bail!("there is no code `{id}`{nearest} (`clisc explain` lists them all)");
    };
    print::to_stdout(&code.page())?;
    Ok(Outcome::Fine.into())
}

/// Returns the code with this id, of whichever command.
fn find(id: &str) -> Option<&'static Code> {
    codes::find(id).or_else(|| Some(&NOT_CANONICAL).filter(|code| code.id.eq_ignore_ascii_case(id)))
}

fn list() -> String {
    codes::ALL
        .iter()
        .chain([&&NOT_CANONICAL])
        .map(|code| format!("{}  {:7}  {}\n", code.id, code.severity.word(), code.title))
        .collect()
}
