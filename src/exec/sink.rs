//! Where images go.

use std::collections::BTreeMap;
use std::io;
use std::path::PathBuf;

use crate::exec::Refusal;
use crate::plan::Size;

/// Takes the images of a program.
///
/// An image is there as a whole after [`Sink::commit`] or not at all: a file dropped before leaves no trace, and what
/// the sink held under its name stays.
pub trait Sink {
    /// An image on its way.
    type File: io::Write + Send;

    /// Finds out what [`Sink::create`] would say to the name, and changes nothing.
    ///
    /// # Errors
    /// When the image cannot be taken.
    fn check(&mut self, name: &str) -> Result<(), SinkError> {
        let _ = name;
        Ok(())
    }

    /// Makes room for an image.
    ///
    /// # Errors
    /// When it cannot be taken.
    fn create(&mut self, request: &ImageRequest<'_>) -> Result<Self::File, SinkError>;

    /// Takes a finished image.
    ///
    /// # Errors
    /// When it cannot be kept; it is then abandoned.
    fn commit(&mut self, file: Self::File) -> Result<(), SinkError>;
}

/// An image that a program wants to write.
#[derive(Clone, Copy, Debug)]
pub struct ImageRequest<'a> {
    /// The name as in the source: a relative path without `..`.
    pub name: &'a str,
    /// Pixels of the image.
    pub size: Size,
}

/// Why a sink cannot take an image.
#[derive(Debug)]
#[non_exhaustive]
pub enum SinkError {
    /// The scene may not write there.
    Refused(Refusal),
    /// The world is in the way.
    Io {
        /// What failed.
        step: Step,
        /// To which file or folder.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
}

/// What a sink was doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Step {
    /// Following the way to the place that the name means.
    Reach,
    /// Making the folder of an image.
    MakeFolder,
    /// Making a file.
    Create,
    /// Giving a finished file its name.
    Save,
}

impl std::fmt::Display for SinkError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Refused(refusal) => write!(f, "the name of the image {refusal}"),
            Self::Io { step, path, .. } => {
                let verb = match step {
                    Step::Reach => "reach",
                    Step::MakeFolder => "make the folder",
                    Step::Create => "create",
                    Step::Save => "save",
                };
                write!(f, "cannot {verb} `{}`", path.display())
            }
        }
    }
}

impl std::error::Error for SinkError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Refused(_) => None,
            Self::Io { source, .. } => Some(source),
        }
    }
}

/// Keeps the files of images in memory, by name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MemorySink {
    /// The PNG files so far.
    pub files: BTreeMap<String, Vec<u8>>,
}

/// An image on its way into a [`MemorySink`].
#[derive(Debug)]
pub struct MemoryFile {
    name: String,
    bytes: Vec<u8>,
}

impl io::Write for MemoryFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.bytes.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Sink for MemorySink {
    type File = MemoryFile;

    fn create(&mut self, request: &ImageRequest<'_>) -> Result<MemoryFile, SinkError> {
        Ok(MemoryFile { name: request.name.to_owned(), bytes: Vec::new() })
    }

    fn commit(&mut self, file: MemoryFile) -> Result<(), SinkError> {
        self.files.insert(file.name, file.bytes);
        Ok(())
    }
}
