//! Saving files, each as a whole or not at all: images below one folder, scenes in place of themselves.

mod in_place;
mod links;
mod pending;
mod replace;

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clisc::exec::{ImageRequest, Refusal, Sink, SinkError, Step};

use self::links::{follow_links, follow_links_below};
use self::pending::PendingFile;

pub use self::replace::replace;

/// Saves images below a folder, which is made when it is missing. An image is there as a whole or not at all.
#[derive(Debug)]
pub struct DiskSink {
    out_dir: PathBuf,
}

/// An image on its way to the disk.
#[derive(Debug)]
pub struct DiskFile {
    pending: PendingFile,
    /// Where it goes, all links followed.
    target: PathBuf,
    /// What messages call it.
    shown: PathBuf,
}

/// Returns the path of the image `name` below `out_dir` as messages show it.
pub fn shown(out_dir: &Path, name: &str) -> PathBuf {
    if out_dir == Path::new(".") { PathBuf::from(name) } else { out_dir.join(name) }
}

/// Saves a file as a whole or not at all; its folder is there already. Links are followed.
pub fn save(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let target = follow_links(path)?;
    let mut pending = PendingFile::create_in(target.parent().unwrap_or(&target))?;
    pending.write_all(bytes)?;
    pending.save_as(&target)
}

impl DiskSink {
    /// Makes the sink of a folder and touches nothing.
    pub fn new(out_dir: &Path) -> Self {
        Self { out_dir: out_dir.to_owned() }
    }

    /// Finds the file that a name means, all links followed, so that a link within the folder stays a link.
    ///
    /// # Errors
    /// When a link leads out of the folder, when the name is that of a folder, or when the way is barred.
    pub fn find(&self, name: &str) -> Result<PathBuf, SinkError> {
        let io_error = |step| move |source| SinkError::Io { step, path: shown(&self.out_dir, name), source };
        let root = follow_links(&self.out_dir).map_err(io_error(Step::Reach))?;
        let target = follow_links_below(&root, Path::new(name)).map_err(io_error(Step::Reach))?;
        if !target.starts_with(&root) {
            return Err(SinkError::Refused(Refusal::LinkLeadsOut { to: target }));
        }
        if target.is_dir() {
            return Err(io_error(Step::Create)(io::ErrorKind::IsADirectory.into()));
        }
        Ok(target)
    }
}

impl Sink for DiskSink {
    type File = DiskFile;

    fn check(&mut self, name: &str) -> Result<(), SinkError> {
        self.find(name).map(drop)
    }

    fn create(&mut self, request: &ImageRequest<'_>) -> Result<DiskFile, SinkError> {
        let target = self.find(request.name)?;
        let shown = shown(&self.out_dir, request.name);
        let folder = target.parent().unwrap_or(&target);
        if let Err(source) = fs::create_dir_all(folder) {
            let path = shown.parent().filter(|path| *path != Path::new("")).unwrap_or(&self.out_dir).to_owned();
            return Err(SinkError::Io { step: Step::MakeFolder, path, source });
        }
        match PendingFile::create_in(folder) {
            Ok(pending) => Ok(DiskFile { pending, target, shown }),
            Err(source) => Err(SinkError::Io { step: Step::Create, path: shown, source }),
        }
    }

    fn commit(&mut self, file: DiskFile) -> Result<(), SinkError> {
        let DiskFile { pending, target, shown } = file;
        pending.save_as(&target).map_err(|source| SinkError::Io { step: Step::Save, path: shown, source })
    }
}

impl Write for DiskFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.pending.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.pending.flush()
    }
}
