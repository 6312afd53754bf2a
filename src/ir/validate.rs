//! The door: a [`Program`] in, a [`Valid`] or the list of what is unsound out.
//!
//! Lowering reports what a person wrote wrong, with its place; this is for every other maker of programs, and the reason
//! why nothing behind it has to check a number again.

use std::ops::Deref;

use rustc_hash::FxHashMap;

use crate::ir::{Command, Program};

/// The identity of a surface equation: two surfaces are the same set of points exactly when their ids are equal.
///
/// A sphere is its centre and radius, a cylinder's wall its axis and radius whatever its height, a cap the plane y = const
/// whatever its axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct EquationId(u32);

impl EquationId {
    /// Returns the number that dumps show; equal numbers mean equal equations.
    #[must_use]
    pub const fn number(self) -> u32 {
        self.0
    }
}

/// The identity of every surface equation of a program.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Equations {
    /// For each sphere.
    pub spheres: Vec<EquationId>,
    /// For each cylinder its wall.
    pub walls: Vec<EquationId>,
    /// For each cylinder its caps: the planes y = y_min and y = y_max.
    pub caps: Vec<[EquationId; 2]>,
}

/// The coefficients of an equation by their bits, with −0 as 0. NaN marks what an equation does not have.
#[derive(PartialEq, Eq, Hash)]
struct EquationKey([u64; 4]);

impl EquationKey {
    fn new(coefficients: [f64; 4]) -> Self {
        Self(coefficients.map(|c| (c + 0.0).to_bits()))
    }
}

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

fn find_violations(program: &Program) -> Vec<Violation> {
    let mut found = Vec::new();
    let has_surface = |surface| program.surfaces.get(surface).is_some();
    for (i, light) in (0..).zip(program.lights.as_slice()) {
        if !(light.color.is_finite() && light.position.is_finite()) {
            found.push(Violation::LightNotFinite(i));
        }
    }
    for (i, s) in (0..).zip(program.surfaces.as_slice()) {
        let finite = s.ambient.is_finite() && s.diffuse.is_finite() && s.specular.is_finite();
        if !(finite && s.shininess.is_finite() && s.reflectance.is_finite() && s.shininess >= 0.0) {
            found.push(Violation::BadSurface(i));
        }
    }
    for (i, s) in (0..).zip(program.spheres.as_slice()) {
        if !(s.center.is_finite() && s.radius.is_finite() && s.radius > 0.0 && has_surface(s.surface)) {
            found.push(Violation::BadSphere(i));
        }
    }
    for (i, c) in (0..).zip(program.cylinders.as_slice()) {
        let finite = [c.radius, c.x, c.z, c.y_min, c.y_max].iter().all(|number| number.is_finite());
        if !(finite && c.radius > 0.0 && c.y_min < c.y_max && has_surface(c.surface)) {
            found.push(Violation::BadCylinder(i));
        }
    }
    find_bad_commands(program, &mut found);
    if !orders_are_dense(program) {
        found.push(Violation::BadOrder);
    }
    found
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
    let mut spheres = program.spheres.as_slice().iter().map(|s| s.order).peekable();
    let mut cylinders = program.cylinders.as_slice().iter().map(|c| c.order).peekable();
    let n_primitives = program.spheres.len() + program.cylinders.len();
    (0..n_primitives).all(|order| spheres.next_if_eq(&order).is_some() || cylinders.next_if_eq(&order).is_some())
}

fn identify_equations(program: &Program) -> Equations {
    // A sphere has one equation, a cylinder three.
    let n_equations = program.spheres.len() as usize + 3 * program.cylinders.len() as usize;
    let mut ids = FxHashMap::with_capacity_and_hasher(n_equations, rustc_hash::FxBuildHasher);
    let mut next_id = 0;
    let mut identify = |coefficients: [f64; 4]| {
        *ids.entry(EquationKey::new(coefficients)).or_insert_with(|| {
            next_id += 1;
            EquationId(next_id - 1)
        })
    };
    let spheres = program.spheres.as_slice();
    let cylinders = program.cylinders.as_slice();
    Equations {
        spheres: spheres.iter().map(|s| identify([s.center.x, s.center.y, s.center.z, s.radius])).collect(),
        walls: cylinders.iter().map(|c| identify([c.x, f64::NAN, c.z, c.radius])).collect(),
        caps: cylinders
            .iter()
            .map(|c| [c.y_min, c.y_max].map(|y| identify([f64::NAN, y, f64::NAN, f64::NAN])))
            .collect(),
    }
}
