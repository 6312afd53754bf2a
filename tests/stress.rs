//! The scenes of `scenes/stress`: what they break, counted, and that their golden images are right.
//!
//! Each scene says in its head how many pixels a textbook tracer gets wrong, and `docs/stress.md` tells of all of them.
//! `CLISC_BLESS=1` writes the numbers there, once the golden images exist. `CLISC_SWEEP=1` looks at all pixels instead of some.

mod textbook;

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use clisc::exact::Renderer;
use clisc::exec::exact_settings;
use clisc::image::decode_png;
use clisc::ir::{self, Registers, SceneView};
use clisc::plan::{Settings, Size};
use clisc::source::Source;
use rayon::prelude::*;

use textbook::Textbook;

/// What the line of a scene with its numbers begins with.
const TEXTBOOK_LINE: &str = "# Textbook: ";

/// The page with the table of all scenes, and the lines that stand before and behind it.
const PAGE: &str = "docs/stress.md";
const TABLE_ENDS: [&str; 2] = ["<!-- counted by tests/stress.rs -->\n", "<!-- end of what is counted -->\n"];

/// The epsilons of the textbook tracers: those that are seen most.
const EPSILONS: [f64; 2] = [1e-4, 1e-6];

/// Of so many pixels one is computed exactly; a prime to the width of the images, so that all columns have their turn.
const STEP: usize = 11;

/// A scene with its golden image.
struct Case {
    name: String,
    path: PathBuf,
    text: String,
    size: Size,
    /// Row by row from the top.
    golden: Vec<[u8; 3]>,
}

fn blesses() -> bool {
    std::env::var_os("CLISC_BLESS").is_some_and(|value| value == "1")
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Reads a scene by its name below `scenes/`.
fn case(name: &str) -> Case {
    let path = root().join("scenes").join(name).with_extension("cli");
    let text = fs::read_to_string(&path).expect("a scene in UTF-8");
    let golden = root().join("reference").join(name).with_extension("png");
    let golden = fs::read(&golden).unwrap_or_else(|error| panic!("{}: {error}", golden.display()));
    let golden = decode_png(&golden).expect("a PNG file");
    let size = Size::new(golden.width(), golden.height()).expect("a size within the limits");
    Case { name: name.to_owned(), path, text, size, golden: golden.rgb().as_chunks().0.to_vec() }
}

/// Returns the scenes of `scenes/stress`, sorted.
fn cases() -> Vec<Case> {
    let entries = fs::read_dir(root().join("scenes/stress")).expect("a folder");
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "cli"));
    paths.sort();
    paths.iter().map(|path| case(&format!("stress/{}", path.file_stem().expect("a name").display()))).collect()
}

impl Case {
    /// Calls `look` with the last view of the scene.
    fn with_view<T>(&self, look: impl FnOnce(SceneView<'_>) -> T) -> T {
        let compiled = clisc::compile(&Source::new("scene.cli", &*self.text));
        let program = ir::validate(compiled.program).expect("a sound program");
        let mut registers = Registers::default();
        program.commands.iter().for_each(|command| registers.step(command));
        look(SceneView::new(&program, registers))
    }

    /// Counts the pixels that the textbook tracers get wrong, for each epsilon.
    fn count_textbook_wrong(&self) -> [usize; 2] {
        EPSILONS.map(|epsilon| {
            let image = self.with_view(|view| Textbook { epsilon }.image(view, self.size));
            image.iter().zip(&self.golden).filter(|(drawn, right)| drawn != right).count()
        })
    }

    /// Returns the line that says so.
    fn textbook_line(&self, [coarse, fine]: [usize; 2]) -> String {
        let n_pixels = self.golden.len();
        format!("{TEXTBOOK_LINE}{coarse} of {n_pixels} pixels wrong with epsilon 1e-4, {fine} with 1e-6.")
    }

    /// Returns what the scene says that it is: the comment at its head as far as its first empty line.
    fn description(&self) -> String {
        let lines = self.text.lines().map_while(|line| line.strip_prefix("# "));
        lines.collect::<Vec<_>>().join(" ")
    }

    /// Writes the line into the scene.
    fn bless(&self, line: &str) {
        let lines = self.text.lines().map(|old| if old.starts_with(TEXTBOOK_LINE) { line } else { old });
        let blessed: String = lines.flat_map(|line| [line, "\n"]).collect();
        if blessed != self.text {
            fs::write(&self.path, blessed).expect("a written scene");
        }
    }
}

#[test]
fn a_scene_says_how_many_pixels_a_textbook_gets_wrong() {
    let mut faults = Vec::new();
    for case in cases() {
        let n_wrong = case.count_textbook_wrong();
        let line = case.textbook_line(n_wrong);
        if blesses() {
            case.bless(&line);
        } else if !case.text.lines().any(|said| said == line) {
            faults.push(format!("{} should say\n  {line}", case.name));
        }
        if n_wrong == [0; 2] {
            faults.push(format!("{} is no stress for a textbook", case.name));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn the_page_has_every_scene() {
    let mut table = String::from("| scene | what it is | wrong with 1e-4 | with 1e-6 |\n|---|---|---:|---:|\n");
    for case in cases() {
        let stem = case.name.trim_start_matches("stress/");
        let [coarse, fine] = case.count_textbook_wrong();
        let link = format!("[{stem}](../scenes/{}.cli)", case.name);
        writeln!(table, "| {link} | {} | {coarse} | {fine} |", case.description()).expect("a string takes any text");
    }
    let page = fs::read_to_string(root().join(PAGE)).expect("the page");
    let [start, end] = TABLE_ENDS.map(|line| page.find(line).expect("a mark around the table"));
    let start = start + TABLE_ENDS[0].len();
    if blesses() {
        fs::write(root().join(PAGE), [&page[..start], &table, &page[end..]].concat()).expect("a written page");
    } else {
        assert!(page[start..end] == table, "{PAGE} tells something else; CLISC_BLESS=1 writes it anew");
    }
}

/// The counts are worth something only if the textbook tracer is right where textbooks are.
#[test]
fn a_textbook_is_right_on_ordinary_scenes() {
    for name in ["first-steps/snowman", "shading/shadows", "mirrors/triangle", "gallery/temple"] {
        let n_wrong = case(name).count_textbook_wrong();
        assert!(n_wrong.iter().all(|n| *n <= 2), "{name}: {n_wrong:?}");
    }
}

#[test]
fn the_golden_images_are_exact() {
    let step = if std::env::var_os("CLISC_SWEEP").is_some() { 1 } else { STEP };
    let mut faults = Vec::new();
    for case in cases() {
        let wrong: Vec<_> = case.with_view(|view| {
            let width = case.size.width();
            let exact = Renderer::new(view, &exact_settings(&Settings { size: case.size, ..Settings::default() }));
            let pixels = (0..case.golden.len()).into_par_iter().step_by(step);
            pixels
                .map(|i| (i as u32 % width, i as u32 / width, case.golden[i]))
                .filter(|&(column, row, golden)| exact.pixel(column, row).rgb != golden)
                .collect()
        });
        if !wrong.is_empty() {
            faults.push(format!("{}: wrong are (column, row, colour) {wrong:?}", case.name));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
