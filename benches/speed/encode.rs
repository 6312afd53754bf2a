//! From pixels to a PNG file.

use clisc::image::{RgbImage, decode_png, encode_png};
use clisc::testing::Stream;
use divan::counter::BytesCount;
use divan::{Bencher, black_box};

use crate::input;

/// Pixels along a side.
const SIDE: u32 = 1000;

/// How many bytes of pixels are encoded in a second: of a render, of one colour, of noise?
#[divan::bench(args = ["render", "flat", "noise"])]
fn png(bencher: Bencher<'_, '_>, kind: &str) {
    let image = match kind {
        "render" => input::pixels("still-life", SIDE),
        "flat" => RgbImage::new(SIDE, SIDE),
        _ => noise(),
    };
    let encoded = encode_png(&image).expect("written to memory");
    assert!(decode_png(&encoded).expect("a PNG file") == image);
    bencher.counter(BytesCount::of_slice(image.rgb())).bench_local(|| encode_png(black_box(&image)));
}

fn noise() -> RgbImage {
    let mut stream = Stream::new(7);
    let rgb = (0..SIDE * SIDE * 3).map(|_| stream.bits() as u8).collect();
    RgbImage::from_rgb(SIDE, SIDE, rgb).expect("three bytes a pixel")
}
