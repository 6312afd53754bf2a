//! Lines that are nearly right: what readers of the language are tried with.

use clisc::testing::Stream;

/// Pieces of lines, right ones and wrong ones.
const PIECES: [&str; 56] = [
    "fov",
    "write",
    "sphere",
    "background",
    "light",
    "Write",
    " ",
    " ",
    " ",
    " ",
    "\t",
    "\n",
    "\r\n",
    "\r",
    "1",
    "0.5",
    "-1",
    "+",
    "-",
    ".",
    "e",
    "E5",
    "1e3",
    ".png",
    ".png",
    "a.png",
    "x",
    "\"",
    "\"",
    "#",
    "#",
    "/",
    ",",
    "inf",
    "0x1",
    "\u{FEFF}",
    "\u{A0}",
    "\u{85}",
    "\u{2028}",
    "\u{200B}",
    "\u{180E}",
    "\u{3000}",
    "\u{0}",
    "\u{1A}",
    "\u{7F}",
    "π",
    "٣",
    "−",
    "😀",
    "fov 60",
    "write a.png",
    "write \"a b.png\"",
    "sphere 1 2 3 4",
    "_",
    "..",
    "\\",
];

/// Returns fewer than `bound` pieces, one behind the other.
pub fn at_random(stream: &mut Stream, bound: usize) -> String {
    (0..stream.below(bound)).map(|_| PIECES[stream.below(PIECES.len())]).collect()
}

/// Removes a character, puts a piece into its place or before it, or swaps it with the next.
pub fn mutate(text: &mut Vec<char>, stream: &mut Stream) {
    let at = stream.below(text.len() + 1);
    let end = (at + stream.below(2)).min(text.len());
    if stream.below(4) == 0 && at + 1 < text.len() {
        text.swap(at, at + 1);
    } else {
        let piece = if stream.below(3) == 0 { "" } else { PIECES[stream.below(PIECES.len())] };
        text.splice(at..end, piece.chars());
    }
}
