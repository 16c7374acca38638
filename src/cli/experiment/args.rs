//! What may be typed after `lwc experiment`.

use crate::cli::args::{Reading, WindowArgs};
use crate::cli::quantity;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::value_parser;
use lwc::descriptors::{Descriptor, NormalWeights, PcaQuadric, UnknownDescriptor};
use lwc::experiment::{Noise, Settings, Units};
use std::path::PathBuf;

/// Repeat the paper's experiment: Algorithm 1 on meshes, with each descriptor, and what it costs.
///
/// Per step: vertices, share removed, mean window, average plane distance (eq. 34), seconds. DIR gets
/// results.json and results.csv, complete after every run, and a chart of each mesh as SVG and PNG. Runs
/// that DIR has already are not repeated, so an experiment that was stopped goes on where it was, and one
/// with --noise can join the one without. The end is a ranking of the descriptors over all runs in DIR.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Example:
  lwc experiment dragon.ply terrain.ply --out results
  lwc experiment dragon.ply terrain.ply --out results --noise")]
pub struct Experiment {
    /// Meshes (.obj .ply .stl .glb .gltf .las .laz, each also as .zst).
    #[arg(value_name = "MESH", required = true)]
    pub meshes: Vec<PathBuf>,
    /// Folder for the results; it is made if it is not there.
    #[arg(short, long, value_name = "DIR")]
    pub out: PathBuf,
    /// Descriptors, separated by commas, or `all`.
    #[arg(short, long, value_name = "NAMES", default_value = "all", value_parser = descriptors)]
    pub descriptors: Descriptors,
    /// How often Algorithm 1 is applied, 1 to 64.
    #[arg(long, value_name = "N", default_value_t = Settings::default().levels)]
    #[arg(value_parser = value_parser!(u32).range(1..=64))]
    pub levels: u32,
    #[command(flatten)]
    pub reading: Reading,
    #[command(flatten)]
    pub window: WindowArgs,
    /// Factor of the radius from each step to the next, 1 to 16.
    #[arg(long, value_name = "FACTOR", default_value_t = Settings::default().growth)]
    #[arg(value_parser = quantity::number(1.0, 16.0))]
    pub growth: f64,
    /// Let Gaussian noise drive descriptors and partition; distances stay those of the mesh as it is.
    #[arg(long)]
    pub noise: bool,
    /// Standard deviation of the noise on each coordinate, in mean edges, above 0, at most 100.
    #[arg(long, value_name = "SIGMA", default_value_t = Noise::default().deviation)]
    #[arg(value_parser = quantity::number(f64::MIN_POSITIVE, 100.0))]
    pub noise_deviation: f64,
    /// Seed of the noise.
    #[arg(long, value_name = "N", default_value_t = Noise::default().seed)]
    pub seed: u64,
    /// Unit of length inside the descriptors: the mean edge of the mesh, or that of the file.
    #[arg(long, value_name = "UNIT", default_value = "mean-edge", value_parser = units_parser())]
    pub units: Units,
    /// How faces count in vertex normals.
    #[arg(long, value_name = "HOW", default_value = NormalWeights::default().name())]
    #[arg(value_parser = normals_parser())]
    pub normals: NormalWeights,
    /// Quadric that pca-qem integrates: the mean of the window, or that of the vertex alone.
    #[arg(long, value_name = "WHICH", default_value = PcaQuadric::default().name())]
    #[arg(value_parser = quadric_parser())]
    pub pca_quadric: PcaQuadric,
}

impl Experiment {
    pub fn settings(&self) -> Settings {
        let mut settings = Settings::default();
        settings.levels = self.levels;
        settings.window = self.window.window();
        settings.growth = self.growth;
        settings.units = self.units;
        settings.readings.normals = self.normals;
        settings.readings.pca_quadric = self.pca_quadric;
        settings
    }

    pub fn noise(&self) -> Option<Noise> {
        self.noise.then_some(Noise { deviation: self.noise_deviation, seed: self.seed })
    }
}

/// A list without repetitions.
#[derive(Clone, Debug)]
pub struct Descriptors(pub Vec<Descriptor>);

fn descriptors(text: &str) -> Result<Descriptors, String> {
    if text == "all" {
        return Ok(Descriptors(Descriptor::ALL.to_vec()));
    }
    let mut list = Vec::new();
    for name in text.split(',') {
        let descriptor: Descriptor = name.trim().parse().map_err(|e: UnknownDescriptor| e.to_string())?;
        if !list.contains(&descriptor) {
            list.push(descriptor);
        }
    }
    Ok(Descriptors(list))
}

fn units_parser() -> impl TypedValueParser<Value = Units> {
    PossibleValuesParser::new(["mean-edge", "model"])
        .map(|name| if name == "model" { Units::Model } else { Units::MeanEdge })
}

fn normals_parser() -> impl TypedValueParser<Value = NormalWeights> {
    PossibleValuesParser::new(NormalWeights::ALL.map(NormalWeights::name))
        .map(|name| NormalWeights::ALL.into_iter().find(|weights| weights.name() == name).unwrap_or_default())
}

fn quadric_parser() -> impl TypedValueParser<Value = PcaQuadric> {
    PossibleValuesParser::new(PcaQuadric::ALL.map(PcaQuadric::name))
        .map(|name| PcaQuadric::ALL.into_iter().find(|quadric| quadric.name() == name).unwrap_or_default())
}
