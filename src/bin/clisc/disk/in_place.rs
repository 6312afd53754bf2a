//! Writing into a file that has several names (hard links): a new file in its place would have only one of them.

use std::fs::{self, File, Metadata};
use std::io::{self, Write};
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use tempfile::NamedTempFile;

use super::replace::HAS_CHANGED;

/// Tells whether a file has several names.
pub fn has_several_names(found: &Metadata) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        found.nlink() > 1
    }
    #[cfg(not(unix))]
    {
        let _ = found;
        false
    }
}

/// One file at a time: each of its names may be a scene of this run.
static TURN: Mutex<()> = Mutex::new(());

/// Writes `new` over the content of a file, which is `old`, if that has not been done by another of its names. Until that is on the disk the old content is kept in a file
/// beside it, `.clisc-*.old`, where it is also found if the process is killed.
///
/// # Errors
/// When it holds something else or cannot be written; the old content is then back in the file, or else the message says where it is.
pub fn overwrite(target: &Path, old: &[u8], new: &[u8]) -> io::Result<()> {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let now = fs::read(target)?;
    if now == new {
        return Ok(());
    }
    if now != old {
        return Err(io::Error::other(HAS_CHANGED));
    }
    let folder = target.parent().unwrap_or(target);
    let mut kept = tempfile::Builder::new().prefix(".clisc-").suffix(".old").tempfile_in(folder)?;
    kept.write_all(old)?;
    kept.as_file().sync_all()?;
    write_over(target, new).map_err(|error| match write_over(target, old) {
        Ok(()) => error,
        Err(_) => told_where(kept, &error),
    })
}

fn write_over(target: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = File::options().write(true).open(target)?;
    file.write_all(bytes)?;
    file.set_len(bytes.len() as u64)?;
    file.sync_all()
}

/// Keeps the old content for good, and says where it is.
fn told_where(kept: NamedTempFile, error: &io::Error) -> io::Error {
    match kept.keep() {
        Ok((_, path)) => io::Error::other(format!("{error}; what it held is in `{}`", path.display())),
        Err(failed) => failed.error,
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn every_name_has_the_new_content_and_nothing_is_left_over() {
        let dir = tempfile::tempdir().unwrap();
        let [first, second] = ["a.cli", "b.cli"].map(|name| dir.path().join(name));
        fs::write(&first, "a long old text").unwrap();
        assert!(!has_several_names(&fs::metadata(&first).unwrap()));
        fs::hard_link(&first, &second).unwrap();
        assert!(has_several_names(&fs::metadata(&first).unwrap()));
        overwrite(&first, b"a long old text", b"new").unwrap();
        assert_eq!(fs::read(&second).unwrap(), b"new");
        overwrite(&second, b"a long old text", b"new").unwrap();
        assert!(overwrite(&second, b"another", b"newer").is_err());
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 2);
    }
}
