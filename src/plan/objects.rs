//! Pass `objects`: objects that no eye ray and no reflected ray of the image can meet.
//!
//! # Why it is safe
//! - **Copies.** Of two objects with the same equations, caps included, a ray meets both at the same t, and the one
//!   declared first counts; on the way to a light either blocks. A ray that leaves one leaves the other. So the later is
//!   never seen and never needed.
//! - **Outside the view.** Each eye ray lies between the four planes of the frustum, with z < 0.
//! - **Sealed.** An object O is sealed when rays from the eye and from mirrors come to it from outside alone. Rays do not
//!   pass surfaces: a reflected ray stays on the side from which its surface was met. So with the eye outside of O, off its
//!   surface, a ray could only start inside, or on O to the inside, where a mirror A cuts the surface of O and A counts for
//!   the hit. At equal t the first declared counts: if A is declared after O, that is O, and convex O is left for good. The
//!   far rim of a cylinder is the exception: what only touches it in passing does not meet it (see `reaches` in
//!   `src/trace/intersect.rs`), so there A may count. So O is sealed if every mirror that is declared before O does not cut
//!   it, and every later one keeps away from its rims. Spheres that touch from outside do not cut: the ray that meets A
//!   where they touch comes from beyond their common tangent plane, or within that plane, and is sent back there.
//! - **Hidden.** A ray that meets what lies strictly inside a sealed O meets O before. On the way to a light, with all
//!   lights outside O, off its surface: a segment from outside or from O's surface through the inside leaves O, with t
//!   above 0 and before the light, so O blocks it too. The same holds for a chain of objects each inside the next.
//! - **Reflected rays** exist only where an eye ray can meet a mirror.
//!
//! Only pairs of objects take more than linear time; with too many pairs for the size of the image all of this but the
//! copies is left out.

use glam::DVec3;
use rustc_hash::FxHashSet;

use crate::plan::bodies::Solid;
use crate::plan::frustum::Frustum;
use crate::plan::scene::retain_at;
use crate::plan::solid::Faces;
use crate::plan::{Part, Scene};

/// What is known of each object, spheres first.
#[derive(Debug)]
pub(super) struct Roles {
    /// Whether eye rays may meet it.
    pub seen: Vec<bool>,
    /// Whether reflected rays may.
    pub mirrored: Vec<bool>,
    /// Whether both come to it from outside alone.
    pub sealed: Vec<bool>,
    /// The faces that they may meet, if they come from outside alone.
    pub faces: Vec<Faces>,
    /// Whether rays may meet it that it reflects.
    pub is_mirror: Vec<bool>,
    /// The object inside of which it is never met.
    pub hidden_in: Vec<Option<usize>>,
}

impl Roles {
    /// Knows nothing: every object may be met from everywhere.
    pub fn unknown(scene: &Scene<'_>, part: Part) -> Self {
        let n = scene.n_objects();
        let is_mirror = mirrors_of(scene, part);
        Self {
            seen: vec![true; n],
            mirrored: vec![is_mirror.contains(&true); n],
            sealed: vec![false; n],
            faces: vec![Faces::ALL; n],
            is_mirror,
            hidden_in: vec![None; n],
        }
    }

    /// Finds out which rays come to which objects.
    pub fn new(scene: &Scene<'_>, solids: &[Solid], frustum: &Frustum, part: Part) -> Self {
        let n = solids.len();
        let mut seen: Vec<_> = solids.iter().map(|solid| !frustum.misses(solid)).collect();
        let is_mirror = live_mirrors(mirrors_of(scene, part), &seen);
        let sealed = find_sealed(scene, solids, &is_mirror);
        let hidden_in = find_hidden(scene, solids, &sealed);
        let is_free = |i: usize| hidden_in[i].is_none();
        seen.iter_mut().enumerate().for_each(|(i, seen)| *seen &= is_free(i));
        let is_mirror = is_mirror.into_iter().enumerate().map(|(i, is_mirror)| is_mirror && is_free(i)).collect();
        let is_mirror = live_mirrors(is_mirror, &seen);
        let faces = (0..n).map(|i| if sealed[i] { faces_met(solids, &is_mirror, i) } else { Faces::ALL }).collect();
        let has_mirrors = is_mirror.contains(&true);
        Self {
            seen,
            mirrored: (0..n).map(|i| has_mirrors && is_free(i)).collect(),
            sealed,
            faces,
            is_mirror,
            hidden_in,
        }
    }

    /// Tells whether any ray but one to a light may meet an object.
    pub fn is_met(&self, i: usize) -> bool {
        self.seen[i] || self.mirrored[i]
    }

    /// Leaves out objects in which none is hidden any more.
    pub fn retain(&mut self, keep: impl Fn(usize) -> bool) {
        let Self { seen, mirrored, sealed, faces, is_mirror, hidden_in } = self;
        [seen, mirrored, sealed, is_mirror].into_iter().for_each(|known| retain_at(known, &keep));
        retain_at(faces, &keep);
        retain_at(hidden_in, &keep);
    }
}

/// Returns the mirrors, if an eye ray can meet one; otherwise none is ever met.
fn live_mirrors(is_mirror: Vec<bool>, seen: &[bool]) -> Vec<bool> {
    let has_start = is_mirror.iter().zip(seen).any(|(is_mirror, seen)| *is_mirror && *seen);
    if has_start { is_mirror } else { vec![false; is_mirror.len()] }
}

/// Returns for each object whether eye rays and reflected rays come to it from outside alone.
fn find_sealed(scene: &Scene<'_>, solids: &[Solid], is_mirror: &[bool]) -> Vec<bool> {
    let orders: Vec<_> = scene.primitives().map(|primitive| primitive.order).collect();
    let n = solids.len();
    let may_open = |m: usize, i: usize| {
        let counts_first = orders[m] < orders[i] || !solids[i].keeps_rims_from(&solids[m]);
        m != i && is_mirror[m] && counts_first && !solids[i].does_not_cut(&solids[m])
    };
    (0..n).map(|i| solids[i].excludes(DVec3::ZERO) && !(0..n).any(|m| may_open(m, i))).collect()
}

/// Returns for each object a sealed one without lights in which it lies.
fn find_hidden(scene: &Scene<'_>, solids: &[Solid], sealed: &[bool]) -> Vec<Option<usize>> {
    let mut hidden_in = vec![None; solids.len()];
    let is_dark = |outer: &Solid| scene.lights.iter().all(|light| outer.excludes(light.position));
    for outer in (0..solids.len()).filter(|&i| sealed[i] && is_dark(&solids[i])) {
        for inner in (0..solids.len()).filter(|&i| i != outer) {
            if hidden_in[inner].is_none() && solids[outer].contains(&solids[inner]) {
                hidden_in[inner] = Some(outer);
            }
        }
    }
    hidden_in
}

/// Returns the faces of a sealed object that the eye and the mirrors face.
fn faces_met(solids: &[Solid], is_mirror: &[bool], i: usize) -> Faces {
    let toward_eye = solids[i].faces_toward(DVec3::ZERO);
    let others = (0..solids.len()).filter(|&m| is_mirror[m] && m != i);
    others.fold(toward_eye, |faces, m| faces.or(solids[i].faces_toward_solid(&solids[m])))
}

/// Tells of each object whether its reflected rays are followed.
fn mirrors_of(scene: &Scene<'_>, part: Part) -> Vec<bool> {
    scene.primitives().map(|primitive| part == Part::B && scene.surface(*primitive).reflectance > 0.0).collect()
}

/// Returns for each object whether an equal one is declared before it.
pub(super) fn find_copies(scene: &Scene<'_>) -> Vec<bool> {
    let n_equations = scene.sphere_equations.iter().map(|id| id.number() as usize + 1).max().unwrap_or(0);
    let mut known = vec![false; n_equations];
    let is_copy_of_sphere = |id: &crate::ir::EquationId| std::mem::replace(&mut known[id.number() as usize], true);
    let mut copies: Vec<_> = scene.sphere_equations.iter().map(is_copy_of_sphere).collect();
    let mut known = FxHashSet::default();
    copies.extend(scene.wall_equations.iter().zip(scene.cap_equations.iter()).map(|ids| !known.insert(ids)));
    copies
}
