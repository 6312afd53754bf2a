//! Whether all pixels of an image have one colour.

/// The colours of some pixels, as far as they are one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Colors {
    /// There is no pixel yet.
    #[default]
    None,
    /// All have this colour.
    One([u8; 3]),
    /// There are several.
    Several,
}

impl Colors {
    /// Looks at pixels; the first that differs ends it.
    pub fn of(rgb: &[u8]) -> Self {
        let Some(first) = rgb.first_chunk() else { return Self::None };
        if rgb[3..] == rgb[..rgb.len() - 3] { Self::One(*first) } else { Self::Several }
    }

    /// Returns the colours of these pixels and of others.
    pub fn and(self, others: Self) -> Self {
        match (self, others) {
            (Self::None, colors) | (colors, Self::None) => colors,
            (Self::One(a), Self::One(b)) if a == b => self,
            _ => Self::Several,
        }
    }

    /// Returns the only colour.
    pub fn one(self) -> Option<[u8; 3]> {
        if let Self::One(color) = self { Some(color) } else { None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_colour_is_told_from_several() {
        let (red, green) = (Colors::of(&[9, 0, 0, 9, 0, 0]), Colors::of(&[0, 9, 0]));
        assert_eq!((red.one(), green.one()), (Some([9, 0, 0]), Some([0, 9, 0])));
        assert_eq!(Colors::of(&[1, 1, 1, 1, 1, 2]), Colors::Several);
        assert_eq!(Colors::of(&[]).and(red).and(Colors::None).and(red), red);
        assert_eq!(red.and(green).and(red), Colors::Several);
    }
}
