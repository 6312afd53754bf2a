//! Arguments of `clisc run`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::StdinArgs;
use super::backend::BackendArgs;
use super::image::ImageArgs;
use super::number::whole;

/// Arguments of `clisc run`.
#[derive(Args, Debug)]
#[command(after_help = RUN_EXAMPLES)]
pub struct RunArgs {
    /// Scenes; a folder means every .cli file below it, - is standard input.
    #[arg(value_name = "PATH", required = true)]
    pub scenes: Vec<PathBuf>,
    /// What standard input is called.
    #[command(flatten)]
    pub stdin: StdinArgs,
    /// The folder below which images are saved, made when missing; {scene} in it stands for the name of the scene without
    /// its ending, {folder} for the folder of the scene, as given. A name that ends in .png is the file of the only image,
    /// and - prints it.
    #[arg(short, long, value_name = "DIR", default_value = ".")]
    pub out_dir: PathBuf,
    /// What the images are.
    #[command(flatten)]
    pub image: ImageArgs,
    /// What traces them.
    #[command(flatten)]
    pub backend: BackendArgs,
    /// Threads to render with, at most 1024; 0 means one a core.
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true, value_parser = whole::<u16>(0..=MAX_THREADS))]
    pub threads: u16,
    /// Print times and counts; --stats=json prints one JSON document in place of the other results.
    #[arg(long, value_enum, value_name = "FORMAT", num_args = 0..=1, require_equals = true, default_missing_value = "table")]
    pub stats: Option<StatsFormat>,
    /// Say in a JSON file what stands behind the pixels of the images saved: how each was proved, and where ties are. Takes
    /// as long as that takes. For --precision certified and exact; saved whole or not at all.
    #[arg(long, value_name = "FILE")]
    pub certificate: Option<PathBuf>,
    /// End with exit code 1 if any pixel of any image is not proved: because its proof takes too long, because a tie stays
    /// open, or because f32 or f64 was asked for. The images are saved all the same. For CI.
    #[arg(long, conflicts_with = "dry_run")]
    pub require_proof: bool,
    /// Print nothing but errors, what is not proved, and the --stats asked for.
    #[arg(short, long)]
    pub quiet: bool,
    /// Check everything, render and save nothing.
    #[arg(long)]
    pub dry_run: bool,
}

/// The most threads to render with: more only cost, and a hundred thousand would not even start.
pub(super) const MAX_THREADS: u32 = 1024;

const RUN_EXAMPLES: &str = "\
Examples:
  clisc run i1.cli                               300x300, saved in this folder
  clisc run scenes -o out --size 1920x1080       every scene below a folder
  clisc run scenes -o 'out/{folder}/{scene}'     each into a folder of its own
  clisc run i1.cli -o first.png                  the only image of the scene, called so
  clisc run i1.cli -o - | display                and as standard output
  clisc run i1.cli --samples 4 --sample-at centre
  clisc run i1.cli --stats=json --quiet          times and counts for other programs
  clisc run i1.cli --no-skip=shadows,tiles       the same image without two of the shortcuts
  clisc run i1.cli --backend scalar              the same image without special instructions of the machine
  clisc run i1.cli --certificate proof.json      and what stands behind its pixels
  clisc run i1.cli --require-proof --quiet       exit code 1 unless every pixel is proved
  clisc run - < i1.cli                           the scene from standard input

A scene can write only below the folder of --out-dir. An image is saved whole or not at all.";

/// How `clisc run` shows times and counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum StatsFormat {
    /// A table for people.
    Table,
    /// One JSON document.
    Json,
}
