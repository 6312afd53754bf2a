//! Addresses of documents, and the paths of those that are files.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use lsp_types::Uri;

/// Returns the name of the file of a document, for messages.
pub fn file_name(uri: &Uri) -> String {
    String::from_utf8_lossy(&decoded(uri.as_str().rsplit('/').next().unwrap_or_default())).into_owned()
}

/// Returns the path of a document that is a file.
pub fn path(uri: &Uri) -> Option<PathBuf> {
    path_of(uri.as_str(), cfg!(windows)).map(PathBuf::from)
}

/// Does the work of [`path`]. A file is `file:///path`, `file:/path` or `file://host/path`.
fn path_of(uri: &str, is_windows: bool) -> Option<OsString> {
    let (scheme, rest) = uri.split_once(':')?;
    if !scheme.eq_ignore_ascii_case("file") {
        return None;
    }
    let (host, path) = match rest.strip_prefix("//") {
        Some(rest) => rest.split_at(rest.find('/')?),
        None => ("", rest),
    };
    let path = decoded(path);
    if !path.starts_with(b"/") {
        return None;
    }
    if !is_windows {
        return os_string(path);
    }
    let has_drive = path.get(1).is_some_and(u8::is_ascii_alphabetic) && path.get(2) == Some(&b':');
    match host {
        _ if has_drive => os_string(path[1..].to_owned()),
        "" | "localhost" => os_string(path),
        host => os_string([format!("//{host}").as_bytes(), &path].concat()),
    }
}

#[cfg(unix)]
fn os_string(bytes: Vec<u8>) -> Option<OsString> {
    Some(std::os::unix::ffi::OsStringExt::from_vec(bytes))
}

#[cfg(not(unix))]
fn os_string(bytes: Vec<u8>) -> Option<OsString> {
    String::from_utf8(bytes).ok().map(OsString::from)
}

/// Returns the address of a file; none of a path that no address can name.
pub fn uri(path: &Path) -> Option<Uri> {
    uri_of(path.as_os_str().as_encoded_bytes(), cfg!(windows)).parse().ok()
}

/// Does the work of [`uri`].
fn uri_of(path: &[u8], is_windows: bool) -> String {
    let path = if is_windows { path.strip_prefix(br"\\?\").unwrap_or(path) } else { path };
    let mut uri = String::from(if path.starts_with(b"/") { "file://" } else { "file:///" });
    for &byte in path {
        match byte {
            b'\\' if is_windows => uri.push('/'),
            b'/' | b'-' | b'.' | b'_' | b'~' | b'0'..=b'9' | b'A'..=b'Z' | b'a'..=b'z' => uri.push(byte.into()),
            _ => uri.push_str(&format!("%{byte:02X}")),
        }
    }
    uri
}

/// Returns the bytes that a part of an address stands for.
fn decoded(part: &str) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(part.len());
    let mut rest = part.as_bytes();
    while let Some((&byte, behind)) = rest.split_first() {
        let code = behind.first_chunk::<2>().filter(|code| byte == b'%' && code.iter().all(u8::is_ascii_hexdigit));
        match code.and_then(|code| u8::from_str_radix(str::from_utf8(code).ok()?, 16).ok()) {
            Some(decoded) => {
                bytes.push(decoded);
                rest = &behind[2..];
            }
            None => {
                bytes.push(byte);
                rest = behind;
            }
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_have_paths() {
        let path = |uri| path_of(uri, false).map(|path| path.into_string().expect("text"));
        for uri in
            ["file:///a%20b/%C3%A4.cli", "file:/a%20b/%c3%a4.cli", "file://localhost/a%20b/ä.cli", "FILE:///a b/ä.cli"]
        {
            assert_eq!(path(uri).as_deref(), Some("/a b/ä.cli"), "{uri}");
        }
        assert_eq!(path("file:///100%/%+1%zz").as_deref(), Some("/100%/%+1%zz"), "what is no code stands for itself");
        assert_eq!(path("file:///c%3A/a.cli").as_deref(), Some("/c:/a.cli"));
        for uri in ["untitled:Untitled-1", "file:a.cli", "file:", "file://host", "git:/a.cli", "a.cli"] {
            assert_eq!(path(uri), None, "{uri}");
        }
    }

    #[test]
    fn drives_and_shares_have_paths() {
        let path = |uri| path_of(uri, true).map(|path| path.into_string().expect("text"));
        for uri in ["file:///c:/a/b.cli", "file:///c%3A/a/b.cli", "file:/c:/a/b.cli", "file://localhost/c:/a/b.cli"] {
            assert_eq!(path(uri).as_deref(), Some("c:/a/b.cli"), "{uri}");
        }
        assert_eq!(path("file://server/share/b.cli").as_deref(), Some("//server/share/b.cli"));
    }

    #[test]
    fn paths_have_addresses() {
        assert_eq!(uri_of("/a b/ä#?.cli".as_bytes(), false), "file:///a%20b/%C3%A4%23%3F.cli");
        assert_eq!(uri_of(br"C:\a b\c.cli", true), "file:///C%3A/a%20b/c.cli");
        assert_eq!(uri_of(br"\\?\C:\c.cli", true), "file:///C%3A/c.cli");
        let path = Path::new("/a b/ä%41.cli");
        assert_eq!(super::path(&uri(path).expect("an address")).as_deref(), Some(path));
    }
}
