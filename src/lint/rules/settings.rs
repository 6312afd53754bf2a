//! What becomes of a `surface`, `background` or `fov`: used, set again, or replaced.

use crate::source::Span;
use crate::syntax::ast::{Command, Shape};
use crate::syntax::spec::CommandKind;

use crate::lint::context::kind_of;

/// What can be wrong with two settings that follow each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fate {
    /// The second sets what the first has set.
    Repeated,
    /// The second replaces the first before anything uses it.
    Overridden,
}

/// The kinds of setting.
const SETTINGS: [CommandKind; 3] = [CommandKind::Fov, CommandKind::Background, CommandKind::Surface];

/// Returns the pairs of settings with one fate, in order of their kinds: kind, first, second.
pub(super) fn fates(commands: &[Command<'_>], fate: Fate) -> Vec<(CommandKind, Span, Span)> {
    SETTINGS.into_iter().flat_map(|kind| fates_of(commands, kind, fate)).collect()
}

fn fates_of(commands: &[Command<'_>], kind: CommandKind, fate: Fate) -> Vec<(CommandKind, Span, Span)> {
    let mut found = Vec::new();
    let mut current: Option<Setting<'_>> = None;
    for command in commands {
        let of = kind_of(command);
        if of.is_none_or(|of| uses(of, kind)) {
            current.iter_mut().for_each(|setting| setting.is_used = true);
        }
        if of != Some(kind) {
            continue;
        }
        let next = Setting { span: command.span, numbers: command.numbers, is_used: false };
        let is_whole = command.shape == Shape::Whole(kind);
        match &current {
            // Nothing is known of a setting that could not be read.
            _ if !is_whole => current = None,
            Some(earlier) if earlier.numbers == command.numbers => {
                if fate == Fate::Repeated {
                    found.push((kind, earlier.span, command.span));
                }
            }
            earlier => {
                if let Some(earlier) = earlier.as_ref().filter(|earlier| !earlier.is_used && fate == Fate::Overridden) {
                    found.push((kind, earlier.span, command.span));
                }
                current = Some(next);
            }
        }
    }
    found
}

/// A setting that is in force.
struct Setting<'a> {
    span: Span,
    numbers: &'a [f64],
    is_used: bool,
}

/// Tells whether a command uses what a setting sets.
fn uses(command: CommandKind, setting: CommandKind) -> bool {
    match command {
        CommandKind::Write => setting != CommandKind::Surface,
        CommandKind::Sphere | CommandKind::Cylinder => setting == CommandKind::Surface,
        CommandKind::Fov | CommandKind::Background | CommandKind::Light | CommandKind::Surface => false,
    }
}

/// Returns the numbers of the last setting of a kind.
pub(super) fn last_set<'a>(commands: &[Command<'a>], kind: CommandKind) -> Option<&'a [f64]> {
    let last = commands.iter().rev().find(|command| kind_of(command) == Some(kind))?;
    (last.shape == Shape::Whole(kind)).then_some(last.numbers)
}
