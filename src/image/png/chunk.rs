//! The chunks of a PNG file.

/// What a PNG file begins with.
pub(super) const SIGNATURE: [u8; 8] = [0x89, b'P', b'N', b'G', b'\r', b'\n', 0x1A, b'\n'];

/// Appends a chunk to `out`: its length, its name, what `fill` appends, and the checksum of name and data.
///
/// # Panics
/// When the data has 2^31 bytes or more.
pub(super) fn push_chunk<T>(out: &mut Vec<u8>, name: [u8; 4], fill: impl FnOnce(&mut Vec<u8>) -> T) -> T {
    let start = out.len();
    out.extend([0; 4]);
    out.extend(name);
    let filled = fill(out);
    let n_bytes = i32::try_from(out.len() - start - 8).expect("chunks are short");
    out[start..start + 4].copy_from_slice(&n_bytes.to_be_bytes());
    let sum = crc32fast::hash(&out[start + 4..]);
    out.extend(sum.to_be_bytes());
    filled
}
