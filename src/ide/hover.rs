//! What the thing below the pointer means.

use std::fmt::Write;

use crate::ide::color::color_words;
use crate::ide::line::{LineAt, arg_spec};
use crate::ide::{Document, surface_at};
use crate::lint::find_rule;
use crate::source::Span;
use crate::syntax::spec::{ArgSpec, CommandKind, CommandSpec, Range, Unit};
use crate::syntax::{TokenKind, directive};

/// What to show.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hover {
    /// What it is about.
    pub span: Span,
    /// In Markdown.
    pub markdown: String,
}

/// Says what stands at `offset`: a command, a number, a comment that speaks to clisc. Of the commands of a scene of another
/// edition nothing is said.
#[must_use]
pub fn hover(document: &Document, offset: u32) -> Option<Hover> {
    let line = LineAt::new(document, offset);
    if line.is_in_comment() {
        return directive_hover(document, &line);
    }
    let word = line.word()?;
    let command = line.command(document).filter(|_| !document.is_of_other_edition())?;
    if line.name() == Some(word) {
        return Some(Hover { span: word, markdown: command_page(document, command, offset) });
    }
    let index = line.args().iter().position(|arg| *arg == word)?;
    let arg = arg_spec(command, index)?;
    Some(Hover { span: word, markdown: arg_page(document, command, arg, index, &line) })
}

fn directive_hover(document: &Document, line: &LineAt) -> Option<Hover> {
    let comment = line.tokens.iter().find(|token| token.kind == TokenKind::Comment)?.span;
    let markdown = match directive(document.source().slice(comment))? {
        "off" => "From here on `clisc fmt` leaves the text as it is, up to `# clisc: on`.".to_owned(),
        "on" => "From here on `clisc fmt` formats again.".to_owned(),
        other => allow_page(other.strip_prefix("allow(")?.strip_suffix(')')?),
    };
    Some(Hover { span: comment, markdown })
}

/// Says what the rules of a list stand for.
fn allow_page(names: &str) -> String {
    let entry = |name: &str| match find_rule(name) {
        Ok(rule) => format!("\n- `{name}`: {} ({})", rule.title, rule.id),
        Err(error) => format!("\n- {error}"),
    };
    let entries: String = names.split(',').map(|name| entry(name.trim())).collect();
    format!("Not reported of this command, or of the one below:\n{entries}")
}

/// Says what a command does, with the groups of its numbers.
fn command_page(document: &Document, command: &CommandSpec, offset: u32) -> String {
    let mut page = format!("```cli\n{}\n```\n{}\n", command.usage(), command.doc);
    for (numbers, group) in command.grouped() {
        let names: Vec<_> = command.numbers()[numbers].iter().map(|arg| format!("`{}`", arg.name)).collect();
        let _ = write!(page, "\n- {}: {}", names.join(" "), group.name);
    }
    let _ = write!(page, "\n\nSuch as `{}`", command.example);
    if let CommandKind::Sphere | CommandKind::Cylinder = command.kind {
        let surface = surface_at(document, offset);
        let told = surface
            .map(|surface| format!("\n\nIts surface is set in line {}.", document.lines().line_of(surface.start) + 1));
        page.push_str(&told.unwrap_or_default());
    }
    page
}

/// Says what an argument means, and what the colour it belongs to looks like.
fn arg_page(document: &Document, command: &CommandSpec, arg: &ArgSpec, index: usize, line: &LineAt) -> String {
    let mut page = format!("`{}` of `{}`: {}", arg.name, command.name, arg.doc);
    let limits = limits(arg);
    if !limits.is_empty() {
        let _ = write!(page, "\n\n{limits}");
    }
    let Some((numbers, group)) = command.grouped().find(|(numbers, _)| numbers.contains(&index)) else { return page };
    if group.n_numbers > 1 {
        let _ = write!(page, "\n\nOne of the {} numbers of {} (`{}`)", group.n_numbers, group.name, group.symbol);
    }
    let args = line.args();
    let values: Option<Vec<f64>> = args
        .get(numbers)
        .map(|args| args.iter().filter_map(|arg| document.source().slice(*arg).parse().ok()).collect());
    if let (true, Some([r, g, b])) = (group.is_color, values.as_deref()) {
        let rgb = [*r, *g, *b];
        let [r, g, b] = rgb.map(|channel| (channel.clamp(0.0, 1.0) * 255.0).round() as u8);
        let _ = write!(page, ": {}, `#{r:02x}{g:02x}{b:02x}`", color_words(rgb));
    }
    page
}

/// Says in which unit an argument counts and which values it may have.
pub(super) fn limits(arg: &ArgSpec) -> String {
    let unit = match arg.unit {
        Unit::World => "in world units",
        Unit::Degrees => "in degrees",
        Unit::Share | Unit::Exponent => "",
        Unit::FileName => "a file name that ends in `.png`; in double quotes it may hold blanks",
    };
    let range = match arg.range {
        Range::Any => String::new(),
        Range::UsuallyUnit => "from 0 to 1, or with a warning beyond".to_owned(),
        Range::Positive => "above 0".to_owned(),
        Range::NotNegative => "0 or above".to_owned(),
        Range::PositiveBelow(limit) => format!("above 0 and below {limit}"),
    };
    let mut words = [unit, &range].into_iter().filter(|words| !words.is_empty()).collect::<Vec<_>>().join(", ");
    if let Some(first) = words.get_mut(..1) {
        first.make_ascii_uppercase();
    }
    words
}
