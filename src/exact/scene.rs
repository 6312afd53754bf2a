//! A scene, and what of it is needed in one arithmetic.

use std::cmp::Ordering;

use crate::exact::algebra::Kappa;
use crate::exact::ball::Ball;
use crate::exact::reach::Reach;
use crate::exact::real::{Arithmetic, Real};
use crate::exact::vec3::Vec3;
use crate::exact::{Part, Settings};
use crate::ir::{self, SceneView};

/// The equation of a surface, by its exact coefficients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Equation {
    /// Centre and radius.
    Sphere([f64; 4]),
    /// Axis x, z and radius.
    Wall([f64; 3]),
    /// y.
    Cap(f64),
}

/// A sphere, or a cylinder, as the IR has it.
#[derive(Clone, Copy, Debug)]
pub enum Body<'p> {
    Sphere(&'p ir::Sphere),
    Cylinder(&'p ir::Cylinder),
}

impl Body<'_> {
    fn order(self) -> u32 {
        match self {
            Self::Sphere(sphere) => sphere.order,
            Self::Cylinder(cylinder) => cylinder.order,
        }
    }

    /// Returns the number of its surface.
    pub fn surface_idx(self) -> usize {
        match self {
            Self::Sphere(sphere) => sphere.surface.index(),
            Self::Cylinder(cylinder) => cylinder.surface.index(),
        }
    }

    /// Returns the equation of the sphere or the infinite wall.
    fn equation(self) -> Equation {
        let Reach { center: [x, y, z], radius, .. } = self.reach();
        match self {
            Self::Sphere(_) => Equation::Sphere([x, y, z, radius]),
            Self::Cylinder(_) => Equation::Wall([x, z, radius]),
        }
    }

    /// Returns what it is to the filter in binary64.
    pub fn reach(self) -> Reach {
        match self {
            Self::Sphere(s) => Reach { center: s.center.to_array(), radius: s.radius, axes: &[0, 1, 2] },
            Self::Cylinder(c) => Reach { center: [c.x, 0.0, c.z], radius: c.radius, axes: &[0, 2] },
        }
    }

    /// Returns the sphere or the infinite wall.
    pub fn quadric(self, arithmetic: Arithmetic) -> Quadric {
        let Reach { center, radius, axes } = self.reach();
        Quadric { equation: self.equation(), center: arithmetic.vec3(center), radius: arithmetic.number(radius), axes }
    }

    /// Returns the caps: of a cylinder the lower and the upper.
    pub fn caps(self, arithmetic: Arithmetic) -> impl Iterator<Item = Cap> {
        let heights = match self {
            Self::Sphere(_) => None,
            Self::Cylinder(c) => Some([(c.y_min, -1.0), (c.y_max, 1.0)]),
        };
        heights.into_iter().flatten().map(move |(y, normal)| Cap { y: arithmetic.number(y), y_exact: y, normal })
    }

    /// Returns on which side of the sphere or the infinite wall a point lies: `Less` is inside, `Equal` on it. Nothing is
    /// rounded here, however long the numbers grow.
    pub fn side_of(self, point: [f64; 3]) -> Ordering {
        let Reach { center, radius, axes } = self.reach();
        let radius = Ball::unrounded(radius);
        let mut power = -&(&radius * &radius);
        for &axis in axes {
            let offset = &Ball::unrounded(point[axis]) - &Ball::unrounded(center[axis]);
            power = &power + &(&offset * &offset);
        }
        power.sign().expect("what is not rounded has a sign")
    }
}

/// A sphere |p − c|² = r², or an infinite wall, which leaves out y.
#[derive(Debug)]
pub struct Quadric {
    pub equation: Equation,
    pub center: Vec3,
    pub radius: Real,
    /// The axes that the equation has.
    pub axes: &'static [usize],
}

/// A cap of a cylinder.
#[derive(Debug)]
pub struct Cap {
    pub y: Real,
    /// The same, to compare with.
    pub y_exact: f64,
    /// The y of the outward normal: −1 for the lower cap, 1 for the upper.
    pub normal: f64,
}

/// A light.
#[derive(Debug)]
pub struct Light {
    pub color: Vec3,
    pub position: Vec3,
    /// The same, to compare with.
    pub position_exact: [f64; 3],
}

/// A surface.
#[derive(Debug)]
pub struct Surface {
    pub ambient: Vec3,
    pub diffuse: Vec3,
    pub specular: Vec3,
    pub shininess: f64,
    pub reflectance: Real,
}

/// Returns the bodies that are drawn, in the order of declaration.
pub fn bodies<'p>(view: &SceneView<'p>, part: Part) -> Vec<Body<'p>> {
    let cylinders = match part {
        Part::A => &[],
        Part::B => view.cylinders(),
    };
    let mut bodies: Vec<_> = view.spheres().iter().map(Body::Sphere).collect();
    bodies.extend(cylinders.iter().map(Body::Cylinder));
    bodies.sort_unstable_by_key(|body| body.order());
    bodies
}

/// Returns the equations of the surfaces, endless walls and planes of caps that hold a point, exactly.
pub fn holding(bodies: &[Body<'_>], point: [f64; 3]) -> Vec<Equation> {
    let mut equations: Vec<Equation> = Vec::new();
    let mut add = |equation: Equation| {
        if !equations.contains(&equation) {
            equations.push(equation);
        }
    };
    for body in bodies {
        if !body.reach().is_surely_off(point) && body.side_of(point) == Ordering::Equal {
            add(body.equation());
        }
        if let Body::Cylinder(cylinder) = body {
            [cylinder.y_min, cylinder.y_max]
                .into_iter()
                .filter(|&y| y == point[1])
                .map(Equation::Cap)
                .for_each(&mut add);
        }
    }
    equations
}

/// What of a scene is the same for all pixels, in one arithmetic.
#[derive(Debug)]
pub struct Scene {
    pub arithmetic: Arithmetic,
    /// From one step of the image to the next, at z = −1: k/N, where half the height of the image has N steps.
    pub step: Real,
    /// What algebra knows of k.
    pub kappa: Kappa,
    pub background: Vec3,
    pub lights: Vec<Light>,
    /// What cannot be told from 0 and has a larger bound need not be 0: see [`Attempt::sign`](crate::exact::attempt::Attempt::sign).
    pub vague: f64,
}

/// What cannot be told from 0 with the last of the precisions has a bound of 2⁻³⁰⁰⁰ or so of what it was made from, if it is 0.
/// Bounds that have grown to more than this share of the largest length, or of its fourth power as in a discriminant, have
/// lost most of their digits among mirrors.
const VAGUE_EXPONENT: i32 = -900;

/// Returns the bound above which numbers are vague in a scene of this size.
fn vague(view: &SceneView<'_>) -> f64 {
    let spheres = view.spheres().iter().map(|s| s.center.abs().max_element().max(s.radius));
    let walls = view.cylinders().iter().map(|c| c.x.abs().max(c.z.abs()).max(c.radius));
    let largest = spheres.chain(walls).fold(1.0, f64::max);
    libm::ldexp(1.0, VAGUE_EXPONENT + 4 * libm::ilogb(largest))
}

impl Scene {
    /// Takes what a view shows.
    pub fn new(view: &SceneView<'_>, settings: &Settings, arithmetic: Arithmetic) -> Self {
        let color = |v: glam::DVec3| arithmetic.forgetful().vec3(v.to_array());
        let lights = view.lights().iter().map(|light| Light {
            color: color(light.color),
            position: arithmetic.vec3(light.position.to_array()),
            position_exact: light.position.to_array(),
        });
        let (half_width, kappa) = arithmetic.half_width(view.fov_deg());
        let n_steps = f64::from(settings.samples) * f64::from(settings.height);
        Self {
            arithmetic,
            step: &half_width / &arithmetic.number(n_steps),
            kappa,
            background: color(view.background()),
            lights: lights.collect(),
            vague: vague(view),
        }
    }
}

impl Surface {
    /// Takes a surface as the IR has it.
    pub fn new(surface: &ir::Surface, arithmetic: Arithmetic) -> Self {
        let vec3 = |v: glam::DVec3| arithmetic.vec3(v.to_array());
        Self {
            ambient: vec3(surface.ambient),
            diffuse: vec3(surface.diffuse),
            specular: vec3(surface.specular),
            shininess: surface.shininess,
            reflectance: arithmetic.number(surface.reflectance),
        }
    }
}

impl Quadric {
    /// Returns |p − c|² − r²: below 0 inside, 0 on the surface.
    pub fn at(&self, p: &Vec3) -> Real {
        let offset = self.offset(p);
        &self.dot(&offset, &offset) - &(&self.radius * &self.radius)
    }

    /// Returns p − c, 0 along y for a wall.
    pub fn offset(&self, p: &Vec3) -> Vec3 {
        [0, 1, 2].map(
            |axis| {
                if self.axes.contains(&axis) { &p[axis] - &self.center[axis] } else { self.radius.like(0.0) }
            },
        )
    }

    /// Returns the dot product over the equation's axes.
    pub fn dot(&self, a: &Vec3, b: &Vec3) -> Real {
        let products = self.axes.iter().map(|&axis| &a[axis] * &b[axis]);
        products.reduce(|sum, product| &sum + &product).expect("a quadric has axes")
    }
}

impl Cap {
    /// Turns a length along y so that it is above 0 into the cylinder.
    pub fn inward(&self, along_y: &Real) -> Real {
        if self.normal < 0.0 { along_y.clone() } else { -along_y }
    }
}
