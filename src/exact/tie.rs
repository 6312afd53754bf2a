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
    /// A light in the plane of the surface: n·L = 0. It does not count.
    Lit,
    /// A light at the hit point. It does not count.
    AtLight,
    /// A channel of exactly a whole number.
    Quantise,
}

impl Tie {
    /// Every kind, in the order of declaration.
    pub const ALL: [Self; 10] = [
        Self::Tangent,
        Self::Start,
        Self::Light,
        Self::Parallel,
        Self::Rim,
        Self::Order,
        Self::OwnRim,
        Self::Lit,
        Self::AtLight,
        Self::Quantise,
    ];

    /// Returns the name that certificates use.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Tangent => "tangent",
            Self::Start => "start",
            Self::Light => "light",
            Self::Parallel => "parallel",
            Self::Rim => "rim",
            Self::Order => "order",
            Self::OwnRim => "own-rim",
            Self::Lit => "lit",
            Self::AtLight => "at-light",
            Self::Quantise => "quantise",
        }
    }
}

/// How often each kind of tie was met.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
pub struct Ties([u32; Tie::ALL.len()]);

impl Ties {
    /// Makes so many of some kinds.
    #[must_use]
    pub fn new(numbers: &[(Tie, u32)]) -> Self {
        let mut ties = Self::default();
        numbers.iter().for_each(|(tie, n)| ties.0[*tie as usize] += n);
        ties
    }

    /// Returns the number of ties of one kind.
    #[must_use]
    pub fn of(&self, tie: Tie) -> u32 {
        self.0[tie as usize]
    }

    /// Counts one.
    pub(super) fn count(&mut self, tie: Tie) {
        self.0[tie as usize] += 1;
    }

    /// Returns the number of ties of all kinds.
    #[must_use]
    pub fn total(&self) -> u32 {
        self.0.iter().sum()
    }

    /// Returns these and others.
    #[must_use]
    pub(super) fn plus(&self, others: &Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] + others.0[k]))
    }

    /// Returns those of one of these kinds alone.
    #[must_use]
    pub fn only(&self, kinds: &[Tie]) -> Self {
        Self(std::array::from_fn(|k| if kinds.contains(&Tie::ALL[k]) { self.0[k] } else { 0 }))
    }

    /// Returns the kinds that were met, each with its number.
    pub fn met(&self) -> impl Iterator<Item = (Tie, u32)> {
        Tie::ALL.into_iter().map(|tie| (tie, self.of(tie))).filter(|(_, n)| *n > 0)
    }
}

impl std::fmt::Debug for Ties {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_map().entries(self.met()).finish()
    }
}
