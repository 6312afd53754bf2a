//! A ray tracer written from `grammar/semantics.md` alone, in plain binary64.
//!
//! It shares no code with clisc, not even the reader of scenes, and follows the page section by section. It is what a
//! student may write; nothing of it is made to be fast.

use glam::DVec3;

/// What an image is asked for, besides its scene.
#[derive(Clone, Debug)]
pub struct Request {
    pub width: u32,
    pub height: u32,
    pub is_part_a: bool,
    /// N of the N×N samples a pixel.
    pub samples: u32,
    pub is_centred: bool,
    /// The last level that is shaded.
    pub max_level: u32,
}

/// A scene as it stands at a `write`.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    pub fov: f64,
    pub background: DVec3,
    pub lights: Vec<Light>,
    pub objects: Vec<Object>,
}

#[derive(Clone, Copy, Debug)]
pub struct Light {
    pub color: DVec3,
    pub position: DVec3,
}

#[derive(Clone, Copy, Debug, Default)]
pub struct Surface {
    pub ambient: DVec3,
    pub diffuse: DVec3,
    pub specular: DVec3,
    pub shininess: f64,
    pub reflectance: f64,
}

#[derive(Clone, Copy, Debug)]
pub struct Object {
    shape: Shape,
    pub surface: Surface,
}

#[derive(Clone, Copy, Debug)]
enum Shape {
    Sphere { center: DVec3, radius: f64 },
    Cylinder { radius: f64, x: f64, z: f64, y_min: f64, y_max: f64 },
}

/// What two surfaces share that lie in each other.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Equation {
    Sphere(DVec3, f64),
    Wall(f64, f64, f64),
    Plane(f64),
}

#[derive(Clone, Copy, Debug)]
pub struct Ray {
    pub origin: DVec3,
    pub dir: DVec3,
    /// The surface that the ray starts on: t = 0 is a root of its equation, and no hit.
    leaves: Option<Equation>,
}

#[derive(Clone, Copy, Debug)]
pub struct Hit {
    pub t: f64,
    pub point: DVec3,
    /// Turned against the ray.
    pub normal: DVec3,
    pub surface: Surface,
    equation: Equation,
}

impl Scene {
    /// Reads a scene up to the `write` of this name. The scene is known to be right.
    pub fn read(text: &str, write: &str) -> Self {
        let mut scene = Self { fov: 60.0, ..Self::default() };
        let mut surface = Surface::default();
        for line in text.lines() {
            // No scene of the project has a `#` in a file name.
            let words: Vec<&str> = line.split('#').next().unwrap_or("").split_whitespace().collect();
            let Some((&command, arguments)) = words.split_first() else { continue };
            if command == "write" {
                if arguments == [write] {
                    return scene;
                }
                continue;
            }
            let a: Vec<f64> = arguments.iter().map(|word| word.parse().expect("a number")).collect();
            let triple = |from: usize| DVec3::new(a[from], a[from + 1], a[from + 2]);
            match command {
                "fov" => scene.fov = a[0],
                "background" => scene.background = triple(0),
                "light" => scene.lights.push(Light { color: triple(0), position: triple(3) }),
                "surface" => {
                    let [ambient, diffuse, specular] = [0, 3, 6].map(triple);
                    surface = Surface { ambient, diffuse, specular, shininess: a[9], reflectance: a[10] };
                }
                "sphere" => {
                    let shape = Shape::Sphere { center: triple(0), radius: a[3] };
                    scene.objects.push(Object { shape, surface });
                }
                "cylinder" => {
                    let shape = Shape::Cylinder { radius: a[0], x: a[1], z: a[2], y_min: a[3], y_max: a[4] };
                    scene.objects.push(Object { shape, surface });
                }
                other => panic!("no command `{other}`"),
            }
        }
        panic!("the scene does not write {write}");
    }

    /// Renders the scene, row by row from the top.
    pub fn image(mut self, request: &Request) -> Vec<[u8; 3]> {
        if request.is_part_a {
            self.objects.retain(|object| matches!(object.shape, Shape::Sphere { .. }));
        }
        let pixels = (0..request.height).flat_map(|row| (0..request.width).map(move |column| (column, row)));
        pixels.map(|(column, row)| self.pixel(request, column, row)).collect()
    }

    fn pixel(&self, request: &Request, column: u32, row: u32) -> [u8; 3] {
        let n = f64::from(request.samples);
        let offset = |s: u32| (2.0 * f64::from(s) + 1.0 - n) / (2.0 * n) + if request.is_centred { 0.5 } else { 0.0 };
        let mut sum = DVec3::ZERO;
        for u in 0..request.samples {
            for s in 0..request.samples {
                let ray = self.eye_ray(request, f64::from(column) + offset(s), f64::from(row) + offset(u));
                sum += self.color(request, ray, 0);
            }
        }
        // A conversion to an integer rounds down what is not negative.
        (sum / (n * n)).to_array().map(|channel| (255.0 * channel + 1.0 / 1_048_576.0) as u8)
    }

    /// Section "Camera".
    pub fn eye_ray(&self, request: &Request, i: f64, j: f64) -> Ray {
        let (width, height) = (f64::from(request.width), f64::from(request.height));
        let k = libm::tan(self.fov * std::f64::consts::PI / 360.0);
        let dir = DVec3::new((2.0 * i - width) * k / height, (height - 2.0 * j) * k / height, -1.0);
        Ray { origin: DVec3::ZERO, dir, leaves: None }
    }

    /// Sections "Levels" and "Pixels": the colour of a ray, clamped.
    fn color(&self, request: &Request, ray: Ray, level: u32) -> DVec3 {
        let color = match self.nearest(ray) {
            None => self.background,
            Some(hit) if request.is_part_a => self.shade_part_a(&hit),
            Some(_) if level > request.max_level => DVec3::ZERO,
            Some(hit) => {
                let reflected = reflect(ray, &hit);
                let is_mirror = hit.surface.reflectance > 0.0;
                let mirrored = if is_mirror { self.color(request, reflected, level + 1) } else { DVec3::ZERO };
                hit.surface.ambient + self.light(ray, &hit) + hit.surface.reflectance.max(0.0) * mirrored
            }
        };
        color.clamp(DVec3::ZERO, DVec3::ONE)
    }

    /// Section "Shading": the sum over all lights that count.
    pub fn light(&self, ray: Ray, hit: &Hit) -> DVec3 {
        let (n, v) = (hit.normal, -ray.dir.normalize());
        let mut sum = DVec3::ZERO;
        for light in &self.lights {
            let l = (light.position - hit.point).normalize();
            if n.dot(l) > 0.0 && !self.is_hidden(hit, light) {
                let highlight = libm::pow(n.dot((l + v).normalize()), hit.surface.shininess);
                sum += light.color * (hit.surface.diffuse * n.dot(l) + hit.surface.specular * highlight);
            }
        }
        sum
    }

    /// Section "Shadows": whether something is met on the way to a light.
    pub fn is_hidden(&self, hit: &Hit, light: &Light) -> bool {
        let way = Ray { origin: hit.point, dir: light.position - hit.point, leaves: Some(hit.equation) };
        self.objects.iter().any(|object| object.meet(way).is_some_and(|hit| hit.t < 1.0))
    }

    /// Section "Parts".
    fn shade_part_a(&self, hit: &Hit) -> DVec3 {
        let share = |light: &Light| {
            let l = (light.position - hit.point).normalize_or_zero();
            light.color * hit.surface.diffuse * hit.normal.dot(l).max(0.0)
        };
        self.lights.iter().map(share).sum()
    }

    /// Section "Hits": the hit with the smallest t; of several that of the object declared first.
    pub fn nearest(&self, ray: Ray) -> Option<Hit> {
        let mut nearest: Option<Hit> = None;
        for hit in self.objects.iter().filter_map(|object| object.meet(ray)) {
            if nearest.is_none_or(|best| hit.t < best.t) {
                nearest = Some(hit);
            }
        }
        nearest
    }
}

/// Section "Levels": the reflected ray.
pub fn reflect(ray: Ray, hit: &Hit) -> Ray {
    let dir = ray.dir - 2.0 * hit.normal.dot(ray.dir) * hit.normal;
    Ray { origin: hit.point, dir, leaves: Some(hit.equation) }
}

impl Object {
    /// Returns the nearest hit of a ray on this object.
    fn meet(&self, ray: Ray) -> Option<Hit> {
        match self.shape {
            Shape::Sphere { center, radius } => {
                let equation = Equation::Sphere(center, radius);
                let t = roots(ray.origin - center, ray.dir, radius, ray.leaves == Some(equation)).next()?;
                let point = ray.origin + t * ray.dir;
                Some(self.hit(ray, t, point, (point - center) / radius, equation))
            }
            Shape::Cylinder { y_min, y_max, .. } => {
                let parts = [self.meet_wall(ray), self.meet_cap(ray, y_min), self.meet_cap(ray, y_max)];
                // `min_by` returns the first of equals, which is the wall.
                parts.into_iter().flatten().min_by(|a, b| a.t.total_cmp(&b.t))
            }
        }
    }

    fn meet_wall(&self, ray: Ray) -> Option<Hit> {
        let Shape::Cylinder { radius, x, z, y_min, y_max } = self.shape else { return None };
        let equation = Equation::Wall(x, z, radius);
        let across = |vector: DVec3| DVec3::new(vector.x, 0.0, vector.z);
        let from_axis = across(ray.origin - DVec3::new(x, 0.0, z));
        roots(from_axis, across(ray.dir), radius, ray.leaves == Some(equation)).find_map(|t| {
            let point = ray.origin + t * ray.dir;
            let outward = across(point - DVec3::new(x, 0.0, z)) / radius;
            // The exception of section "cylinder": out of the infinite wall, exactly at the rim, from beyond its cap.
            let comes_from_beyond = (point.y == y_min && ray.dir.y > 0.0) || (point.y == y_max && ray.dir.y < 0.0);
            let is_passing = comes_from_beyond && outward.dot(ray.dir) > 0.0;
            let counts = y_min <= point.y && point.y <= y_max && !is_passing;
            counts.then(|| self.hit(ray, t, point, outward, equation))
        })
    }

    fn meet_cap(&self, ray: Ray, y: f64) -> Option<Hit> {
        let Shape::Cylinder { radius, x, z, y_max, .. } = self.shape else { return None };
        let (equation, t) = (Equation::Plane(y), (y - ray.origin.y) / ray.dir.y);
        // With a level ray t is infinite or no number.
        if ray.leaves == Some(equation) || !t.is_finite() || t <= 0.0 {
            return None;
        }
        let mut point = ray.origin + t * ray.dir;
        point.y = y;
        let from_axis = DVec3::new(point.x - x, 0.0, point.z - z);
        let (distance_squared, outward) =
            (from_axis.length_squared(), if y == y_max { DVec3::Y } else { DVec3::NEG_Y });
        // The same exception.
        let is_passing =
            distance_squared == radius * radius && outward.dot(ray.dir) < 0.0 && from_axis.dot(ray.dir) > 0.0;
        let counts = distance_squared <= radius * radius && !is_passing;
        counts.then(|| self.hit(ray, t, point, outward, equation))
    }

    /// Section "Normals".
    fn hit(&self, ray: Ray, t: f64, point: DVec3, outward: DVec3, equation: Equation) -> Hit {
        let normal = if outward.dot(ray.dir) > 0.0 { -outward } else { outward };
        Hit { t, point, normal, surface: self.surface, equation }
    }
}

/// Sections "sphere" and "Hits": the roots t > 0 of |m + t·d|² = r², rising. On the surface that a ray leaves, t = 0 is one
/// root, and −2b/a the other.
fn roots(m: DVec3, d: DVec3, r: f64, is_left: bool) -> impl Iterator<Item = f64> {
    let (a, b, e) = (d.dot(d), m.dot(d), m.dot(m) - r * r);
    let spread = (b * b - a * e).sqrt();
    let both = if is_left { [0.0, -2.0 * b / a] } else { [(-b - spread) / a, (-b + spread) / a] };
    // Without a root, or with a = 0, they are no numbers or infinite.
    both.into_iter().filter(|t| *t > 0.0 && t.is_finite())
}
