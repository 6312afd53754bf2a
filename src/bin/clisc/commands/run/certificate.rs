//! `clisc run --certificate`: what stands behind the pixels of each image.
//!
//! The shape of the document is `docs/schemas/certificate-v1.schema.json`.

use std::collections::BTreeMap;
use std::path::Path;

use clisc::exact::TiePlace;
use clisc::exec::{Proof, WriteReport};
use clisc::plan::{Part, SampleAt, Settings};
use clisc::trace;
use serde::Serialize;

use crate::disk::Place;
use crate::input;

/// The version of the document: a field may be added, none changes its meaning without a new version.
const VERSION: u32 = 1;

/// The whole document.
#[derive(Debug, Serialize)]
pub struct Certificate {
    version: u32,
    producer: &'static str,
    settings: RenderSettings,
    images: Vec<ImageCertificate>,
}

/// What was asked for, the same for all images.
#[derive(Debug, Serialize)]
struct RenderSettings {
    precision: &'static str,
    part: &'static str,
    samples: u32,
    sample_at: &'static str,
    max_level: u32,
}

/// One image.
#[derive(Debug, Serialize)]
struct ImageCertificate {
    scene: String,
    write: String,
    path: String,
    width: u32,
    height: u32,
    bytes: u64,
    /// CRC-32 of the file, eight hexadecimal digits.
    crc32: String,
    /// Whether every pixel is proved: no tie is open, and none is beyond the limit of exact work.
    proved: bool,
    unproved: UnprovedPixels,
    pixels: PixelCounts,
    /// In levels.
    largest_bound: f64,
    ties: TieList,
}

/// How the pixels were settled; the numbers add up to the image.
#[derive(Debug, Serialize)]
struct PixelCounts {
    binary64: u64,
    double_double: u64,
    long: u64,
    exact: Vec<ExactPixels>,
    shared: u64,
    beyond_limit: u64,
}

/// The pixels that are not proved.
#[derive(Debug, Serialize)]
struct UnprovedPixels {
    pixels: u64,
    /// The first of them that are beyond the limit, row by row; those with open ties stand among the ties.
    beyond_limit: Vec<PixelPlace>,
}

#[derive(Debug, Serialize)]
struct PixelPlace {
    column: u32,
    row: u32,
}

/// The pixels that one precision settled.
#[derive(Debug, Serialize)]
struct ExactPixels {
    bits: usize,
    pixels: u64,
}

/// The pixels in which numbers are equal, or could not be told apart.
#[derive(Debug, Serialize)]
struct TieList {
    pixels: u64,
    open_pixels: u64,
    decisions: u64,
    /// The first of them, row by row.
    listed: Vec<Tie>,
}

/// A pixel with ties.
#[derive(Debug, Serialize)]
struct Tie {
    column: u32,
    row: u32,
    /// How often each kind was met that no precision decided.
    open: BTreeMap<&'static str, u32>,
    /// The same for those that are proved.
    proved: BTreeMap<&'static str, u32>,
}

impl Certificate {
    /// Makes the certificate of no images yet.
    pub fn new(settings: &Settings) -> Self {
        let settings = RenderSettings {
            precision: settings.precision.name(),
            part: match settings.part {
                Part::A => "a",
                Part::B => "b",
            },
            samples: settings.samples,
            sample_at: match settings.sample_at {
                SampleAt::Corner => "corner",
                SampleAt::Centre => "centre",
            },
            max_level: settings.max_level,
        };
        let producer = concat!("clisc ", env!("CARGO_PKG_VERSION"));
        Self { version: VERSION, producer, settings, images: Vec::new() }
    }

    /// Adds the images of a scene that were saved and have a proof.
    pub fn add_writes(&mut self, scene: &Path, place: &Place, reports: &[WriteReport]) {
        for report in reports {
            if let (Some(proof), Some(crc32)) = (&report.proof, report.crc32) {
                self.images.push(ImageCertificate {
                    scene: input::name_of(scene),
                    write: report.name.clone(),
                    path: place.shown(&report.name).display().to_string(),
                    width: report.size.width(),
                    height: report.size.height(),
                    bytes: report.n_bytes,
                    crc32: format!("{crc32:08x}"),
                    proved: proof.is_complete(),
                    unproved: UnprovedPixels {
                        pixels: report.n_unproved(),
                        beyond_limit: report.unproved.listed.iter().map(pixel_place).collect(),
                    },
                    pixels: pixel_counts(proof),
                    largest_bound: proof.largest_bound,
                    ties: TieList {
                        pixels: proof.exact.n_tied_pixels,
                        open_pixels: proof.exact.n_open_pixels,
                        decisions: proof.exact.n_ties,
                        listed: proof.exact.ties.iter().map(tie).collect(),
                    },
                });
            }
        }
    }

    /// Returns the document.
    pub fn json(&self) -> anyhow::Result<String> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }
}

fn pixel_counts(proof: &Proof) -> PixelCounts {
    PixelCounts {
        binary64: proof.n_binary64,
        double_double: proof.n_double_double,
        long: proof.n_long,
        exact: proof.exact.n_pixels.iter().map(|(&bits, &pixels)| ExactPixels { bits, pixels }).collect(),
        shared: proof.n_shared,
        beyond_limit: proof.n_beyond_limit,
    }
}

fn pixel_place(&trace::Place { column, row }: &trace::Place) -> PixelPlace {
    PixelPlace { column, row }
}

fn tie(place: &TiePlace) -> Tie {
    let [open, proved] = [place.open, place.proved].map(|ties| ties.met().map(|(tie, n)| (tie.name(), n)).collect());
    Tie { column: place.column, row: place.row, open, proved }
}
