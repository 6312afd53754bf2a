//! Scenes made by a test: a list of commands that can be scaled, printed as text and turned into a valid program.

use std::fmt::Write;

use clisc::ir::{self, Handle, Registers, SceneView, Valid};
use glam::DVec3;

/// A command that adds, and `surface`.
#[derive(Clone, Copy, Debug)]
pub enum Item {
    Light { color: [f64; 3], position: [f64; 3] },
    Surface(Finish),
    Sphere { center: [f64; 3], radius: f64 },
    Cylinder { radius: f64, x: f64, z: f64, y_min: f64, y_max: f64 },
}

/// The numbers of a `surface`.
#[derive(Clone, Copy, Debug)]
pub struct Finish {
    pub ambient: [f64; 3],
    pub diffuse: [f64; 3],
    pub specular: [f64; 3],
    pub shininess: f64,
    pub reflectance: f64,
}

/// A scene in the making. An object needs a surface before it.
#[derive(Clone, Debug)]
pub struct Sketch {
    pub fov_deg: f64,
    pub background: [f64; 3],
    pub items: Vec<Item>,
}

/// A sketch made valid, and what its one view shows.
pub struct Made {
    program: Valid,
    registers: Registers,
}

impl Made {
    /// Returns the whole scene.
    pub fn view(&self) -> SceneView<'_> {
        SceneView::new(&self.program, self.registers)
    }
}

impl Sketch {
    pub fn new(fov_deg: f64, background: [f64; 3]) -> Self {
        Self { fov_deg, background, items: Vec::new() }
    }

    pub fn light(&mut self, color: [f64; 3], position: [f64; 3]) -> &mut Self {
        self.items.push(Item::Light { color, position });
        self
    }

    pub fn surface(&mut self, finish: Finish) -> &mut Self {
        self.items.push(Item::Surface(finish));
        self
    }

    pub fn sphere(&mut self, center: [f64; 3], radius: f64) -> &mut Self {
        self.items.push(Item::Sphere { center, radius });
        self
    }

    pub fn cylinder(&mut self, radius: f64, [x, z]: [f64; 2], [y_min, y_max]: [f64; 2]) -> &mut Self {
        self.items.push(Item::Cylinder { radius, x, z, y_min, y_max });
        self
    }

    /// Returns the scene with every position and radius mapped.
    pub fn map_lengths(&self, map: impl Fn(f64) -> f64) -> Self {
        let mut mapped = self.clone();
        for item in &mut mapped.items {
            match item {
                Item::Light { position, .. } => *position = position.map(&map),
                Item::Surface(_) => {}
                Item::Sphere { center, radius } => {
                    *center = center.map(&map);
                    *radius = map(*radius);
                }
                Item::Cylinder { radius, x, z, y_min, y_max } => {
                    for length in [radius, x, z, y_min, y_max] {
                        *length = map(*length);
                    }
                }
            }
        }
        mapped
    }

    /// Returns the magnitude of the largest number that is a length.
    pub fn largest_length(&self) -> f64 {
        self.lengths().fold(0.0, |largest: f64, length| largest.max(length.abs()))
    }

    /// Tells whether every length is 0 or a normal number.
    pub fn is_normal(&self) -> bool {
        self.lengths().all(|length| length == 0.0 || length.is_normal())
    }

    /// Returns every position and radius.
    fn lengths(&self) -> impl Iterator<Item = f64> {
        self.items.iter().flat_map(|item| match *item {
            Item::Light { position, .. } => position.to_vec(),
            Item::Surface(_) => Vec::new(),
            Item::Sphere { center: [x, y, z], radius } => vec![x, y, z, radius],
            Item::Cylinder { radius, x, z, y_min, y_max } => vec![radius, x, z, y_min, y_max],
        })
    }

    /// Returns the objects, each with its surface, in order.
    fn objects(&self) -> Vec<[Item; 2]> {
        let mut surface = None;
        let mut objects = Vec::new();
        for &item in &self.items {
            match item {
                Item::Light { .. } => {}
                Item::Surface(_) => surface = Some(item),
                Item::Sphere { .. } | Item::Cylinder { .. } => {
                    objects.push([surface.expect("a surface before any object"), item]);
                }
            }
        }
        objects
    }

    /// Returns the scene with lights and objects declared in the opposite order.
    pub fn reversed(&self) -> Self {
        let lights = self.items.iter().rev().filter(|item| matches!(item, Item::Light { .. })).copied();
        let objects = self.objects().into_iter().rev().flatten();
        Self { items: objects.chain(lights).collect(), ..*self }
    }

    /// Returns the scene with every object declared a second time, with a surface of its own.
    pub fn with_copies(&self, finish: Finish) -> Self {
        let mut copied = self.clone();
        copied.surface(finish);
        copied.items.extend(self.objects().into_iter().map(|[_, object]| object));
        copied
    }

    /// Returns the scene seen in a mirror: every x negated.
    pub fn mirrored(&self) -> Self {
        let mut mirrored = self.clone();
        for item in &mut mirrored.items {
            match item {
                Item::Light { position: [x, ..], .. }
                | Item::Sphere { center: [x, ..], .. }
                | Item::Cylinder { x, .. } => {
                    *x = -*x;
                }
                Item::Surface(_) => {}
            }
        }
        mirrored
    }

    /// Makes the program that lowering would make of [`text`](Self::text).
    ///
    /// # Panics
    /// When a number is out of range or an object has no surface.
    pub fn make(&self) -> Made {
        let mut program = ir::Program::default();
        let mut order = 0;
        for item in &self.items {
            match *item {
                Item::Light { color, position } => {
                    program.lights.push(ir::Light { color: color.into(), position: position.into() });
                }
                Item::Surface(finish) => {
                    program.surfaces.push(ir::Surface {
                        ambient: finish.ambient.into(),
                        diffuse: finish.diffuse.into(),
                        specular: finish.specular.into(),
                        shininess: finish.shininess,
                        reflectance: finish.reflectance,
                    });
                }
                Item::Sphere { center, radius } => {
                    let surface = Handle::new(program.surfaces.len() - 1);
                    program.spheres.push(ir::Sphere { center: center.into(), radius, surface, order });
                    order += 1;
                }
                Item::Cylinder { radius, x, z, y_min, y_max } => {
                    let surface = Handle::new(program.surfaces.len() - 1);
                    program.cylinders.push(ir::Cylinder { radius, x, z, y_min, y_max, surface, order });
                    order += 1;
                }
            }
        }
        let registers = Registers {
            fov_deg: self.fov_deg,
            background: DVec3::from(self.background),
            n_lights: program.lights.len(),
            n_spheres: program.spheres.len(),
            n_cylinders: program.cylinders.len(),
        };
        let program = ir::validate(program).unwrap_or_else(|violations| panic!("{violations:?} in\n{}", self.text()));
        Made { program, registers }
    }

    /// Returns the scene as text that says the same numbers.
    pub fn text(&self) -> String {
        let mut text = String::new();
        let mut line = |name: &str, numbers: &[&[f64]]| {
            text.push_str(name);
            for number in numbers.iter().copied().flatten() {
                write!(text, " {number:?}").expect("a string takes any text");
            }
            text.push('\n');
        };
        line("fov", &[&[self.fov_deg]]);
        line("background", &[&self.background]);
        for item in &self.items {
            match item {
                Item::Light { color, position } => line("light", &[color, position]),
                Item::Surface(f) => {
                    let rest = [f.shininess, f.reflectance];
                    line("surface", &[&f.ambient, &f.diffuse, &f.specular, &rest]);
                }
                Item::Sphere { center, radius } => line("sphere", &[center, &[*radius]]),
                &Item::Cylinder { radius, x, z, y_min, y_max } => line("cylinder", &[&[radius, x, z, y_min, y_max]]),
            }
        }
        text.push_str("write scene.png\n");
        text
    }
}
