//! What may be typed.

use super::quantity;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{ArgAction, Parser, Subcommand, value_parser};
use lwc::descriptors::{Descriptor, FeatureChoice, Window};
use lwc::io::{ReadOptions, TerrainOptions};
use lwc::{EncodeOptions, Limits, Optimize, Partition, Profile};
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
    /// Print no summary, warnings or progress bars: only errors, and what was asked for.
    #[arg(long, global = true)]
    pub quiet: bool,
    /// Print more details on standard error.
    #[arg(short, long, global = true, action = ArgAction::Count, conflicts_with = "quiet")]
    pub verbose: u8,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    Encode(Encode),
    Decode(Decode),
    Info(Info),
    Describe(Describe),
    Compare(Compare),
    Experiment(super::experiment::args::Experiment),
    Render(super::render::args::Render),
    Filter(super::filter::Filter),
    Edit(super::edit::Edit),
    View(View),
    Completions(super::completions::Completions),
    Man(super::man::Man),
}

/// Encode a mesh (.obj .ply .stl .glb .gltf) or a terrain point cloud (.las .laz), plain or compressed (.zst).
///
/// The finest level is the mesh with its vertices rounded to a grid of 2^BITS cells along its longest side;
/// every triangle comes back, with its orientation. Warnings count what has to be dropped or cut.
#[derive(Debug, clap::Args)]
pub struct Encode {
    /// Mesh to encode.
    #[arg(value_name = "MODEL")]
    pub input: PathBuf,
    /// Stream to write, `-` for standard output. Default: MODEL with the ending .lwc, in the same folder. The endings of
    /// mesh files are refused.
    ///
    /// A file that exists is replaced once the new one is complete.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub scale: Scale,
    /// Bits per coordinate, 1 to 30 [default: 12].
    ///
    /// With `--lossless` the default is 12, 15 or 18, whichever makes the smallest file; that takes three times
    /// as long.
    #[arg(short = 'q', long, value_name = "BITS", allow_negative_numbers = true)]
    #[arg(value_parser = value_parser!(u32).range(1..=30))]
    pub quantization_bits: Option<u32>,
    /// Levels above the base mesh, 0 to 128, or `auto`: as many as it takes to a small base mesh.
    #[arg(long, value_name = "N", default_value = "auto", allow_negative_numbers = true)]
    #[arg(value_parser = levels)]
    pub levels: Levels,
    /// Factor by which the radius grows from each level to the next coarser one, 1 to 16.
    #[arg(long, value_name = "FACTOR", default_value_t = EncodeOptions::default().growth)]
    #[arg(allow_negative_numbers = true, value_parser = quantity::number(1.0, 16.0))]
    pub growth: f64,
    /// How the vertices that a level removes are chosen.
    ///
    /// - weighted-error: the error, weighted by the descriptor, decides which vertices stay, the cost of coding which of
    ///   the others go
    /// - algorithm1: exactly the paper's Algorithm 1
    #[arg(long, value_name = "NAME", verbatim_doc_comment)]
    #[arg(default_value = EncodeOptions::default().partition.name(), value_parser = partition_parser())]
    pub partition: Partition,
    /// What the partition by weighted error aims at.
    ///
    /// - size: the smallest file; no vertex is kept for its saliency, and --levels auto leaves out the levels where that is smaller
    /// - balanced: the beginning of a file shows nearly as good a mesh as with prefix, and the file is smaller
    /// - prefix: the beginning of a file shows the best mesh
    #[arg(long, value_name = "AIM", verbatim_doc_comment)]
    #[arg(default_value = EncodeOptions::default().optimize.name(), value_parser = optimize_parser())]
    pub optimize: Optimize,
    /// How the passes are coded. Default: max with `--optimize size`, else small.
    ///
    /// All give the same meshes, except that `--optimize size` always keeps the levels with fast.
    ///
    /// - max: arithmetic coding with the largest models, which takes 1.3 to 1.5 times as long to decode as small
    /// - small: arithmetic coding, a stream half a percent to 1 % larger than with max
    /// - fast: zstd, a stream 1.2 to 1.6 times as large that decodes three to five times as fast
    #[arg(long, value_name = "NAME", verbatim_doc_comment)]
    #[arg(value_parser = profile_parser())]
    pub profile: Option<Profile>,
    /// Time to spend, 0 to 9.
    ///
    /// - 0 to 2: the partition by weighted error leaves the descriptor out, and --optimize size makes one try
    /// - 3 to 6: the usual search
    /// - 7, 8: --optimize size also tries other ways to spread the bits over the passes, and keeps the smallest file
    /// - 9: --optimize size also tries other partitions, each in all these ways
    #[arg(long, value_name = "N", verbatim_doc_comment)]
    #[arg(default_value_t = EncodeOptions::default().effort, value_parser = clap::value_parser!(u32).range(0..=9))]
    pub effort: u32,
    /// Grid steps per mean edge length of a level, 0.5 to 1e9 [default: chosen by the error of each level].
    #[arg(long, value_name = "STEPS")]
    #[arg(allow_negative_numbers = true, value_parser = quantity::number(0.5, 1e9))]
    pub steps_per_edge: Option<f64>,
    /// Bits of each of the two coordinates of a normal (octahedral mapping), 2 to 30.
    #[arg(long, value_name = "BITS", default_value_t = EncodeOptions::default().normal_bits)]
    #[arg(value_parser = value_parser!(u32).range(2..=30), allow_negative_numbers = true)]
    pub normal_bits: u32,
    /// Bits of each texture coordinate, 1 to 30.
    #[arg(long, value_name = "BITS", default_value_t = EncodeOptions::default().texcoord_bits)]
    #[arg(value_parser = value_parser!(u32).range(1..=30), allow_negative_numbers = true)]
    pub texcoord_bits: u32,
    /// Bits of each component of a colour, 1 to 30. Colours of 8 bits are kept exactly with 8.
    #[arg(long, value_name = "BITS", default_value_t = EncodeOptions::default().color_bits)]
    #[arg(value_parser = value_parser!(u32).range(1..=30), allow_negative_numbers = true)]
    pub color_bits: u32,
    /// Bits of each component of all other attributes, 1 to 30. Integers that fit are kept exactly.
    #[arg(long, value_name = "BITS", default_value_t = EncodeOptions::default().generic_bits)]
    #[arg(value_parser = value_parser!(u32).range(1..=30), allow_negative_numbers = true)]
    pub generic_bits: u32,
    /// Keep only positions and triangles.
    #[arg(long)]
    pub no_attributes: bool,
    /// Keep every number of positions and attributes bit for bit: floats, doubles and integers. What the grid rounds off is
    /// stored after the last pass.
    #[arg(long)]
    pub lossless: bool,
    /// Keep vertices that no face uses. Without this option they are dropped and counted.
    #[arg(long)]
    pub keep_isolated: bool,
    /// Keep faces that have the same vertex twice. Without this option they are dropped and counted.
    #[arg(long)]
    pub keep_degenerate: bool,
    /// Keep the order of vertices and faces, and the first corner of each face; `lwc info` shows how many bytes that takes.
    #[arg(long)]
    pub keep_order: bool,
    /// Join the meshes of a scene (.glb .gltf) into one, each in its place. Without this option each mesh is stored
    /// once, in its own coordinates, with a list of all the places where it is used.
    #[arg(long)]
    pub merge: bool,
    /// Decode the stream and compare it with the mesh before it is written.
    #[arg(long)]
    pub verify: bool,
    /// Print one JSON object instead of the summary (to standard error with `-o -`).
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub reading: Reading,
    // Last: its heading would cover what follows.
    #[command(flatten)]
    pub terrain: Terrain,
}

/// How mesh files are read.
#[derive(Debug, clap::Args)]
pub struct Reading {
    /// Read even .zst files that unpack to both more than 256 MiB and more than 1000 times their size.
    #[arg(long)]
    pub any_ratio: bool,
}

impl Reading {
    /// The options of the library.
    pub fn options(&self) -> ReadOptions {
        if self.any_ratio { ReadOptions::default().any_ratio() } else { ReadOptions::default() }
    }
}

/// Which points of a point cloud become vertices.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Point clouds (.las .laz)")]
pub struct Terrain {
    /// Use only the last return of each pulse. Default: all.
    #[arg(long)]
    pub last_returns: bool,
    /// Keep one point in each square of this size, in units of the file, above 0, at most 1e9.
    #[arg(long, value_name = "SIZE", value_parser = quantity::number(f64::MIN_POSITIVE, 1e9))]
    #[arg(allow_negative_numbers = true)]
    pub thin: Option<f64>,
    /// Keep at most N points, spread evenly, e.g. 500K.
    #[arg(long, value_name = "N", value_parser = quantity::count, allow_negative_numbers = true)]
    pub max_points: Option<u32>,
}

impl Terrain {
    /// The options of the library, `None` if none is given.
    pub fn options(&self) -> Option<TerrainOptions> {
        let mut options = TerrainOptions::default();
        options.last_returns_only = self.last_returns;
        options.cell_size = self.thin;
        options.max_points = self.max_points.map(|points| points as usize);
        Some(options).filter(|options| *options != TerrainOptions::default())
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
    /// `color`, `uv`, `normal` or names of attributes, separated by commas. The whole range of an attribute counts
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

/// Decode a stream, or as much of it as there is.
///
/// A stream that ends early gives a coarser mesh, with a note on standard error.
#[derive(Debug, clap::Args)]
pub struct Decode {
    /// Stream to decode; standard input if it is `-` or missing.
    #[arg(value_name = "FILE.lwc")]
    pub input: Option<PathBuf>,
    /// Mesh to write, `-` for standard output. The ending is the format: .obj .ply .stl .glb .gltf, or compressed, such as
    /// .obj.zst. Default, in the folder of model.lwc: model.level5.obj with `--level 5`, model.decoded.obj without.
    ///
    /// A file that exists is replaced once the new one is complete; the input is never replaced.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Stop at this level; 0 is the base mesh. Default: the finest.
    #[arg(short, long, value_name = "K", allow_negative_numbers = true)]
    pub level: Option<u32>,
    /// Leave the vertices of coarse levels where they are in the finest mesh. By default they are moved a little outwards,
    /// since coarse meshes shrink.
    #[arg(long)]
    pub no_shrinkage_compensation: bool,
    /// Decode the first N bytes only, e.g. 5000 or 20K. Default: all.
    #[arg(short, long, value_name = "N", value_parser = quantity::bytes, allow_negative_numbers = true)]
    pub bytes: Option<u64>,
    /// Format for standard output and for the default file name. Default: obj.
    #[arg(long, value_name = "FORMAT", value_parser = format_parser())]
    pub format: Option<lwc::io::Format>,
    /// Write the finest intact mesh of a damaged stream, and succeed with a warning.
    #[arg(long)]
    pub salvage: bool,
    #[command(flatten)]
    pub limits: LimitArgs,
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

/// Show levels, passes and parameters of a stream without decoding it.
///
/// The beginning of a stream is enough, if its table of passes is complete.
#[derive(Debug, clap::Args)]
pub struct Info {
    /// Stream to look at; standard input if it is `-` or missing.
    #[arg(value_name = "FILE.lwc")]
    pub input: Option<PathBuf>,
    /// Print one JSON object.
    #[arg(long)]
    pub json: bool,
    /// Draw a chart (.svg or .png): the distance from the finest mesh over the bytes read. This decodes the stream.
    #[arg(long, value_name = "FILE", conflicts_with = "json")]
    pub plot: Option<PathBuf>,
    #[command(flatten)]
    pub limits: LimitArgs,
}

/// Evaluate a descriptor at every vertex of a mesh.
///
/// As CSV: the header `vertex,value` and one line per vertex, in the order of the file, with all digits.
/// As PNG: a picture coloured by the values, with a legend. As PLY: the mesh with the same colours at its
/// vertices. Vertices without faces have the value 0.
#[derive(Debug, clap::Args)]
pub struct Describe {
    /// Mesh to describe.
    #[arg(value_name = "MESH")]
    pub input: PathBuf,
    #[command(flatten)]
    pub scale: Scale,
    /// Table (.csv), picture (.png) or coloured mesh (.ply) to write, `-` for a table on standard output.
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    pub output: PathBuf,
    #[command(flatten)]
    pub heat: super::render::args::HeatArgs,
    #[command(flatten)]
    pub reading: Reading,
    #[command(flatten)]
    pub picture: super::render::args::Picture,
}

/// Measure the distance between two surfaces.
///
/// Root mean square and maximum of the distance to the nearest point of the other surface, in both directions.
/// Each file is a mesh (.obj .ply .stl .glb .gltf .las .laz, or compressed, such as .obj.zst) or a stream (.lwc).
#[derive(Debug, clap::Args)]
pub struct Compare {
    /// Reference: relative values are divided by the diagonal of its bounding box.
    #[arg(value_name = "A")]
    pub a: PathBuf,
    /// What to compare with it.
    #[arg(value_name = "B")]
    pub b: PathBuf,
    /// Surface samples in each direction, e.g. 500K, at most 4G. Default: two per vertex, at least
    /// 100,000.
    #[arg(long, value_name = "N", value_parser = quantity::count, allow_negative_numbers = true)]
    pub samples: Option<u32>,
    /// Print one JSON object; `db` is null if the surfaces are identical.
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub reading: Reading,
    #[command(flatten)]
    pub limits: LimitArgs,
}

/// Show a model in the browser, coarse at once and finer while it loads.
///
/// Serves a page on this machine, prints its address and opens it. A mesh (.obj .ply .stl .glb .gltf .las
/// .laz, or compressed, such as .obj.zst) is encoded first, with default options except those below.
#[derive(Debug, clap::Args)]
pub struct View {
    /// Stream (.lwc) or mesh to show.
    #[arg(value_name = "MODEL")]
    pub input: PathBuf,
    /// Port to listen on; 0 chooses one that is free.
    #[arg(long, value_name = "PORT", default_value_t = 0)]
    pub port: u16,
    /// Do not start a browser.
    #[arg(long)]
    pub no_open: bool,
    #[command(flatten)]
    pub reading: Reading,
    #[command(flatten)]
    pub scale: Scale,
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

pub fn descriptor_parser() -> impl TypedValueParser<Value = Descriptor> {
    PossibleValuesParser::new(Descriptor::ALL.map(Descriptor::name))
        .try_map(|name| name.parse::<Descriptor>())
}

fn partition_parser() -> impl TypedValueParser<Value = Partition> {
    PossibleValuesParser::new(Partition::ALL.map(Partition::name))
        .try_map(|name| Partition::ALL.into_iter().find(|p| p.name() == name).ok_or("unknown partition"))
}

fn optimize_parser() -> impl TypedValueParser<Value = Optimize> {
    PossibleValuesParser::new(Optimize::ALL.map(Optimize::name))
        .try_map(|name| Optimize::ALL.into_iter().find(|o| o.name() == name).ok_or("unknown aim"))
}

fn profile_parser() -> impl TypedValueParser<Value = Profile> {
    PossibleValuesParser::new(Profile::ALL.map(Profile::name))
        .try_map(|name| Profile::ALL.into_iter().find(|p| p.name() == name).ok_or("unknown profile"))
}

fn format_parser() -> impl TypedValueParser<Value = lwc::io::Format> {
    use lwc::io::Format;
    let written = || Format::ALL.iter().copied().filter(|format| format.is_written());
    PossibleValuesParser::new(written().map(Format::extension))
        .try_map(move |name| written().find(|f| f.extension() == name).ok_or("unknown format"))
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
        let Command::Encode(encode) = args.command else { panic!("not encode") };
        assert_eq!(encode.options(), EncodeOptions::default());
        let args = Args::try_parse_from(["lwc", "decode", "x.lwc"]).unwrap();
        let Command::Decode(decode) = args.command else { panic!("not decode") };
        assert_eq!(decode.limits.limits(), Limits::default());
    }
}
