//! The door: a [`Program`] in, a [`Valid`] or the list of what is unsound out.
//!
//! Lowering reports what a person wrote wrong, with its place; this is for every other maker of programs, and the reason
//! why nothing behind it has to check a number again.

use std::ops::Deref;

use rayon::prelude::*;

use crate::ir::equations::{Equations, identify_equations};
use crate::ir::{Command, Program, Sphere};

/// One way in which a program is unsound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Violation {
    /// A number of the light with this index is infinite or NaN.
    LightNotFinite(u32),
    /// A number of the surface with this index is infinite or NaN, or its shininess is negative.
    BadSurface(u32),
    /// A number of the sphere with this index is infinite or NaN, its radius is not above 0, or its surface is missing.
    BadSphere(u32),
    /// A number of the cylinder with this index is infinite or NaN, its radius is not above 0, `y_min` is not below
    /// `y_max`, or its surface is missing.
    BadCylinder(u32),
    /// The command with this index sets an angle outside 0…180, a colour that is not finite, or a length beyond its arena
    /// or below an earlier one.
    BadCommand(u32),
    /// The orders of declaration are not 0, 1, 2, … over all primitives, rising within each arena.
    BadOrder,
}

impl std::fmt::Display for Violation {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::LightNotFinite(i) => write!(f, "light {i} has a number that is not finite"),
            Self::BadSurface(i) => write!(f, "surface {i} has a number out of range"),
            Self::BadSphere(i) => write!(f, "sphere {i} has a number out of range or no surface"),
            Self::BadCylinder(i) => write!(f, "cylinder {i} has a number out of range or no surface"),
            Self::BadCommand(i) => write!(f, "command {i} has a number out of range"),
            Self::BadOrder => write!(f, "the primitives are not numbered in the order of declaration"),
        }
    }
}

impl std::error::Error for Violation {}

/// A program that is proved sound: all numbers finite, radii above 0, handles and lengths in range.
#[derive(Clone, Debug)]
pub struct Valid {
    program: Program,
    equations: Equations,
}

impl Valid {
    /// Returns the identities of the surface equations.
    #[must_use]
    pub fn equations(&self) -> &Equations {
        &self.equations
    }
}

impl Deref for Valid {
    type Target = Program;

    fn deref(&self) -> &Program {
        &self.program
    }
}

/// Proves a program sound and gives equal surface equations one identity.
///
/// # Errors
/// Every violation, in the order of arenas and commands.
pub fn validate(program: Program) -> Result<Valid, Vec<Violation>> {
    let violations = find_violations(&program);
    if !violations.is_empty() {
        return Err(violations);
    }
    let equations = identify_equations(&program);
    Ok(Valid { program, equations })
}

/// From so many items on it pays to wake the other threads.
const MANY: usize = 1 << 14;

fn find_violations(program: &Program) -> Vec<Violation> {
    let has_surface = |surface| program.surfaces.get(surface).is_some();
    let mut found = find_bad(program.lights.as_slice(), Violation::LightNotFinite, |light| {
        light.color.is_finite() && light.position.is_finite()
    });
    found.extend(find_bad(program.surfaces.as_slice(), Violation::BadSurface, |s| {
        let finite = s.ambient.is_finite() && s.diffuse.is_finite() && s.specular.is_finite();
        finite && s.shininess.is_finite() && s.reflectance.is_finite() && s.shininess >= 0.0
    }));
    found.extend(find_bad(program.spheres.as_slice(), Violation::BadSphere, |s| {
        s.center.is_finite() && s.radius.is_finite() && s.radius > 0.0 && has_surface(s.surface)
    }));
    found.extend(find_bad(program.cylinders.as_slice(), Violation::BadCylinder, |c| {
        let finite = [c.radius, c.x, c.z, c.y_min, c.y_max].iter().all(|number| number.is_finite());
        finite && c.radius > 0.0 && c.y_min < c.y_max && has_surface(c.surface)
    }));
    find_bad_commands(program, &mut found);
    if !orders_are_dense(program) {
        found.push(Violation::BadOrder);
    }
    found
}

/// Returns the violation of each item that is not sound, in order.
fn find_bad<T: Sync>(
    items: &[T],
    violation: fn(u32) -> Violation,
    is_sound: impl Fn(&T) -> bool + Sync,
) -> Vec<Violation> {
    let bad = |(i, item): (usize, &T)| (!is_sound(item)).then(|| violation(i as u32));
    if items.len() < MANY {
        items.iter().enumerate().filter_map(bad).collect()
    } else {
        items.par_iter().enumerate().filter_map(bad).collect()
    }
}

fn find_bad_commands(program: &Program, found: &mut Vec<Violation>) {
    let (mut n_lights, mut n_spheres, mut n_cylinders) = (0, 0, 0);
    let grows = |shown: &mut u32, to: u32, len: u32| {
        let ok = *shown <= to && to <= len;
        *shown = to;
        ok
    };
    for (i, command) in (0..).zip(&program.commands) {
        let ok = match *command {
            Command::Fov(fov_deg) => fov_deg > 0.0 && fov_deg < 180.0,
            Command::Background(color) => color.is_finite(),
            Command::Lights(n) => grows(&mut n_lights, n, program.lights.len()),
            Command::Spheres(n) => grows(&mut n_spheres, n, program.spheres.len()),
            Command::Cylinders(n) => grows(&mut n_cylinders, n, program.cylinders.len()),
            Command::Write(_) => true,
        };
        if !ok {
            found.push(Violation::BadCommand(i));
        }
    }
}

/// Tells whether the orders are those of a merge of the two arenas.
fn orders_are_dense(program: &Program) -> bool {
    let (spheres, cylinders) = (program.spheres.as_slice(), program.cylinders.as_slice());
    let n_head = spheres.len().min(cylinders.first().map_or(spheres.len(), |first| first.order as usize));
    let (head, tail) = spheres.split_at(n_head);
    let mut spheres = tail.iter().map(|s| s.order).peekable();
    let mut cylinders = cylinders.iter().map(|c| c.order).peekable();
    let n_primitives = program.spheres.len() + program.cylinders.len();
    is_counted(head)
        && (n_head as u32..n_primitives)
            .all(|order| spheres.next_if_eq(&order).is_some() || cylinders.next_if_eq(&order).is_some())
}

/// Tells whether the orders of the spheres are 0, 1, 2, …
fn is_counted(spheres: &[Sphere]) -> bool {
    let is_next = |(i, sphere): (usize, &Sphere)| sphere.order as usize == i;
    if spheres.len() < MANY {
        spheres.iter().enumerate().all(is_next)
    } else {
        spheres.par_iter().enumerate().all(is_next)
    }
}
