//! How a number was made, as far as algebra can follow.

use std::sync::Arc;

/// Roots may stand in roots this deep: the second surface on a path, and the shadows there.
const MAX_DEPTH: u32 = 3;

/// A number as it was made from those of the scene and from κ. Cheap to copy; parts are shared.
#[derive(Clone, Debug)]
pub struct Expression(Arc<Node>);

#[derive(Debug)]
struct Node {
    made: Made,
    /// How deep roots stand in roots.
    depth: u32,
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

impl Expression {
    /// Makes an expression, unless it is beyond what algebra is for.
    pub fn new(made: Made) -> Option<Self> {
        let depth = match &made {
            Made::Number(_) | Made::Kappa => 0,
            Made::Sum(a, b) | Made::Difference(a, b) | Made::Product(a, b) | Made::Quotient(a, b) => {
                a.0.depth.max(b.0.depth)
            }
            Made::Root(a) => a.0.depth + 1,
        };
        (depth <= MAX_DEPTH).then(|| Self(Arc::new(Node { made, depth })))
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
