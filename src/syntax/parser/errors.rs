//! The translation of what chumsky found into diagnostics. Nothing else knows chumsky's errors.

use chumsky::error::Rich;

use crate::diag::words::{counted, listed, named, ordinal, quoted};
use crate::diag::{Diagnostic, Edit, Fix, Safety, codes, fix};
use crate::source::{Source, Span};
use crate::syntax::lexer::lex_line;
use crate::syntax::parser::{grammar, names, numeral, path};
use crate::syntax::spec::{self, ArgSpec, Arguments, CommandSpec};
use crate::syntax::token::{Token, TokenKind};

/// A command whose arguments are wrong.
pub(super) struct BadCommand<'l> {
    /// The source it stands in.
    pub(super) source: &'l Source,
    /// What its name says it is.
    pub(super) spec: &'static CommandSpec,
    /// The place of its name.
    pub(super) name: Span,
    /// Its arguments, up to the end of the line or to the name of another command.
    pub(super) args: &'l [Token],
    /// The name of another command on the same line.
    pub(super) next_name: Option<Span>,
}

/// One thing that is wrong, by the index of the argument.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    /// The argument at this index is none.
    Malformed(usize),
    /// The arguments from this index on are missing.
    Missing(usize),
    /// The arguments from this index on are too many.
    Surplus(usize),
}

impl Fault {
    /// Reads an error about the tokens of a command that takes `n_expected` arguments.
    fn new(error: &Rich<'_, Token>, n_expected: usize) -> Self {
        let index = error.span().start;
        match error.found() {
            None => Self::Missing(index),
            Some(_) if index < n_expected => Self::Malformed(index),
            Some(_) => Self::Surplus(index),
        }
    }
}

/// Appends what is wrong with the arguments of a command, one diagnostic for each mistake.
pub(super) fn check_arguments(command: &BadCommand<'_>, acc: &mut Vec<Diagnostic>) {
    let of_all = [numeral::find_commas, numeral::find_stray_words, numeral::find_block];
    if let Some(diagnostic) = of_all.into_iter().find_map(|find| find(command)) {
        return acc.push(diagnostic);
    }
    let n_before = acc.len();
    for fault in find_faults(command) {
        acc.push(match fault {
            Fault::Malformed(index) => malformed(command, index),
            Fault::Missing(index) => missing(command, index),
            Fault::Surplus(index) => surplus(command, index),
        });
    }
    if acc.len() == n_before
        && let Some(next_name) = command.next_name
    {
        acc.push(second_command(command, next_name));
    }
}

/// Lists the faults. Where an argument is malformed the count proves nothing: `1,2,3` is three numbers in one.
fn find_faults(command: &BadCommand<'_>) -> Vec<Fault> {
    let n_expected = command.n_expected();
    let errors = grammar::errors(&command.spec.arguments, command.args);
    let mut faults: Vec<_> = errors.iter().map(|error| Fault::new(error, n_expected)).collect();
    if faults.iter().any(|fault| matches!(fault, Fault::Malformed(_))) {
        faults.retain(|fault| !matches!(fault, Fault::Missing(_)));
    }
    faults
}

impl BadCommand<'_> {
    /// Returns the text of an argument.
    pub(super) fn text(&self, arg: &Token) -> &str {
        self.source.slice(arg.span)
    }

    /// Returns the place of the command, from its name to its last argument.
    fn span(&self) -> Span {
        self.args.last().map_or(self.name, |last| self.name.to(last.span))
    }

    /// Returns the fix that writes `command` in place of this one, and what follows on a line of its own.
    pub(super) fn rewritten(&self, safety: Safety, command: &str) -> Fix {
        let mut fix = Fix::write(safety, self.span(), command);
        fix.edits.extend(self.next_name.map(|next| self.broken_before(next)));
        fix
    }

    /// Returns the fix that removes the arguments below `surplus` with the blanks before them.
    pub(super) fn without_surplus(&self, surplus: Span) -> Fix {
        let own = self.args.iter().take_while(|arg| arg.span.end <= surplus.start).last();
        let start = own.map_or(self.name, |own| own.span).end;
        let removed = quoted(self.source.slice(surplus));
        let mut edits = vec![Edit::remove(Span::new(start, surplus.end))];
        edits.extend(self.next_name.map(|next| self.broken_before(next)));
        Fix::guess(format!("remove {removed}"), edits)
    }

    /// Returns the edit that begins a new line before the command named at `next`.
    fn broken_before(&self, next: Span) -> Edit {
        Edit::replace(Span::new(self.span().end, next.start), fix::line_end(self.source))
    }

    /// Returns how many arguments the command takes.
    pub(super) fn n_expected(&self) -> usize {
        match self.spec.arguments {
            Arguments::Numbers(args) => args.len(),
            Arguments::FileName(_) => 1,
        }
    }

    /// Returns "`sphere` takes 4 numbers, found 5".
    fn count_message(&self) -> String {
        let name = self.spec.name;
        let n_found = self.args.len();
        let found = if n_found == 0 { "none".to_owned() } else { n_found.to_string() };
        match self.spec.arguments {
            Arguments::Numbers(args) => {
                let all_numbers = self.args.iter().all(|arg| arg.kind == TokenKind::Number);
                let words = if all_numbers { "" } else { " arguments" };
                format!("`{name}` takes {}, found {found}{words}", counted(args.len(), "number"))
            }
            Arguments::FileName(_) => format!("`{name}` takes 1 file name, found {found}"),
        }
    }

    /// Returns "needs x, y, z, radius".
    fn needs(&self) -> String {
        format!("needs {}", listed(self.spec.arg_names()))
    }
}

fn malformed(command: &BadCommand<'_>, index: usize) -> Diagnostic {
    let arg = &command.args[index];
    match command.spec.arguments {
        Arguments::Numbers(args) => {
            let is_exact = command.args.len() == args.len();
            let diagnostic = numeral::diagnose(command.source, arg.span, command.spec, &args[index], is_exact);
            let is_short = command.args.len() < args.len();
            if is_short { diagnostic.secondary(command.name, command.needs()) } else { diagnostic }
        }
        Arguments::FileName(_) => path::unterminated_quote(command.source, arg.span),
    }
}

fn missing(command: &BadCommand<'_>, index: usize) -> Diagnostic {
    let Arguments::Numbers(args) = command.spec.arguments else {
        return path::missing(command.source, command.name);
    };
    let missing = named(args[index..].iter().map(|arg| arg.name));
    let help = match index {
        _ if goes_on_in_next_line(command) => {
            "join the next line to this one: a command and its arguments stand on one".to_owned()
        }
        0 => format!("add the missing {missing} behind `{}`", command.spec.name),
        n => format!("add the missing {missing} after the {} number", ordinal(n)),
    };
    let mut diagnostic = Diagnostic::new(&codes::MISSING_ARGUMENT, command.name, command.count_message())
        .label(command.needs())
        .help(help)
        .fix(next_line_joined(command, index));
    if let [first, .., last] | [first @ last] = command.args {
        let given = listed(args[..index].iter().map(|arg| arg.name));
        diagnostic = diagnostic.secondary(first.span.to(last.span), format!("given: {given}"));
    }
    match (command.next_name, glued_comment(command)) {
        (Some(next_name), _) => diagnostic.secondary(next_name, "another command begins here"),
        (None, Some(comment)) => diagnostic.secondary(comment, "`#` begins a comment"),
        (None, None) => diagnostic,
    }
}

/// Returns the place of a comment whose text begins directly behind its `#`: perhaps no comment was meant.
fn glued_comment(command: &BadCommand<'_>) -> Option<Span> {
    let end = command.args.last().map_or(command.name, |last| last.span).end;
    let rest = command.source.text()[end as usize..].lines().next()?;
    let comment = &rest[rest.find('#')?..];
    let start = end + (rest.len() - comment.len()) as u32;
    let is_glued = comment[1..].starts_with(char::is_alphanumeric);
    is_glued.then(|| Span::new(start, start + comment.trim_end().len() as u32))
}

/// Returns the fix that joins the next line to this one, if nothing is missing then. `n` arguments are there already. A lone
/// number may be a line of its own, of which the command is missing.
fn next_line_joined(command: &BadCommand<'_>, n: usize) -> Option<Fix> {
    let end = command.span().end;
    let rest = &command.source.text()[end as usize..];
    let next = rest.trim_start();
    let between = &rest[..rest.len() - next.len()];
    let line = next.lines().next().unwrap_or_default();
    let arguments = line.split('#').next().unwrap_or_default();
    let n_more = arguments.split_ascii_whitespace().take_while(|word| numeral::is_number(word)).count();
    let is_whole = n + n_more == command.n_expected() && n_more == arguments.split_ascii_whitespace().count();
    let joined = Edit::replace(Span::new(end, end + between.len() as u32), " ");
    let safety = if n_more > 1 { Safety::Safe } else { Safety::Unsafe };
    (is_whole && between.matches('\n').count() == 1).then(|| Fix {
        title: "join the next line to this one".to_owned(),
        edits: vec![joined],
        safety,
    })
}

/// Tells whether the next line begins with a number, as if it were part of this one.
fn goes_on_in_next_line(command: &BadCommand<'_>) -> bool {
    let rest = &command.source.text()[command.name.end as usize..];
    let mut lines = rest.lines();
    let next_line = lines.nth(1).unwrap_or_default();
    let first_word = next_line.split_ascii_whitespace().next().unwrap_or_default();
    numeral::is_number(first_word)
}

fn surplus(command: &BadCommand<'_>, index: usize) -> Diagnostic {
    let surplus = &command.args[index..];
    let span = surplus.iter().fold(surplus[0].span, |span, arg| span.to(arg.span));
    let (help, fix) = match command.spec.arguments {
        Arguments::Numbers(_) => help_for_surplus(command, surplus, span),
        Arguments::FileName(_) => path::help_for_surplus(command, span),
    };
    let label = if surplus.len() == 1 { "surplus" } else { "all of these are surplus" };
    Diagnostic::new(&codes::SURPLUS_ARGUMENT, span, command.count_message())
        .label(label)
        .secondary(command.name, command.needs())
        .help(help)
        .fix(fix)
}

/// Says what to do about numbers that are too many; `span` is their place.
fn help_for_surplus(command: &BadCommand<'_>, surplus: &[Token], span: Span) -> (String, Fix) {
    let first = command.text(&surplus[0]);
    if let Some(fix) = names::comment_mark_replaced(first, span.start) {
        return ("a comment begins with `#`".to_owned(), fix);
    }
    let last_name = command.spec.numbers().last().map_or("", |arg: &ArgSpec| arg.name);
    let help = match surplus {
        [_] => format!("remove {}: nothing follows `{last_name}`", quoted(first)),
        _ => format!("remove the {} arguments behind `{last_name}`", surplus.len()),
    };
    (help, command.without_surplus(span))
}

/// Reports a command that is whole and another that follows it on the same line.
fn second_command(command: &BadCommand<'_>, next_name: Span) -> Diagnostic {
    let next = command.source.slice(next_name);
    let edits = vec![command.broken_before(next_name)];
    // Words that happen to be commands may have been meant as a comment.
    let is_sure = matches!(command.spec.arguments, Arguments::Numbers(_)) && begins_whole_command(command, next_name);
    let safety = if is_sure { Safety::Safe } else { Safety::Unsafe };
    Diagnostic::new(
        &codes::SURPLUS_ARGUMENT,
        next_name,
        format!("a second command, `{next}`, on the line of `{}`", command.spec.name),
    )
    .label("begins a second command")
    .secondary(command.name, command.needs())
    .help(format!("begin a new line before `{next}`"))
    .fix(Fix { title: format!("begin a new line before `{next}`"), edits, safety })
    .note("a line holds one command")
}

/// Tells whether a whole command stands at `name`, with nothing or another command behind it.
fn begins_whole_command(command: &BadCommand<'_>, name: Span) -> bool {
    let rest = &command.source.text()[name.start as usize..];
    let mut tokens = Vec::new();
    lex_line(rest.lines().next().unwrap_or_default(), name.start, |token| {
        tokens.extend(token.kind.is_significant().then_some(token))
    });
    let text = |token: &Token| command.source.slice(token.span);
    let Some((spec, args)) = tokens.split_first().and_then(|(name, args)| Some((spec::find(text(name))?, args))) else {
        return false;
    };
    let n_own = args.iter().position(|arg| spec::find(text(arg)).is_some()).unwrap_or(args.len());
    match (&spec.arguments, &args[..n_own]) {
        (Arguments::Numbers(numbers), own) => {
            own.len() == numbers.len() && own.iter().all(|arg| numeral::is_number(text(arg)))
        }
        (Arguments::FileName(_), [name]) => path::is_png(path::unquoted(command.source, name.span)),
        (Arguments::FileName(_), _) => false,
    }
}
