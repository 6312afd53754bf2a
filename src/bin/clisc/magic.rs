//! What files that are no scenes begin with.

/// The first bytes of files that people pass for scenes by mistake, and what such a file is.
const BEGINNINGS: &[(&[u8], &str)] = &[
    (b"\x89PNG\r\n\x1A\n", "a PNG image"),
    (b"\xFF\xD8\xFF", "a JPEG image"),
    (b"GIF87a", "a GIF image"),
    (b"GIF89a", "a GIF image"),
    (b"II*\0", "a TIFF image"),
    (b"MM\0*", "a TIFF image"),
    (b"P6\n", "a PPM image"),
    (b"P3\n", "a PPM image"),
    (b"PK\x03\x04", "a ZIP archive"),
    (b"PK\x05\x06", "a ZIP archive"),
    (b"7z\xBC\xAF\x27\x1C", "a 7z archive"),
    (b"\x1F\x8B\x08", "compressed with gzip"),
    (b"\xFD7zXZ\0", "compressed with xz"),
    (b"\x28\xB5\x2F\xFD", "compressed with zstd"),
    (b"%PDF-", "a PDF document"),
    (b"\x7FELF", "a program"),
    (b"\xCF\xFA\xED\xFE", "a program"),
    (b"\xCA\xFE\xBA\xBE", "a program"),
];

/// Returns what the bytes of a file are, as far as they are known to be something else than text.
pub fn kind_of(bytes: &[u8]) -> Option<&'static str> {
    let known = BEGINNINGS.iter().find(|(beginning, _)| bytes.starts_with(beginning));
    known.map(|(_, kind)| *kind).or(match bytes {
        // Two letters are too few to tell, but these are followed by what no text holds.
        [b'B', b'M', _, _, _, _, 0, 0, 0, 0, ..] => Some("a BMP image"),
        [b'M', b'Z', _, 0, ..] => Some("a program"),
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => Some("a WebP image"),
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_no_such_file() {
        for text in [
            &b""[..],
            b"fov 60\n",
            b"MZ\n",
            b"BM 1\n",
            b"BZh is no command\n",
            b"P\n",
            b"\xEF\xBB\xBFfov 60\n",
            b"f\0o\0",
        ] {
            assert_eq!(kind_of(text), None, "{text:?}");
        }
        for (bytes, kind) in [
            (&b"\x89PNG\r\n\x1A\n\0\0"[..], "a PNG image"),
            (b"BM\x36\x10\0\0\0\0\0\0\x36", "a BMP image"),
            (b"RIFF\x10\0\0\0WEBPVP8 ", "a WebP image"),
            (b"MZ\x90\0", "a program"),
        ] {
            assert_eq!(kind_of(bytes), Some(kind));
        }
    }
}
