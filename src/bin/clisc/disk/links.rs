//! The place that a path means.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Component, Path, PathBuf};

/// The most links on one way; more mean a circle. Linux stops there too.
const MAX_LINKS: usize = 40;

/// Returns the absolute path that `path` means once every link on the way is followed, the last part among them.
///
/// Parts that do not exist stay as they are, unlike in `std::fs::canonicalize`: the file is still to be made.
pub fn follow_links(path: &Path) -> io::Result<PathBuf> {
    follow_links_below(Path::new(""), &std::path::absolute(path)?)
}

/// Does the work of [`follow_links`] for `path` in the folder `real`, whose own links are followed already.
pub fn follow_links_below(real: &Path, path: &Path) -> io::Result<PathBuf> {
    let mut real = real.to_owned();
    let mut ahead = path.to_owned();
    let mut n_links = 0;
    loop {
        let mut parts = ahead.components();
        let Some(part) = parts.next() else { return Ok(real) };
        let mut rest = parts.as_path().to_owned();
        match part {
            Component::Prefix(_) | Component::RootDir => real.push(part),
            Component::CurDir => {}
            Component::ParentDir => drop(real.pop()),
            Component::Normal(name) => {
                real.push(name);
                if let Some(to) = read_link(&real)? {
                    n_links += 1;
                    if n_links > MAX_LINKS {
                        return Err(io::Error::new(ErrorKind::InvalidInput, "the links on the way form a circle"));
                    }
                    real.pop();
                    rest = to.join(rest);
                }
            }
        }
        ahead = rest;
    }
}

/// Returns where a link leads; `None` when there is no link at `path`.
fn read_link(path: &Path) -> io::Result<Option<PathBuf>> {
    match fs::symlink_metadata(path) {
        Ok(found) if found.is_symlink() => fs::read_link(path).map(Some),
        Ok(_) => Ok(None),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error),
    }
}

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::fs::symlink;

    use super::*;

    #[test]
    fn links_are_followed_to_where_they_lead() {
        let dir = tempfile::tempdir().unwrap();
        let root = fs::canonicalize(dir.path()).unwrap();
        let at = |path: &str| root.join(path);
        fs::create_dir_all(at("a/b")).unwrap();
        symlink("a/b", at("relative")).unwrap();
        symlink(at("a"), at("absolute")).unwrap();
        symlink("../../missing/x", at("a/b/dangling")).unwrap();
        symlink("circle", at("circle")).unwrap();
        for (path, real) in [
            ("new/file.png", "new/file.png"),
            ("relative/file.png", "a/b/file.png"),
            ("absolute/b/./file.png", "a/b/file.png"),
            ("relative/../file.png", "a/file.png"),
            ("absolute/b/dangling", "missing/x"),
        ] {
            assert_eq!(follow_links(&at(path)).unwrap(), at(real), "{path}");
        }
        assert!(follow_links(&at("circle/file.png")).is_err());
    }
}
