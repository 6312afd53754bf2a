//! Arguments of `clisc bench`.

use std::path::PathBuf;

use clap::Args;
use clisc::plan::{Settings, Size};

use super::StdinArgs;
use super::backend::BackendArgs;
use super::image::{Precision, parse_size};
use super::number::whole;
use super::run::MAX_THREADS;

/// Arguments of `clisc bench`.
#[derive(Args, Debug)]
#[command(after_help = BENCH_EXAMPLES)]
pub struct BenchArgs {
    /// Scenes; - is standard input. Of each the last image is measured.
    #[arg(value_name = "SCENE", required = true)]
    pub scenes: Vec<PathBuf>,
    /// What standard input is called.
    #[command(flatten)]
    pub stdin: StdinArgs,
    /// Width and height of the image in pixels.
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "300x300", value_parser = parse_size)]
    pub size: Size,
    /// The arithmetics to measure, separated by commas; all of them, unless named.
    #[arg(long, value_enum, value_name = "MODE", value_delimiter = ',', num_args = 1.., ignore_case = true)]
    pub modes: Option<Vec<Precision>>,
    /// Samples a pixel to measure, N by N each, separated by commas; against 32 by 32, which is 1024.
    #[arg(long, value_name = "N", value_delimiter = ',', num_args = 1.., value_parser = whole::<u32>(1..=Settings::MAX_SAMPLES))]
    pub samples: Vec<u32>,
    /// What traces them.
    #[command(flatten)]
    pub backend: BackendArgs,
    /// How often each is timed, in turns; what has taken ten seconds is not timed again.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = whole::<u32>(1..=1000))]
    pub repeat: u32,
    /// Threads to render with, at most 1024; 0 means one a core.
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true, value_parser = whole::<u16>(0..=MAX_THREADS))]
    pub threads: u16,
    /// Save the measurements as one JSON document; docs/schemas has its schema.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Save a plot of time and error for each scene in this folder, made when missing.
    #[arg(long, value_name = "DIR")]
    pub svg: Option<PathBuf>,
}

const BENCH_EXAMPLES: &str = "\
Examples:
  clisc bench i1.cli                                  time and error of every arithmetic
  clisc bench i1.cli --modes f32,f64 --size 1920x1080
  clisc bench i1.cli --modes f64 --samples 1,2,4,8    what more samples a pixel cost, and gain
  clisc bench scenes/gallery/*.cli --json bench.json --svg plots

Times are from plan to pixels, without reading the scene and saving the image. Errors are counted in levels, of which a \
channel has 255: in the bytes of the image, and before they are rounded. A star marks what nothing beats in both.";
