//! Places and files as other programs name them.

use std::io::{self, Write};

use crate::diag::Diagnostic;
use crate::source::{LineIndex, Position, Source, Span};

/// The first and, one past it, the last character of a place.
pub(super) fn ends(source: &Source, span: Span) -> [Position; 2] {
    [span.start, span.end].map(|offset| source.lines().position(source.text(), offset))
}

/// Returns the name of a source as a reference to a file, as RFC 3986 has it: every byte that has a meaning there, or none
/// at all, is escaped.
pub(super) fn uri(name: &str) -> String {
    const KEPT: &[u8] = b"-._~/";
    let mut uri = String::with_capacity(name.len());
    if name.starts_with('/') {
        uri.push_str("file://");
    }
    for &byte in name.as_bytes() {
        match byte {
            b'\\' if cfg!(windows) => uri.push('/'),
            _ if byte.is_ascii_alphanumeric() || KEPT.contains(&byte) => uri.push(char::from(byte)),
            _ => uri.push_str(&format!("%{byte:02X}")),
        }
    }
    uri
}

/// Makes fingerprints: a number for each finding of a source that stays the same while other lines come, go and move.
///
/// It is made of the name of the source, the code and the text of the line, and of how many findings before it have the
/// same three. The number is a 64-bit FNV-1a hash, which will be the same with any later version.
#[derive(Default)]
pub(super) struct Fingerprints(std::collections::HashMap<u64, u64>);

impl Fingerprints {
    /// Returns the fingerprint of the next finding of `source`.
    pub fn next(&mut self, source: &Source, diagnostic: &Diagnostic) -> String {
        let line = line_at(source.lines(), source.text(), diagnostic.primary.span.start);
        let parts = [source.name(), diagnostic.code.id, line.trim()];
        let key = fnv(FNV_BASIS, parts.iter().flat_map(|part| part.bytes().chain([0])));
        let n_before = self.0.entry(key).or_insert(0);
        let fingerprint = fnv(key, n_before.to_le_bytes().into_iter());
        *n_before += 1;
        format!("{fingerprint:016x}")
    }
}

fn line_at<'s>(lines: &LineIndex, text: &'s str, offset: u32) -> &'s str {
    &text[lines.line_span(text, lines.line_of(offset)).range()]
}

/// Returns the fingerprint of something that has no line.
pub(super) fn fingerprint(parts: &[&str]) -> String {
    format!("{:016x}", fnv(FNV_BASIS, parts.iter().flat_map(|part| part.bytes().chain([0]))))
}

/// The state of the hash before the first byte.
const FNV_BASIS: u64 = 0xCBF2_9CE4_8422_2325;

/// Goes on with a hash from `state`.
fn fnv(state: u64, bytes: impl Iterator<Item = u8>) -> u64 {
    const PRIME: u64 = 0x0000_0100_0000_01B3;
    bytes.fold(state, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(PRIME))
}

/// Writes the items of a JSON array one by one.
#[derive(Debug, Default)]
pub(super) struct Items {
    n: usize,
}

impl Items {
    /// Writes the next item.
    pub fn write(&mut self, item: &impl serde::Serialize, out: &mut dyn Write) -> io::Result<()> {
        out.write_all(if self.n == 0 { b"\n    " } else { b",\n    " })?;
        self.n += 1;
        Ok(serde_json::to_writer(out, item)?)
    }

    /// Writes what follows the last item: `]`, on a line of its own if there was any.
    pub fn close(&self, out: &mut dyn Write) -> io::Result<()> {
        out.write_all(if self.n == 0 { b"]" } else { b"\n  ]" })
    }

    /// Returns how many there were.
    pub fn n(&self) -> usize {
        self.n
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diag::codes;

    #[test]
    fn names_become_references() {
        for (name, expected) in [
            ("scenes/a.cli", "scenes/a.cli"),
            ("a b#.cli", "a%20b%23.cli"),
            ("/tmp/ü.cli", "file:///tmp/%C3%BC.cli"),
            ("<stdin>", "%3Cstdin%3E"),
            ("c:x.cli", "c%3Ax.cli"),
        ] {
            assert_eq!(uri(name), expected);
        }
    }

    #[test]
    fn fingerprints_move_with_their_line() {
        let of = |text: &str, starts: &[u32]| -> Vec<String> {
            let source = Source::new("a.cli", text);
            let mut fingerprints = Fingerprints::default();
            let found = starts.iter().map(|&start| Diagnostic::new(&codes::NO_FOV, Span::at(start), "x"));
            found.map(|diagnostic| fingerprints.next(&source, &diagnostic)).collect()
        };
        assert_eq!(of("write a.png\n", &[0]), of("# more\n\n  write a.png\n", &[10]));
        let twice = of("write a.png\nwrite a.png\n", &[0, 12]);
        assert_ne!(twice[0], twice[1]);
        assert_eq!(twice[0], of("write a.png\n", &[0])[0]);
        // A number that other programs keep: it may not change.
        assert_eq!(of("write a.png", &[0]), ["06f3d057508872e5"]);
    }
}
