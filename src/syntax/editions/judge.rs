//! The choice of an edition: which one the lines of a scene speak for.
//!
//! Every line is read under every edition. A line that 2018 refuses and another edition takes speaks for that one; a line
//! that the other refuses, or that says something odd there, speaks against it. Lines that fare alike in both say nothing,
//! mistakes included. So one wrong line of a scene of 2018 does not make it one of 2017: its other lines stand against that.

use crate::source::Source;
use crate::syntax::editions::reading::{Camera, Line, Reading, read_lines};
use crate::syntax::editions::verdict::{Evidence, Verdict};
use crate::syntax::editions::{Edition, Editions, editions_with};

/// The commands that are looked at: they tell, and a large scene is not read a second time for a slip at its end.
const MAX_COMMANDS: usize = 2_000;

/// The command that sets the camera.
const EYE: &str = "eye";

/// How many times more must speak for an edition than against it.
const MIN_MAJORITY: u32 = 3;

/// Finds out whether a scene is written in another edition than 2018, from the scene as a whole; `None` when nothing says
/// so, or not enough.
#[must_use]
pub fn judge(source: &Source) -> Option<Verdict> {
    let scene = read_lines(source, MAX_COMMANDS);
    let others = || Edition::BY_PREFERENCE.into_iter().filter(|edition| *edition != Edition::OURS);
    let tallies: Vec<_> = others().map(|edition| Tally::of(&scene, edition)).collect();
    let best = tallies.iter().min_by_key(|tally| tally.faults)?;
    if best.votes_for <= MIN_MAJORITY * best.votes_against {
        return None;
    }
    let is_certain = best.has_proof;
    let is_suspect = best.evidence.iter().any(|evidence| evidence.reading == Reading::Odd);
    if !is_certain && !is_suspect {
        return None;
    }
    let equals: Vec<_> =
        tallies.iter().filter(|tally| tally.faults == best.faults).map(|tally| tally.edition).collect();
    let names = used_names(&scene);
    Some(Verdict { editions: Editions::of(&equals), is_certain, evidence: best.evidence.clone(), names })
}

/// What speaks for an edition and against it.
struct Tally {
    edition: Edition,
    /// What is wrong and odd under this edition.
    faults: u32,
    votes_for: u32,
    votes_against: u32,
    /// Whether a line that is wrong in 2018 is fine here.
    has_proof: bool,
    /// The lines that speak for it.
    evidence: Vec<Evidence>,
}

impl Tally {
    fn of(scene: &[Line<'_>], edition: Edition) -> Self {
        let [ours, theirs] = [Edition::OURS, edition].map(|edition| Camera::of(scene, edition));
        let mut tally =
            Self { edition, faults: 0, votes_for: 0, votes_against: 0, has_proof: false, evidence: Vec::new() };
        // Where a scene can set its camera it does; that tells editions apart in which all lines read alike.
        let can_set_camera = editions_with(EYE).has(edition);
        if can_set_camera && !scene.iter().any(|line| line.name == EYE) {
            tally.faults += weight(Reading::Odd);
        }
        for line in scene.iter().filter(|line| has_vote(line)) {
            let there = line.under(edition, &theirs);
            let here = match line.under(Edition::OURS, &ours) {
                // In doubt a light is one of 2018.
                Reading::Odd if line.is_just_bright(Edition::OURS) => there.min(Reading::Odd),
                here => here,
            };
            tally.faults += weight(there);
            tally.votes_for += weight(here).saturating_sub(weight(there));
            tally.votes_against += weight(there).saturating_sub(weight(here));
            tally.has_proof |= (here, there) == (Reading::Wrong, Reading::Fine);
            if here > there {
                let form = line.form(edition).map(|(form, _)| form).expect("a line that is not wrong has a form");
                let with_it = editions_with(line.name);
                tally.evidence.push(Evidence { span: line.span, form, with_it, reading: here });
            }
        }
        tally
    }
}

/// Returns how much a line weighs that reads like this.
const fn weight(reading: Reading) -> u32 {
    match reading {
        Reading::Fine => 0,
        Reading::Odd => 1,
        Reading::Wrong => 3,
    }
}

/// Tells whether a line counts: a triangle counts once, not for each of its five lines.
fn has_vote(line: &Line<'_>) -> bool {
    !matches!(line.name, "vertex" | "end")
}

/// Returns the first words of the lines that some edition has as commands, each once, in their order.
fn used_names(scene: &[Line<'_>]) -> Vec<&'static str> {
    let mut names = Vec::new();
    for form in super::FORMS.iter() {
        if !names.contains(&form.name) && scene.iter().any(|line| line.name == form.name) {
            names.push(form.name);
        }
    }
    names
}
