//! Unified diffs, as `patch` reads them.

use std::io::{self, Write};
use std::path::Path;

use clisc::format::Piece;
use clisc::source::Source;
use similar::{ChangeTag, DiffOp, group_diff_ops};

/// How many lines around a change are shown.
const CONTEXT: usize = 3;

/// What has changed between two texts.
#[derive(Debug)]
pub struct Diff<'t> {
    old: Vec<&'t [u8]>,
    new: Vec<&'t [u8]>,
    ops: Vec<DiffOp>,
}

impl<'t> Diff<'t> {
    /// Makes the diff of a text in which `changes` have been carried out: there is nothing to search for, so that it takes
    /// no longer where everything has changed. `old` are the bytes of `source`.
    pub fn of_changes(source: &Source, changes: &[Piece<'_>], old: &'t [u8], new: &'t [u8]) -> Self {
        let (old, new) = (lines_of(old), lines_of(new));
        let mut ops = Vec::new();
        let (mut old_index, mut new_index) = (0, 0);
        for change in changes {
            let start = source.lines().line_of(change.old.start);
            push_equal(&mut ops, &mut old_index, &mut new_index, start);
            let (old_len, new_len) = (lines_of(source.slice(change.old).as_bytes()).len(), lines_of(&change.new).len());
            push_replace(&mut ops, DiffOp::Replace { old_index, old_len, new_index, new_len });
            (old_index, new_index) = (old_index + old_len, new_index + new_len);
        }
        push_equal(&mut ops, &mut old_index, &mut new_index, old.len());
        Self { old, new, ops }
    }

    /// Makes the diff of two texts that are to be compared.
    pub fn of_texts(old: &'t [u8], new: &'t [u8]) -> Self {
        let (old, new) = (lines_of(old), lines_of(new));
        let ops = similar::capture_diff_slices(similar::Algorithm::Myers, &old, &new);
        Self { old, new, ops }
    }

    /// Writes the diff of the file at `path`, as git does: `patch -p1` and `git apply` take it. Writes nothing when
    /// nothing has changed.
    pub fn write(&self, path: &Path, out: &mut dyn Write) -> io::Result<()> {
        let hunks = group_diff_ops(self.ops.clone(), CONTEXT);
        if hunks.is_empty() {
            return Ok(());
        }
        for (mark, folder) in [("---", "a/"), ("+++", "b/")] {
            write!(out, "{mark} ")?;
            out.write_all(&file_name(folder, path))?;
            out.write_all(b"\n")?;
        }
        for hunk in hunks {
            let (Some(first), Some(last)) = (hunk.first(), hunk.last()) else { continue };
            let old = Extent { start: first.old_range().start, end: last.old_range().end };
            let new = Extent { start: first.new_range().start, end: last.new_range().end };
            writeln!(out, "@@ -{old} +{new} @@")?;
            for op in &hunk {
                self.write_op(op, out)?;
            }
        }
        Ok(())
    }

    fn write_op(&self, op: &DiffOp, out: &mut dyn Write) -> io::Result<()> {
        for change in op.iter_changes(&self.old, &self.new) {
            let line: &[u8] = change.value();
            let sign = match change.tag() {
                ChangeTag::Equal => b" ",
                ChangeTag::Delete => b"-",
                ChangeTag::Insert => b"+",
            };
            out.write_all(sign)?;
            out.write_all(line)?;
            if !line.ends_with(b"\n") {
                out.write_all(b"\n\\ No newline at end of file\n")?;
            }
        }
        Ok(())
    }
}

/// Adds the lines up to line `old_end` of the old text, which have not changed.
fn push_equal(ops: &mut Vec<DiffOp>, old_index: &mut usize, new_index: &mut usize, old_end: usize) {
    let len = old_end - *old_index;
    if len > 0 {
        ops.push(DiffOp::Equal { old_index: *old_index, new_index: *new_index, len });
        (*old_index, *new_index) = (*old_index + len, *new_index + len);
    }
}

/// Adds lines that have changed; one change with those just before.
fn push_replace(ops: &mut Vec<DiffOp>, next: DiffOp) {
    match (ops.last_mut(), next) {
        (Some(DiffOp::Replace { old_len, new_len, .. }), DiffOp::Replace { old_len: n_old, new_len: n_new, .. }) => {
            *old_len += n_old;
            *new_len += n_new;
        }
        _ => ops.push(next),
    }
}

/// Returns the lines of a text, with their ends.
fn lines_of(text: &[u8]) -> Vec<&[u8]> {
    text.split_inclusive(|&byte| byte == b'\n').collect()
}

/// Returns the name of a file below a folder as git writes it in the head of a diff: in quotes, with escapes, when it has
/// bytes beyond ASCII or with a meaning, and followed by a tab when it has blanks, so that `patch` sees where it ends.
///
/// # Source
/// `core.quotePath` in git-config(1).
fn file_name(folder: &str, path: &Path) -> Vec<u8> {
    let path = path.as_os_str().as_encoded_bytes();
    let path = path.strip_prefix(b"./").or(path.strip_prefix(b"/")).unwrap_or(path);
    let is_plain = |byte: &u8| matches!(byte, b' '..=b'~') && !matches!(byte, b'"' | b'\\');
    let mut name = folder.as_bytes().to_vec();
    if path.iter().all(is_plain) {
        name.extend(path);
    } else {
        name.insert(0, b'"');
        path.iter().for_each(|&byte| push_escaped(byte, &mut name));
        name.push(b'"');
    }
    if path.contains(&b' ') {
        name.push(b'\t');
    }
    name
}

/// Appends a byte of a quoted name.
fn push_escaped(byte: u8, name: &mut Vec<u8>) {
    match byte {
        b'\n' => name.extend(b"\\n"),
        b'\t' => name.extend(b"\\t"),
        b'\r' => name.extend(b"\\r"),
        b'"' | b'\\' => name.extend([b'\\', byte]),
        b' '..=b'~' => name.push(byte),
        _ => name.extend(format!("\\{byte:03o}").bytes()),
    }
}

/// The lines of a hunk, as its head tells them.
struct Extent {
    start: usize,
    end: usize,
}

impl std::fmt::Display for Extent {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.end - self.start {
            // Nothing lies behind the line that is named.
            0 => write!(f, "{},0", self.start),
            1 => write!(f, "{}", self.start + 1),
            n => write!(f, "{},{n}", self.start + 1),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stand_as_git_writes_them() {
        for (name, expected) in [
            ("x/a.cli", "b/x/a.cli"),
            ("./a.cli", "b/a.cli"),
            ("/tmp/a.cli", "b/tmp/a.cli"),
            ("a b.cli", "b/a b.cli\t"),
            ("a\tb.cli", "\"b/a\\tb.cli\""),
            ("a\"b \\.cli", "\"b/a\\\"b \\\\.cli\"\t"),
            ("é.cli", "\"b/\\303\\251.cli\""),
        ] {
            assert_eq!(String::from_utf8(file_name("b/", Path::new(name))).expect("ASCII"), expected);
        }
    }
}
