//! Rule `name-unlike-file`.

use crate::diag::words::quoted;
use crate::diag::{Diagnostic, Fix, Safety};
use crate::lint::context::RuleContext;
use crate::lint::registry::declare_rule;
use crate::syntax::file_name;
use crate::syntax::spec::CommandKind;

declare_rule! {
    /// Finds a `write` whose name does not begin with that of the scene's file.
    ///
    /// ## Why
    ///
    /// Who sees `cube.png` looks for `cube.cli`; mostly a scene was copied and the name forgotten.
    ///
    /// ## Example
    ///
    /// ```cli
    /// fov 60
    /// light 1 1 1  0 0 5
    /// surface 0.1 0 0  0.8 0.2 0.2  0 0 0  1  0
    /// sphere 0 0 -4  1
    /// write cube.png
    /// ```
    ///
    /// ## Instead
    ///
    /// ```cli
    /// fov 60
    /// light 1 1 1  0 0 5
    /// surface 0.1 0 0  0.8 0.2 0.2  0 0 0  1  0
    /// sphere 0 0 -4  1
    /// write ball.png
    /// ```
    ///
    /// ## Fix safety
    ///
    /// Unsafe: the image gets another name.
    ///
    /// ## Limits
    ///
    /// Case, folders and what follows the name are no matter: `out/Ball-2.png` is fine in `ball.cli`. Nor are the words of a name
    /// that begins with a number: `p01.png` is fine in `01_one_sphere.cli`, and `i1_partA.png` in `i1_mine.cli`. A scene that is
    /// not a file has no name.
    pub static NAME_UNLIKE_FILE = {
        id: "L0501", name: "name-unlike-file", title: "a `write` whose name is unlike that of its file", fix: Some(Safety::Unsafe),
    }
}

fn check(cx: &RuleContext<'_>, acc: &mut Vec<Diagnostic>) {
    let Some(file_stem) = cx.options.file_stem.as_deref().filter(|stem| !stem.is_empty()) else { return };
    let mut is_first = true;
    for write in cx.all_of(CommandKind::Write) {
        let Some((name, span)) = file_name(cx.source, write.span) else { continue };
        if is_like(stem_of(name), file_stem) {
            continue;
        }
        let message =
            format!("{} is unlike the name of its scene, {}", quoted(name), quoted(&format!("{file_stem}.cli")));
        let renamed = renamed(name, file_stem).filter(|_| std::mem::take(&mut is_first));
        acc.push(
            Diagnostic::new(&NAME_UNLIKE_FILE.code, span, message)
                .label("begins with another name")
                .help(format!("let it begin with {}", quoted(file_stem)))
                .fix(renamed.map(|name| Fix::write(Safety::Unsafe, span, name))),
        );
    }
}

/// Returns the name of an image without folders and ending.
fn stem_of(name: &str) -> &str {
    let file = name.rsplit(['/', '\\']).next().unwrap_or(name);
    file.strip_suffix(".png").unwrap_or(file)
}

/// Tells whether an image is called as its scene, or so with something behind that, or bears the scene's number: `p01` and
/// `01_one_sphere`, `i1_partA` and `i1-mine`.
fn is_like(image: &str, scene: &str) -> bool {
    let [image, scene] = [image, scene].map(str::to_lowercase);
    let is_numbered = || match (numbered(&image), numbered(&scene)) {
        (Some((letters, number)), Some((other_letters, other))) => {
            number == other && (letters == other_letters || letters.is_empty() || other_letters.is_empty())
        }
        _ => false,
    };
    image.starts_with(&scene) || is_numbered()
}

/// Returns the number with which a name begins, but for a letter or a few before it, and those letters.
fn numbered(name: &str) -> Option<(&str, &str)> {
    /// `scene` and `image` are words before a number, and so is `p`.
    const MAX_LETTERS: usize = 6;
    let start = name.find(|c: char| c.is_ascii_digit()).filter(|start| *start <= MAX_LETTERS)?;
    let (letters, rest) = name.split_at(start);
    let digits = &rest[..rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len())];
    let letters = letters.trim_end_matches(['_', '-', ' ']);
    letters.chars().all(char::is_alphabetic).then_some((letters, digits.trim_start_matches('0')))
}

/// Returns the name of an image, in its folder, that is called as its scene.
fn renamed(name: &str, file_stem: &str) -> Option<String> {
    let folder = name.strip_suffix(&format!("{}.png", stem_of(name)))?;
    let renamed = format!("{folder}{file_stem}.png");
    let needs_quotes = renamed.contains([' ', '\t', '#', '"']);
    (!needs_quotes).then_some(renamed)
}
