//! Options that several commands have.

use super::quantity;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{ArgAction, value_parser};
use lwc::Limits;
use lwc::descriptors::{Descriptor, FeatureChoice, Window};
use lwc::io::{Format, ReadOptions};

/// What every command knows.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "General options")]
pub struct Global {
    /// Threads to use, 0 to 1024; 0 is one per core.
    #[arg(long, global = true, value_name = "N", default_value_t = 0)]
    #[arg(value_parser = value_parser!(u32).range(0..=1024))]
    pub threads: u32,
    /// Print no summary, warnings or progress bars: only errors, and what was asked for.
    #[arg(long, global = true)]
    pub quiet: bool,
    /// Print more details on standard error.
    #[arg(short, long, global = true, action = ArgAction::Count, conflicts_with = "quiet")]
    pub verbose: u8,
}

/// How mesh files are read.
#[derive(Debug, clap::Args)]
pub struct Reading {
    /// Read even .gz and .zst files that unpack to both more than 256 MiB and more than 1000 times their size.
    #[arg(long)]
    pub any_ratio: bool,
    /// Format of a mesh from standard input, `-`: obj, ply, stl, glb, gltf, las or laz, plain or compressed.
    #[arg(long, value_name = "FORMAT", value_parser = format_parser())]
    pub format: Option<Format>,
}

impl Reading {
    /// The options of the library.
    pub fn options(&self) -> ReadOptions {
        if self.any_ratio { ReadOptions::default().any_ratio() } else { ReadOptions::default() }
    }
}

/// Descriptor and window.
#[derive(Debug, clap::Args)]
pub struct Scale {
    /// Descriptor, the measure of how important (salient) each vertex is.
    #[arg(short, long, value_name = "NAME", default_value_t = Descriptor::default())]
    #[arg(value_parser = descriptor_parser())]
    pub descriptor: Descriptor,
    /// Attributes that the descriptor uses in addition to positions; for `pca` and `pca-qem` only.
    ///
    /// `color`, `texcoord`, `normal` or names of attributes, separated by commas. The whole range of an attribute counts
    /// as much as WEIGHT mean edge lengths, 0 to 1e6, by default 10.
    #[arg(long, value_name = "NAME[:WEIGHT],…", value_delimiter = ',')]
    pub descriptor_attributes: Vec<FeatureChoice>,
    #[command(flatten)]
    pub window: WindowArgs,
}

/// Neighbourhood of a vertex that a descriptor sees.
#[derive(Debug, clap::Args)]
pub struct WindowArgs {
    /// Radius of the descriptor's window, the neighbourhood that it looks at: in edges along the surface, 1 to 64.
    #[arg(long, value_name = "N", default_value_t = Window::default().rings, allow_negative_numbers = true)]
    #[arg(value_parser = value_parser!(u32).range(1..=64))]
    pub rings: u32,
    /// Radius of the window in space, in mean edge lengths of the mesh, above 0, at most 1e6.
    #[arg(long, value_name = "R", default_value_t = Window::default().radius)]
    #[arg(allow_negative_numbers = true, value_parser = quantity::number(f64::MIN_POSITIVE, 1e6))]
    pub radius: f64,
}

impl WindowArgs {
    pub fn window(&self) -> Window {
        Window { rings: self.rings, radius: self.radius }
    }
}

/// What a stream may ask for.
#[derive(Debug, clap::Args)]
pub struct LimitArgs {
    /// Most memory that decoding may take, e.g. 512M.
    #[arg(long, value_name = "BYTES", default_value = "4G", value_parser = quantity::bytes, allow_negative_numbers = true)]
    pub max_memory: u64,
    /// Most vertices that may be decoded, e.g. 2M.
    #[arg(long, value_name = "N", default_value_t = Limits::default().max_vertices)]
    #[arg(value_parser = quantity::count, allow_negative_numbers = true)]
    pub max_vertices: u32,
    /// Most work that decoding may take, e.g. 50M; a second is about ten million units. Default: 262144, and 128 more for
    /// each byte of the stream, several times what an ordinary stream takes.
    #[arg(long, value_name = "UNITS", value_parser = quantity::units, allow_negative_numbers = true)]
    pub max_work: Option<u64>,
}

impl LimitArgs {
    pub fn limits(&self) -> Limits {
        let Self { max_memory, max_vertices, max_work } = *self;
        Limits { max_memory, max_vertices, max_work, ..Limits::default() }
    }
}

fn format_parser() -> impl TypedValueParser<Value = Format> {
    PossibleValuesParser::new(Format::ALL.iter().map(|format| format.extension()))
        .try_map(|name| Format::from_extension(&name).ok_or("unknown format"))
}

pub fn descriptor_parser() -> impl TypedValueParser<Value = Descriptor> {
    PossibleValuesParser::new(Descriptor::ALL.map(Descriptor::name))
        .try_map(|name| name.parse::<Descriptor>())
}
