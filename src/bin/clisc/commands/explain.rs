//! `clisc explain`.

use std::process::ExitCode;

use clisc::diag::Code;
use clisc::format::NOT_CANONICAL;
use clisc::lint;

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
        let nearest =
            lint::nearest(id.trim()).map_or_else(String::new, |code| format!("; did you mean {}?", code.label()));
        anyhow::bail!("there is no code `{id}`{nearest} (`clisc explain` lists them all)");
    };
    print::to_stdout(&code.page())?;
    Ok(Outcome::Fine.into())
}

/// Returns the code with this id or name, of whichever command.
fn find(id: &str) -> Option<&'static Code> {
    lint::find(id).or_else(|| Some(&NOT_CANONICAL).filter(|code| code.id.eq_ignore_ascii_case(id)))
}

fn list() -> String {
    let line = |code: &Code| {
        let name = code.name.map_or_else(String::new, |name| format!(" ({name})"));
        format!("{}  {:7}  {}{name}\n", code.id, code.severity.word(), code.title)
    };
    lint::all_codes().chain([&NOT_CANONICAL]).map(line).collect()
}
