//! Rule `too-bright`.

use glam::DVec3;

use crate::diag::Diagnostic;
use crate::ir::{self, Arena, Program, SceneView, Surface};
use crate::lint::context::{RuleContext, views};
use crate::lint::registry::declare_rule;
use crate::lint::sight::{eye_ray, first_met};
use crate::plan::{Object, Settings, Size, plan};
use crate::trace::Tracer;

declare_rule! {
    /// Finds a surface whose ambient and diffuse colour are together above 1, where an image shows much of it cut off at full
    /// brightness.
    ///
    /// ## Why
    ///
    /// Where such a surface faces a light it is all of one colour: there its shape is lost.
    ///
    /// ## Example
    ///
    /// ```cli
    /// fov 60
    /// light 1 1 1  0 0 5
    /// surface 0.6 0 0  0.9 0.2 0.2  0 0 0  1  0
    /// sphere 0 0 -4  1
    /// write ball.png
    /// ```
    ///
    /// ## Instead
    ///
    /// ```cli
    /// fov 60
    /// light 1 1 1  0 0 5
    /// surface 0.1 0 0  0.8 0.2 0.2  0 0 0  1  0
    /// sphere 0 0 -4  1
    /// write ball.png
    /// ```
    ///
    /// ## Fix safety
    ///
    /// There is no fix: which of the terms is too much is not known.
    ///
    /// ## Limits
    ///
    /// A surface is reported when more than a quarter of what is seen of it is cut off. Highlights and mirror images do not
    /// count: they are often at full brightness, and meant so. Nor do several lights that are too bright together. The image
    /// looked at has 100×100 pixels, and scenes of more than a thousand objects are not. Values outside 0 to 1 are reported by
    /// themselves.
    pub static TOO_BRIGHT = {
        id: "L0401", name: "too-bright", title: "a surface that returns more light than it gets", fix: None,
    }
}

/// The share of what is seen of a surface that has to be cut off.
const MIN_SHARE: f64 = 0.25;

/// Scenes of more objects are not looked at.
const MAX_OBJECTS: usize = 1000;

/// The sides of the image that is looked at, in pixels.
const SIDE: u32 = 100;

fn check(cx: &RuleContext<'_>, acc: &mut Vec<Diagnostic>) {
    let (Some(program), Some(scene)) = (cx.program, cx.scene) else { return };
    let surfaces = cx.used_surfaces();
    let is_usual = |numbers: DVec3| numbers.to_array().iter().all(|number| (0.0..=1.0).contains(number));
    let lights_are_usual = scene.lights().iter().all(|light| is_usual(light.color));
    let n_objects = scene.spheres().len() + scene.cylinders().len();
    let is_suspect = |surface: &Surface| {
        brightness(surface).max_element() > 1.0 && [surface.ambient, surface.diffuse].into_iter().all(is_usual)
    };
    let suspects: Vec<_> = surfaces.into_iter().filter(|(_, surface)| is_suspect(surface)).collect();
    if suspects.is_empty() || !lights_are_usual || n_objects > MAX_OBJECTS {
        return;
    }
    let Ok(matte) = ir::validate(matte(program)) else { return };
    let Some(scene) = views(&matte).pop() else { return };
    let shares = saturated_shares(&scene);
    let mut told: Vec<Surface> = Vec::new();
    for (place, surface) in suspects.into_iter().map(|(place, surface)| (place, dull(surface))) {
        if told.contains(&surface) {
            continue;
        }
        let share = shares.iter().find(|(known, _)| **known == surface).map_or(0.0, |(_, share)| *share);
        if share > MIN_SHARE {
            let most = brightness(&surface).max_element();
            let message = format!("this `surface` returns up to {most:.2} times the light that it gets");
            let percent = (share * 100.0).round();
            acc.push(
                Diagnostic::new(&TOO_BRIGHT.code, place, message)
                    .label(format!("{percent} % of what is seen of it is cut off"))
                    .help("lower its ambient or diffuse colour until they are together at most 1"),
            );
        }
        told.push(surface);
    }
}

/// Returns for each channel the most of the light of one white lamp that a surface returns, but for its highlight.
fn brightness(surface: &Surface) -> DVec3 {
    surface.ambient + surface.diffuse
}

/// Returns a surface without its highlight and its mirror image.
fn dull(surface: &Surface) -> Surface {
    Surface { specular: DVec3::ZERO, reflectance: 0.0, ..*surface }
}

/// Returns a program with all surfaces dull.
fn matte(program: &Program) -> Program {
    let mut matte = Program { surfaces: Arena::default(), ..program.clone() };
    for surface in program.surfaces.as_slice() {
        matte.surfaces.push(dull(surface));
    }
    matte
}

/// Returns for each surface that is seen the share of its pixels in which a channel with too much brightness is full.
fn saturated_shares<'a>(scene: &SceneView<'a>) -> Vec<(&'a Surface, f64)> {
    let settings = Settings { size: Size::new(SIDE, SIDE).unwrap_or_default(), ..Settings::default() };
    let mut rgb = vec![0; (SIDE * SIDE * 3) as usize];
    Tracer::new(plan(*scene, &settings)).render_rows(0..SIDE, &mut rgb);
    let mut counts: Vec<(&Surface, [f64; 2])> = Vec::new();
    for (i, pixel) in (0..).zip(rgb.as_chunks::<3>().0) {
        let at = |step: u32| 2.0 * f64::from(step) / f64::from(SIDE) - 1.0;
        let Some((object, _)) = first_met(scene, eye_ray(scene, &settings, [at(i % SIDE), -at(i / SIDE)])) else {
            continue;
        };
        let surface = surface_of(scene, object);
        let brightness = brightness(surface);
        let is_full = (0..3).any(|channel| pixel[channel] == u8::MAX && brightness[channel] > 1.0);
        let place = counts.iter().position(|(known, _)| *known == surface);
        let place = place.unwrap_or_else(|| {
            counts.push((surface, [0.0; 2]));
            counts.len() - 1
        });
        counts[place].1[0] += f64::from(u8::from(is_full));
        counts[place].1[1] += 1.0;
    }
    counts.into_iter().map(|(surface, [n_full, n])| (surface, n_full / n)).collect()
}

fn surface_of<'a>(scene: &SceneView<'a>, object: Object) -> &'a Surface {
    let handle = match object {
        Object::Sphere(i) => scene.spheres()[i as usize].surface,
        Object::Cylinder(i) => scene.cylinders()[i as usize].surface,
    };
    &scene.surfaces()[handle.index()]
}
