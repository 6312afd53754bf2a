//! What is kept of the images that a program has written, for those that are still to come.
//!
//! An image that equals an earlier one, by the pass `writes` of the plan, is not traced again: its file is copied. One that
//! shares pixels with the last one traced gets them from there. Both are kept only where a later `write` has the same field
//! of view and background, and only within [`MAX_BYTES`] each.

use crate::exec::{Proof, Unproved};
use crate::ir::{Command, Registers, Valid};
use crate::plan::{Changes, Pass, Plan, Precision, Settings, TileMask};
use crate::trace::Canvas;

/// The most bytes of files that are kept, and of pixels.
const MAX_BYTES: usize = 64 << 20;

/// The images so far.
#[derive(Debug)]
pub(super) struct Earlier {
    /// What each `write` of the program sees.
    views: Vec<Registers>,
    files: Vec<File>,
    /// What stands behind the pixels of each image so far, and which of them are not proved.
    proofs: Vec<(Option<Proof>, Unproved)>,
    /// The colour of all pixels of each image so far, if they have one.
    colors: Vec<Option<[u8; 3]>>,
    /// The last image that was traced whole, or in part upon another.
    pixels: Option<(usize, Canvas)>,
}

/// A file that was written.
#[derive(Debug)]
struct File {
    write_idx: usize,
    bytes: Vec<u8>,
}

impl Earlier {
    /// Looks ahead which images a program writes; keeps nothing when the pass is switched off.
    pub fn new(program: &Valid, settings: &Settings) -> Self {
        let mut registers = Registers::default();
        let mut views = Vec::new();
        for command in &program.commands {
            registers.step(command);
            if matches!(command, Command::Write(_)) && settings.passes.contains(Pass::Writes) {
                views.push(registers);
            }
        }
        Self { views, files: Vec::new(), proofs: Vec::new(), colors: Vec::new(), pixels: None }
    }

    /// Returns how many bytes of the file of a `write` are worth keeping.
    pub fn n_bytes_to_keep(&self, write_idx: usize) -> usize {
        if !self.is_needed_later(write_idx) {
            return 0;
        }
        let n_kept: usize = self.files.iter().map(|file| file.bytes.len()).sum();
        MAX_BYTES.saturating_sub(n_kept)
    }

    /// Tells whether a later `write` may share pixels with this one.
    fn is_needed_later(&self, write_idx: usize) -> bool {
        let Some(now) = self.views.get(write_idx) else { return false };
        let shares = |later: &Registers| later.fov_deg == now.fov_deg && later.background == now.background;
        self.views[write_idx + 1..].iter().any(shares)
    }

    /// Keeps what stands behind the pixels of the next `write`.
    pub fn keep_proof(&mut self, proof: Option<Proof>, unproved: Unproved) {
        self.proofs.push((proof, unproved));
    }

    /// Keeps the colour of all pixels of the next `write`, if they have one.
    pub fn keep_color(&mut self, color: Option<[u8; 3]>) {
        self.colors.push(color);
    }

    /// Returns the colour of all pixels of an earlier `write`, if they have one.
    pub fn color(&self, write_idx: usize) -> Option<[u8; 3]> {
        self.colors[write_idx]
    }

    /// Returns what stands behind the pixels of an earlier `write`, and which of them are not proved.
    pub fn proof(&self, write_idx: usize) -> &(Option<Proof>, Unproved) {
        &self.proofs[write_idx]
    }

    /// Tells whether another scene may have pixels of an earlier `write`. That those of both are the same is proved of what is
    /// right, and not of best values. Of a draft nothing is proved, and nothing asked.
    fn may_share(&self, write_idx: usize, settings: &Settings) -> bool {
        let (proof, unproved) = self.proof(write_idx);
        settings.precision == Precision::F32
            || unproved.n_pixels == 0
                && proof.as_ref().is_none_or(|proof| proof.is_complete() && proof.exact.lists_all_ties())
    }

    /// Keeps the file of a `write`.
    pub fn keep_file(&mut self, write_idx: usize, bytes: Vec<u8>) {
        self.files.push(File { write_idx, bytes });
    }

    /// Returns the `write` with the same scene, and its file.
    pub fn same_scene(&self, write_idx: usize) -> Option<(usize, &[u8])> {
        let now = self.views.get(write_idx)?;
        self.find_file(|file| self.views[file.write_idx] == *now)
    }

    /// Returns the `write` with the same image, and its file.
    pub fn same_image(&self, plan: &Plan<'_>) -> Option<(usize, &[u8])> {
        self.find_file(|file| {
            self.may_share(file.write_idx, &plan.settings)
                && plan.changes_since(&self.views[file.write_idx]) == Changes::Nothing
        })
    }

    fn find_file(&self, is_same: impl Fn(&File) -> bool) -> Option<(usize, &[u8])> {
        let file = self.files.iter().rev().find(|file| is_same(file))?;
        Some((file.write_idx, &file.bytes))
    }

    /// Returns the pixels so far, for an image to be traced upon, with its `write` and the tiles that may differ.
    pub fn shared_pixels(&self, plan: &Plan<'_>) -> Option<(usize, TileMask)> {
        let (write_idx, _) = self.pixels.as_ref()?;
        if !self.may_share(*write_idx, &plan.settings) {
            return None;
        }
        match plan.changes_since(&self.views[*write_idx]) {
            Changes::Tiles(mask) => Some((*write_idx, mask)),
            Changes::Nothing | Changes::Everything => None,
        }
    }

    /// Returns where the pixels of a `write` are to be kept, if they are needed later or hold what it shares.
    pub fn canvas(&mut self, write_idx: usize, plan: &Plan<'_>, is_upon: bool) -> Option<&Canvas> {
        if !is_upon {
            self.pixels = None;
            let size = plan.settings.size;
            let n_bytes = size.width() as usize * size.height() as usize * 3;
            if n_bytes > MAX_BYTES || !self.is_needed_later(write_idx) {
                return None;
            }
            self.pixels = Some((write_idx, Canvas::new(size, plan.scene.background)?));
        }
        let (of, canvas) = self.pixels.as_mut()?;
        *of = write_idx;
        Some(canvas)
    }
}
