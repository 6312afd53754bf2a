//! Images of one call that would have the same place, found before anything is rendered.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use anyhow::bail;
use clisc::diag::words::{counted, visible};
use clisc::ir::{Command, Program};
use clisc::source::Source;

use crate::disk::{Destination, ImageSink};
use crate::input;

/// The most clashes that are told one by one.
const MAX_TOLD: usize = 5;

/// What is known of a scene before it is rendered.
#[derive(Debug, Default)]
pub struct Preview {
    /// The names that it writes to, in order.
    names: Vec<String>,
    /// Standard input, which cannot be read again.
    pub stdin: Option<Source>,
}

/// Reads scenes for what they write; one that cannot be read or has errors writes nothing, and is told of later.
pub fn preview(scenes: &[PathBuf]) -> Vec<Preview> {
    let mut previews = Vec::with_capacity(scenes.len());
    let look = |path: &Path| {
        let Ok(source) = input::read(path) else { return Preview::default() };
        let compilation = clisc::compile(&source);
        let names = if compilation.has_errors() {
            Vec::new()
        } else {
            names(&compilation.program).map(str::to_owned).collect()
        };
        Preview { names, stdin: Some(source).filter(|_| input::is_stdin(path)) }
    };
    let take = |_: &Path, preview| {
        previews.push(preview);
        Ok(())
    };
    input::for_each_scene(scenes, look, take).expect("nothing that ends it");
    previews
}

/// Looks whether every image of all scenes has a place of its own. Of two images of one scene that have one name the later
/// replaces the earlier; the compiler warns of that.
///
/// # Errors
/// When two have not; the message tells how to give them one.
pub fn refuse_clashes(destination: &Destination, scenes: &[PathBuf], previews: &[Preview]) -> anyhow::Result<()> {
    let names: Vec<&[String]> = previews.iter().map(|preview| &preview.names[..]).collect();
    let clashes = find(destination, scenes, &names);
    if clashes.is_empty() {
        return Ok(());
    }
    let way_out = way_out(destination, scenes, &names);
    let told: Vec<&str> = clashes.iter().take(MAX_TOLD).map(String::as_str).collect();
    let more = match clashes.len().saturating_sub(MAX_TOLD) {
        0 => String::new(),
        n => format!("; and {n} more"),
    };
    bail!("{}{more}; nothing is rendered\n  {way_out}", told.join("; "))
}

/// As [`refuse_clashes`], for the names of the only scene of a call.
pub fn refuse_clashes_within(destination: &Destination, scene: &PathBuf, program: &Program) -> anyhow::Result<()> {
    let preview = Preview { names: names(program).map(str::to_owned).collect(), stdin: None };
    refuse_clashes(destination, std::slice::from_ref(scene), &[preview])
}

/// Says of each place that two images have what they are.
fn find(destination: &Destination, scenes: &[PathBuf], names: &[&[String]]) -> Vec<String> {
    let mut first_at: HashMap<Option<PathBuf>, (usize, usize)> = HashMap::new();
    let mut clashes = Vec::new();
    for (scene_idx, scene) in scenes.iter().enumerate() {
        let place = destination.place_for(scene);
        let sink = ImageSink::new(place.clone());
        for (write_idx, name) in names[scene_idx].iter().enumerate() {
            // What the sink refuses is told when the scene is rendered.
            let Ok(target) = sink.find(name) else { continue };
            let (other_scene, other_write) = *first_at.entry(target).or_insert((scene_idx, write_idx));
            let shown = visible(&place.shown(name).display().to_string()).into_owned();
            if other_scene != scene_idx {
                let [first, second] = [other_scene, scene_idx].map(|idx| input::name_of(&scenes[idx]));
                clashes.push(format!("`{first}` and `{second}` both write `{shown}`"));
            } else if other_write != write_idx && !place.is_folder() {
                let n = counted(names[scene_idx].len(), "image");
                clashes.push(format!("`{}` has {n}, and `{shown}` is one", input::name_of(scene)));
                break;
            }
        }
    }
    clashes
}

/// Tells how each image gets a place of its own.
fn way_out(destination: &Destination, scenes: &[PathBuf], names: &[&[String]]) -> String {
    let clashing_scenes = scenes.len() > 1;
    let better = destination.alternatives().into_iter().find(|other| find(other, scenes, names).is_empty());
    match better {
        Some(folder) if clashing_scenes => format!("give each scene a folder of its own: --out-dir '{folder}'"),
        _ if clashing_scenes => "render them one by one, each with an --out-dir of its own".to_owned(),
        _ => "name a folder: --out-dir out".to_owned(),
    }
}

/// Returns the file names of a program, in order.
pub fn names(program: &Program) -> impl Iterator<Item = &str> {
    program.commands.iter().filter_map(|command| match command {
        Command::Write(name) => Some(&**name),
        _ => None,
    })
}
