//! A scene at one precision.

use std::cmp::Ordering;

use clisc::ir::SceneView;

use super::ball::Ball;
use super::reach::Reach;
use super::vec3::Vec3;

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

/// A sphere |p − c|² = r², or an infinite wall, which leaves out y.
pub struct Quadric {
    pub equation: Equation,
    pub center: Vec3,
    pub radius: Ball,
    /// The axes that the equation has.
    pub axes: &'static [usize],
}

/// A cap of a cylinder.
pub struct Cap {
    pub y: Ball,
    /// The same, to compare with.
    pub y_exact: f64,
    /// The y of the outward normal: −1 for the lower cap, 1 for the upper.
    pub normal: f64,
}

/// A sphere, or a cylinder, which has two caps.
pub struct Primitive {
    pub quadric: Quadric,
    pub caps: Vec<Cap>,
    pub surface: usize,
    pub reach: Reach,
    /// For each light, which side of the quadric it is on; `Equal` is on the surface, `None` cannot be told.
    pub light_sides: Vec<Option<Ordering>>,
}

/// A light.
pub struct Light {
    pub color: Vec3,
    pub position: Vec3,
    /// The position's y, to compare with.
    pub y_exact: f64,
}

/// A surface.
pub struct Surface {
    pub ambient: Vec3,
    pub diffuse: Vec3,
    pub specular: Vec3,
    pub shininess: f64,
    pub reflectance: Ball,
}

/// A scene whose numbers are balls.
pub struct Scene {
    pub bits: usize,
    /// tan(fov · π / 360)
    pub k: Ball,
    pub background: Vec3,
    pub lights: Vec<Light>,
    pub surfaces: Vec<Surface>,
    /// In the order of declaration.
    pub primitives: Vec<Primitive>,
}

impl Scene {
    /// Takes what a view shows to `bits` of precision.
    pub fn new(view: &SceneView<'_>, bits: usize) -> Self {
        let ball = |x: f64| Ball::exact(x, bits);
        let vec3 = |v: glam::DVec3| v.to_array().map(ball);
        let lights = view.lights().iter().map(|light| Light {
            color: vec3(light.color),
            position: vec3(light.position),
            y_exact: light.position.y,
        });
        let surfaces = view.surfaces().iter().map(|surface| Surface {
            ambient: vec3(surface.ambient),
            diffuse: vec3(surface.diffuse),
            specular: vec3(surface.specular),
            shininess: surface.shininess,
            reflectance: ball(surface.reflectance),
        });
        let spheres = view.spheres().iter().map(|s| {
            let [x, y, z] = s.center.to_array();
            let quadric = Quadric {
                equation: Equation::Sphere([x, y, z, s.radius]),
                center: [x, y, z].map(ball),
                radius: ball(s.radius),
                axes: &[0, 1, 2],
            };
            let reach = Reach { center: [x, y, z], radius: s.radius, axes: quadric.axes };
            (s.order, quadric, Vec::new(), s.surface, reach)
        });
        let cylinders = view.cylinders().iter().map(|c| {
            let quadric = Quadric {
                equation: Equation::Wall([c.x, c.z, c.radius]),
                center: [c.x, 0.0, c.z].map(ball),
                radius: ball(c.radius),
                axes: &[0, 2],
            };
            let caps = [(c.y_min, -1.0), (c.y_max, 1.0)].map(|(y, normal)| Cap { y: ball(y), y_exact: y, normal });
            let reach = Reach { center: [c.x, 0.0, c.z], radius: c.radius, axes: quadric.axes };
            (c.order, quadric, Vec::from(caps), c.surface, reach)
        });
        let lights: Vec<_> = lights.collect();
        let mut ordered: Vec<_> = spheres.chain(cylinders).collect();
        ordered.sort_by_key(|&(order, ..)| order);
        let primitives = ordered.into_iter().map(|(_, quadric, caps, surface, reach)| {
            let light_sides = lights.iter().map(|light| quadric.at(&light.position).sign()).collect();
            Primitive { quadric, caps, surface: surface.index(), reach, light_sides }
        });
        Self {
            bits,
            k: Ball::tan_half_degrees(view.fov_deg(), bits),
            background: vec3(view.background()),
            surfaces: surfaces.collect(),
            primitives: primitives.collect(),
            lights,
        }
    }
}

impl Quadric {
    /// Returns |p − c|² − r²: below 0 inside, 0 on the surface.
    pub fn at(&self, p: &Vec3) -> Ball {
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
    pub fn dot(&self, a: &Vec3, b: &Vec3) -> Ball {
        let products = self.axes.iter().map(|&axis| &a[axis] * &b[axis]);
        products.reduce(|sum, product| &sum + &product).expect("a quadric has axes")
    }
}

impl Cap {
    /// Turns a length along y so that it is above 0 into the cylinder.
    pub fn inward(&self, along_y: &Ball) -> Ball {
        if self.normal < 0.0 { along_y.clone() } else { -along_y }
    }
}
