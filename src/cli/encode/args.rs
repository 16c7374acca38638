//! What may be typed after `lwc encode`.

use super::grid::GridArgs;
use crate::cli::args::{Reading, Scale};
use crate::cli::exit::Failure;
use crate::cli::input::{StreamInput, name_of};
use crate::cli::input_file::is_stdin;
use crate::cli::losses::Strictness;
use crate::cli::output::{Destination, with_ending, without_mesh_ending};
use crate::cli::quantity;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::value_parser;
use lwc::io::TerrainOptions;
use lwc::{EncodeOptions, GridChoice, Optimize, Partition, Profile};
use std::path::{Path, PathBuf};

/// Encode a mesh (.obj .ply .stl .glb .gltf) or a terrain point cloud (.las .laz), plain or compressed (.gz .zst).
///
/// The finest level is the mesh with its vertices rounded to a grid: 2^BITS − 1 steps along its longest side (`-q`), or steps in
/// units of the model (`--step`, `--precision`, `--grid`). Every triangle comes back, with its orientation. Warnings count what has to be dropped or cut.
#[derive(Debug, clap::Args)]
pub struct Encode {
    /// Mesh to encode, `-` for standard input (with --format).
    #[arg(value_name = "MODEL")]
    pub input: PathBuf,
    /// More meshes: all become one scene, each mesh with the name of its file. Needs -o.
    #[arg(value_name = "MORE")]
    pub others: Vec<PathBuf>,
    /// Stream to write, `-` for standard output. Default: MODEL with the ending .lwc, in the same folder; standard output
    /// for standard input. The endings of mesh files are refused.
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
    /// - weighted-error: vertices stay whose error, weighted by the descriptor, is large; of the others the cheap ones go
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
    /// All give the same meshes, if they have the same levels.
    ///
    /// - max: arithmetic coding with the largest models, which takes 1.3 to 1.5 times as long to decode as small
    /// - small: arithmetic coding, a stream half a percent to 1 % larger than with max
    /// - fast: zstd, a stream 1.2 to 1.6 times as large that decodes three to five times as fast; with `--levels 0`
    ///   tables, about as large and four times as fast
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
    /// Bits of each component of all other attributes, 1 to 30. Whole numbers, which may name things, are kept exactly whatever
    /// the bits; intensity and near infrared of LAS are rounded.
    #[arg(long, value_name = "BITS", default_value_t = EncodeOptions::default().generic_bits)]
    #[arg(value_parser = value_parser!(u32).range(1..=30), allow_negative_numbers = true)]
    pub generic_bits: u32,
    /// Keep only positions and triangles.
    #[arg(long)]
    pub no_attributes: bool,
    /// Leave out textures; colours and names of materials stay.
    #[arg(long)]
    pub no_textures: bool,
    /// Keep every number of positions and attributes bit for bit: floats, doubles and integers. What the grid rounds off is
    /// stored after the last pass.
    #[arg(long)]
    pub lossless: bool,
    /// Keep vertices that no triangle uses. Without this option they are dropped and counted.
    #[arg(long)]
    pub keep_isolated: bool,
    /// Keep triangles that have the same vertex twice. Without this option they are dropped and counted.
    #[arg(long)]
    pub keep_degenerate: bool,
    /// Keep the order of vertices and triangles, and the first corner of each triangle; `lwc info` shows how many bytes that takes.
    #[arg(long)]
    pub keep_order: bool,
    /// Join the meshes of a scene (.glb .gltf), or of several files, into one, each in its place. Without this option each mesh is stored
    /// once, in its own coordinates, with a list of all the places where it is used.
    #[arg(long)]
    pub merge: bool,
    /// Decode the stream and compare it with the mesh before it is written.
    #[arg(long)]
    pub verify: bool,
    #[command(flatten)]
    pub strictness: Strictness,
    /// Print one JSON object instead of the summary (to standard error with `-o -`).
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub reading: Reading,
    // Last: their headings would cover what follows.
    #[command(flatten)]
    pub grid: GridArgs,
    #[command(flatten)]
    pub terrain: Terrain,
}

impl Encode {
    /// The options of the library, with the grid that is asked for.
    pub fn options(&self, grid: GridChoice) -> EncodeOptions {
        let mut options = EncodeOptions::default();
        options.grid = grid;
        options.descriptor = self.scale.descriptor;
        options.window = self.scale.window.window();
        options.descriptor_attributes.clone_from(&self.scale.descriptor_attributes);
        options.growth = self.growth;
        options.quantization_bits = self.quantization_bits.unwrap_or(options.quantization_bits);
        options.levels = self.levels.0;
        options.partition = self.partition;
        options.optimize = self.optimize;
        options.profile = self.profile;
        options.effort = self.effort;
        options.steps_per_edge = self.steps_per_edge;
        options.normal_bits = self.normal_bits;
        options.texcoord_bits = self.texcoord_bits;
        options.color_bits = self.color_bits;
        options.generic_bits = self.generic_bits;
        options.lossless = self.lossless;
        options.keep_isolated = self.keep_isolated;
        options.keep_degenerate = self.keep_degenerate;
        options.keep_order = self.keep_order;
        options
    }

    /// All of them, in order.
    pub fn inputs(&self) -> impl Iterator<Item = &Path> {
        std::iter::once(&self.input).chain(&self.others).map(PathBuf::as_path)
    }

    /// What to call them.
    pub fn input_name(&self) -> String {
        self.inputs().map(name_of).collect::<Vec<_>>().join(", ")
    }

    pub fn stream_input(&self) -> StreamInput<'_> {
        let has_textures = !(self.no_textures || self.no_attributes);
        let (paths, merge) = (self.inputs().collect(), self.merge);
        StreamInput { paths, merge, has_textures, reading: &self.reading }
    }

    /// What can be seen before anything is read.
    ///
    /// # Errors
    /// If several files have no name in common, or options are for one only.
    pub fn check_output(&self) -> Result<(), Failure> {
        let refuse = |what: &str| Err(Failure::Usage(what.to_owned()));
        if !self.others.is_empty() && self.output.is_none() {
            return refuse("several inputs make one stream: name it with -o");
        }
        if self.inputs().filter(|input| is_stdin(input)).count() > 1 {
            return refuse("standard input can be read once");
        }
        if !self.others.is_empty() && self.terrain.options().is_some() {
            return refuse("options for point clouds are for a single input");
        }
        Ok(())
    }

    pub fn destination(&self) -> Destination {
        if self.output.is_none() && is_stdin(&self.input) {
            return Destination::Stdout;
        }
        let beside = || with_ending(without_mesh_ending(&self.input), "lwc");
        Destination::new(self.output.clone().unwrap_or_else(beside))
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
    /// Keep only points of these classes, such as 2,9 for ground and water. Default: all.
    #[arg(long, value_name = "CLASS,…", value_delimiter = ',')]
    pub classes: Option<Vec<u8>>,
    /// Leave out triangles with a longer edge in the plane, in units of the file, above 0, at most 1e9.
    #[arg(long, value_name = "LENGTH", value_parser = quantity::number(f64::MIN_POSITIVE, 1e9))]
    #[arg(allow_negative_numbers = true)]
    pub longest_edge: Option<f64>,
}

impl Terrain {
    /// The options of the library, `None` if none is given.
    pub fn options(&self) -> Option<TerrainOptions> {
        let mut options = TerrainOptions::default();
        options.last_returns_only = self.last_returns;
        options.cell_size = self.thin;
        options.max_points = self.max_points.map(|points| points as usize);
        options.classes.clone_from(&self.classes);
        options.longest_edge = self.longest_edge;
        Some(options).filter(|options| *options != TerrainOptions::default())
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
