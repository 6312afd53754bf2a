//! Notes on images that show less than their scene declares.

use clisc::diag::Diagnostic;
use clisc::diag::words::{counted, visible};
use clisc::lint::{OneColor, Unseen};
use clisc::source::Source;

/// Returns the note on an image, if there is something to note: a line that says what is not seen, and why.
///
/// - `image`: what messages call it.
/// - `color`: that of all its pixels, if they have one and have been made.
/// - `unseen`: what is known of the scene.
pub fn on_image(source: &Source, image: &str, color: Option<[u8; 3]>, unseen: &Unseen) -> Option<String> {
    let image = visible(image);
    let what = match (color, unseen.one_color) {
        (Some([0, 0, 0]), _) | (None, Some(OneColor::Black)) => format!("every pixel of `{image}` is black"),
        (Some([r, g, b]), _) => format!("every pixel of `{image}` has the colour #{r:02x}{g:02x}{b:02x}"),
        (None, Some(_)) => format!("`{image}` shows nothing but its background"),
        (None, None) => return on_objects(source, &image, &unseen.objects),
    };
    Some(format!("note: {what}: {}\n", reason(source, unseen)))
}

/// Says why an image has one colour, as far as it is known.
fn reason(source: &Source, unseen: &Unseen) -> String {
    let found: Vec<&Diagnostic> = match unseen.one_color {
        Some(OneColor::Black) => unseen.lights.iter().chain(&unseen.objects).collect(),
        _ => unseen.objects.iter().chain(&unseen.view).chain(&unseen.lights).collect(),
    };
    match (found.as_slice(), unseen.one_color) {
        (_, Some(OneColor::NoObject { is_early: true })) => {
            "the objects stand behind its `write`, which shows what stands before".into()
        }
        (_, Some(OneColor::NoObject { is_early: false })) => "the scene has no object".into(),
        ([first], _) => at_place(source, first),
        ([first, ..], _) => format!("{}; `clisc lint {}` tells more", at_place(source, first), visible(source.name())),
        ([], Some(OneColor::Black)) => "no surface has an ambient colour, and none is lit".into(),
        ([], Some(OneColor::NothingInView)) => "no object is in view: the eye looks along −z".into(),
        ([], _) => format!("`clisc ir {} --emit plan` tells what it needs of the scene", visible(source.name())),
    }
}

/// Says that objects are not seen.
fn on_objects(source: &Source, image: &str, objects: &[Diagnostic]) -> Option<String> {
    let first = at_place(source, objects.first()?);
    Some(match objects.len() {
        1 => format!("note: an object cannot be seen in `{image}`: {first}\n"),
        n => {
            let (objects, scene) = (counted(n, "object"), visible(source.name()));
            format!("note: {objects} cannot be seen in `{image}`, as {first}; `clisc lint {scene}` tells more\n")
        }
    })
}

/// Returns a finding with its place.
fn at_place(source: &Source, found: &Diagnostic) -> String {
    let place = source.lines().position(source.text(), found.primary.span.start);
    format!("{} ({}:{}:{})", found.message, visible(source.name()), place.line, place.column)
}
