//! Comments that allow a finding: `# clisc: allow(no-fov, L0101)` behind a command, or above it on lines of their own.

use std::collections::HashMap;

use crate::diag::fix::Edit;
use crate::diag::words::quoted;
use crate::diag::{Code, Diagnostic, Fix, Safety};
use crate::lint::options::{Level, Options, UnknownRule, find_rule};
use crate::lint::rules::unused_allow::UNUSED_ALLOW;
use crate::source::{Source, Span};
use crate::syntax::{Directive, directives};

/// One rule that a comment allows.
struct Allow<'s> {
    rule: Result<&'static Code, UnknownRule>,
    /// The place of its name.
    name: Span,
    directive: Directive<'s>,
    /// How many rules the comment names.
    n_names: usize,
    /// The lines of the comment and of the command that it speaks of.
    lines: [usize; 2],
    is_used: bool,
}

/// Holds back what the options or a comment of a scene allow, and remembers which comments did.
pub(super) struct Sieve<'a> {
    pub source: &'a Source,
    options: &'a Options,
    /// Searched for when the first finding comes that can be allowed.
    allows: Option<Allows<'a>>,
    has_errors: bool,
}

/// What comments allow, and the indices of what counts on a line.
struct Allows<'a> {
    all: Vec<Allow<'a>>,
    by_line: HashMap<usize, Vec<usize>>,
}

impl<'a> Sieve<'a> {
    pub fn new(source: &'a Source, options: &'a Options) -> Self {
        Self { source, options, allows: None, has_errors: false }
    }

    /// Returns a finding with its level, unless it is allowed.
    pub fn keep(&mut self, found: Diagnostic) -> Option<Diagnostic> {
        if found.code.name.is_none() {
            self.has_errors = true;
            return Some(found);
        }
        let found = self.options.leveled(found)?;
        let source = self.source;
        let allows = self.allows();
        let line = source.lines().line_of(found.primary.span.start);
        let mut is_kept = true;
        for &index in allows.by_line.get(&line).into_iter().flatten() {
            let allow = &mut allows.all[index];
            if allow.rule == Ok(found.code) {
                (allow.is_used, is_kept) = (true, false);
            }
        }
        is_kept.then_some(found)
    }

    pub fn keep_all(&mut self, found: Vec<Diagnostic>) -> Vec<Diagnostic> {
        found.into_iter().filter_map(|found| self.keep(found)).collect()
    }

    /// Reports the comments that allow nothing. With an error in the scene it is not known whether they would.
    pub fn finish(mut self) -> Vec<Diagnostic> {
        let (source, options, has_errors) = (self.source, self.options, self.has_errors);
        let mut idle = misspelt_directives(source);
        for allow in &self.allows().all {
            let is_known = !has_errors && allow.rule.as_ref().is_ok_and(|rule| options.level(rule) != Level::Off);
            match &allow.rule {
                Ok(rule) if is_known && !allow.is_used && **rule != UNUSED_ALLOW.code => {
                    idle.push(unused(source, allow));
                }
                Err(error) => idle.push(unknown(source, allow, error)),
                Ok(_) => {}
            }
        }
        self.keep_all(idle)
    }

    fn allows(&mut self) -> &mut Allows<'a> {
        let source = self.source;
        self.allows.get_or_insert_with(|| Allows::find(source))
    }
}

impl<'a> Allows<'a> {
    fn find(source: &'a Source) -> Self {
        let all = find_allows(source);
        let mut by_line: HashMap<usize, Vec<usize>> = HashMap::new();
        for (index, allow) in all.iter().enumerate() {
            let [comment, command] = allow.lines;
            by_line.entry(comment).or_default().push(index);
            if command != comment {
                by_line.entry(command).or_default().push(index);
            }
        }
        Self { all, by_line }
    }
}

/// Returns what the comments of a scene allow.
fn find_allows(source: &Source) -> Vec<Allow<'_>> {
    let mut allows = Vec::new();
    for directive in directives(source) {
        let Some(names) = directive.text.strip_prefix("allow(").and_then(|rest| rest.strip_suffix(')')) else {
            continue;
        };
        let line = source.lines().line_of(directive.comment.start);
        let target = if directive.is_behind_command { line } else { next_command_line(source, line) };
        let n_names = names.split(',').count();
        let mut start = directive.comment.start + offset_in(source.slice(directive.comment), names);
        for name in names.split(',') {
            let trimmed = name.trim();
            let at = start + offset_in(name, trimmed);
            allows.push(Allow {
                rule: find_rule(trimmed),
                name: Span::new(at, at + trimmed.len() as u32),
                directive,
                n_names,
                lines: [line, target],
                is_used: false,
            });
            start += name.len() as u32 + 1;
        }
    }
    allows
}

/// Returns how many bytes of `text` stand before `part`, a slice of it.
fn offset_in(text: &str, part: &str) -> u32 {
    (part.as_ptr().addr() - text.as_ptr().addr()) as u32
}

/// Returns the line of the first command behind a line, or that line if there is none.
fn next_command_line(source: &Source, line: usize) -> usize {
    let is_command = |&next: &usize| {
        let text = source.slice(source.lines().line_span(source.text(), next)).trim_ascii_start();
        !text.is_empty() && !text.starts_with('#')
    };
    (line + 1..source.lines().n_lines()).find(is_command).unwrap_or(line)
}

fn unused(source: &Source, allow: &Allow<'_>) -> Diagnostic {
    let name = source.slice(allow.name);
    Diagnostic::new(&UNUSED_ALLOW.code, allow.name, format!("{} is allowed, but not found here", quoted(name)))
        .label("allows nothing")
        .help("remove it, or move it to the line of the finding, or above that")
        .fix(removal(source, allow))
}

fn unknown(source: &Source, allow: &Allow<'_>, error: &UnknownRule) -> Diagnostic {
    let rename = match error {
        UnknownRule::NotFound(_, Some(nearest)) => Some(Fix::write(Safety::Unsafe, allow.name, *nearest)),
        UnknownRule::NotFound(_, None) | UnknownRule::IsError(_) => None,
    };
    Diagnostic::new(&UNUSED_ALLOW.code, allow.name, error.to_string())
        .label("allows nothing")
        .fix(rename)
        .fix(removal(source, allow))
}

/// Returns the fix that removes a name, and the comment when it is the only one.
fn removal(source: &Source, allow: &Allow<'_>) -> Fix {
    let comment = allow.directive.comment;
    let edit = if allow.n_names > 1 {
        let rest = &source.text()[allow.name.end as usize..comment.end as usize];
        let before = &source.text()[comment.start as usize..allow.name.start as usize];
        match rest.trim_start().starts_with(',') {
            true => {
                let n_blanks = rest.find(',').map_or(0, |comma| {
                    let behind = &rest[comma + 1..];
                    comma + 1 + behind.len() - behind.trim_start().len()
                });
                Edit::remove(Span::new(allow.name.start, allow.name.end + n_blanks as u32))
            }
            false => {
                let comma = before.rfind(',').unwrap_or(before.len());
                Edit::remove(Span::new(comment.start + comma as u32, allow.name.end))
            }
        }
    } else if allow.directive.is_behind_command {
        let line = source.lines().line_span(source.text(), allow.lines[0]);
        let before = source.slice(Span::new(line.start, comment.start));
        Edit::remove(Span::new(line.start + before.trim_end().len() as u32, comment.end))
    } else {
        Edit::remove_command(source, comment)
    };
    Fix::safe("remove what allows nothing", vec![edit])
}

/// Reports comments that speak to clisc in words that it does not know.
fn misspelt_directives(source: &Source) -> Vec<Diagnostic> {
    let is_known = |text: &str| matches!(text, "off" | "on") || (text.starts_with("allow(") && text.ends_with(')'));
    let misspelt = directives(source).into_iter().filter(|directive| !is_known(directive.text));
    misspelt
        .map(|directive| {
            let message = format!("{} is nothing that clisc knows", quoted(directive.text));
            Diagnostic::new(&UNUSED_ALLOW.code, directive.comment, message)
                .label("does nothing")
                .help("write `# clisc: allow(RULE)`, `# clisc: off` or `# clisc: on`")
        })
        .collect()
}
