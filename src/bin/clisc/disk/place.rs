//! Where the images of a scene go, as `--out-dir` says it.

use std::ffi::{OsStr, OsString};
use std::fmt;
use std::path::{Component, Path, PathBuf};

use crate::input;

/// What messages call standard output.
const STDOUT_NAME: &str = "<stdout>";

/// What `{scene}` and `{folder}` stand for when standard input has no name.
const STDIN_STEM: &str = "stdin";

/// Where the images of one scene go.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Place {
    /// Below a folder, by the names of the scene.
    Folder(PathBuf),
    /// To a file: there can be one image.
    File(PathBuf),
    /// To standard output: there can be one image.
    Stdout,
}

/// Where the images of all scenes go: `--out-dir` as it was read.
#[derive(Clone, Debug)]
pub struct Destination {
    /// As it was written.
    text: OsString,
    pieces: Vec<Piece>,
    kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Folder,
    File,
    Stdout,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Piece {
    Text(OsString),
    /// `{scene}`: the name of the scene without its ending.
    Scene,
    /// `{folder}`: the folder of the scene as it was given, without what leads out of a folder.
    Folder,
}

/// Something in braces that stands for nothing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownPlaceholder(String);

impl fmt::Display for UnknownPlaceholder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "`{}` in --out-dir stands for nothing; {{scene}} stands for the name of the scene and {{folder}} for its folder, \
             and {{{{ and }}}} for braces",
            self.0
        )
    }
}

impl std::error::Error for UnknownPlaceholder {}

impl Place {
    /// Tells whether there is room for several images.
    pub fn is_folder(&self) -> bool {
        matches!(self, Self::Folder(_))
    }

    /// Returns what messages call the image of this name.
    pub fn shown(&self, name: &str) -> PathBuf {
        match self {
            Self::Folder(folder) if folder == Path::new(".") => PathBuf::from(name),
            Self::Folder(folder) => folder.join(name),
            Self::File(file) => file.clone(),
            Self::Stdout => PathBuf::from(STDOUT_NAME),
        }
    }
}

impl Destination {
    /// Reads the value of `--out-dir`: `-` is standard output, a name that ends in .png a file, unless a folder is called
    /// so, and all else a folder.
    ///
    /// # Errors
    /// When it holds a placeholder that is none.
    pub fn parse(text: &Path) -> Result<Self, UnknownPlaceholder> {
        let is_image = text.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png"));
        let ends_as_folder = text.as_os_str().as_encoded_bytes().ends_with(b"/");
        let kind = match text {
            _ if text == Path::new("-") => Kind::Stdout,
            _ if is_image && !ends_as_folder && !text.is_dir() => Kind::File,
            _ => Kind::Folder,
        };
        let pieces = match text.to_str() {
            Some(text) => pieces(text)?,
            None => vec![Piece::Text(text.into())],
        };
        Ok(Self { text: text.into(), pieces, kind })
    }

    /// Tells whether images go to standard output, so that nothing else may.
    pub fn is_stdout(&self) -> bool {
        self.kind == Kind::Stdout
    }

    /// Returns the place for the images of a scene.
    pub fn place_for(&self, scene: &Path) -> Place {
        let file = input::file_of(scene).unwrap_or(Path::new(STDIN_STEM));
        let mut text = OsString::new();
        for piece in &self.pieces {
            match piece {
                Piece::Text(literal) => text.push(literal),
                Piece::Scene => text.push(stem(file)),
                Piece::Folder => text.push(folder(file)),
            }
        }
        // Without parts that are empty or `.`, as a scene in this folder leaves them.
        let path: PathBuf = Path::new(&text).components().collect();
        match self.kind {
            Kind::Folder => Place::Folder(path),
            Kind::File => Place::File(path),
            Kind::Stdout => Place::Stdout,
        }
    }

    /// Returns destinations that are likelier to give each scene a place of its own, the simpler one first.
    pub fn alternatives(&self) -> Vec<Self> {
        let folder = match self.kind {
            Kind::Folder if self.text != "." => Path::new(&self.text),
            _ => Path::new("out"),
        };
        let proposed = [folder.join("{scene}"), folder.join("{folder}").join("{scene}")];
        proposed.iter().filter_map(|path| Self::parse(path).ok()).collect()
    }
}

impl fmt::Display for Destination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Path::new(&self.text).display().fmt(f)
    }
}

/// Takes a text with placeholders apart.
fn pieces(text: &str) -> Result<Vec<Piece>, UnknownPlaceholder> {
    let mut pieces = Vec::new();
    let mut literal = String::new();
    let mut rest = text;
    while let Some(at) = rest.find(['{', '}']) {
        literal.push_str(&rest[..at]);
        rest = &rest[at..];
        let doubled = ["{{", "}}"].into_iter().find(|doubled| rest.starts_with(doubled));
        if let Some(doubled) = doubled {
            literal.push_str(&doubled[1..]);
            rest = &rest[2..];
            continue;
        }
        let known = [("{scene}", Piece::Scene), ("{folder}", Piece::Folder)];
        let Some((name, piece)) = known.into_iter().find(|(name, _)| rest.starts_with(name)) else {
            let end = rest.find('}').map_or(rest.len(), |end| end + 1);
            return Err(UnknownPlaceholder(rest[..end].to_owned()));
        };
        pieces.extend([Piece::Text(std::mem::take(&mut literal).into()), piece]);
        rest = &rest[name.len()..];
    }
    literal.push_str(rest);
    pieces.push(Piece::Text(literal.into()));
    Ok(pieces)
}

/// Returns the name of a scene without its ending, unless what is left leads elsewhere.
fn stem(file: &Path) -> &OsStr {
    let leads_elsewhere = |stem: &&OsStr| matches!(stem.as_encoded_bytes(), b"." | b"..");
    let name = file.file_name().unwrap_or(OsStr::new(STDIN_STEM));
    file.file_stem().filter(|stem| !leads_elsewhere(stem)).unwrap_or(name)
}

/// Returns the folder of a scene as far as it leads down; `.` if nothing is left.
fn folder(file: &Path) -> OsString {
    let parts = file.parent().unwrap_or(file).components();
    let down: PathBuf = parts.filter(|part| matches!(part, Component::Normal(_))).collect();
    if down == Path::new("") { OsString::from(".") } else { down.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(out_dir: &str, scene: &str) -> Place {
        Destination::parse(Path::new(out_dir)).unwrap().place_for(Path::new(scene))
    }

    #[test]
    fn placeholders_stand_for_scene_and_folder() {
        let folder = |path: &str| Place::Folder(path.into());
        for (out_dir, scene, expected) in [
            ("out", "a/b.cli", "out"),
            ("out/{scene}", "a/b.cli", "out/b"),
            ("out/{folder}/{scene}", "a/x/b.cli", "out/a/x/b"),
            ("out/{folder}/{scene}", "b.cli", "out/b"),
            ("{folder}/{scene}", "b.cli", "./b"),
            ("{folder}", "../a/./b.cli", "a"),
            ("out/{folder}", "/abs/a/b.cli", "out/abs/a"),
            ("out/x-{scene}-{{}}", "b.c.cli", "out/x-b.c-{}"),
            ("out/{scene}", "...cli", "out/...cli"),
        ] {
            assert_eq!(place(out_dir, scene), folder(expected), "{out_dir} {scene}");
        }
        for (out_dir, unknown) in [("{a}", "{a}"), ("x{scene", "{scene"), ("a}b", "}")] {
            let found = Destination::parse(Path::new(out_dir)).unwrap_err();
            assert_eq!(found, UnknownPlaceholder(unknown.into()));
        }
    }

    #[test]
    fn files_and_standard_output_are_told_from_folders() {
        assert_eq!(place("-", "a.cli"), Place::Stdout);
        assert_eq!(place("./-", "a.cli"), Place::Folder("./-".into()));
        assert_eq!(place("x/a.PNG", "a.cli"), Place::File("x/a.PNG".into()));
        assert_eq!(place("{scene}.png", "b/a.cli"), Place::File("a.png".into()));
        assert_eq!(place("a.png/", "a.cli"), Place::Folder("a.png".into()));
        assert_eq!(place(".png", "a.cli"), Place::Folder(".png".into()));
    }
}
