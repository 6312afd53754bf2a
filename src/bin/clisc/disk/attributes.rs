//! Extended attributes of files: tags, access lists and their like.

use std::fs::File;
use std::path::Path;

/// Gives `file` the extended attributes of the file at `from`, as far as the system allows: few may set them all, and not
/// every file system has them.
#[cfg(target_os = "linux")]
pub fn copy(from: &Path, file: &File) {
    use rustix::fs::{XattrFlags, fsetxattr, getxattr, getxattr_query, listxattr, listxattr_query};

    let Ok(n_bytes @ 1..) = listxattr_query(from) else { return };
    let mut names = vec![0; n_bytes];
    let Ok(n_bytes) = listxattr(from, &mut names[..]) else { return };
    for name in names[..n_bytes].split(|byte| *byte == 0).filter(|name| !name.is_empty()) {
        let Ok(n_bytes) = getxattr_query(from, name) else { continue };
        let mut value = vec![0; n_bytes];
        let Ok(n_bytes) = getxattr(from, name, &mut value[..]) else { continue };
        let _ = fsetxattr(file, name, &value[..n_bytes], XattrFlags::empty());
    }
}

/// Copies nothing: elsewhere than on Linux attributes are not known.
#[cfg(not(target_os = "linux"))]
pub fn copy(_: &Path, _: &File) {}
