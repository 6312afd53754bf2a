//! Laws of the encoder, on images of every kind.

use proptest::prelude::*;

use crate::image::png::bands::{EncodedBand, PngBands};
use crate::image::png::writer::PngWriter;
use crate::image::{RgbImage, decode_png, encode_png};

/// What the pixels of a test image are like.
#[derive(Clone, Copy, Debug)]
enum Kind {
    Uniform,
    /// Slow changes, as shading has them.
    Gradient,
    /// Stretches of one colour, each of any length.
    Runs,
    /// Single pixels on a ground.
    Specks,
    Noise,
}

fn random(state: &mut u64) -> u8 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 56) as u8
}

/// Makes an image of a kind.
fn image(kind: Kind, width: u32, height: u32, seed: u64) -> RgbImage {
    let mut state = seed;
    let mut color = [0; 3].map(|_: u8| random(&mut state));
    let ground = color;
    let mut image = RgbImage::new(width, height);
    for (idx, pixel) in (0..).zip(image.rgb_mut().chunks_exact_mut(3)) {
        let (x, y) = (idx % width, idx / width);
        let luck = random(&mut state);
        match kind {
            Kind::Uniform => {}
            Kind::Gradient => color = [x + y / 3, (x * x + y * y) >> 7, (x * y) >> 9].map(|value| value as u8),
            Kind::Runs if luck < 3 => color = color.map(|_| random(&mut state)),
            Kind::Runs => {}
            Kind::Specks => color = if luck < 2 { ground.map(|_| random(&mut state)) } else { ground },
            Kind::Noise => color = color.map(|_| random(&mut state)),
        }
        pixel.copy_from_slice(&color);
    }
    image
}

fn any_image() -> impl Strategy<Value = RgbImage> {
    let kind =
        prop_oneof![Just(Kind::Uniform), Just(Kind::Gradient), Just(Kind::Runs), Just(Kind::Specks), Just(Kind::Noise)];
    let size =
        prop_oneof![(1..=90u32, 1..=90u32), (1..=3000u32, Just(1)), (Just(1), 1..=3000u32), (1..=2000u32, 1..=4u32)];
    (kind, size, any::<u64>()).prop_map(|(kind, (width, height), seed)| image(kind, width, height, seed))
}

/// Encodes an image in the bands given, those of one colour without their pixels if asked.
fn encoded(image: &RgbImage, bands: &PngBands, knows_uniform: bool) -> Vec<u8> {
    let mut file = PngWriter::new(Vec::new(), bands).unwrap();
    let mut band = EncodedBand::default();
    for band_idx in 0..bands.n_bands() {
        let rows = bands.rows(band_idx);
        let start = bands.rgb_bytes(&(0..rows.start));
        let rgb = &image.rgb()[start..][..bands.rgb_bytes(&rows)];
        let color = [rgb[0], rgb[1], rgb[2]];
        if knows_uniform && rgb.chunks_exact(3).all(|pixel| pixel == color) {
            bands.encode_uniform(band_idx, color, &mut band);
        } else {
            bands.encode(band_idx, rgb, &mut band);
        }
        file.write_band(&band).unwrap();
    }
    file.finish().unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn bands_of_every_height_give_the_same_pixels(image in any_image(), rows_per_band in 1..=100u32) {
        let (width, height) = (image.width(), image.height());
        let bands = PngBands { width, height, rows_per_band: rows_per_band.min(height) };
        let file = encoded(&image, &bands, false);
        prop_assert!(decode_png(&file).unwrap() == image);
        prop_assert!(file == encoded(&image, &bands, true), "without the pixels of bands of one colour");
    }

    #[test]
    fn no_image_takes_much_more_than_its_pixels(image in any_image()) {
        let n_bytes = encode_png(&image).unwrap().len();
        let bands = PngBands::new(image.width(), image.height()).unwrap();
        let frame = 70 + 70 * bands.n_bands() as usize;
        prop_assert!(n_bytes <= image.rgb().len() + image.height() as usize + frame, "{n_bytes}");
    }
}

#[test]
fn runs_of_every_length_come_back() {
    // One pixel that differs at every distance up to some matches, also across the ends of blocks and rows.
    for width in [1, 21, 22, 23, 43, 400] {
        let mut image = RgbImage::new(width, 700);
        let mut at = 0;
        for length in 1.. {
            at += length;
            let Some(byte) = image.rgb_mut().get_mut(at) else { break };
            *byte = 1 + (length % 255) as u8;
        }
        assert!(decode_png(&encode_png(&image).unwrap()).unwrap() == image, "{width} columns");
    }
}

#[test]
fn a_long_band_of_one_color_comes_back() {
    let bands = PngBands::new(20_000, 40).unwrap();
    let mut file = PngWriter::new(Vec::new(), &bands).unwrap();
    let mut band = EncodedBand::default();
    for band_idx in 0..bands.n_bands() {
        bands.encode_uniform(band_idx, [255, 0, 7], &mut band);
        file.write_band(&band).unwrap();
    }
    let file = file.finish().unwrap();
    let image = decode_png(&file).unwrap();
    assert!(image.rgb().chunks_exact(3).all(|pixel| pixel == [255, 0, 7]));
    assert!(file.len() < 3000, "2 bits for 258 bytes: {}", file.len());
}

#[test]
fn bands_tile_the_image_and_are_neither_small_nor_large() {
    for (width, height, rows) in [
        (1, 65535, 2736),
        (1, 5, 5),
        (100, 300, 32),
        (300, 300, 16),
        (4000, 4000, 16),
        (21845, 100, 16),
        (21846, 100, 8),
        (65535, 65535, 8),
    ] {
        let bands = PngBands::new(width, height).unwrap();
        assert_eq!(bands.rows_per_band(), rows, "{width}x{height}");
        let mut end = 0;
        for band_idx in 0..bands.n_bands() {
            let rows = bands.rows(band_idx);
            assert_eq!(rows.start, end);
            assert!(!rows.is_empty());
            end = rows.end;
        }
        assert_eq!(end, height);
    }
}
