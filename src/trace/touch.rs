//! Eye rays that touch a surface or meet a rim: whether they do, exactly.
//!
//! The discriminant of a ray that touches is 0, and no bound that rounding leaves tells 0 from what is merely small. But all
//! that an eye ray is made of is known exactly, save one number.
//!
//! # Method
//! The eye is the origin, and its rays lead along d = (x·k, y·k, −n): n whole steps make half the image's height, x and y are
//! the place of the sample in such steps, and k = tan(fov/2). What is asked is whether c₀ + c₁·k + c₂·k² = 0, where the
//! coefficients are polynomials in numbers of the scene, which [`Expansion`]s hold without rounding.
//!
//! - *A sphere at c with radius r is touched* if D = (c·d)² − (d·d)·p is 0, with p = |c|² − r². Let A = x·cₓ + y·c_y and
//!   q = x² + y². Then c₂ = A² − q·p, c₁ = −2·n·A·c_z and c₀ = n²·(c_z² − p).
//! - *A wall* is touched if the same holds in the plane of x and z: with y = 0 and c_y = 0.
//! - *A rim*, a circle about (cₓ, h, c_z) of radius r at the height h, is met if the ray, at that height for t = h/(y·k), is
//!   r away from its axis. Times y·k: (x·h − y·cₓ)²·k² + (n·h + y·k·c_z)² = r²·y²·k². So c₂ = (x·h − y·cₓ)² + y²·(c_z² − r²),
//!   c₁ = 2·n·h·y·c_z and c₀ = n²·h².
//!
//! For a field of view of 90 degrees k is 1, and the sum is one more expansion. For 120 and 60 degrees k is √3 and 1/√3, which
//! no fraction is: c₁ has to be 0 and c₀ + 3·c₂ or 3·c₀ + c₂ too. For others the coefficients have to be 0, each; k could be
//! the root of such a polynomial all the same, so that "no" only says that it is not known.

use crate::math::Expansion;

/// How an eye ray may barely meet what it meets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Touch {
    /// It touches a sphere or a wall.
    Tangent,
    /// It meets the rim of a wall or a cap.
    Rim,
}

/// How often eye rays were proved to touch, in one pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Touches {
    /// Spheres and walls.
    pub n_tangents: u32,
    /// Rims, of walls and of caps.
    pub n_rims: u32,
}

impl Touches {
    /// Counts one.
    pub fn count(&mut self, touch: Touch) {
        match touch {
            Touch::Tangent => self.n_tangents += 1,
            Touch::Rim => self.n_rims += 1,
        }
    }

    /// Returns the number of both.
    #[must_use]
    pub fn total(self) -> u32 {
        self.n_tangents + self.n_rims
    }
}

/// What is known of k = tan(fov/2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HalfTangent {
    /// 1/√3, of 60 degrees.
    RootOfThird,
    /// 1, of 90 degrees.
    One,
    /// √3, of 120 degrees.
    RootOf3,
    /// Nothing.
    Unknown,
}

/// The direction (x·k, y·k, −n) of an eye ray.
#[derive(Clone, Copy, Debug)]
pub struct Aim {
    /// Steps from the middle of the image to the right: a whole number up to 2²⁵.
    x: f64,
    /// Steps from the middle of the image up, as `x`.
    y: f64,
    /// Steps in half the height of the image: a whole number up to 2²⁴.
    n: f64,
    k: HalfTangent,
}

impl HalfTangent {
    /// Returns what is known for a field of view in degrees.
    pub fn of_fov(fov_deg: f64) -> Self {
        match fov_deg {
            60.0 => Self::RootOfThird,
            90.0 => Self::One,
            120.0 => Self::RootOf3,
            _ => Self::Unknown,
        }
    }

    /// Tells whether c₀ + c₁·k + c₂·k² is known to be 0; `linear_is_zero` of c₁, and the others are made only if that can be.
    fn is_root(self, linear: &Expansion, others: impl FnOnce() -> Option<[Expansion; 2]>) -> Option<bool> {
        if self != Self::One && !linear.is_zero() {
            return Some(false);
        }
        let [constant, square] = others()?;
        Some(match self {
            Self::RootOfThird => constant.scaled(3.0)?.plus(&square).is_zero(),
            Self::One => constant.plus(linear).plus(&square).is_zero(),
            Self::RootOf3 => square.scaled(3.0)?.plus(&constant).is_zero(),
            Self::Unknown => constant.is_zero() && square.is_zero(),
        })
    }
}

impl Aim {
    /// Aims at the place (`x`, `y`), in steps from the middle of the image, right and up, of which half its height has
    /// `steps_per_half_height`.
    pub fn new(x: i64, y: i64, steps_per_half_height: u32, k: HalfTangent) -> Self {
        // At most 65535 · 2 · 256 steps: exact, and so are squares of them and their sums.
        Self { x: x as f64, y: y as f64, n: f64::from(steps_per_half_height), k }
    }

    /// Tells whether the ray is known to touch a sphere.
    pub fn touches_sphere(&self, center: [f64; 3], radius: f64) -> bool {
        self.touches(center, radius).unwrap_or(false)
    }

    /// Tells whether the ray is known to touch the infinite wall of a cylinder, whose axis is at `center`, x and z.
    pub fn touches_wall(&self, center: [f64; 2], radius: f64) -> bool {
        Self { y: 0.0, ..*self }.touches_sphere([center[0], 0.0, center[1]], radius)
    }

    fn touches(&self, center: [f64; 3], radius: f64) -> Option<bool> {
        let Self { x, y, n, k } = *self;
        let across = Expansion::of_products([[x, center[0]], [y, center[1]]])?;
        let linear = across.scaled(center[2])?.scaled(-2.0 * n)?;
        k.is_root(&linear, || {
            let power = Expansion::power_of_point([0.0; 3], center, radius)?;
            let square = across.times(&across)?.plus(&power.scaled(-(x * x + y * y))?);
            let depth_squared = Expansion::of_products([[center[2], center[2]]])?;
            let constant = depth_squared.plus(&power.scaled(-1.0)?).scaled(n * n)?;
            Some([constant, square])
        })
    }

    /// Tells whether the ray is known to meet a rim, a circle at a height about an axis at `center`, x and z.
    pub fn meets_rim(&self, center: [f64; 2], radius: f64, height: f64) -> bool {
        // The ray is at that height before the eye, not in it or behind.
        self.y * height > 0.0 && self.is_level_with_rim(center, radius, height).unwrap_or(false)
    }

    fn is_level_with_rim(&self, [center_x, center_z]: [f64; 2], radius: f64, height: f64) -> Option<bool> {
        let Self { x, y, n, k } = *self;
        let linear = Expansion::of_products([[height, center_z]])?.scaled(2.0 * n * y)?;
        k.is_root(&linear, || {
            let across = Expansion::of_products([[x, height], [-y, center_x]])?;
            let along = Expansion::of_products([[center_z, center_z], [-radius, radius]])?;
            let square = across.times(&across)?.plus(&along.scaled(y * y)?);
            let constant = Expansion::of_products([[height, height]])?.scaled(n * n)?;
            Some([constant, square])
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Stream;

    /// Fields of view with tan(fov/2), and whether every touch is known.
    const FIELDS: [(f64, f64, bool); 4] = [
        (60.0, 0.577_350_269_189_625_8, true),
        (90.0, 1.0, true),
        (120.0, 1.732_050_807_568_877_2, true),
        (40.0, 0.363_970_234_266_202_4, false),
    ];

    /// What is not 0 is at least so large: u + v·√3 of whole numbers below 10⁶ is at least 1/(|u| + |v|·√3) if it is not 0.
    const ZERO: f64 = 1e-8;

    /// A case of whole numbers: x, y and n, the centre and the radius of a sphere.
    fn small_case(stream: &mut Stream) -> ([i64; 2], u32, [f64; 3], f64) {
        let mut whole = |reach: usize| stream.below(2 * reach + 1) as i64 - reach as i64;
        let aim = [whole(6), whole(6)];
        // For most fields of view a rim is met exactly only if its axis is beside the eye.
        let center = [whole(3), whole(3), whole(12) * whole(1).abs()].map(|c| c as f64);
        (aim, stream.below(6) as u32 + 1, center, stream.below(6) as f64 + 1.0)
    }

    /// The discriminant of a ray of direction (x·k, y·k, −n) and a sphere, or circle without y, by its definition.
    fn discriminant([x, y]: [i64; 2], n: u32, k: f64, center: [f64; 3], radius: f64) -> f64 {
        let dir = [x as f64 * k, y as f64 * k, -f64::from(n)];
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let along = dot(center, dir);
        along * along - dot(dir, dir) * (dot(center, center) - radius * radius)
    }

    /// Asserts that a touch is told where there is one, and nowhere else; scaled up to many bits, and not next to it.
    fn assert_told(told: impl Fn(f64) -> bool, told_beside: bool, distance: f64, is_complete: bool, case: &str) -> u32 {
        let is_touch = distance.abs() < ZERO;
        for scale in [1.0, 1.0 + libm::ldexp(1.0, -40), libm::ldexp(1.0, 100), libm::ldexp(3.0, -200)] {
            let is_told = told(scale);
            assert!(is_touch || !is_told, "no touch, by {distance}: {case} times {scale}");
            assert!(is_told || !is_touch || !is_complete, "a touch: {case} times {scale}");
        }
        assert!(!(is_touch && told_beside), "not with another radius: {case}");
        u32::from(told(1.0))
    }

    #[test]
    fn a_sphere_or_wall_is_touched_exactly_if_the_discriminant_is_0() {
        let mut stream = Stream::new(3);
        for (fov_deg, k, is_complete) in FIELDS {
            let mut n_touches = 0;
            for _ in 0..60_000 {
                let (place, n, center, radius) = small_case(&mut stream);
                let aim = Aim::new(place[0], place[1], n, HalfTangent::of_fov(fov_deg));
                let case = format!("fov {fov_deg}, {aim:?}, {center:?}, {radius}");
                let sphere = |scale: f64| aim.touches_sphere(center.map(|c| c * scale), radius * scale);
                let beside = aim.touches_sphere(center, radius.next_up());
                let distance = discriminant(place, n, k, center, radius);
                n_touches += assert_told(sphere, beside, distance, is_complete, &case);

                let axis = [center[0], center[2]];
                let wall = |scale: f64| aim.touches_wall(axis.map(|c| c * scale), radius * scale);
                let beside = aim.touches_wall(axis, radius.next_up());
                let distance = discriminant([place[0], 0], n, k, [axis[0], 0.0, axis[1]], radius);
                assert_told(wall, beside, distance, is_complete, &case);
            }
            assert!(n_touches >= 10, "{n_touches} of fov {fov_deg}");
        }
    }

    #[test]
    fn a_rim_is_met_exactly_if_the_ray_is_a_radius_away_at_its_height() {
        let mut stream = Stream::new(4);
        for (fov_deg, k, is_complete) in FIELDS {
            let mut n_touches = 0;
            for _ in 0..60_000 {
                let ([x, y], n, [center_x, height, center_z], radius) = small_case(&mut stream);
                let aim = Aim::new(x, y, n, HalfTangent::of_fov(fov_deg));
                let case = format!("fov {fov_deg}, {aim:?}, axis at {center_x} {center_z}, height {height}, {radius}");
                let center = [center_x, center_z];
                let rim = |scale: f64| aim.meets_rim(center.map(|c| c * scale), radius * scale, height * scale);
                if y as f64 * height <= 0.0 {
                    assert!(!rim(1.0), "not before the eye: {case}");
                    continue;
                }
                let t = height / (y as f64 * k);
                let (across, along) = (x as f64 * k * t - center_x, f64::from(n) * t + center_z);
                let away = across * across + along * along;
                let beside = aim.meets_rim(center, radius.next_down(), height);
                // Times (y·k)² and for 60 degrees 3 more it is of whole numbers.
                let distance = (away - radius * radius) * (y * y * 3) as f64;
                n_touches += assert_told(rim, beside, distance, is_complete, &case);
            }
            assert!(n_touches >= 5 || !is_complete, "{n_touches} of fov {fov_deg}");
        }
    }

    #[test]
    fn what_may_underflow_or_overflow_is_not_told() {
        let aim = Aim::new(0, 0, 1, HalfTangent::One);
        assert!(aim.touches_sphere([3.0, 0.0, -4.0], 3.0), "the middle ray touches a ball beside it");
        assert!(!aim.touches_sphere([3e-300, 0.0, -4e-300], 3e-300));
        assert!(!aim.touches_sphere([3e300, 0.0, -4e300], 3e300));
    }
}
