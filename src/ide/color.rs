//! Colours: where they stand, how they are written, what they are called.

use crate::ide::{Document, MAX_ANSWERS};
use crate::source::Span;
use crate::syntax::argument_spans;

/// A colour in a scene: three numbers, red, green and blue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorPlace {
    /// From the first to the last number.
    pub span: Span,
    /// As the scene has it, also outside 0…1.
    pub rgb: [f64; 3],
}

/// Returns the colours of the whole commands of a scene, in order; none in a scene of another edition.
#[must_use]
pub fn colors(document: &Document) -> Vec<ColorPlace> {
    let mut places = Vec::new();
    if document.is_of_other_edition() {
        return places;
    }
    for command in document.file().commands() {
        let Some(kind) = super::document::kind_of(&command).filter(|_| !command.numbers.is_empty()) else { continue };
        let mut groups = kind.spec().grouped().filter(|(_, group)| group.is_color).peekable();
        if groups.peek().is_none() {
            continue;
        }
        let spans = argument_spans(document.source(), command.span);
        places.extend(groups.map(|(numbers, _)| ColorPlace {
            span: spans[numbers.start].to(spans[numbers.end - 1]),
            rgb: std::array::from_fn(|channel| command.numbers[numbers.start + channel]),
        }));
        if places.len() >= MAX_ANSWERS {
            break;
        }
    }
    places
}

/// Writes a colour as three numbers: as short as a colour picker of 8 bits a channel allows, within a thousandth.
#[must_use]
pub fn color_text(rgb: [f64; 3]) -> String {
    rgb.map(channel_text).join(" ")
}

fn channel_text(value: f64) -> String {
    let thousandths = (value.clamp(0.0, 1.0) * 1000.0).round() / 1000.0;
    let byte = |value: f64| (value * 255.0).round();
    let coarse = (thousandths * 100.0).round() / 100.0;
    // A picker cannot tell these two apart; the shorter one is what a person writes.
    let shown = if byte(coarse) == byte(value) { coarse } else { thousandths };
    shown.to_string()
}

/// Returns a colour in words, such as "dark red" or "pale blue".
#[must_use]
pub fn color_words(rgb: [f64; 3]) -> String {
    let clamped = rgb.map(|channel| channel.clamp(0.0, 1.0));
    let (most, least) = (clamped.into_iter().fold(0.0, f64::max), clamped.into_iter().fold(1.0, f64::min));
    let (chroma, lightness) = (most - least, (most + least) / 2.0);
    if chroma < 0.08 {
        return grey(lightness).to_owned();
    }
    let tone = match lightness {
        _ if most < 0.2 => "very dark ",
        _ if most < 0.5 => "dark ",
        light if light > 0.78 => "pale ",
        _ if chroma / most < 0.3 => "greyish ",
        light if light > 0.65 => "light ",
        _ => "",
    };
    format!("{tone}{}", hue_name(hue(clamped, most, chroma)))
}

fn grey(lightness: f64) -> &'static str {
    match lightness {
        light if light < 0.03 => "black",
        light if light < 0.3 => "dark grey",
        light if light < 0.65 => "grey",
        light if light < 0.93 => "light grey",
        _ => "white",
    }
}

/// Returns the hue in degrees: red is 0, green 120, blue 240.
fn hue([r, g, b]: [f64; 3], most: f64, chroma: f64) -> f64 {
    let sixth = if most == r {
        ((g - b) / chroma).rem_euclid(6.0)
    } else if most == g {
        (b - r) / chroma + 2.0
    } else {
        (r - g) / chroma + 4.0
    };
    60.0 * sixth
}

fn hue_name(degrees: f64) -> &'static str {
    const NAMES: [(f64, &str); 13] = [
        (15.0, "red"),
        (42.0, "orange"),
        (66.0, "yellow"),
        (85.0, "yellow-green"),
        (150.0, "green"),
        (170.0, "sea green"),
        (195.0, "cyan"),
        (215.0, "sky blue"),
        (255.0, "blue"),
        (285.0, "violet"),
        (320.0, "magenta"),
        (345.0, "pink"),
        (360.1, "red"),
    ];
    NAMES.iter().find(|(end, _)| degrees < *end).map_or("red", |(_, name)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_have_names() {
        for (rgb, words) in [
            ([0.0, 0.0, 0.0], "black"),
            ([1.0, 1.0, 1.0], "white"),
            ([0.5, 0.5, 0.52], "grey"),
            ([0.8, 0.2, 0.2], "red"),
            ([0.4, 0.1, 0.1], "dark red"),
            ([0.1, 0.02, 0.02], "very dark red"),
            ([0.2, 0.3, 0.8], "blue"),
            ([0.9, 0.9, 0.7], "pale yellow"),
            ([9.0, 0.0, 0.0], "red"),
            ([0.0, 0.9, 0.9], "cyan"),
        ] {
            assert_eq!(color_words(rgb), words, "{rgb:?}");
        }
    }

    #[test]
    fn colours_are_short() {
        assert_eq!(color_text([1.0, 0.0, 0.2]), "1 0 0.2");
        assert_eq!(color_text([51.0 / 255.0, 128.0 / 255.0, 1.0 / 255.0]), "0.2 0.5 0.004");
        for byte in 0..=255 {
            let text = color_text([f64::from(byte) / 255.0; 3]);
            let value: f64 = text.split(' ').next().unwrap().parse().unwrap();
            assert_eq!((value * 255.0).round(), f64::from(byte), "{text}");
        }
    }
}
