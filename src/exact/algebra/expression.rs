//! How a number was made, as far as algebra can follow.

use std::mem;
use std::sync::Arc;

/// Roots may stand in roots this deep: the second surface on a path, and the shadows there.
const MAX_DEPTH: u32 = 3;

/// The most steps that may follow on each other. A path among flat mirrors takes about a dozen for each of its rays and no
/// root, so that without this the numbers of a path of ten thousand would all be kept; to evaluate so many steps is beyond
/// the work for one question.
const MAX_STEPS: u32 = 4096;

/// A number as it was made from those of the scene and from κ. Cheap to copy; parts are shared.
#[derive(Clone, Debug)]
pub struct Expression(Arc<Node>);

#[derive(Debug)]
struct Node {
    made: Made,
    /// How deep roots stand in roots.
    depth: u32,
    /// How many steps follow on each other.
    n_steps: u32,
}

impl Drop for Node {
    /// Drops parts one after the other: left to itself one would drop the next from within, as deep as there are steps.
    fn drop(&mut self) {
        let mut dropped = vec![mem::replace(&mut self.made, Made::Kappa)];
        while let Some(made) = dropped.pop() {
            for Expression(part) in made.into_parts().into_iter().flatten() {
                if let Some(mut node) = Arc::into_inner(part) {
                    dropped.push(mem::replace(&mut node.made, Made::Kappa));
                }
            }
        }
    }
}

/// One step of a computation.
#[derive(Debug)]
pub enum Made {
    Number(f64),
    Kappa,
    Sum(Expression, Expression),
    Difference(Expression, Expression),
    Product(Expression, Expression),
    Quotient(Expression, Expression),
    Root(Expression),
}

impl Made {
    fn parts(&self) -> [Option<&Expression>; 2] {
        match self {
            Self::Number(_) | Self::Kappa => [None, None],
            Self::Sum(a, b) | Self::Difference(a, b) | Self::Product(a, b) | Self::Quotient(a, b) => [Some(a), Some(b)],
            Self::Root(a) => [Some(a), None],
        }
    }

    fn into_parts(self) -> [Option<Expression>; 2] {
        match self {
            Self::Number(_) | Self::Kappa => [None, None],
            Self::Sum(a, b) | Self::Difference(a, b) | Self::Product(a, b) | Self::Quotient(a, b) => [Some(a), Some(b)],
            Self::Root(a) => [Some(a), None],
        }
    }
}

impl Expression {
    /// Makes an expression, unless it is beyond what algebra is for.
    pub fn new(made: Made) -> Option<Self> {
        let most = |of: fn(&Node) -> u32| made.parts().into_iter().flatten().map(|part| of(&part.0)).max().unwrap_or(0);
        let depth = most(|node| node.depth) + u32::from(matches!(made, Made::Root(_)));
        let n_steps = most(|node| node.n_steps) + 1;
        (depth <= MAX_DEPTH && n_steps <= MAX_STEPS).then(|| Self(Arc::new(Node { made, depth, n_steps })))
    }

    /// Returns what the last step is made from.
    pub fn parts(&self) -> [Option<&Self>; 2] {
        self.made().parts()
    }

    /// Returns the last step.
    pub fn made(&self) -> &Made {
        &self.0.made
    }

    /// Returns what tells it from every other expression that exists at the time.
    pub fn identity(&self) -> usize {
        Arc::as_ptr(&self.0).addr()
    }
}
