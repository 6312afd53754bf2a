//! Flocks: packets of rays that go the same way among the spheres of a cluster.
//!
//! Neighbouring pixels mostly see the same mirrors one behind the other, for some levels. As long as all rays of a packet
//! leave one sphere and meet one other, what is to be known of the two stands once and not lane by lane, nothing is sorted,
//! and nothing waits: the packet is followed to its end at once. Rays that go their own ways leave the flock and wait as
//! others do (see `queue`).
//!
//! A ray that leaves a sphere is the unit normal n there and its own direction d, a unit vector. With Δ from the centre of
//! that sphere, of radius r, to that of another, of radius R, and γ = n·d:
//! - the other's middle lies at b = Δ·d − r·γ, and the power of the ray's origin is |Δ|² + r² − R² − 2r·Δ·n: both need the
//!   origin itself no more, and the power is linear in n;
//! - the normal where it is met, at t, is (r·n + t·d − Δ)/R.
//!
//! Of a light the height above the horizon of n tells all (see `horizon`).
//!
//! # Which sphere is met
//! As in `cluster`: the one whose middle comes first of all that the ray may meet. The sphere that it leaves is not among
//! them.
//!
//! # Errors
//! d is off the exact ray's direction by at most ε, n off its normal by x ≤ ε/2. Lengths are taken in a power of two of about
//! the radii; S is the largest distance of an origin from a centre, r ≤ S/2. k counts levels. ε is never below 400u.
//!
//! *Lengths.* n is made a unit vector anew at each hit, up to 10u in its square. A reflection at such a normal changes |d|² by
//! at most 80u, so that it is within 96(k + 1)u of 1. n·d is known as the cosine before the reflection, within 24u.
//!
//! *Tests.* b is off by S·ε + r·x + 28u·S ≤ 2S·ε; the power, of at most S², by 2r·|Δ|·x + 18u·S² ≤ S²·ε; so D = b² − power
//! is off by at most 5S²·ε.
//!
//! *Hits.* The exact ray passes the computed point within δ = r·x + t·ε + 24u·S. That point is off the surface by
//! ρ ≤ (45 + 48(k + 1))·u·S²/R: what t solves is off by 12u·S², the power by 18u·S², b by 28u·S, twice t times that, and t²
//! times how far |d|² is off 1. As `mirror` shows, the exact ray meets the sphere within 1.06(δ + ρ)/γ of the computed point;
//! so x' = 1.07(r·x + t·ε + 24u·S + ρ)/(R·γ), as long as that is below γ/64. What is added to 24u·S + ρ makes x' at least 400u.
//!
//! *Reflections.* ε' = ε + 2.05x': twice the error of the normal, and a share of it for all roundings.
//!
//! What is carried is a slack, a multiple κ·ε that covers b, D and the heights of lights at once, and κ·x.

use crate::plan::Plan;
use crate::trace::kernels::{Lanes, Mask, Precision};
use crate::trace::wide::bounds::{Bounds, Face};
use crate::trace::wide::cluster::{Cluster, Table};
use crate::trace::wide::horizon::BallLight;
use crate::trace::wide::queue::Rays;
use crate::trace::wide::shadow::LightOccluders;

/// The largest ε with which eye rays set out, as a share of √u: squares of it are lost in roundings.
const MAX_EYE_SHARE: f64 = 0.5;

/// The largest ε of a ray that stays, as a share of the least cosine g.
const MAX_SHARE: f64 = 1.0 / 128.0;

/// What is known of a cluster whose spheres have one grey surface.
#[derive(Clone, Debug)]
pub(super) struct Flock {
    pub balls: Vec<Ball>,
    /// For each ball what the ways to the others are, side by side.
    ways: Vec<Way>,
    /// The slack is this many times ε.
    factor: f64,
    /// Slacks of rays that set out, and of those that stay, are below.
    pub max_eye_slack: f64,
    max_slack: f64,
    /// D of a sure hit is larger.
    least: f64,
    /// What the colours of a hit lose to roundings.
    pub color_rounding: f64,
    pub reflectance: f64,
    pub ambient: f64,
    /// As in [`Terms`](crate::trace::wide::bounds::Terms).
    pub n_lightings: u32,
}

/// A sphere of a cluster.
#[derive(Clone, Debug)]
pub(super) struct Ball {
    pub face: usize,
    center: [f64; 3],
    radius: f64,
    equation: f64,
    /// −r.
    minus_radius: f64,
    /// What points of it lose to rounding, in units of u.
    rounding: f64,
    /// κ times the error of an eye ray's direction, and κ times that of the normal where it meets the sphere at right angles.
    eye_dir_slack: f64,
    eye_normal_slack: f64,
    pub lights: Vec<BallLight>,
    /// The error of a hit's own colour is at most this many slacks, beside roundings.
    pub color_slacks: f64,
    pub occluders: LightOccluders,
}

/// What lies between a sphere of a cluster and another.
#[derive(Clone, Copy, Debug)]
struct Way {
    to: usize,
    /// Δ.
    middle: [f64; 3],
    /// −2r·Δ and |Δ|² + r² − R².
    pull: [f64; 3],
    power: f64,
    /// r/R, 1/R and −Δ/R.
    ratio: f64,
    per_radius: f64,
    back: [f64; 3],
    /// 1.07κ(24u·S + ρ)/R without levels, and what each level adds.
    rounding: f64,
    rounding_by_level: f64,
}

/// A packet of rays that have left one sphere.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flight<L: Lanes> {
    pub ball: usize,
    pub lanes: L::Mask,
    pub normal: [L; 3],
    pub dir: [L; 3],
    /// Of the normal and the ray.
    pub cosine: L,
    /// κ·ε and κ·x.
    pub slack: L,
    normal_slack: L,
    /// How many mirrors they have left.
    pub level: u32,
}

/// What a packet of rays meets next.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ahead<L: Lanes> {
    /// The lanes that meet something, perhaps.
    pub met: L::Mask,
    /// Those of them that surely do.
    pub sure: L::Mask,
    /// Those whose errors have become too large.
    pub wild: L::Mask,
    /// What most of them meet first, and which these are.
    way: usize,
    pub lead: L::Mask,
    t: L,
}

impl Flock {
    /// Works out the constants; `None` of what is followed in another way.
    pub fn new(plan: &Plan<'_>, bounds: &Bounds, cluster: &Cluster, table: &Table) -> Option<Self> {
        let faces: Vec<_> = plan.mirrored().spheres.iter().map(|&i| i as usize).collect();
        let precision = bounds.eye.precision;
        let surface = bounds.faces[table.face].surface;
        let terms = &bounds.terms[surface];
        let is_plain = !terms.has_specular && terms.is_nonnegative && terms.is_grey();
        if !is_plain || terms.reflectance <= 0.0 || terms.reflectance > 1.0 || faces.len() < 2 {
            return None;
        }
        let face = |i: usize| &bounds.faces[faces[i]];
        let max_radius = (0..faces.len()).map(|i| face(i).radius).fold(0.0, f64::max);
        let scale = libm::exp2(-max_radius.log2().floor());
        let mut span = 0.0_f64;
        for (i, k) in pairs(faces.len()) {
            let [x, y, z] = between(face(i), face(k), scale);
            span = span.max(1.001 * (libm::sqrt(x * x + y * y + z * z) + face(i).radius * scale));
        }
        let factor = (2.0 * span).max(5.0 * span * span).max(2.0);
        let units = Units { precision, scale, span, factor };
        let ways = pairs(faces.len()).map(|(i, k)| Way::new(face(i), (k, face(k)), &units)).collect();
        let balls = faces.iter().map(|&face| Ball::new(plan, bounds, face, &units)).collect::<Option<Vec<_>>>()?;
        let max_error = (MAX_SHARE * precision.min_cosine).min(0.5 * cluster.gap * scale / span);
        let least = precision.min_cosine * max_radius * scale;
        Some(Self {
            ways,
            factor,
            max_eye_slack: factor * max_error.min(MAX_EYE_SHARE * precision.u.sqrt()),
            max_slack: factor * max_error,
            least: least * least,
            color_rounding: terms.rounding,
            reflectance: terms.reflectance,
            ambient: terms.ambient[0],
            n_lightings: terms.n_lightings,
            balls,
        })
    }

    /// Returns the number of the ball that has a face.
    #[inline(always)]
    pub fn ball_of(&self, face: usize) -> Option<usize> {
        let mut ball = 0;
        while ball < self.balls.len() {
            if self.balls[ball].face == face {
                return Some(ball);
            }
            ball += 1;
        }
        None
    }

    /// Finds what a packet of rays meets first: the ball with the smallest b.
    #[inline(always)]
    pub fn look_ahead<L: Lanes>(&self, flight: &Flight<L>) -> Ahead<L> {
        let n_ways = self.balls.len() - 1;
        let first_way = flight.ball * n_ways;
        let (normal, dir, lowest) = (flight.normal, flight.dir, -flight.slack);
        let foot = flight.cosine * L::splat(self.balls[flight.ball].minus_radius);
        let mut met = L::Mask::from_bits(0);
        let (mut b_first, mut discriminant_first) = (L::splat(f64::INFINITY), L::splat(0.0));
        let (mut lead_way, mut lead) = (first_way, 0);
        for way_idx in first_way..first_way + n_ways {
            let way = &self.ways[way_idx];
            let b = along(dir, way.middle, foot);
            let power = along(normal, way.pull, L::splat(way.power));
            let discriminant = b.mul_add(b, -power);
            let first = b.lt(b_first) & b.ge(lowest) & discriminant.ge(lowest);
            met = met | first;
            b_first = L::select(first, b, b_first);
            discriminant_first = L::select(first, discriminant, discriminant_first);
            let bits = (first & flight.lanes).bits();
            lead &= !bits;
            if bits.count_ones() > lead.count_ones() {
                (lead_way, lead) = (way_idx, bits);
            }
        }
        let root = discriminant_first.sqrt();
        let t = b_first - root;
        // The power is b² − D.
        let power = t * (b_first + root);
        let sure = discriminant_first.gt(flight.slack + L::splat(self.least))
            & b_first.gt(flight.slack)
            & power.gt(flight.slack);
        let wild = !flight.slack.lt(L::splat(self.max_slack));
        let met = met & flight.lanes;
        Ahead { met, sure: met & sure, wild: wild & flight.lanes, way: lead_way, lead: L::Mask::from_bits(lead), t }
    }

    /// Follows a packet of rays to what most of them meet, and reflects it there.
    #[inline(always)]
    pub fn go_to<L: Lanes>(&self, flight: &Flight<L>, ahead: &Ahead<L>, lanes: L::Mask) -> Flight<L> {
        let way = &self.ways[ahead.way];
        let (t, ratio) = (ahead.t * L::splat(way.per_radius), L::splat(way.ratio));
        let mut normal = flight.normal;
        for k in 0..3 {
            normal[k] = t.mul_add(flight.dir[k], ratio.mul_add(normal[k], L::splat(way.back[k])));
        }
        let rounding = L::splat(f64::from(flight.level).mul_add(way.rounding_by_level, way.rounding));
        let passes_within = t.mul_add(flight.slack, ratio.mul_add(flight.normal_slack, rounding));
        let level = flight.level + 1;
        reflect(way.to, lanes, level, normal, flight.dir, flight.slack, passes_within)
    }

    /// Reflects a packet of eye rays, of directions `dir`, where they meet a ball, at normals that need not be of unit length.
    #[inline(always)]
    pub fn set_out<L: Lanes>(&self, ball: usize, lanes: L::Mask, normal: [L; 3], dir: [L; 3]) -> Flight<L> {
        let (slack, normal_slack) = (self.balls[ball].eye_dir_slack, self.balls[ball].eye_normal_slack);
        reflect(ball, lanes, 1, normal, dir, L::splat(slack), L::splat(normal_slack))
    }

    /// Returns the rays of a packet as others see them.
    #[inline(always)]
    pub fn rays<L: Lanes>(&self, flight: &Flight<L>) -> Rays<L> {
        let ball = &self.balls[flight.ball];
        let origin_error =
            flight.slack.mul_add(L::splat(0.5 * ball.radius / self.factor), L::splat(ball.rounding * L::U));
        Rays {
            origin: ball.points(flight.normal),
            dir: flight.dir,
            origin_error,
            dir_error: flight.slack * L::splat(1.0 / self.factor),
            leaving: L::splat(ball.equation),
        }
    }
}

/// Returns a·b + c.
#[inline(always)]
pub(super) fn along<L: Lanes>(a: [L; 3], b: [f64; 3], c: L) -> L {
    a[0].mul_add(L::splat(b[0]), a[1].mul_add(L::splat(b[1]), a[2].mul_add(L::splat(b[2]), c)))
}

/// Reflects a packet of rays.
///
/// `slack`: of them before. `passes_within`: κ·x' times the cosine, over 1.07.
#[inline(always)]
fn reflect<L: Lanes>(
    ball: usize,
    lanes: L::Mask,
    level: u32,
    normal: [L; 3],
    dir: [L; 3],
    slack: L,
    passes_within: L,
) -> Flight<L> {
    let [x, y, z] = normal;
    let excess = x.mul_add(x, y.mul_add(y, z.mul_add(z, -L::splat(1.0))));
    let per_length = excess.mul_add(L::splat(-0.5), L::splat(1.0));
    let normal = [x * per_length, y * per_length, z * per_length];
    let cosine = (-normal[0]).mul_add(dir[0], (-normal[1]).mul_add(dir[1], -(normal[2] * dir[2])));
    let twice = cosine + cosine;
    let mut reflected = dir;
    for k in 0..3 {
        reflected[k] = twice.mul_add(normal[k], dir[k]);
    }
    let normal_slack = passes_within * (cosine.reciprocal_bound() * L::splat(1.07));
    let slack = normal_slack.mul_add(L::splat(2.05), slack);
    Flight { ball, lanes, normal, dir: reflected, cosine, slack, normal_slack, level }
}

/// What lengths and errors are measured in.
struct Units {
    precision: Precision,
    /// What lengths are multiplied with.
    scale: f64,
    /// S and κ.
    span: f64,
    factor: f64,
}

impl Way {
    /// Works out the way from a sphere to another, with its number.
    fn new(from: &Face, (to, other): (usize, &Face), units: &Units) -> Self {
        let (radius, other_radius) = (from.radius * units.scale, other.radius * units.scale);
        let middle = between(from, other, units.scale);
        let [x, y, z] = middle;
        let per_radius = 1.0 / other_radius;
        let Units { precision: Precision { u, .. }, span, factor, .. } = *units;
        let per_level = 48.0 * span * span * per_radius;
        let rounding = 24.0 * span + 45.0 * span * span * per_radius + per_level;
        let rounding = (u * rounding * per_radius).max(400.0 * u);
        Self {
            to,
            middle,
            pull: middle.map(|c| -2.0 * radius * c),
            power: x * x + y * y + z * z + radius * radius - other_radius * other_radius,
            ratio: radius * per_radius,
            per_radius,
            back: middle.map(|c| -c * per_radius),
            rounding: factor * rounding,
            rounding_by_level: factor * u * per_level * per_radius,
        }
    }
}

/// Returns what every number below `n` and every other one are, in order.
fn pairs(n: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..n).flat_map(move |i| (0..n).filter(move |&k| k != i).map(move |k| (i, k)))
}

/// Returns the way between two centres.
fn between(from: &Face, to: &Face, scale: f64) -> [f64; 3] {
    [0, 1, 2].map(|k| (to.center[k] - from.center[k]) * scale)
}

impl Ball {
    /// Works out what a sphere and the lights are to each other; `None` when a light is too near.
    fn new(plan: &Plan<'_>, bounds: &Bounds, face_idx: usize, units: &Units) -> Option<Self> {
        let (u, factor) = (units.precision.u, units.factor);
        let face = &bounds.faces[face_idx];
        let terms = &bounds.terms[face.surface];
        let occluders = LightOccluders::new(bounds, plan, face);
        let n_lights = if terms.has_diffuse { bounds.lights.len() } else { 0 };
        let seen = (0..n_lights).filter(|&light_idx| !occluders.is_hidden(light_idx));
        let lights = seen.map(|light_idx| BallLight::new(face, light_idx, bounds, &occluders));
        let lights = lights.collect::<Option<Vec<_>>>()?;
        let at_right_angles = (face.eye_error_at_right_angles / face.radius).max(400.0 * u);
        let [x, y, z] = face.center;
        Some(Self {
            face: face_idx,
            center: face.center,
            radius: face.radius,
            equation: f64::from(face.equation),
            minus_radius: -face.radius * units.scale,
            rounding: 2.0 * (x.abs() + y.abs() + z.abs() + 3.0 * face.radius),
            eye_dir_slack: factor * 2.0 * bounds.eye.roundoff,
            eye_normal_slack: factor * 1.05 * at_right_angles,
            color_slacks: lights.iter().map(BallLight::error).sum::<f64>() / factor,
            lights,
            occluders,
        })
    }

    /// Returns the points with the given unit normals.
    #[inline(always)]
    fn points<L: Lanes>(&self, normal: [L; 3]) -> [L; 3] {
        let radius = L::splat(self.radius);
        [
            radius.mul_add(normal[0], L::splat(self.center[0])),
            radius.mul_add(normal[1], L::splat(self.center[1])),
            radius.mul_add(normal[2], L::splat(self.center[2])),
        ]
    }
}
