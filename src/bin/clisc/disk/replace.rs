//! Taking the place of a file: what may be replaced, and what the new file takes over.

use std::fs::{self, File, Metadata};
use std::io::{self, ErrorKind, Write};
use std::path::Path;

use super::in_place;
use super::links::follow_links;
use super::pending::PendingFile;

/// What is wrong with a file that somebody else has written.
pub(super) const HAS_CHANGED: &str = "has changed in the meantime";

/// Replaces the content of a file, as a whole or not at all. Links on the way are followed and stay; so do the rights of
/// the file, its attributes and, where the system allows, its owner. A file with several names is written
/// [in place](in_place).
///
/// # Errors
/// When the file may not be written, is no regular file, or no longer holds `old`.
pub fn replace(path: &Path, old: &[u8], new: &[u8]) -> io::Result<()> {
    let target = follow_links(path)?;
    let found = existing(&target)?.ok_or(ErrorKind::NotFound)?;
    check_writable(&target, &found)?;
    if in_place::has_several_names(&found) {
        return in_place::overwrite(&target, old, new);
    }
    if fs::read(&target)? != old {
        return Err(io::Error::other(HAS_CHANGED));
    }
    let mut pending = PendingFile::create_in(target.parent().unwrap_or(&target))?;
    pending.write_all(new)?;
    save_over(pending, &target)
}

/// Looks at the file that is to be replaced; `None` when there is none yet.
///
/// # Errors
/// When it is a folder or some device, or when it cannot be looked at.
pub fn existing(target: &Path) -> io::Result<Option<Metadata>> {
    match fs::metadata(target) {
        Ok(found) if found.is_dir() => Err(ErrorKind::IsADirectory.into()),
        Ok(found) if !found.is_file() => Err(io::Error::new(ErrorKind::InvalidInput, "it is no regular file")),
        Ok(found) => Ok(Some(found)),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error),
    }
}

/// Tells whether a file may be written. To replace one, the system asks for the rights of its folder only; here its own are
/// to count as well, and for everybody.
///
/// # Errors
/// When it may not.
pub fn check_writable(target: &Path, found: &Metadata) -> io::Result<()> {
    if found.permissions().readonly() {
        return Err(io::Error::new(ErrorKind::PermissionDenied, "it is read-only"));
    }
    File::options().write(true).open(target).map(drop)
}

/// Gives a file its name. If there is one of that name, its rights and attributes stay and, where the system allows, its
/// owner.
///
/// # Errors
/// When the file cannot be kept or named; the old one is then still there.
pub fn save_over(mut pending: PendingFile, target: &Path) -> io::Result<()> {
    pending.flush()?;
    if let Some(found) = existing(target)? {
        pending.take_after(target, &found)?;
    }
    pending.save_as(target)
}

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::fs::{PermissionsExt, symlink};

    use super::*;

    #[test]
    fn rights_and_links_stay() {
        let dir = tempfile::tempdir().unwrap();
        let (file, link) = (dir.path().join("a.cli"), dir.path().join("link.cli"));
        fs::write(&file, "old").unwrap();
        fs::set_permissions(&file, fs::Permissions::from_mode(0o640)).unwrap();
        symlink("a.cli", &link).unwrap();
        replace(&link, b"old", b"new").unwrap();
        assert_eq!(fs::read(&file).unwrap(), b"new");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::metadata(&file).unwrap().permissions().mode() & 0o7777, 0o640);
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 2);
    }

    #[test]
    fn what_may_not_be_written_or_has_changed_stays() {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("a.cli");
        fs::write(&file, "old").unwrap();
        assert_eq!(replace(&file, b"older", b"new").unwrap_err().to_string(), "has changed in the meantime");
        fs::set_permissions(&file, fs::Permissions::from_mode(0o444)).unwrap();
        assert_eq!(replace(&file, b"old", b"new").unwrap_err().kind(), ErrorKind::PermissionDenied);
        assert_eq!(fs::read(&file).unwrap(), b"old");
        assert!(replace(dir.path(), b"old", b"new").is_err());
        assert_eq!(replace(&dir.path().join("b.cli"), b"", b"new").unwrap_err().kind(), ErrorKind::NotFound);
    }
}
