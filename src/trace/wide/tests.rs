//! The bounds are honest: what packets compute lies within them of what double-double computes, and not far within.

mod margins;

use glam::DVec3;

use super::*;
use crate::ir::{self, Handle, Registers, SceneView, Valid};
use crate::math::{Ball106, Vector};
use crate::plan::{Candidates, Pass, Passes, Settings, Size, plan};
use crate::testing::Stream;
use crate::trace::camera::Camera;
use crate::trace::integrator::Integrator;
use crate::trace::kernels::{Job, Lanes, Mask};
use crate::trace::pixel::{self, Pixel};
use crate::trace::shade::HitPoint;

/// The hits of a tile's eye rays: packets with their points.
struct Probe<'a>(TileJob<'a>);

/// A hit of one eye ray, and how far it may be off.
struct Found {
    pixel: usize,
    face: usize,
    point: [f64; 3],
    normal: [f64; 3],
    point_error: f64,
    normal_error: f64,
}

impl Job for Probe<'_> {
    type Output = Vec<Found>;

    #[inline(always)]
    fn run<L: Lanes>(mut self) -> Vec<Found> {
        let among = self.0.plan.tiles.candidates(self.0.rect.columns.start, self.0.rect.rows.start);
        self.0.scratch.slow.fill(0);
        self.0.meet::<L>(among);
        let mut found = Vec::new();
        for hit in self.0.scratch.hits.clone() {
            let lanes = L::Mask::from_bits(hit.lanes);
            let face = &self.0.wide.bounds.faces[hit.face as usize];
            let at = self.0.points::<L>(face, hit.packet as usize, lanes);
            let lanes_of = |numbers: L| {
                let mut lanes = [0.0; eye::MAX_LANES];
                numbers.store(&mut lanes);
                lanes
            };
            let [point, normal] = [at.point, at.normal].map(|vector| vector.map(lanes_of));
            let (point_error, normal_error) = (lanes_of(at.point_error), lanes_of(at.normal_error));
            for lane in (0..L::N).filter(|lane| hit.lanes >> lane & 1 != 0) {
                found.push(Found {
                    pixel: hit.packet as usize * L::N + lane,
                    face: hit.face as usize,
                    point: point.map(|lanes| lanes[lane]),
                    normal: normal.map(|lanes| lanes[lane]),
                    point_error: point_error[lane],
                    normal_error: normal_error[lane],
                });
            }
        }
        found
    }
}

/// Spheres and cylinders of all sizes at all distances in front of the eye; one time in three inside of a sphere.
fn random_program(stream: &mut Stream) -> Valid {
    let mut program = ir::Program::default();
    program.surfaces.push(ir::Surface {
        ambient: DVec3::ZERO,
        diffuse: DVec3::ONE,
        specular: DVec3::ZERO,
        shininess: 1.0,
        reflectance: 0.0,
    });
    let surface = Handle::new(0);
    let n_objects = 12;
    for order in 0..n_objects {
        let distance = libm::exp2(stream.between(0.0, 7.0));
        let [x, y] = [(); 2].map(|()| stream.between(-0.5, 0.5) * distance);
        let radius = distance * libm::exp2(stream.between(-7.0, -1.0));
        if stream.unit() < 0.5 {
            program.spheres.push(ir::Sphere { center: DVec3::new(x, y, -distance), radius, surface, order });
        } else {
            let y_max = y + radius * stream.between(0.1, 4.0);
            program.cylinders.push(ir::Cylinder { radius, x, z: -distance, y_min: y, y_max, surface, order });
        }
    }
    if stream.unit() < 0.33 {
        let radius = libm::exp2(stream.between(3.0, 9.0));
        program.spheres.push(ir::Sphere { center: DVec3::splat(0.2 * radius), radius, surface, order: n_objects });
    }
    ir::validate(program).expect("a sound program")
}

/// Returns the largest error of a point and of a normal, each as a share of its bound.
fn worst_shares(program: &Valid, settings: &Settings) -> Option<[f64; 2]> {
    let registers =
        Registers { n_spheres: program.spheres.len(), n_cylinders: program.cylinders.len(), ..Registers::default() };
    let plan = plan(SceneView::new(program, registers), settings);
    let sampling = Sampling::new(settings);
    let camera: Camera<Ball64> = Camera::new(plan.fov_deg, sampling.steps_per_half_height());
    let fine_camera: Camera<Ball106> = Camera::new(plan.fov_deg, sampling.steps_per_half_height());
    let wide = Wide::new(&plan, camera.step(), Backend::Scalar)?;
    let mut integrator = Integrator::<Ball106>::new(&plan);
    let mut scratch = wide.scratch(false);
    let mut worst = [0.0_f64; 2];
    for rect in Wide::tiles(&plan, 0..settings.size.height()) {
        let (bounds, scratch, sample) = (&wide.bounds, &mut scratch, [0; 2]);
        let among = plan.tiles.candidates(rect.columns.start, rect.rows.start);
        let job =
            TileJob { wide: &wide, bounds, among, plan: &plan, sampling: &sampling, rect: &rect, scratch, sample };
        for found in Backend::Scalar.run(Probe(job)) {
            let (column, row) = ((found.pixel % TILE_WIDTH) as u32, (found.pixel / TILE_WIDTH) as u32);
            if column >= rect.columns.len() as u32 {
                continue;
            }
            let (column, row) = (rect.columns.start + column, rect.rows.start + row);
            let (left, top) = sampling.first_sample(column, row);
            let ray = fine_camera.eye_ray(left, top);
            let hit = integrator.intersect(&ray, plan.tiles.candidates(column, row)).expect("the finest arithmetic");
            let hit = hit.expect("what a packet meets is met");
            let at = HitPoint::new(&plan.scene, &ray, &hit);
            let face = &wide.bounds.faces[found.face];
            assert_eq!(face.equation, at.equation.number(), "another face");
            let off = |exact: Vector<Ball106>, computed: [f64; 3]| {
                let off = exact.to_array().into_iter().zip(computed).map(|(e, c)| (e - Ball106::exact(c)).value());
                off.map(|off| off * off).sum::<f64>().sqrt()
            };
            let share = |off: f64, bound: f64| if off == 0.0 { 0.0 } else { off / bound };
            worst[0] = worst[0].max(share(off(at.point, found.point), found.point_error));
            worst[1] = worst[1].max(share(off(at.normal, found.normal), found.normal_error));
        }
    }
    Some(worst)
}

#[test]
fn the_bounds_of_eye_rays_are_honest_and_not_idle() {
    let mut stream = Stream::new(17);
    let mut worst = [0.0_f64; 2];
    for _ in 0..150 {
        let program = random_program(&mut stream);
        let settings = Settings { size: Size::new(72, 48).expect("a size"), ..Settings::default() };
        if let Some(shares) = worst_shares(&program, &settings) {
            assert!(shares.into_iter().all(|share| share <= 1.0), "{shares:?}");
            worst = [worst[0].max(shares[0]), worst[1].max(shares[1])];
        }
    }
    assert!(worst.into_iter().all(|share| share > 1e-3), "{worst:?} of the bounds at most");
}
