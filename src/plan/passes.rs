//! The names of the passes, and sets of them.

/// One way in which an image may need less than the scene holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(u8)]
pub enum Pass {
    /// Images that equal one already rendered, and pixels that a later `write` cannot change.
    Writes,
    /// Objects that no ray of the image can meet.
    Objects,
    /// Lights and terms of surfaces that add nothing.
    Terms,
    /// Channels that are saturated whatever is still to come.
    Saturation,
    /// Reflected rays that can no longer change the pixel.
    Bounces,
    /// Objects that cannot lie between a surface and a light, or between what a tile shows of it and a light.
    Shadows,
    /// Objects that the eye rays of a tile cannot meet.
    Tiles,
}

impl Pass {
    /// Every pass, in the order in which they run.
    pub const ALL: [Self; 7] =
        [Self::Writes, Self::Objects, Self::Terms, Self::Saturation, Self::Bounces, Self::Shadows, Self::Tiles];

    /// Returns the name by which a command line calls it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Writes => "writes",
            Self::Objects => "objects",
            Self::Terms => "terms",
            Self::Saturation => "saturation",
            Self::Bounces => "bounces",
            Self::Shadows => "shadows",
            Self::Tiles => "tiles",
        }
    }

    /// Returns what it skips, in a few words.
    #[must_use]
    pub const fn skips(self) -> &'static str {
        match self {
            Self::Writes => "images equal to an earlier one, and pixels that a later write cannot change",
            Self::Objects => "objects that no ray of the image can meet",
            Self::Terms => "lights and terms of surfaces that add nothing",
            Self::Saturation => "lights on channels that are full",
            Self::Bounces => "reflected rays that no longer change the pixel",
            Self::Shadows => "objects that cannot lie between a surface and a light",
            Self::Tiles => "objects that the eye rays of a tile cannot meet",
        }
    }
}

/// A set of passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Passes(u8);

impl Passes {
    /// Returns the set of all.
    #[must_use]
    pub const fn all() -> Self {
        Self((1 << Pass::ALL.len()) - 1)
    }

    /// Returns the set of none.
    #[must_use]
    pub const fn none() -> Self {
        Self(0)
    }

    /// Returns the set without one.
    #[must_use]
    pub const fn without(self, pass: Pass) -> Self {
        Self(self.0 & !(1 << pass as u8))
    }

    /// Tells whether a pass is in the set.
    #[must_use]
    pub const fn contains(self, pass: Pass) -> bool {
        self.0 & (1 << pass as u8) != 0
    }
}
