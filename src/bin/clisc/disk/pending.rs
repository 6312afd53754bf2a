//! A file that nobody sees until it is whole.

use std::fs::{File, Metadata};
use std::io::{self, Write};
use std::path::Path;

use tempfile::NamedTempFile;

use super::attributes;

/// A file being written. Dropped before [`PendingFile::save_as`], it leaves nothing behind.
#[derive(Debug)]
pub enum PendingFile {
    /// A file without a name: the system removes it however the process ends.
    #[cfg(target_os = "linux")]
    Nameless(File),
    /// A temporary file beside the target, where files without names do not exist.
    Named(NamedTempFile),
}

impl PendingFile {
    /// Makes a file in `folder`, the folder where it will be saved.
    pub fn create_in(folder: &Path) -> io::Result<Self> {
        #[cfg(target_os = "linux")]
        if let Some(file) = linux::create_nameless(folder)? {
            return Ok(Self::Nameless(file));
        }
        Self::create_named_in(folder)
    }

    /// Makes a temporary file with the rights of any new file; tempfile's own are for secrets.
    fn create_named_in(folder: &Path) -> io::Result<Self> {
        let create = |path: &Path| File::options().write(true).create_new(true).open(path);
        tempfile::Builder::new().prefix(".clisc-").suffix(".tmp").make_in(folder, create).map(Self::Named)
    }

    /// Gives the file its name, in one step for whoever looks; a file of that name is replaced.
    ///
    /// A file system that knows files without names takes the room for what is written to them at once, so that nothing
    /// is left to fail. Others, those behind a network first of all, may still find that a file is too large when it is
    /// sent to the disk: there that comes before the name. A power cut may take any image that has not reached the disk
    /// yet; the scene can make it again.
    ///
    /// # Errors
    /// When the file cannot be kept or named; a file of that name is then still there.
    pub fn save_as(self, target: &Path) -> io::Result<()> {
        match self {
            #[cfg(target_os = "linux")]
            Self::Nameless(file) => linux::give_name(&file, target),
            Self::Named(file) => {
                file.as_file().sync_all()?;
                file.persist(target).map(drop).map_err(|failed| failed.error)
            }
        }
    }

    /// Gives the file the rights of the one at `path`, which is `other`, and its owner and attributes as far as the system
    /// allows.
    ///
    /// # Errors
    /// When it cannot have these rights.
    pub fn take_after(&self, path: &Path, other: &Metadata) -> io::Result<()> {
        #[cfg(unix)]
        {
            use std::os::unix::fs::{MetadataExt, fchown};
            let own = self.file().metadata()?;
            if (own.uid(), own.gid()) != (other.uid(), other.gid()) {
                // Few may give files away; whoever may not keeps the file.
                let _ = fchown(self.file(), Some(other.uid()), Some(other.gid()));
            }
        }
        self.file().set_permissions(other.permissions())?;
        attributes::copy(path, self.file());
        Ok(())
    }

    fn file(&self) -> &File {
        match self {
            #[cfg(target_os = "linux")]
            Self::Nameless(file) => file,
            Self::Named(file) => file.as_file(),
        }
    }
}

impl Write for PendingFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file().flush()
    }
}

#[cfg(target_os = "linux")]
mod linux {
    use std::fs::{self, File};
    use std::io;
    use std::os::fd::AsRawFd;
    use std::path::Path;

    use rustix::fs::{AtFlags, CWD, Mode, OFlags};
    use rustix::io::Errno;

    /// Through it a file without a name can be reached; not there in every container.
    const DESCRIPTORS: &str = "/proc/self/fd";

    /// Makes a file without a name; `None` where the file system cannot.
    pub fn create_nameless(folder: &Path) -> io::Result<Option<File>> {
        if !Path::new(DESCRIPTORS).exists() {
            return Ok(None);
        }
        let flags = OFlags::TMPFILE | OFlags::WRONLY | OFlags::CLOEXEC;
        match rustix::fs::open(folder, flags, Mode::from_raw_mode(0o666)) {
            Ok(fd) => Ok(Some(fd.into())),
            // The first is today's answer, the others are those of kernels and file systems that do not know the flag.
            Err(Errno::OPNOTSUPP | Errno::ISDIR | Errno::NOENT | Errno::INVAL) => Ok(None),
            Err(error) => Err(error.into()),
        }
    }

    /// Links the file to its name. A taken name is replaced by way of a temporary one, because `link` cannot replace.
    pub fn give_name(file: &File, target: &Path) -> io::Result<()> {
        match link(file, target) {
            Err(Errno::EXIST) => replace(file, target),
            result => Ok(result?),
        }
    }

    fn replace(file: &File, target: &Path) -> io::Result<()> {
        for attempt in 0.. {
            let temporary = target.with_file_name(format!(".clisc-{}-{attempt}.tmp", std::process::id()));
            match link(file, &temporary) {
                Ok(()) => return fs::rename(&temporary, target).inspect_err(|_| drop(fs::remove_file(&temporary))),
                Err(Errno::EXIST) => {}
                Err(error) => return Err(error.into()),
            }
        }
        unreachable!("some number is free")
    }

    fn link(file: &File, name: &Path) -> rustix::io::Result<()> {
        let nameless = format!("{DESCRIPTORS}/{}", file.as_raw_fd());
        rustix::fs::linkat(CWD, nameless, CWD, name, AtFlags::SYMLINK_FOLLOW)
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    type Create = fn(&Path) -> io::Result<PendingFile>;

    /// Every way to make a pending file on this system.
    const WAYS: [Create; 2] = [PendingFile::create_in, PendingFile::create_named_in];

    fn names_in(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> =
            fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_appears_when_saved_and_replaces_another() {
        for create_in in WAYS {
            let dir = tempfile::tempdir().unwrap();
            let target = dir.path().join("a.png");
            for content in ["one", "two"] {
                let mut file = create_in(dir.path()).unwrap();
                file.write_all(content.as_bytes()).unwrap();
                assert_ne!(fs::read_to_string(&target).ok().as_deref(), Some(content));
                file.save_as(&target).unwrap();
                assert_eq!(fs::read_to_string(&target).unwrap(), content);
            }
            assert_eq!(names_in(dir.path()), ["a.png"]);
        }
    }

    #[test]
    fn a_dropped_file_leaves_nothing_also_in_a_panic() {
        for create_in in WAYS {
            let dir = tempfile::tempdir().unwrap();
            let folder = dir.path().to_owned();
            fs::write(folder.join("a.png"), "old").unwrap();
            let panicked = std::panic::catch_unwind(|| {
                let mut file = create_in(&folder).unwrap();
                file.write_all(b"new").unwrap();
                std::panic::resume_unwind(Box::new("a bug"));
            });
            assert!(panicked.is_err());
            assert_eq!(names_in(dir.path()), ["a.png"]);
            assert_eq!(fs::read_to_string(dir.path().join("a.png")).unwrap(), "old");
        }
    }

    #[test]
    fn a_file_that_cannot_get_its_name_leaves_nothing() {
        for create_in in WAYS {
            let dir = tempfile::tempdir().unwrap();
            fs::create_dir(dir.path().join("folder.png")).unwrap();
            let file = create_in(dir.path()).unwrap();
            assert!(file.save_as(&dir.path().join("folder.png")).is_err());
            assert_eq!(names_in(dir.path()), ["folder.png"]);
        }
    }

    /// The rights of a saved file are those that any new file here has.
    #[cfg(unix)]
    #[test]
    fn a_saved_file_has_ordinary_rights() {
        use std::os::unix::fs::PermissionsExt;
        for create_in in WAYS {
            let dir = tempfile::tempdir().unwrap();
            let mode = |name| fs::metadata(dir.path().join(name)).unwrap().permissions().mode();
            fs::write(dir.path().join("ordinary"), "").unwrap();
            create_in(dir.path()).unwrap().save_as(&dir.path().join("saved")).unwrap();
            assert_eq!(mode("saved"), mode("ordinary"));
        }
    }

    #[test]
    fn a_missing_folder_is_an_error_without_a_temporary_path() {
        for create_in in WAYS {
            let error = create_in(Path::new("/missing/folder")).unwrap_err();
            assert_eq!(error.kind(), io::ErrorKind::NotFound);
            assert!(!error.to_string().contains("clisc"), "{error}");
        }
    }
}
