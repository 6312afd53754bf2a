//! What is seen of the objects, over all images of a scene.

use glam::DVec3;

use crate::ir::SceneView;
use crate::plan::{Inspected, Object, Settings, Sight, inspect};

/// What is known of each object over all images that show it.
#[derive(Debug)]
pub(super) struct Sights {
    /// Spheres first, each kind in its order.
    pub objects: Vec<Inspected>,
}

impl Sights {
    /// Inspects the images; `None` when there is none. Of two images the later shows all that the earlier shows.
    pub fn of_images(images: &[SceneView<'_>], settings: &Settings) -> Option<Self> {
        let (last, earlier) = images.split_last()?;
        let mut objects = inspect(*last, settings);
        let n_spheres = last.spheres().len();
        for image in earlier {
            for seen in inspect(*image, settings) {
                let place = match seen.object {
                    Object::Sphere(i) => i as usize,
                    Object::Cylinder(i) => n_spheres + i as usize,
                };
                merge(&mut objects[place], seen);
            }
        }
        Some(Self { objects })
    }
}

/// Adds what another image shows of an object: it is needed if one of them needs it.
fn merge(known: &mut Inspected, seen: Inspected) {
    known.needless = known.needless.filter(|_| seen.needless.is_some());
    if seen.sight == Sight::InView {
        known.sight = Sight::InView;
    }
    known.pixels = [0, 1].map(|side| known.pixels[side].max(seen.pixels[side]));
}

/// Returns the object that fills the whole view, with the eye outside and no other before it, as far as rays can tell.
pub(super) fn find_filling(sights: &Sights, scene: &SceneView<'_>, settings: &Settings) -> Option<Object> {
    let fills = |seen: &&Inspected| {
        let is_candidate = seen.sight == Sight::InView && !seen.holds_eye && !seen.is_copy();
        is_candidate && fills_view(&Shape::of(scene, seen.object), scene, settings)
    };
    let is_first =
        |seen: &Inspected| !sights.objects.iter().any(|other| is_before(other.object, seen.object, scene, settings));
    // Of two that fill the view the one behind is not seen.
    sights.objects.iter().filter(fills).find(|seen| is_first(seen)).map(|seen| seen.object)
}

/// Tells whether every eye ray meets a shape with the eye outside: the four at the corners do, and the rays that meet a
/// convex body make a convex cone.
fn fills_view(shape: &Shape, scene: &SceneView<'_>, settings: &Settings) -> bool {
    let corners = [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]];
    corners.into_iter().all(|corner| shape.meet(eye_ray(scene, settings, corner)).is_some())
}

/// Tells whether, along one of many rays, an object is met before another.
fn is_before(object: Object, other: Object, scene: &SceneView<'_>, settings: &Settings) -> bool {
    /// Rays along each side of the image.
    const N_RAYS: i32 = 64;
    if object == other {
        return false;
    }
    let [shape, other] = [object, other].map(|object| Shape::of(scene, object));
    let is_before = |at: [f64; 2]| {
        let dir = eye_ray(scene, settings, at);
        shape.meet(dir).is_some_and(|t| other.meet(dir).is_none_or(|behind| t < behind))
    };
    let place = |i: i32| f64::from(2 * i + 1) / f64::from(N_RAYS) - 1.0;
    let is_in_view = |[u, v]: &[f64; 2]| u.abs() <= 1.0 && v.abs() <= 1.0;
    shape.middle(scene, settings).filter(is_in_view).is_some_and(is_before)
        || (0..N_RAYS).any(|row| (0..N_RAYS).any(|column| is_before([place(column), place(row)])))
}

/// The shape of an object, for rays that need no proof.
#[derive(Clone, Copy, Debug)]
pub(super) enum Shape {
    Sphere { center: DVec3, radius: f64 },
    Cylinder { x: f64, z: f64, radius: f64, y_min: f64, y_max: f64 },
}

impl Shape {
    /// Returns the shape of an object.
    pub fn of(scene: &SceneView<'_>, object: Object) -> Self {
        match object {
            Object::Sphere(i) => {
                let sphere = &scene.spheres()[i as usize];
                Self::Sphere { center: sphere.center, radius: sphere.radius }
            }
            Object::Cylinder(i) => {
                let c = &scene.cylinders()[i as usize];
                Self::Cylinder { x: c.x, z: c.z, radius: c.radius, y_min: c.y_min, y_max: c.y_max }
            }
        }
    }

    /// Returns where in the image the middle of the shape lies, as [`eye_ray`] has it; `None` when it is not ahead.
    pub fn middle(&self, scene: &SceneView<'_>, settings: &Settings) -> Option<[f64; 2]> {
        let middle = match *self {
            Self::Sphere { center, .. } => center,
            Self::Cylinder { x, z, y_min, y_max, .. } => DVec3::new(x, 0.5 * (y_min + y_max), z),
        };
        let corner = eye_ray(scene, settings, [1.0, 1.0]);
        (middle.z < 0.0).then(|| [middle.x / -middle.z / corner.x, middle.y / -middle.z / corner.y])
    }

    /// Returns the least t above 0 at which the ray t·`dir` from the eye meets the shape, within a few roundings.
    pub fn meet(&self, dir: DVec3) -> Option<f64> {
        let first = |roots: Option<[f64; 2]>, is_on: &dyn Fn(f64) -> bool| {
            roots.into_iter().flatten().find(|&t| t > 0.0 && is_on(t))
        };
        match *self {
            Self::Sphere { center, radius } => first(roots(dir, center, radius), &|_| true),
            Self::Cylinder { x, z, radius, y_min, y_max } => {
                let flat = |v: DVec3| DVec3::new(v.x, 0.0, v.z);
                let axis = DVec3::new(x, 0.0, z);
                let wall = first(roots(flat(dir), axis, radius), &|t| (y_min..=y_max).contains(&(t * dir.y)));
                let caps = [y_min, y_max].map(|y| y / dir.y);
                let caps = caps.into_iter().filter(|&t| t > 0.0 && (flat(dir) * t - axis).length() <= radius);
                wall.into_iter().chain(caps).min_by(f64::total_cmp)
            }
        }
    }
}

/// Returns where |t·dir − center| = radius, the lesser first.
fn roots(dir: DVec3, center: DVec3, radius: f64) -> Option<[f64; 2]> {
    let (a, b) = (dir.length_squared(), dir.dot(center));
    let discriminant = b * b - a * (center.length_squared() - radius * radius);
    (discriminant >= 0.0 && a > 0.0).then(|| [-1.0, 1.0].map(|side| (b + side * discriminant.sqrt()) / a))
}

/// Returns the direction of the eye ray through a point of the image, from −1, −1 at the lower left corner to 1, 1.
pub(super) fn eye_ray(scene: &SceneView<'_>, settings: &Settings, [u, v]: [f64; 2]) -> DVec3 {
    let k = libm::tan(scene.fov_deg().to_radians() / 2.0);
    let aspect = f64::from(settings.size.width()) / f64::from(settings.size.height());
    DVec3::new(u * k * aspect, v * k, -1.0)
}

/// Returns the object that a ray from the eye meets first, and where.
pub(super) fn first_met(scene: &SceneView<'_>, dir: DVec3) -> Option<(Object, f64)> {
    let spheres = (0..scene.spheres().len() as u32).map(Object::Sphere);
    let objects = spheres.chain((0..scene.cylinders().len() as u32).map(Object::Cylinder));
    let met = objects.filter_map(|object| Shape::of(scene, object).meet(dir).map(|t| (object, t)));
    met.min_by(|(_, a), (_, b)| a.total_cmp(b))
}
