//! What may be typed.

use super::quantity;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{ArgAction, Parser, Subcommand, value_parser};
use lwc::descriptors::{Descriptor, Window};
use lwc::{EncodeOptions, Partition};
use std::path::PathBuf;

/// Progressive codec for triangle meshes: one small file that can be cut anywhere.
#[derive(Debug, Parser)]
#[command(name = "lwc", version, after_help = super::exit::HELP)]
#[command(disable_help_subcommand = true)]
pub struct Args {
    #[command(flatten)]
    pub global: Global,
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "General options")]
pub struct Global {
    /// Threads to use, 0 to 1024; 0 is one per core.
    #[arg(long, global = true, value_name = "N", default_value_t = 0)]
    #[arg(value_parser = value_parser!(u32).range(0..=1024))]
    pub threads: u32,
    /// No summary, no warnings, no progress bars: only errors, and what was asked for.
    #[arg(long, global = true)]
    pub quiet: bool,
    /// Tells more on standard error.
    #[arg(short, long, global = true, action = ArgAction::Count, conflicts_with = "quiet")]
    pub verbose: u8,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    Encode(Encode),
}

/// Encode a mesh file (.obj .ply .stl, each also as .zst).
///
/// The finest level is the mesh on a grid of 2^BITS cells along its longest side; every oriented
/// triangle comes back exactly. What has to be dropped or cut is counted in warnings.
#[derive(Debug, clap::Args)]
pub struct Encode {
    /// Mesh to encode.
    #[arg(value_name = "MODEL")]
    pub input: PathBuf,
    /// Stream to write, `-` for standard output. Default: MODEL with the ending .lwc, beside MODEL.
    ///
    /// A file that exists is replaced once the new one is complete.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub scale: Scale,
    /// Bits per coordinate, 1 to 30.
    #[arg(short, long, value_name = "BITS", allow_negative_numbers = true)]
    #[arg(default_value_t = EncodeOptions::default().quantization)]
    #[arg(value_parser = value_parser!(u32).range(1..=30))]
    pub quantization: u32,
    /// Levels above the base mesh, 0 to 128, or `auto`: until the base mesh is small.
    #[arg(long, value_name = "N", default_value = "auto", allow_negative_numbers = true)]
    #[arg(value_parser = levels)]
    pub levels: Levels,
    /// Factor of the radius from each level to the next coarser one, 1 to 16.
    #[arg(long, value_name = "FACTOR", default_value_t = EncodeOptions::default().growth)]
    #[arg(allow_negative_numbers = true, value_parser = quantity::number(1.0, 16.0))]
    pub growth: f64,
    /// How the vertices that a level removes are chosen.
    ///
    /// - balanced: the descriptor says which vertices stay, the cost of coding which others go
    /// - algorithm1: the paper's Algorithm 1 to the letter
    #[arg(long, value_name = "NAME", verbatim_doc_comment)]
    #[arg(default_value = EncodeOptions::default().partition.name(), value_parser = partition_parser())]
    pub partition: Partition,
    /// Grid steps to the mean edge of a level, 0.5 to 1e9: fewer favour short prefixes.
    #[arg(long, value_name = "STEPS", default_value_t = EncodeOptions::default().steps_per_edge)]
    #[arg(allow_negative_numbers = true, value_parser = quantity::number(0.5, 1e9))]
    pub steps_per_edge: f64,
    /// Decode the stream and compare it with the mesh before it is written.
    #[arg(long)]
    pub verify: bool,
    /// Print one JSON object in place of the summary (to standard error with `-o -`).
    #[arg(long)]
    pub json: bool,
}

/// Descriptor and window.
#[derive(Debug, clap::Args)]
pub struct Scale {
    /// Measure of saliency.
    #[arg(short, long, value_name = "NAME", default_value_t = Descriptor::default())]
    #[arg(value_parser = descriptor_parser())]
    pub descriptor: Descriptor,
    /// Topological radius of the descriptor's window, in edges, 1 to 64.
    #[arg(long, value_name = "N", default_value_t = Window::default().rings, allow_negative_numbers = true)]
    #[arg(value_parser = value_parser!(u32).range(1..=64))]
    pub rings: u32,
    /// Euclidean radius of the window, in mean edges of the mesh, above 0, at most 1e6.
    #[arg(long, value_name = "R", default_value_t = Window::default().radius)]
    #[arg(allow_negative_numbers = true, value_parser = quantity::number(f64::MIN_POSITIVE, 1e6))]
    pub radius: f64,
}

impl Scale {
    pub fn window(&self) -> Window {
        Window { rings: self.rings, radius: self.radius }
    }
}

/// Number of levels, `None` for `auto`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Levels(pub Option<u32>);

fn levels(text: &str) -> Result<Levels, String> {
    match text.parse() {
        _ if text == "auto" => Ok(Levels(None)),
        Ok(n @ 0..=128) => Ok(Levels(Some(n))),
        _ => Err("it is neither `auto` nor a whole number from 0 to 128".into()),
    }
}

fn descriptor_parser() -> impl TypedValueParser<Value = Descriptor> {
    PossibleValuesParser::new(Descriptor::ALL.map(Descriptor::name))
        .try_map(|name| name.parse::<Descriptor>())
}

fn partition_parser() -> impl TypedValueParser<Value = Partition> {
    PossibleValuesParser::new(Partition::ALL.map(Partition::name))
        .try_map(|name| Partition::ALL.into_iter().find(|p| p.name() == name).ok_or("unknown partition"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn options_do_not_clash() {
        Args::command().debug_assert();
    }

    #[test]
    fn defaults_are_those_of_the_library() {
        let args = Args::try_parse_from(["lwc", "encode", "x.ply"]).unwrap();
        let Command::Encode(encode) = args.command;
        assert_eq!(encode.options(), EncodeOptions::default());
    }
}
