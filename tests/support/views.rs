//! Scenes as the tracers take them.

use clisc::ir::{self, Registers, SceneView, Valid};
use clisc::source::Source;

/// Compiles a sound scene.
pub fn compile(text: &str) -> Valid {
    let compiled = clisc::compile(&Source::new("scene.cli", text));
    assert!(!compiled.has_errors(), "{:?}", compiled.diagnostics);
    ir::validate(compiled.program).expect("a sound program")
}

/// Returns what a program has set and placed at its end.
pub fn last_view(program: &Valid) -> SceneView<'_> {
    let mut registers = Registers::default();
    program.commands.iter().for_each(|command| registers.step(command));
    SceneView::new(program, registers)
}

/// Calls `visit` with the title and the last view of every scene in `scenes/` that has no errors, those under stress aside.
pub fn for_every_scene(mut visit: impl FnMut(&str, SceneView<'_>)) {
    for folder in ["first-steps", "commands", "shading", "mirrors", "gallery"] {
        let folder = format!("{}/scenes/{folder}", env!("CARGO_MANIFEST_DIR"));
        let mut paths: Vec<_> =
            std::fs::read_dir(&folder).expect("a folder").map(|entry| entry.expect("an entry").path()).collect();
        paths.sort();
        for path in paths {
            let text = std::fs::read_to_string(&path).expect("a readable scene");
            visit(&path.display().to_string(), last_view(&compile(&text)));
        }
    }
}
