//! The tree: one node for each line that holds a command.
//!
//! A scene of a million spheres makes a million nodes, so a node is 16 bytes and its numbers lie together in one list.
//! The places of single arguments are not kept: who needs them (a diagnostic, an editor) asks
//! [`argument_spans`](crate::syntax::argument_spans), which reads the line again.

use crate::source::Span;
use crate::syntax::spec::{COMMANDS, CommandKind};

/// How many kinds of command there are.
const N_KINDS: usize = COMMANDS.len();

/// What became of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// A command with all its arguments.
    Whole(CommandKind),
    /// A line that is no command, reported already; which command it was meant to be, if that can be told.
    Bad(Option<CommandKind>),
}

/// One command, whole or bad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command<'f> {
    /// From its name to its last argument, without comment.
    pub span: Span,
    /// What it is.
    pub shape: Shape,
    /// Its numbers, all finite; empty for `write` and for a bad command.
    pub numbers: &'f [f64],
}

/// How a [`Command`] is kept.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Node {
    span: Span,
    /// Index of its first number in the numbers of its part.
    first_number: u32,
    shape: Shape,
}

/// The commands of a run of whole lines.
#[derive(Debug, Default)]
pub(super) struct Part {
    nodes: Vec<Node>,
    numbers: Vec<f64>,
}

impl Part {
    /// Makes an empty part with room for the commands of a usual text of `n_bytes`.
    pub(super) fn for_text(n_bytes: usize) -> Self {
        /// What a sphere and a number usually take.
        const COMMAND_BYTES: usize = 40;
        const NUMBER_BYTES: usize = 10;
        Self { nodes: Vec::with_capacity(n_bytes / COMMAND_BYTES), numbers: Vec::with_capacity(n_bytes / NUMBER_BYTES) }
    }

    /// Adds a command.
    pub(super) fn push(&mut self, span: Span, shape: Shape, numbers: &[f64]) {
        let first_number = self.numbers.len() as u32;
        self.numbers.extend_from_slice(numbers);
        self.nodes.push(Node { span, first_number, shape });
    }

    fn get(&self, node: &Node) -> Command<'_> {
        let n_numbers = match node.shape {
            Shape::Whole(kind) => kind.spec().numbers().len(),
            Shape::Bad(_) => 0,
        };
        let first = node.first_number as usize;
        Command { span: node.span, shape: node.shape, numbers: &self.numbers[first..first + n_numbers] }
    }
}

/// A parsed scene. Two files are equal when they hold the same commands at the same places.
#[derive(Debug, Default)]
pub struct File {
    /// In the order of the text.
    parts: Vec<Part>,
}

impl File {
    /// Adds the commands of the lines that follow.
    pub(super) fn push(&mut self, part: Part) {
        self.parts.push(part);
    }

    /// Adds the commands of the lines that follow.
    pub(super) fn append(&mut self, later: Self) {
        self.parts.extend(later.parts);
    }

    /// Returns the commands in the order of the text.
    pub fn commands(&self) -> impl DoubleEndedIterator<Item = Command<'_>> + '_ {
        self.parts.iter().flat_map(|part| part.nodes.iter().map(|node| part.get(node)))
    }

    /// Returns the number of commands, bad ones included.
    #[must_use]
    pub fn n_commands(&self) -> usize {
        self.parts.iter().map(|part| part.nodes.len()).sum()
    }

    /// Returns the number of whole commands of each kind, in the order of [`CommandKind`].
    #[must_use]
    pub fn counts(&self) -> [usize; N_KINDS] {
        let mut counts = [0; N_KINDS];
        for node in self.parts.iter().flat_map(|part| &part.nodes) {
            if let Shape::Whole(kind) = node.shape {
                counts[kind as usize] += 1;
            }
        }
        counts
    }
}

impl PartialEq for File {
    fn eq(&self, other: &Self) -> bool {
        self.commands().eq(other.commands())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_node_is_sixteen_bytes() {
        assert_eq!(size_of::<Node>(), 16);
    }
}
