//! Pass `terms`: what of the formula for a hit's colour a surface needs at all.
//!
//! # Why it is safe
//! The colour is Ca + Σ Cl·(Cd·(n·L) + Cs·(n·H)^P) + Krefl·(reflected colour), per channel, clamped to 0…1.
//!
//! - A term with a factor of 0 in every channel is 0: n·L and (n·H)^P are finite. So a surface needs no normal to a light
//!   where Cd is 0, no half vector where Cs is, no light at all where both are, and not the light k where Clₖ·Cd and
//!   Clₖ·Cs are 0 in every channel, as a red light on a blue surface.
//! - (n·H)⁰ = 1 for every n·H, 0 among them; a whole P is a product of factors n·H.
//! - A lit term is never below 0 where its coefficients are not: n·L > 0, and n·H > 0 because n·L > 0 and n·V ≥ 0 (the
//!   normal is turned to the viewer). A reflected colour is at least 0, and Krefl is above 0 where it counts. So a channel
//!   with Ca ≥ 1 that only gains is 1 after clamping, one with Ca ≤ 0 that only loses is 0; when every channel is settled
//!   so, or nothing is added to it, the colour is a constant.

use glam::DVec3;

use crate::ir::Surface;
use crate::plan::{Light, Part, Pass, Settings};

/// What a surface needs to be shaded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Terms {
    /// Whether it needs n·L.
    pub diffuse: bool,
    /// Whether it needs (n·H)^P, and which P that is.
    pub specular: Option<Exponent>,
    /// Whether its reflected ray is followed.
    pub mirror: bool,
    /// The colour, clamped to 0…1, when it is the same at every hit; then nothing of the above is needed.
    pub constant: Option<DVec3>,
    /// Whether no light and no reflection can make a channel smaller.
    pub only_gains: bool,
}

/// The exponent of a specular term.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exponent {
    /// A whole number of at most [`Exponent::MAX_WHOLE`]; 0 needs no half vector.
    Whole(u32),
    /// Any other.
    Real(f64),
}

impl Exponent {
    /// The largest exponent for which products are fewer than what a power takes.
    pub const MAX_WHOLE: u32 = 1024;

    /// Sorts an exponent.
    fn new(shininess: f64) -> Self {
        if shininess <= f64::from(Self::MAX_WHOLE) && shininess.fract() == 0.0 {
            Self::Whole(shininess as u32)
        } else {
            Self::Real(shininess)
        }
    }
}

impl Terms {
    /// Finds out what a surface needs under these lights.
    pub(super) fn new(surface: &Surface, lights: &[Light], settings: &Settings) -> Self {
        match (settings.part, settings.passes.contains(Pass::Terms)) {
            (Part::A, false) => Self { diffuse: true, ..Self::NOTHING },
            (Part::A, true) => {
                let black = Surface { ambient: DVec3::ZERO, specular: DVec3::ZERO, reflectance: 0.0, ..*surface };
                Self::needed(&black, lights)
            }
            (Part::B, false) => Self {
                diffuse: true,
                specular: Some(Exponent::Real(surface.shininess)),
                mirror: surface.reflectance > 0.0,
                ..Self::NOTHING
            },
            (Part::B, true) => Self::needed(surface, lights),
        }
    }

    /// Nothing but the ambient colour, of which nothing is known.
    const NOTHING: Self = Self { diffuse: false, specular: None, mirror: false, constant: None, only_gains: false };

    fn needed(surface: &Surface, lights: &[Light]) -> Self {
        let reaches = |coefficient: DVec3| lights.iter().any(|light| is_seen(coefficient, light.color));
        let terms = Self {
            diffuse: reaches(surface.diffuse),
            specular: reaches(surface.specular).then(|| Exponent::new(surface.shininess)),
            mirror: surface.reflectance > 0.0,
            ..Self::NOTHING
        };
        let gains = gains(surface, lights);
        let only_gains = gains.iter().all(|change| change.is_none_or(|is_gain| is_gain == Gain::Up));
        let constant = constant(surface.ambient, gains);
        Self { constant, only_gains, ..terms }
    }
}

/// Which way the channels of a hit's colour can move from its ambient colour.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Gain {
    Up,
    Down,
    Either,
}

/// Returns for each channel which way lights and reflection can move it; `None` is not at all.
fn gains(surface: &Surface, lights: &[Light]) -> [Option<Gain>; 3] {
    std::array::from_fn(|channel| {
        let products = lights.iter().flat_map(|light| {
            [surface.diffuse[channel], surface.specular[channel]].map(|coefficient| {
                let color = light.color[channel];
                // The sign of the product, which may underflow.
                if color == 0.0 || coefficient == 0.0 { 0.0 } else { color.signum() * coefficient.signum() }
            })
        });
        let mirror = if surface.reflectance > 0.0 { 1.0 } else { 0.0 };
        products.chain([mirror]).filter(|sign| *sign != 0.0).fold(None, |known, sign| {
            let gain = if sign > 0.0 { Gain::Up } else { Gain::Down };
            Some(if known.is_none_or(|known| known == gain) { gain } else { Gain::Either })
        })
    })
}

/// Returns the clamped colour if every channel of it is settled.
fn constant(ambient: DVec3, gains: [Option<Gain>; 3]) -> Option<DVec3> {
    let channels = [0, 1, 2].map(|channel| {
        let ambient = ambient[channel];
        match gains[channel] {
            None => Some(ambient.clamp(0.0, 1.0)),
            Some(Gain::Up) => (ambient >= 1.0).then_some(1.0),
            Some(Gain::Down) => (ambient <= 0.0).then_some(0.0),
            Some(Gain::Either) => None,
        }
    });
    let [Some(red), Some(green), Some(blue)] = channels else { return None };
    Some(DVec3::new(red, green, blue))
}

/// Tells whether a light of this colour adds to a term with this coefficient, in some channel.
fn is_seen(coefficient: DVec3, color: DVec3) -> bool {
    (0..3).any(|channel| coefficient[channel] != 0.0 && color[channel] != 0.0)
}

/// Tells whether a light adds to a hit on a surface in some channel, by the rules of `part`.
pub(super) fn answers(surface: &Surface, light: &Light, part: Part) -> bool {
    is_seen(surface.diffuse, light.color) || (part == Part::B && is_seen(surface.specular, light.color))
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHITE: Light = Light { color: DVec3::ONE, position: DVec3::ZERO };
    const PLAIN: Surface =
        Surface { ambient: DVec3::ZERO, diffuse: DVec3::ZERO, specular: DVec3::ZERO, shininess: 1.0, reflectance: 0.0 };

    fn terms(surface: Surface, lights: &[Light]) -> Terms {
        Terms::new(&surface, lights, &Settings::default())
    }

    #[test]
    fn exponents_are_sorted() {
        for (shininess, exponent) in [
            (0.0, Exponent::Whole(0)),
            (20.0, Exponent::Whole(20)),
            (0.5, Exponent::Real(0.5)),
            (1e300, Exponent::Real(1e300)),
        ] {
            let shiny = Surface { specular: DVec3::X, shininess, ..PLAIN };
            assert_eq!(terms(shiny, &[WHITE]).specular, Some(exponent));
        }
    }

    #[test]
    fn what_no_light_reaches_is_a_constant() {
        let red = Light { color: DVec3::X, ..WHITE };
        let blue = Surface { ambient: DVec3::new(0.5, 2.0, -1.0), diffuse: DVec3::Z, specular: DVec3::Y, ..PLAIN };
        let found = terms(blue, &[red]);
        assert_eq!((found.diffuse, found.specular), (false, None));
        assert_eq!(found.constant, Some(DVec3::new(0.5, 1.0, 0.0)));
        assert_eq!(terms(blue, &[red, WHITE]).constant, None);
        assert!(answers(&blue, &WHITE, Part::A) && !answers(&blue, &red, Part::B));
    }

    #[test]
    fn a_full_channel_that_only_gains_stays_full() {
        let bright = Surface { ambient: DVec3::ONE, diffuse: DVec3::ONE, reflectance: 0.5, ..PLAIN };
        assert_eq!(terms(bright, &[WHITE]).constant, Some(DVec3::ONE));
        assert!(terms(bright, &[WHITE]).only_gains);
        let dark = Light { color: -DVec3::ONE, ..WHITE };
        assert_eq!(terms(bright, &[dark]).constant, None);
        assert!(!terms(bright, &[WHITE, dark]).only_gains);
        // Two signs that are one: a dark light on a negative coefficient adds.
        let inverse = Surface { diffuse: -DVec3::ONE, ..bright };
        assert_eq!(terms(inverse, &[dark]).constant, Some(DVec3::ONE));
    }
}
