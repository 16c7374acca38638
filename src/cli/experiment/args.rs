//! What may be typed after `lwc experiment`.

use crate::cli::args::{Reading, WindowArgs};
use crate::cli::quantity;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{ValueHint, value_parser};
use lwc::descriptors::{Descriptor, NormalWeights, PcaQuadric, UnknownDescriptor};
use lwc::experiment::{Noise, Settings, Units};
use std::path::PathBuf;

/// Repeat the paper's experiment: simplify meshes by Algorithm 1 with each descriptor, and measure error and time.
///
/// Printed for each step: vertices, share removed, mean window, average plane distance (eq. 34), seconds. DIR
/// gets results.json and results.csv, complete after every run, and a chart of each mesh as SVG and PNG. Runs
/// whose results are in DIR are not repeated: an experiment that was stopped continues, and runs with --noise
/// are added to those without. At the end the descriptors are ranked over all runs in DIR.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  lwc experiment dragon.ply terrain.ply --output results
  lwc experiment dragon.ply terrain.ply --output results --noise")]
pub struct Experiment {
    /// Meshes (.obj .ply .stl .glb .gltf .las .laz, or compressed, such as .obj.gz).
    #[arg(value_name = "MESH", required = true)]
    pub meshes: Vec<PathBuf>,
    /// Folder for the results, created if it does not exist.
    #[arg(short, long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub output: PathBuf,
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
    /// Factor by which the radius grows from each step to the next, 1 to 16.
    #[arg(long, value_name = "FACTOR", default_value_t = Settings::default().growth)]
    #[arg(value_parser = quantity::number(1.0, 16.0))]
    pub growth: f64,
    /// Let descriptors and partition see the mesh with Gaussian noise; distances are measured on the mesh without it.
    #[arg(long)]
    pub noise: bool,
    /// Standard deviation of the noise on each coordinate, in mean edge lengths, above 0, at most 100.
    #[arg(long, value_name = "SIGMA", default_value_t = Noise::default().deviation)]
    #[arg(value_parser = quantity::number(f64::MIN_POSITIVE, 100.0))]
    pub noise_deviation: f64,
    /// Seed of the noise.
    #[arg(long, value_name = "N", default_value_t = Noise::default().seed)]
    pub seed: u64,
    /// Unit of length inside the descriptors: the mean edge length of the mesh, or the unit of the file.
    #[arg(long, value_name = "UNIT", default_value = "mean-edge", value_parser = units_parser())]
    pub units: Units,
    /// How triangles are weighted in vertex normals.
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
