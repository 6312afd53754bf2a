//! What can be done to a scene without changing its image, or only turning it.

use super::sketch::{Finish, Item, Sketch};

/// A surface that is seen wherever it shows.
const GAUDY: Finish =
    Finish { ambient: [1.0, 0.0, 1.0], diffuse: [0.0; 3], specular: [1.0; 3], shininess: 1.0, reflectance: 1.0 };

/// An object counts as holding the eye if the eye is that much of its size outside: where roundings cannot reach.
const EYE_MARGIN: f64 = 1e-6;

impl Sketch {
    /// Returns the scene with every item replaced by those that `replace` makes of it.
    fn flat_map(&self, replace: impl FnMut(Item) -> Vec<Item>) -> Self {
        Self { items: self.items.iter().copied().flat_map(replace).collect(), ..*self }
    }

    /// Returns the scene with the positions of lights and spheres mapped, and without its cylinders.
    fn map_spheres(&self, map: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        self.flat_map(|item| match item {
            Item::Light { color, position } => vec![Item::Light { color, position: map(position) }],
            Item::Sphere { center, radius } => vec![Item::Sphere { center: map(center), radius }],
            Item::Surface(_) => vec![item],
            Item::Cylinder { .. } => Vec::new(),
        })
    }

    /// Returns the scene without its cylinders.
    pub fn spheres_alone(&self) -> Self {
        self.map_spheres(|position| position)
    }

    /// Returns the scene without its cylinders, turned about the view axis so that what was on the right is on top.
    pub fn quarter_turned(&self) -> Self {
        self.map_spheres(|[x, y, z]| [-y, x, z])
    }

    /// Returns the scene upside down: every y negated.
    pub fn upside_down(&self) -> Self {
        self.flat_map(|item| {
            vec![match item {
                Item::Light { color, position: [x, y, z] } => Item::Light { color, position: [x, -y, z] },
                Item::Sphere { center: [x, y, z], radius } => Item::Sphere { center: [x, -y, z], radius },
                Item::Cylinder { radius, x, z, y_min, y_max } => {
                    Item::Cylinder { radius, x, z, y_min: -y_max, y_max: -y_min }
                }
                Item::Surface(_) => item,
            }]
        })
    }

    /// Returns the scene with every cylinder cut in two at half its height, but for those that hold the eye: it would see
    /// the caps between the halves.
    pub fn with_split_cylinders(&self) -> Self {
        self.flat_map(|item| match item {
            Item::Cylinder { radius, x, z, y_min, y_max } if !holds_eye(&item) => {
                let middle = 0.5 * y_min + 0.5 * y_max;
                if !(y_min < middle && middle < y_max) {
                    return vec![item];
                }
                [[y_min, middle], [middle, y_max]]
                    .map(|[y_min, y_max]| Item::Cylinder { radius, x, z, y_min, y_max })
                    .to_vec()
            }
            _ => vec![item],
        })
    }

    /// Returns the scene with a gaudy ball inside of every object that does not hold the eye.
    pub fn with_hidden_balls(&self) -> Self {
        let mut filled = self.clone();
        filled.surface(GAUDY);
        for item in self.items.iter().filter(|item| !holds_eye(item)) {
            match *item {
                Item::Sphere { center: [x, y, z], radius } => {
                    filled.sphere([x + 0.3 * radius, y - 0.2 * radius, z + 0.25 * radius], 0.3 * radius);
                }
                Item::Cylinder { radius, x, z, y_min, y_max } => {
                    let y = 0.5 * y_min + 0.5 * y_max;
                    let hidden = 0.5 * (y - y_min).min(y_max - y).min(radius);
                    if hidden > 0.0 {
                        filled.sphere([x + 0.3 * radius, y, z - 0.2 * radius], hidden);
                    }
                }
                Item::Light { .. } | Item::Surface(_) => {}
            }
        }
        filled
    }

    /// Returns the scene with every light there twice, at half its colour.
    pub fn with_halved_lights(&self) -> Self {
        self.flat_map(|item| match item {
            Item::Light { color, position } => vec![Item::Light { color: color.map(|c| 0.5 * c), position }; 2],
            _ => vec![item],
        })
    }

    /// Returns the scene with lights twice as bright, on surfaces that answer half as much.
    pub fn with_brighter_lights(&self) -> Self {
        self.flat_map(|item| {
            vec![match item {
                Item::Light { color, position } => Item::Light { color: color.map(|c| 2.0 * c), position },
                Item::Surface(finish) => Item::Surface(Finish {
                    diffuse: finish.diffuse.map(|c| 0.5 * c),
                    specular: finish.specular.map(|c| 0.5 * c),
                    ..finish
                }),
                _ => item,
            }]
        })
    }
}

/// Tells whether the eye may be inside of an object or on it.
fn holds_eye(item: &Item) -> bool {
    let within = |distance: f64, radius: f64| distance <= radius * (1.0 + EYE_MARGIN);
    match *item {
        Item::Sphere { center: [x, y, z], radius } => within(x.hypot(y).hypot(z), radius),
        Item::Cylinder { radius, x, z, y_min, y_max } => {
            let margin = EYE_MARGIN * (y_max - y_min);
            within(x.hypot(z), radius) && y_min - margin <= 0.0 && 0.0 <= y_max + margin
        }
        Item::Light { .. } | Item::Surface(_) => false,
    }
}
