//! The scene as one `write` sees it.

use glam::DVec3;

use crate::ir::{Command, Cylinder, Equations, Light, Sphere, Surface, Valid};

/// The field of view before any `fov`, in degrees.
const DEFAULT_FOV_DEG: f64 = 60.0;

/// What the commands so far have set: the state of the executor between two steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Registers {
    /// Vertical field of view, in degrees.
    pub fov_deg: f64,
    /// The colour of a ray that meets nothing.
    pub background: DVec3,
    /// Lights shown so far.
    pub n_lights: u32,
    /// Spheres shown so far.
    pub n_spheres: u32,
    /// Cylinders shown so far.
    pub n_cylinders: u32,
}

impl Default for Registers {
    fn default() -> Self {
        Self { fov_deg: DEFAULT_FOV_DEG, background: DVec3::ZERO, n_lights: 0, n_spheres: 0, n_cylinders: 0 }
    }
}

impl Registers {
    /// Carries out one command; a `write` sets nothing.
    pub fn step(&mut self, command: &Command) {
        match *command {
            Command::Fov(fov_deg) => self.fov_deg = fov_deg,
            Command::Background(background) => self.background = background,
            Command::Lights(n_lights) => self.n_lights = n_lights,
            Command::Spheres(n_spheres) => self.n_spheres = n_spheres,
            Command::Cylinders(n_cylinders) => self.n_cylinders = n_cylinders,
            Command::Write(_) => {}
        }
    }
}

/// The scene as it stands at one `write`: the arenas up to the lengths in the registers, nothing copied.
#[derive(Clone, Copy, Debug)]
pub struct SceneView<'p> {
    program: &'p Valid,
    registers: Registers,
}

impl<'p> SceneView<'p> {
    /// Freezes what `registers` show of `program`.
    ///
    /// # Panics
    /// When the registers show more than the program holds, or hold numbers that no valid program sets.
    #[must_use]
    pub fn new(program: &'p Valid, registers: Registers) -> Self {
        assert!(registers.n_lights <= program.lights.len());
        assert!(registers.n_spheres <= program.spheres.len());
        assert!(registers.n_cylinders <= program.cylinders.len());
        assert!(registers.fov_deg > 0.0 && registers.fov_deg < 180.0 && registers.background.is_finite());
        Self { program, registers }
    }

    /// Returns what the commands so far have set.
    #[must_use]
    pub fn registers(&self) -> &Registers {
        &self.registers
    }

    /// Returns the vertical field of view in degrees, above 0 and below 180.
    #[must_use]
    pub fn fov_deg(&self) -> f64 {
        self.registers.fov_deg
    }

    /// Returns the colour of a ray that meets nothing.
    #[must_use]
    pub fn background(&self) -> DVec3 {
        self.registers.background
    }

    /// Returns the lights, in order.
    #[must_use]
    pub fn lights(&self) -> &'p [Light] {
        &self.program.lights.as_slice()[..self.registers.n_lights as usize]
    }

    /// Returns the spheres, in order.
    #[must_use]
    pub fn spheres(&self) -> &'p [Sphere] {
        &self.program.spheres.as_slice()[..self.registers.n_spheres as usize]
    }

    /// Returns the cylinders, in order.
    #[must_use]
    pub fn cylinders(&self) -> &'p [Cylinder] {
        &self.program.cylinders.as_slice()[..self.registers.n_cylinders as usize]
    }

    /// Returns every surface of the program; handles of the primitives point into it.
    #[must_use]
    pub fn surfaces(&self) -> &'p [Surface] {
        self.program.surfaces.as_slice()
    }

    /// Returns the identities of the surface equations, index for index with spheres and cylinders.
    #[must_use]
    pub fn equations(&self) -> &'p Equations {
        self.program.equations()
    }
}
