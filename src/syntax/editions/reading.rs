//! One line under one form: whether it fits, and whether what it then says makes sense.

use crate::source::{Source, Span};
use crate::syntax::editions::{Edition, Form, forms_of};
use crate::syntax::lexer::{lex_line, lines};
use crate::syntax::parser::read_arguments;
use crate::syntax::spec::CommandKind;
use crate::syntax::token::Token;

/// How a line reads under an edition.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Reading {
    /// It is a command as scenes have it.
    Fine,
    /// It is a command, but says what hardly a scene says.
    Odd,
    /// It is no command.
    Wrong,
}

/// A line with a command, or with what should be one.
#[derive(Clone, Debug)]
pub(super) struct Line<'s> {
    /// Its first word.
    pub(super) name: &'s str,
    /// From its name to its last argument.
    pub(super) span: Span,
    /// Each form that fits, with the numbers.
    fitting: Vec<(&'static Form, Vec<f64>)>,
}

/// Reads the lines of a scene under all forms. Lines with characters that no edition takes are left out, and so is what
/// follows the first `max` commands.
pub(super) fn read_lines(source: &Source, max: usize) -> Vec<Line<'_>> {
    let mut read = Vec::new();
    let mut tokens: Vec<Token> = Vec::new();
    for line in lines(source.text(), 0) {
        let mut is_foreign = false;
        tokens.clear();
        lex_line(line.text, line.start, |token| {
            is_foreign |= token.kind.is_foreign();
            if token.kind.is_significant() {
                tokens.push(token);
            }
        });
        if let ([name, args @ ..], false) = (tokens.as_slice(), is_foreign) {
            read.push(Line::new(source, name, args));
        }
        if read.len() == max {
            break;
        }
    }
    read
}

impl<'s> Line<'s> {
    fn new(source: &'s Source, name: &Token, args: &[Token]) -> Self {
        let span = args.last().map_or(name.span, |last| name.span.to(last.span));
        let name = source.slice(name.span);
        let fit = |form: &'static Form| {
            let numbers = read_arguments(source, &form.arguments, args)?[..form.numbers().len()].to_vec();
            form.allows(&numbers).then_some((form, numbers))
        };
        Self { name, span, fitting: forms_of(name).filter_map(fit).collect() }
    }

    /// Returns the form in which an edition reads the line, and the numbers, if it does.
    pub(super) fn form(&self, edition: Edition) -> Option<(&'static Form, &[f64])> {
        let (form, numbers) = self.fitting.iter().find(|(form, _)| form.editions.has(edition))?;
        Some((form, numbers))
    }

    /// Judges the line under an edition. `camera` is that of the scene in this edition.
    pub(super) fn under(&self, edition: Edition, camera: &Camera) -> Reading {
        match self.form(edition) {
            None => Reading::Wrong,
            Some((form, numbers)) if is_sensible(form, numbers, camera) => Reading::Fine,
            Some(_) => Reading::Odd,
        }
    }

    /// Tells whether the line is a light of an edition that is brighter than usual, but not as if its place came first.
    pub(super) fn is_just_bright(&self, edition: Edition) -> bool {
        let light = self.form(edition).and_then(|(form, numbers)| light_parts(form, numbers));
        light.is_some_and(|[color, place]| !is_color(color) && !is_place_before_color(color, place))
    }
}

/// Tells whether a command of this form, in a scene with the usual camera, would hold such numbers and make sense.
pub(super) fn is_plausible(form: &Form, numbers: &[f64]) -> bool {
    let are_usual = || form.numbers().iter().zip(numbers).all(|(arg, number)| arg.range.expects(*number));
    form.allows(numbers)
        && are_usual()
        && is_sensible(form, numbers, &Camera::default())
        && !adds_nothing(form, numbers)
}

/// Tells whether a command is a black light.
fn adds_nothing(form: &Form, numbers: &[f64]) -> bool {
    light_parts(form, numbers).is_some_and(|[color, _]| color == [0.0; 3])
}

/// Tells whether scenes usually hold such numbers in this form: the colour of a light in 0…1, a sphere in view.
fn is_sensible(form: &Form, numbers: &[f64], camera: &Camera) -> bool {
    if let Some([color, _]) = light_parts(form, numbers) {
        return is_color(color);
    }
    sphere_parts(form, numbers).is_none_or(|(center, radius)| camera.sees(center, radius))
}

/// Returns the colour and the place of a light.
fn light_parts(form: &Form, numbers: &[f64]) -> Option<[[f64; 3]; 2]> {
    let &[a, b, c, d, e, f] = numbers else { return None };
    let (first, second) = ([a, b, c], [d, e, f]);
    let has_color_first = form.numbers().first().is_some_and(|arg| arg.name == "r");
    let parts = if has_color_first { [first, second] } else { [second, first] };
    (form.name == CommandKind::Light.name()).then_some(parts)
}

/// Returns the centre and the radius of a sphere.
fn sphere_parts(form: &Form, numbers: &[f64]) -> Option<([f64; 3], f64)> {
    let &[a, b, c, d] = numbers else { return None };
    let has_radius_first = form.numbers().first().is_some_and(|arg| arg.name == "radius");
    let parts = if has_radius_first { ([b, c, d], a) } else { ([a, b, c], d) };
    (form.name == CommandKind::Sphere.name()).then_some(parts)
}

/// Tells whether the colour and the place of a light look like the other: the numbers in the place of a colour make none,
/// and those in the place of its place would. A light brighter than 1 is none, unless all else says so.
#[must_use]
pub fn is_place_before_color(color: [f64; 3], place: [f64; 3]) -> bool {
    let n_lit = place.iter().filter(|channel| **channel > 0.0).count();
    let has_negative = color.iter().any(|channel| *channel < 0.0);
    let is_swapped = is_color(place) && !is_color(color);
    is_swapped && ((has_negative && n_lit > 0) || (n_lit >= 2 && !is_in_bytes(color)))
}

/// Tells whether three numbers are the channels of a colour as scenes usually have it.
fn is_color(channels: [f64; 3]) -> bool {
    channels.iter().all(|channel| (0.0..=1.0).contains(channel))
}

/// Tells whether those of three numbers that make no channel look like channels from 0 to 255.
fn is_in_bytes(color: [f64; 3]) -> bool {
    // A light of 2 or 10 is meant as one; above this a scale to 255 is likelier.
    const LEAST: f64 = 16.0;
    let is_byte = |number: &f64| *number >= 0.0 && *number <= 255.0 && (number.fract() == 0.0 || *number <= 1.0);
    color.iter().all(is_byte) && color.iter().any(|number| *number >= LEAST)
}

/// From where a scene is seen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Camera {
    eye: [f64; 3],
    /// To the right, up, and towards the viewer.
    axes: [[f64; 3]; 3],
    /// Half of the height of the image at distance 1.
    k: f64,
}

impl Default for Camera {
    fn default() -> Self {
        Self::new([0.0; 3], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], 60.0)
    }
}

impl Camera {
    fn new(eye: [f64; 3], axes: [[f64; 3]; 3], fov_deg: f64) -> Self {
        Self { eye, axes, k: libm::tan(fov_deg.to_radians() / 2.0) }
    }

    /// Returns the camera that the last commands set which an edition has for that.
    pub(super) fn of(scene: &[Line<'_>], edition: Edition) -> Self {
        let last = |name: &str| {
            let mut lines = scene.iter().rev().filter(|line| line.name == name);
            lines.find_map(|line| line.form(edition)).map(|(_, numbers)| numbers)
        };
        let eye = match last("eye") {
            Some(&[x, y, z]) => [x, y, z],
            _ => [0.0; 3],
        };
        let axes = match last("uvw") {
            Some(&[ux, uy, uz, vx, vy, vz, wx, wy, wz]) => [[ux, uy, uz], [vx, vy, vz], [wx, wy, wz]],
            _ => Self::default().axes,
        };
        let fov_deg = last(CommandKind::Fov.name()).map_or(60.0, |numbers| numbers[0]);
        Self::new(eye, axes, fov_deg)
    }

    /// Tells whether part of a sphere lies in the view of a square image, roughly: its centre is ahead, and no farther to a
    /// side than the view is wide and its radius long.
    fn sees(&self, center: [f64; 3], radius: f64) -> bool {
        let from_eye = [0, 1, 2].map(|i| center[i] - self.eye[i]);
        let along = |axis: [f64; 3]| (0..3).map(|i| axis[i] * from_eye[i]).sum::<f64>();
        let [right, up, behind] = self.axes.map(along);
        let half = -behind * self.k + radius * (1.0 + self.k);
        behind < 0.0 && right.abs() <= half && up.abs() <= half
    }
}
