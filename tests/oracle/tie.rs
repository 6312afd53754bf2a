//! Equal quantities: what kinds there are, and how often each was met.

/// Two quantities that were found equal, or could not be told apart at the last precision.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tie {
    /// A discriminant of 0: the ray touches. Counts as a hit.
    Tangent,
    /// A ray that starts on a surface it is not known to leave. No hit at t = 0.
    Start,
    /// A light on a surface: the hit at the light's distance casts no shadow.
    Light,
    /// A ray parallel to a wall or a cap. No hit.
    Parallel,
    /// A hit on the rim of a wall or a cap. Counts.
    Rim,
    /// Hits of two primitives at equal t. The first declared is met.
    Order,
    /// Hits of the wall and a cap of one cylinder at equal t. The page does not choose; here the wall is met.
    OwnRim,
    /// A surface seen edge on: n·d = 0. The normal is not turned.
    Facing,
    /// A light in the plane of the surface: n·L = 0. It does not count.
    Lit,
    /// A light at the hit point. It does not count.
    AtLight,
    /// A channel of exactly a whole number.
    Quantise,
}

impl Tie {
    /// Every kind, in the order of declaration.
    const ALL: [Self; 11] = [
        Self::Tangent,
        Self::Start,
        Self::Light,
        Self::Parallel,
        Self::Rim,
        Self::Order,
        Self::OwnRim,
        Self::Facing,
        Self::Lit,
        Self::AtLight,
        Self::Quantise,
    ];
}

/// How often each kind of tie was met.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
pub struct Ties([u32; Tie::ALL.len()]);

impl Ties {
    /// Returns the number of ties of one kind.
    pub fn of(&self, tie: Tie) -> u32 {
        self.0[tie as usize]
    }

    /// Counts one.
    pub(super) fn count(&mut self, tie: Tie) {
        self.0[tie as usize] += 1;
    }

    /// Returns the number of ties of all kinds.
    pub fn total(&self) -> u32 {
        self.0.iter().sum()
    }
}

impl std::fmt::Debug for Ties {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let met = Tie::ALL.iter().filter(|&&tie| self.of(tie) > 0);
        f.debug_map().entries(met.map(|&tie| (tie, self.of(tie)))).finish()
    }
}
