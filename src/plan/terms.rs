//! Pass `terms`: what of the formula for a hit's colour a surface needs at all.
//!
//! The pass takes the terms that add nothing out of the surfaces of the scene, so that nothing later sees them: packets, single
//! rays and drafts shade what is left, and the passes behind this one find fewer mirrors and fewer lit objects.
//!
//! # Why it is safe
//! The colour is Ca + Σ Cl·(Cd·(n·L) + Cs·(n·H)^P) + Krefl·(reflected colour), per channel, clamped to 0…1.
//!
//! - A term with a factor of 0 in every channel is 0: n·L and (n·H)^P are finite. So a surface needs no normal to a light
//!   where Cd is 0, no half vector where Cs is, no light at all where both are, and not the light k where Clₖ·Cd and
//!   Clₖ·Cs are 0 in every channel, as a red light on a blue surface.
//! - A lit term is never below 0 where its coefficients are not: n·L > 0, and n·H > 0 because n·L > 0 and n·V ≥ 0 (the
//!   normal is turned to the viewer). A reflected colour is at least 0, and Krefl is above 0 where it counts. So a channel
//!   with Ca ≥ 1 that only gains is 1 after clamping, one with Ca ≤ 0 that only loses is 0; when every channel is settled
//!   so, or nothing is added to it, the colour is a constant.
//! - What is so under some lights is so under fewer of them: a constant is the same in every earlier image.

use std::borrow::Cow;

use glam::DVec3;
use rayon::prelude::*;

use crate::ir::Surface;
use crate::plan::{Light, Part, Pass, Settings};

/// Surfaces that a thread looks at at a time.
const SURFACES_PER_TASK: usize = 4096;

/// What a surface needs to be shaded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Terms {
    /// Whether it needs n·L.
    pub diffuse: bool,
    /// Whether it needs (n·H)^P, and which P that is.
    pub specular: Option<f64>,
    /// Whether its reflected ray is followed.
    pub mirror: bool,
    /// The colour, clamped to 0…1, when it is proved to be the same at every hit; then nothing of the above is needed.
    pub constant: Option<DVec3>,
    /// Whether no light and no reflection can make a channel smaller.
    pub only_gains: bool,
}

impl Terms {
    /// Finds out what a surface, as it is [drawn], needs under all lights; with the pass switched off, every term that is not
    /// 0 by itself.
    pub(super) fn new(surface: &Surface, lights: &AllLights, settings: &Settings) -> Self {
        let is_on = settings.passes.contains(Pass::Terms);
        let gains = lights.gains(surface);
        let constant = constant(surface.ambient, gains).filter(|_| is_on);
        let is_needed = |coefficient: DVec3| {
            constant.is_none() && if is_on { lights.show(coefficient) } else { coefficient != DVec3::ZERO }
        };
        Self {
            diffuse: is_needed(surface.diffuse),
            specular: is_needed(surface.specular).then_some(surface.shininess),
            mirror: constant.is_none() && surface.reflectance > 0.0,
            constant,
            only_gains: gains.iter().all(|change| change.is_none_or(|is_gain| is_gain == Gain::Up)),
        }
    }

    /// Returns a surface without the terms that it does not need.
    fn reduce(&self, surface: &Surface) -> Surface {
        Surface {
            ambient: self.constant.unwrap_or(surface.ambient),
            diffuse: if self.diffuse { surface.diffuse } else { DVec3::ZERO },
            specular: if self.specular.is_some() { surface.specular } else { DVec3::ZERO },
            reflectance: if self.mirror { surface.reflectance } else { 0.0 },
            shininess: surface.shininess,
        }
    }
}

/// Takes out of surfaces what they do not need under these lights; nothing, when the pass is switched off.
pub(super) fn reduce<'p>(surfaces: &'p [Surface], lights: &[Light], settings: &Settings) -> Cow<'p, [Surface]> {
    if !settings.passes.contains(Pass::Terms) {
        return surfaces.into();
    }
    let lights = AllLights::new(lights);
    let reduced = |surface: &Surface| {
        let surface = drawn(surface, settings.part);
        Terms::new(&surface, &lights, settings).reduce(&surface)
    };
    let all = || surfaces.par_iter().with_min_len(SURFACES_PER_TASK);
    if all().all(|surface| n_terms(&reduced(surface)) == n_terms(&drawn(surface, settings.part))) {
        return surfaces.into();
    }
    all().map(reduced).collect::<Vec<_>>().into()
}

/// Returns a surface as the rules of `part` draw it.
pub(super) fn drawn(surface: &Surface, part: Part) -> Surface {
    match part {
        Part::A => Surface { ambient: DVec3::ZERO, specular: DVec3::ZERO, reflectance: 0.0, ..*surface },
        Part::B => *surface,
    }
}

/// Returns how many of the terms for diffuse and specular light and for reflection a surface has.
pub(super) fn n_terms(surface: &Surface) -> u64 {
    let terms = [surface.diffuse != DVec3::ZERO, surface.specular != DVec3::ZERO, surface.reflectance > 0.0];
    terms.into_iter().map(u64::from).sum()
}

/// What the lights of a scene can add in each channel.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct AllLights {
    /// Whether some light is above 0 there.
    has_bright: [bool; 3],
    /// Whether some light is below 0 there.
    has_dark: [bool; 3],
}

impl AllLights {
    pub fn new(lights: &[Light]) -> Self {
        let any = |is_so: fn(f64) -> bool| {
            std::array::from_fn(|channel| lights.iter().any(|light| is_so(light.color[channel])))
        };
        Self { has_bright: any(|color| color > 0.0), has_dark: any(|color| color < 0.0) }
    }

    /// Tells whether some light adds to a term with this coefficient, in some channel.
    fn show(&self, coefficient: DVec3) -> bool {
        (0..3).any(|channel| coefficient[channel] != 0.0 && (self.has_bright[channel] || self.has_dark[channel]))
    }

    /// Returns for each channel which way lights and reflection can move it; `None` is not at all.
    fn gains(&self, surface: &Surface) -> [Option<Gain>; 3] {
        std::array::from_fn(|channel| {
            let mut ways = [surface.reflectance > 0.0, false];
            for coefficient in [surface.diffuse[channel], surface.specular[channel]] {
                // The sign of the product, which may underflow.
                let (bright, dark) = (self.has_bright[channel], self.has_dark[channel]);
                ways[0] |= (coefficient > 0.0 && bright) || (coefficient < 0.0 && dark);
                ways[1] |= (coefficient > 0.0 && dark) || (coefficient < 0.0 && bright);
            }
            match ways {
                [false, false] => None,
                [true, false] => Some(Gain::Up),
                [false, true] => Some(Gain::Down),
                [true, true] => Some(Gain::Either),
            }
        })
    }
}

/// Which way the channels of a hit's colour can move from its ambient colour.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Gain {
    Up,
    Down,
    Either,
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

/// Tells whether a light may add to a hit on a surface in some channel; with the pass switched off, every light may to a
/// surface that answers light.
pub(super) fn answers(surface: &Surface, light: &Light, settings: &Settings) -> bool {
    let color = if settings.passes.contains(Pass::Terms) { light.color } else { DVec3::ONE };
    is_seen(surface.diffuse, color) || (settings.part == Part::B && is_seen(surface.specular, color))
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHITE: Light = Light { color: DVec3::ONE, position: DVec3::ZERO };
    const PLAIN: Surface =
        Surface { ambient: DVec3::ZERO, diffuse: DVec3::ZERO, specular: DVec3::ZERO, shininess: 1.0, reflectance: 0.0 };

    fn terms(surface: Surface, lights: &[Light]) -> Terms {
        Terms::new(&surface, &AllLights::new(lights), &Settings::default())
    }

    #[test]
    fn what_no_light_reaches_is_a_constant() {
        let red = Light { color: DVec3::X, ..WHITE };
        let blue = Surface { ambient: DVec3::new(0.5, 2.0, -1.0), diffuse: DVec3::Z, specular: DVec3::Y, ..PLAIN };
        let found = terms(blue, &[red]);
        assert_eq!((found.diffuse, found.specular), (false, None));
        assert_eq!(found.constant, Some(DVec3::new(0.5, 1.0, 0.0)));
        assert_eq!(terms(blue, &[red, WHITE]).constant, None);
        let all = Settings::default();
        let without = Settings { passes: all.passes.without(Pass::Terms), ..all.clone() };
        let part_a = Settings { part: Part::A, ..all.clone() };
        assert!(answers(&blue, &WHITE, &part_a) && !answers(&blue, &red, &all) && answers(&blue, &red, &without));
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
    #[test]
    fn surfaces_lose_what_they_do_not_need() {
        let (all, one) = (Settings::default(), [WHITE]);
        let full = Surface { ambient: DVec3::ONE, diffuse: DVec3::X, reflectance: 0.5, ..PLAIN };
        let plain = Surface { diffuse: DVec3::X, specular: DVec3::Y, reflectance: 0.5, ..PLAIN };
        let surfaces = [full, plain];
        let reduced = reduce(&surfaces, &one, &all);
        assert_eq!(*reduced, [Surface { ambient: DVec3::ONE, ..PLAIN }, plain]);
        assert!(matches!(reduce(&surfaces[1..], &one, &all), Cow::Borrowed(_)), "nothing to take out");
        let without = Settings { passes: all.passes.without(Pass::Terms), ..all.clone() };
        assert!(matches!(reduce(&surfaces, &one, &without), Cow::Borrowed(_)));
        let red = [Light { color: DVec3::X, ..WHITE }];
        assert_eq!(reduce(&surfaces, &red, &all)[1], Surface { specular: DVec3::ZERO, ..plain });
        let part_a = Settings { part: Part::A, ..all };
        assert!(
            matches!(reduce(&surfaces, &one, &part_a), Cow::Borrowed(_)),
            "the part leaves these terms out by itself"
        );
        let blue = Surface { diffuse: DVec3::Z, ..full };
        assert_eq!(*reduce(&[blue], &red, &part_a), [PLAIN]);
    }
}
