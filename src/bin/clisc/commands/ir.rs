//! `clisc ir`.

use std::io::{self, Write};
use std::process::ExitCode;

use anyhow::Context;
use clisc::Compilation;
use clisc::ir::{self, Valid};
use clisc::plan::{dump_plans, dump_plans_json};
use clisc::source::Source;
use clisc::syntax;

use crate::args::{DumpFormat, Emit, IrArgs};
use crate::config::Configs;
use crate::outcome::Outcome;
use crate::{input, print};

/// Shows a stage of the compiler. What is wrong with the scene goes to standard error; a scene with errors still has
/// tokens and a tree, but nothing behind them.
pub fn run(args: &IrArgs) -> anyhow::Result<ExitCode> {
    input::name_stdin(&args.stdin, std::slice::from_ref(&args.scene))?;
    let source = input::read(&args.scene)?;
    let compilation = clisc::lint::check(&source, &Configs::default().options_for(&args.scene)?);
    let has_errors = compilation.has_errors();
    // There is no place left to say that this failed.
    let _ = print::diagnostics_to_stderr(&source, &compilation.diagnostics);
    print::unlisted_to_stderr(&source, &compilation);
    let mut out = print::stdout();
    dump(args, &source, compilation, &mut out)?.and_then(|()| out.flush()).context(print::CANNOT_WRITE)?;
    Ok(if has_errors { Outcome::SceneErrors } else { Outcome::Fine }.into())
}

/// Writes the stage that is asked for, if the scene gets that far.
fn dump(
    args: &IrArgs,
    source: &Source,
    compilation: Compilation,
    out: &mut dyn Write,
) -> anyhow::Result<io::Result<()>> {
    Ok(match (args.emit, args.format) {
        (Emit::Tokens, DumpFormat::Text) => syntax::dump_tokens(source, &syntax::lex(source), out),
        (Emit::Tokens, DumpFormat::Json) => syntax::dump_tokens_json(source, &syntax::lex(source), out),
        (Emit::Ast, DumpFormat::Text) => syntax::dump_ast(source, &syntax::parse(source).file, out),
        (Emit::Ast, DumpFormat::Json) => syntax::dump_ast_json(source, &syntax::parse(source).file, out),
        (Emit::Ir | Emit::Commands | Emit::Plan, _) if compilation.has_errors() => Ok(()),
        (Emit::Ir, DumpFormat::Text) => ir::dump_arenas(source, &validate(compilation)?, out),
        (Emit::Ir, DumpFormat::Json) => ir::dump_arenas_json(source, &validate(compilation)?, out),
        (Emit::Commands, DumpFormat::Text) => ir::dump_commands(source, &validate(compilation)?, out),
        (Emit::Commands, DumpFormat::Json) => ir::dump_commands_json(source, &validate(compilation)?, out),
        (Emit::Plan, DumpFormat::Text) => dump_plans(source, &validate(compilation)?, &args.image.settings(), out),
        (Emit::Plan, DumpFormat::Json) => dump_plans_json(source, &validate(compilation)?, &args.image.settings(), out),
    })
}

fn validate(compilation: Compilation) -> anyhow::Result<Valid> {
    // The checks of the language leave nothing to find here.
    ir::validate(compilation.program).map_err(|found| anyhow::anyhow!("a bug in clisc let pass: {}", found[0]))
}
