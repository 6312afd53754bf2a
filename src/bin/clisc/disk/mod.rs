//! Saving files, each as a whole or not at all: images where a call wants them, scenes in place of themselves.

mod attributes;
mod in_place;
mod links;
mod pending;
mod place;
mod replace;

use std::fs;
use std::io::{self, Seek, Write};
use std::path::{Path, PathBuf};

use clisc::exec::{ImageRequest, Refusal, Sink, SinkError, Step};
use tempfile::SpooledTempFile;

use self::links::{follow_links, follow_links_below};
use self::pending::PendingFile;
use crate::print;

pub use self::place::{Destination, Place};
pub use self::replace::replace;

/// Takes the images of a scene to their place; folders are made when they are missing. An image is there as a whole or not
/// at all.
#[derive(Debug)]
pub struct ImageSink {
    place: Place,
}

/// An image on its way.
#[derive(Debug)]
pub enum ImageFile {
    /// To the disk.
    Disk {
        /// The file.
        pending: PendingFile,
        /// Where it goes, all links followed.
        target: PathBuf,
        /// What messages call it.
        shown: PathBuf,
    },
    /// To standard output: it may be begun anew, and is not shown before it is whole.
    Stdout(SpooledTempFile),
}

/// Images for standard output wait in memory up to this size, larger ones in a temporary file.
const MAX_SPOOLED_BYTES: usize = 64 << 20;

/// Saves a file as a whole or not at all; its folder is there already. Links are followed, and the rights of a file that is
/// there stay.
///
/// # Errors
/// When it cannot be saved, or when the file that is there may not be written.
pub fn save(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let target = follow_links(path)?;
    if let Some(found) = replace::existing(&target)? {
        replace::check_writable(&target, &found)?;
    }
    let mut pending = PendingFile::create_in(target.parent().unwrap_or(&target))?;
    pending.write_all(bytes)?;
    replace::save_over(pending, &target)
}

impl ImageSink {
    /// Makes the sink of a place and touches nothing.
    pub fn new(place: Place) -> Self {
        Self { place }
    }

    /// Finds the file that a name means, all links followed, so that a link within the folder stays a link; `None` for
    /// standard output.
    ///
    /// # Errors
    /// When a link leads out of the folder, when the name is that of a folder or of a file that may not be written, or when
    /// the way is barred.
    pub fn find(&self, name: &str) -> Result<Option<PathBuf>, SinkError> {
        let io_error = |step| move |source| SinkError::Io { step, path: self.place.shown(name), source };
        let target = match &self.place {
            Place::Stdout => return Ok(None),
            Place::File(file) => follow_links(file).map_err(io_error(Step::Reach))?,
            Place::Folder(folder) => {
                let root = follow_links(folder).map_err(io_error(Step::Reach))?;
                let target = follow_links_below(&root, Path::new(name)).map_err(io_error(Step::Reach))?;
                if !target.starts_with(&root) {
                    return Err(SinkError::Refused(Refusal::LinkLeadsOut { to: target }));
                }
                target
            }
        };
        if let Some(found) = replace::existing(&target).map_err(io_error(Step::Create))? {
            match replace::check_writable(&target, &found) {
                Err(error) if error.kind() == io::ErrorKind::PermissionDenied => {
                    return Err(SinkError::Refused(Refusal::ReadOnly { path: self.place.shown(name) }));
                }
                checked => checked.map_err(io_error(Step::Create))?,
            }
        }
        Ok(Some(target))
    }
}

impl Sink for ImageSink {
    type File = ImageFile;

    fn check(&mut self, name: &str) -> Result<(), SinkError> {
        self.find(name).map(drop)
    }

    fn create(&mut self, request: &ImageRequest<'_>) -> Result<ImageFile, SinkError> {
        let Some(target) = self.find(request.name)? else {
            return Ok(ImageFile::Stdout(SpooledTempFile::new(MAX_SPOOLED_BYTES)));
        };
        let shown = self.place.shown(request.name);
        let folder = target.parent().unwrap_or(&target);
        if let Err(source) = fs::create_dir_all(folder) {
            let path = shown.parent().filter(|path| *path != Path::new("")).unwrap_or(Path::new(".")).to_owned();
            return Err(SinkError::Io { step: Step::MakeFolder, path, source });
        }
        match PendingFile::create_in(folder) {
            Ok(pending) => Ok(ImageFile::Disk { pending, target, shown }),
            Err(source) => Err(SinkError::Io { step: Step::Create, path: shown, source }),
        }
    }

    fn commit(&mut self, file: ImageFile) -> Result<(), SinkError> {
        let io_error = |path| |source| SinkError::Io { step: Step::Save, path, source };
        match file {
            ImageFile::Disk { pending, target, shown } => replace::save_over(pending, &target).map_err(io_error(shown)),
            ImageFile::Stdout(file) => print_file(file).map_err(io_error(self.place.shown(""))),
        }
    }
}

/// Copies a file to standard output from its beginning.
fn print_file(mut file: SpooledTempFile) -> io::Result<()> {
    file.rewind()?;
    let mut out = print::stdout();
    io::copy(&mut file, &mut out)?;
    out.flush()
}

impl Write for ImageFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Disk { pending, .. } => pending.write(bytes),
            Self::Stdout(file) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::Disk { pending, .. } => pending.flush(),
            Self::Stdout(file) => file.flush(),
        }
    }
}
