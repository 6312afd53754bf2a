//! What a line is that begins with no command.

use crate::diag::words::{listed, proposed, quoted};
use crate::diag::{Diagnostic, Edit, Fix, Safety, codes};
use crate::source::{Source, Span};
use crate::syntax::parser::foreign::{self, Foreign};
use crate::syntax::parser::numeral::{SEPARATORS, numbers_between, safety_without_separators};
use crate::syntax::spec::{self, Arguments, COMMANDS, CommandKind, CommandSpec};
use crate::syntax::token::{Token, TokenKind};

/// How other languages begin a comment.
const COMMENT_MARKS: [&str; 7] = ["//", "/*", ";", "--", "%", "'", "!"];
/// Those that mean nothing else at the start of a word and end with their line.
const SURE_COMMENT_MARKS: [&str; 3] = ["//", ";", "--"];

/// Reports the line and returns the command that it was meant to be, if that can be told.
pub(super) fn diagnose(source: &Source, name: &Token, args: &[Token]) -> (Diagnostic, Option<CommandKind>) {
    let text = source.slice(name.span);
    if name.kind == TokenKind::Number {
        let meant = find_by_arguments(source, name, args);
        let values = || std::iter::once(name).chain(args).map(|arg| source.slice(arg.span).parse());
        let allows = |kind: &CommandKind| {
            let mut allowed = kind.spec().numbers().iter().zip(values());
            allowed.all(|(arg, value)| value.is_ok_and(|value| arg.range.allows(value)))
        };
        let named = meant.filter(allows).map(|kind| {
            let edit = Edit::insert(name.span.start, format!("{} ", kind.name()));
            Fix::guess(format!("begin the line with `{}`", kind.name()), vec![edit])
        });
        return (begins_with_number(text, name.span).fix(named), meant);
    }
    if let Some(foreign) = foreign::find(&bare(text)) {
        return (known_elsewhere(source, name, args, foreign), foreign.meant);
    }
    if let Some(guess) = guess(text, source, args) {
        let message = format!("unknown command {}", quoted(text));
        let place = if guess.is_whole { args.iter().fold(name.span, |span, arg| span.to(arg.span)) } else { name.span };
        let diagnostic = Diagnostic::new(&codes::UNKNOWN_COMMAND, name.span, message)
            .label(guess.label)
            .help(guess.help)
            .fix(Fix::write(guess.safety, place, guess.repair));
        return (diagnostic, Some(guess.spec.kind));
    }
    (unlike_any(text, name.span), by_arguments(source, args))
}

/// Returns a word in lower case and without brackets and the like.
fn bare(text: &str) -> String {
    text.trim_matches(|c: char| SEPARATORS.contains(&c) || matches!(c, ':' | '=' | '"' | '\'' | '.')).to_lowercase()
}

/// Reports a word that is a command elsewhere. Where the command that does the same takes just these arguments it is offered;
/// not for a light, whose place mostly comes first elsewhere.
fn known_elsewhere(source: &Source, name: &Token, args: &[Token], foreign: &Foreign) -> Diagnostic {
    let text = source.slice(name.span);
    let same = foreign.meant.filter(|kind| by_arguments(source, args) == Some(*kind) && *kind != CommandKind::Light);
    Diagnostic::new(&codes::UNKNOWN_COMMAND, name.span, format!("unknown command {}", quoted(text)))
        .label(foreign.label)
        .help(foreign.help)
        .fix(same.map(|kind| Fix::write(Safety::Unsafe, name.span, kind.name())))
}

fn begins_with_number(text: &str, span: Span) -> Diagnostic {
    Diagnostic::new(&codes::NO_COMMAND, span, format!("a line begins with the number {}", quoted(text)))
        .label("no command before it")
        .help("begin the line with a command, or join it to the command above")
        .note("a command and all its arguments stand on one line")
}

fn unlike_any(text: &str, span: Span) -> Diagnostic {
    if let Some(fix) = comment_mark_replaced(text, span.start) {
        return Diagnostic::new(&codes::NO_COMMAND, span, format!("{} begins no comment", quoted(text)))
            .label("neither a command nor a comment")
            .help("a comment begins with `#`")
            .fix(fix);
    }
    let commands = format!("the commands are {}", listed(COMMANDS.iter().map(|command| command.name)));
    if text.starts_with(|first: char| first.is_alphabetic() || first == '_') {
        return Diagnostic::new(&codes::UNKNOWN_COMMAND, span, format!("unknown command {}", quoted(text)))
            .label("not a command")
            .help(commands);
    }
    Diagnostic::new(&codes::NO_COMMAND, span, format!("a line begins with {}", quoted(text)))
        .label("not a command")
        .help(commands)
}

/// Returns the fix that begins a comment with `#`, if the word `text` at `start` begins one as in another language.
pub(super) fn comment_mark_replaced(text: &str, start: u32) -> Option<Fix> {
    let mark = COMMENT_MARKS.iter().find(|mark| text.starts_with(**mark))?;
    let edits = vec![Edit::replace(Span::new(start, start + mark.len() as u32), "#")];
    let safety = if SURE_COMMENT_MARKS.contains(mark) { Safety::Safe } else { Safety::Unsafe };
    Some(Fix { title: "begin the comment with `#`".to_owned(), edits, safety })
}

/// A command that an unknown word was probably meant to be.
struct Guess {
    spec: &'static CommandSpec,
    label: String,
    help: String,
    /// What to write instead of the word, and how sure that is.
    repair: String,
    safety: Safety,
    /// Whether the repair stands for the arguments too.
    is_whole: bool,
}

impl Guess {
    fn new(spec: &'static CommandSpec, label: &str) -> Self {
        let help = format!("did you mean `{}`?", spec.name);
        Self {
            spec,
            label: label.to_owned(),
            help,
            repair: spec.name.to_owned(),
            safety: Safety::Unsafe,
            is_whole: false,
        }
    }

    /// Makes the guess that the first word is `spec` with its first argument glued to it.
    fn glued(spec: &'static CommandSpec, help: String, repair: String) -> Self {
        Self { help, repair, ..Self::new(spec, "a command and its argument in one word") }
    }

    /// Makes the guess that the whole line is `repair`.
    fn glued_line(spec: &'static CommandSpec, repair: String, safety: Safety) -> Self {
        Self { safety, is_whole: true, ..Self::glued(spec, proposed(&repair), repair) }
    }
}

/// Guesses what `text` was meant to be; none when no guess is good.
fn guess(text: &str, source: &Source, args: &[Token]) -> Option<Guess> {
    let lower = text.to_lowercase();
    if let Some(spec) = spec::find(&lower) {
        let guess = Guess::new(spec, "command names are lower case");
        return Some(Guess { help: proposed(spec.name), safety: Safety::Safe, ..guess });
    }
    if let Some(spec) = spec::find(lower.trim_matches(|c: char| !c.is_alphanumeric())) {
        let guess = Guess::new(spec, "a command is a word without punctuation");
        let is_sure = by_arguments(source, args) == Some(spec.kind);
        return Some(Guess { safety: if is_sure { Safety::Safe } else { Safety::Unsafe }, ..guess });
    }
    glued(&lower, text, source, args).or_else(|| {
        let fits = by_arguments(source, args);
        abbreviated(&lower, fits).or_else(|| misspelt(&lower, fits)).map(|spec| Guess::new(spec, "not a command"))
    })
}

/// Finds a command with its first argument glued to it: `sphere0`, `fov60`, `sphere(0`.
fn glued(lower: &str, text: &str, source: &Source, args: &[Token]) -> Option<Guess> {
    let spec = COMMANDS.iter().find(|spec| lower.starts_with(spec.name))?;
    let rest = &text[spec.name.len()..];
    if rest.starts_with(char::is_alphabetic) {
        return None;
    }
    let bare_name = rest.trim_matches(|c| SEPARATORS.contains(&c) || matches!(c, '=' | ':' | '"' | '\''));
    if matches!(spec.arguments, Arguments::FileName(_)) && args.is_empty() && bare_name.ends_with(".png") {
        let repair = format!("{} {bare_name}", spec.name);
        return Some(Guess::glued_line(spec, repair, Safety::Safe));
    }
    let texts =
        || std::iter::once(rest.trim_start_matches(['=', ':'])).chain(args.iter().map(|arg| source.slice(arg.span)));
    match numbers_between(texts(), &SEPARATORS) {
        Some(numbers) if numbers.len() == spec.numbers().len() => {
            let repair = format!("{} {}", spec.name, numbers.join(" "));
            // `sphere1` may be the first sphere; an angle is the one number that there is.
            let is_numbered = rest.starts_with(|c: char| c.is_ascii_digit()) && spec.kind != CommandKind::Fov;
            let safety = if is_numbered { Safety::Unsafe } else { safety_without_separators(texts()) };
            Some(Guess::glued_line(spec, repair, safety))
        }
        _ => {
            let help = format!("put a blank between `{}` and {}", spec.name, quoted(rest));
            Some(Guess::glued(spec, help, format!("{} {rest}", spec.name)))
        }
    }
}

/// Finds the command that begins like this, if it is the only one.
fn abbreviated(lower: &str, fits: Option<CommandKind>) -> Option<&'static CommandSpec> {
    let min_len = if fits.is_some() { 2 } else { 3 };
    let mut found = COMMANDS.iter().filter(|spec| lower.len() >= min_len && spec.name.starts_with(lower));
    found.next().filter(|_| found.next().is_none())
}

/// Finds the command that is nearest in spelling, if it is near and the only one. Near is a third of its letters when
/// the arguments fit, a quarter when they do not.
fn misspelt(lower: &str, fits: Option<CommandKind>) -> Option<&'static CommandSpec> {
    const MAX_LEN: usize = 20;
    if lower.len() > MAX_LEN {
        return None;
    }
    let near = COMMANDS.iter().filter_map(|spec| {
        let distance = strsim::osa_distance(lower, spec.name);
        let share = if fits == Some(spec.kind) { 3 } else { 4 };
        (distance <= spec.name.len() / share).then_some((distance, spec))
    });
    let near: Vec<_> = near.collect();
    let least = near.iter().map(|&(distance, _)| distance).min()?;
    let mut nearest = near.into_iter().filter(|&(distance, _)| distance == least);
    let (_, spec) = nearest.next()?;
    nearest.next().is_none().then_some(spec)
}

/// Finds the command that takes just these arguments: no two commands take the same number of numbers.
fn by_arguments(source: &Source, args: &[Token]) -> Option<CommandKind> {
    if let [name] = args
        && source.slice(name.span).trim_matches('"').ends_with(".png")
    {
        return Some(CommandKind::Write);
    }
    let all_numbers = args.iter().all(|arg| arg.kind == TokenKind::Number);
    let takes = |spec: &&CommandSpec| match spec.arguments {
        Arguments::Numbers(names) => names.len() == args.len(),
        Arguments::FileName(_) => false,
    };
    COMMANDS.iter().find(takes).filter(|_| all_numbers).map(|spec| spec.kind)
}

/// Does the same for a line whose first word is already an argument.
fn find_by_arguments(source: &Source, first: &Token, rest: &[Token]) -> Option<CommandKind> {
    let args: Vec<_> = std::iter::once(*first).chain(rest.iter().copied()).collect();
    by_arguments(source, &args)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::syntax::lex;

    /// Returns the command that the line is guessed to be, as the help names it.
    fn guessed(line: &str) -> Option<&'static str> {
        let source = Source::new("test", line);
        let tokens: Vec<_> = lex(&source).into_iter().filter(|token| token.kind.is_significant()).collect();
        guess(source.slice(tokens[0].span), &source, &tokens[1..]).map(|guess| guess.spec.name)
    }

    #[test]
    fn a_guess_is_good_or_none() {
        for (line, name) in [
            ("Sphere 0 0 0 1", "sphere"),
            ("WRITE a.png", "write"),
            ("sphre", "sphere"),
            ("shpere 1 2 3", "sphere"),
            ("spheer 0 0 0 1", "sphere"),
            ("surfcae 1", "surface"),
            ("cilynder 1 0 0 0 1", "cylinder"),
            ("zylinder 1 0 0 0 1", "cylinder"),
            ("backgroud 0 0 0", "background"),
            ("fvo 60", "fov"),
            ("sphere0 0 0 1", "sphere"),
            ("fov60", "fov"),
            ("sphere: 0 0 0 1", "sphere"),
            ("sphere(0,0,0,1)", "sphere"),
            ("cyl 1 0 0 0 1", "cylinder"),
            ("bg 0 0 0", ""),
            ("lights 1 1 1 0 0 0", "light"),
            ("wirte a.png", "write"),
            ("spheres 1", "sphere"),
        ] {
            let expected = (!name.is_empty()).then_some(name);
            assert_eq!(guessed(line), expected, "{line}");
        }
        for line in [
            "camera 0 0 0",
            "fog 0.5 0.5 0.5",
            "foo",
            "material 1",
            "triangle 0 0 0 1 1 1 2 2 2",
            "render a.png",
            "s 1",
        ] {
            assert_eq!(guessed(line), None, "{line}");
        }
    }
}
