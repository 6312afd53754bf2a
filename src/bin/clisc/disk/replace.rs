//! Saving a scene in place of itself.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Write};
use std::path::Path;

use super::in_place;
use super::links::follow_links;
use super::pending::PendingFile;

/// What is wrong with a file that somebody else has written.
pub(super) const HAS_CHANGED: &str = "has changed in the meantime";

/// Replaces the content of a file, as a whole or not at all. Links on the way are followed and stay; so do the rights of
/// the file and, where the system allows, its owner. A file with several names is written [in place](in_place).
///
/// # Errors
/// When the file may not be written, is no regular file, or no longer holds `old`.
pub fn replace(path: &Path, old: &[u8], new: &[u8]) -> io::Result<()> {
    let target = follow_links(path)?;
    let found = fs::metadata(&target)?;
    if !found.is_file() {
        return Err(io::Error::new(ErrorKind::InvalidInput, "is no regular file"));
    }
    // Its folder alone decides whether a file can be replaced; here its own rights are to count as well.
    if found.permissions().readonly() {
        return Err(ErrorKind::PermissionDenied.into());
    }
    drop(File::options().write(true).open(&target)?);
    if in_place::has_several_names(&found) {
        return in_place::overwrite(&target, old, new);
    }
    if fs::read(&target)? != old {
        return Err(io::Error::other(HAS_CHANGED));
    }
    let mut pending = PendingFile::create_in(target.parent().unwrap_or(&target))?;
    pending.write_all(new)?;
    pending.flush()?;
    pending.take_after(&found)?;
    pending.save_as(&target)
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
