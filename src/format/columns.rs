//! The columns of one paragraph: first all its commands are measured, then each is written.

use crate::format::MAX_ALIGNED;
use crate::format::number::Parts;
use crate::syntax::spec::{Arguments, COMMANDS, CommandKind, MAX_NUMBERS};

/// How many blanks stand before the first number of a group.
const BEFORE_GROUP: usize = 3;
/// How many blanks stand before a comment behind a command.
const BEFORE_COMMENT: usize = 2;
/// The longest file name, in characters, behind which the comments of other lines align.
const MAX_ALIGNED_NAME: usize = 80;

/// The widths of a paragraph, in characters.
#[derive(Debug, Default)]
pub(super) struct Columns {
    /// Of the longest name.
    name: usize,
    /// By kind of command.
    tables: [Table; COMMANDS.len()],
}

/// The widths of the commands of one kind.
#[derive(Clone, Copy, Debug, Default)]
struct Table {
    numbers: [Width; MAX_NUMBERS],
    /// The widest end of those with a comment: their last number from its point on, or their file name.
    commented_end: Option<usize>,
}

/// The width of a column of numbers, before and from the point on.
#[derive(Clone, Copy, Debug, Default)]
struct Width {
    before: usize,
    behind: usize,
}

/// Returns the words behind the name of a command whose text is `command`.
fn words(kind: CommandKind, command: &str) -> impl Iterator<Item = &str> {
    let rest = command[kind.name().len()..].trim_start_matches([' ', '\t']);
    let (name, numbers) = match kind.spec().arguments {
        Arguments::FileName(_) => (Some(rest), ""),
        Arguments::Numbers(_) => (None, rest),
    };
    name.into_iter().chain(numbers.split([' ', '\t']).filter(|word| !word.is_empty()))
}

impl Columns {
    /// Makes room for a command. `command` is its text from its name to its last argument.
    pub(super) fn measure(&mut self, kind: CommandKind, command: &str, has_comment: bool) {
        self.name = self.name.max(kind.name().len());
        let table = &mut self.tables[kind as usize];
        let (mut end, mut is_regular) = (0, true);
        if let Arguments::FileName(_) = kind.spec().arguments {
            end = words(kind, command).next().map_or(0, |name| name.chars().count());
            is_regular = end <= MAX_ALIGNED_NAME;
        } else {
            for (width, number) in table.numbers.iter_mut().zip(words(kind, command)) {
                let parts = Parts::of(number);
                end = parts.n_behind();
                if parts.n_before() + parts.n_behind() <= MAX_ALIGNED {
                    width.before = width.before.max(parts.n_before());
                    width.behind = width.behind.max(parts.n_behind());
                } else {
                    is_regular = false;
                }
            }
        }
        if has_comment && is_regular {
            table.commented_end = table.commented_end.max(Some(end));
        }
    }

    /// Appends a command that has been measured.
    pub(super) fn write(&self, kind: CommandKind, command: &str, out: &mut String) {
        let spec = kind.spec();
        out.push_str(spec.name);
        let mut n_blanks = self.name - spec.name.len() + 1;
        if let Arguments::FileName(_) = spec.arguments {
            push_blanks(out, n_blanks);
            words(kind, command).for_each(|name| out.push_str(name));
            return;
        }
        let mut group_ends = spec.groups.iter().scan(0, |end, group| {
            *end += group.n_numbers;
            Some(*end)
        });
        let mut group_end = group_ends.next();
        for (i, number) in words(kind, command).enumerate() {
            let (parts, width) = (Parts::of(number), &self.tables[kind as usize].numbers[i]);
            push_blanks(out, n_blanks + width.before.saturating_sub(parts.n_before()));
            parts.push_to(out);
            let ends_group = group_end == Some(i + 1);
            if ends_group {
                group_end = group_ends.next();
            }
            let gap = if ends_group { BEFORE_GROUP } else { 1 };
            n_blanks = gap + width.behind.saturating_sub(parts.n_behind());
        }
    }

    /// Appends blanks behind a command of this kind, `n_written` characters long, up to where comments begin.
    pub(super) fn write_blanks_before_comment(&self, kind: CommandKind, n_written: usize, out: &mut String) {
        let column = self.comment_column(kind).unwrap_or(0);
        push_blanks(out, column.saturating_sub(n_written).max(BEFORE_COMMENT));
    }

    /// Returns the column in which comments behind commands of this kind begin.
    fn comment_column(&self, kind: CommandKind) -> Option<usize> {
        let table = &self.tables[kind as usize];
        let numbers = &table.numbers[..kind.spec().numbers().len()];
        let n_gaps = BEFORE_GROUP * kind.spec().groups.len().saturating_sub(1);
        let n_blanks = n_gaps + numbers.len().saturating_sub(kind.spec().groups.len());
        let n_numbers: usize = numbers.iter().map(|width| width.before + width.behind).sum();
        let n_last = numbers.last().map_or(0, |width| width.behind);
        table.commented_end.map(|end| self.name + 1 + n_blanks + n_numbers - n_last + end + BEFORE_COMMENT)
    }
}

fn push_blanks(out: &mut String, n: usize) {
    const BLANKS: &str = "                                                                ";
    match BLANKS.get(..n) {
        Some(blanks) => out.push_str(blanks),
        None => out.extend(std::iter::repeat_n(' ', n)),
    }
}
