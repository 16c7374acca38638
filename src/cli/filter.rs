//! `lwc filter`: features of chosen scales weakened, strengthened or taken for noise.

use super::args::{Reading, Scale};
use super::exit::Failure;
use super::gain::Gain;
use super::input::read_mesh;
use super::new_shape;
use super::output::{Destination, say_written, size_of};
use super::quantity;
use super::ui::Ui;
use super::writing::Writing;
use anyhow::Context;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use lwc::TriMesh;
use lwc::descriptors::mean_edge_length;
use lwc::io::{Format, MeshFile, WriteError};
use lwc::multiresolution::{Decomposition, Options, Prediction, Threshold, denoised_with_progress};
use std::io::{self, Write};
use std::path::PathBuf;

/// Smooth or enhance features of a chosen size, or remove noise.
///
/// The mesh becomes a base mesh, level 0, and the details of levels 1, 2, … up to the finest; the details of
/// the levels chosen are multiplied and the mesh is put together again, with the same vertices, triangles and attributes but
/// without normals. A scene (.glb .gltf) becomes one mesh.
/// Without -o the levels are listed: vertices, and the root mean square of the details.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  lwc filter model.ply                                   # which levels there are
  lwc filter model.ply --gain 12..=0 -o smooth.ply       # nothing finer than level 11
  lwc filter model.ply --gain 8..10=2 -o bold.ply        # levels 8 to 10 twice as strong
  lwc filter scan.ply --denoise -o clean.ply")]
pub struct Filter {
    /// Mesh (.obj .ply .stl .glb .gltf .las .laz, or compressed, such as .obj.gz).
    #[arg(value_name = "MESH")]
    pub input: PathBuf,
    /// Mesh to write. The ending is the format: .obj .ply .stl .glb .gltf, or compressed, such as .obj.gz.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Multiply the details of levels: 7=0, 5..=0 (5 and finer), ..3=2 (up to 3), 2..4=1.5 (2, 3 and 4).
    ///
    /// May be given several times; factors of the same level multiply. -1000 to 1000.
    #[arg(long, value_name = "LEVELS=FACTOR", value_parser = Gain::parse)]
    pub gain: Vec<Gain>,
    /// Remove noise that is independent from vertex to vertex; how strong it is is estimated from the mesh.
    #[arg(long, conflicts_with_all = ["gain", "prediction", "update", "descriptor"])]
    pub denoise: bool,
    /// How the vertices are predicted that the coarser mesh lacks: curved follows the normals of the coarser mesh.
    #[arg(long, value_name = "HOW", default_value = "curved", value_parser = prediction_parser())]
    pub prediction: Prediction,
    /// Let each coarser mesh average the finer one, instead of sampling it.
    #[arg(long)]
    pub update: bool,
    #[command(flatten)]
    pub scale: Scale,
    /// Levels above the base mesh, 1 to 128. Default: until the base mesh is small.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=128))]
    pub levels: Option<u32>,
    /// Factor by which the window's radius grows from each level to the next coarser one, 1 to 16.
    #[arg(long, value_name = "FACTOR", default_value_t = Options::default().growth)]
    #[arg(value_parser = quantity::number(1.0, 16.0))]
    pub growth: f64,
    #[command(flatten)]
    pub reading: Reading,
    #[command(flatten)]
    pub writing: Writing,
}

impl Filter {
    fn options(&self) -> Options {
        let mut options = Options::default();
        options.descriptor = self.scale.descriptor;
        options.window = self.scale.window.window();
        options.growth = self.growth;
        options.levels = self.levels;
        options.prediction = self.prediction;
        options.update = self.update;
        options
    }
}

/// Reads, filters, writes, reports.
pub fn run(args: &Filter, ui: &Ui) -> anyhow::Result<()> {
    let destination = args.output.clone().map(Destination::new);
    if let Some(destination) = &destination {
        check(destination).with_context(|| destination.name())?;
        destination.check(Some(&args.input), false)?;
    } else if args.denoise || !args.gain.is_empty() {
        return Err(Failure::Usage("give -o FILE for the result".into()).into());
    }
    let name = args.input.display().to_string();
    let bar = ui.bar();
    // Noise takes seven times as long as gains.
    let filtering = if args.denoise { 600.0 } else { 85.0 };
    let [reading, filtering, writing] =
        bar.split([("reading", 10.0), ("filtering", filtering), ("writing", 5.0)]);
    let MeshFile { mesh, attributes, .. } = read_mesh(&args.input, &args.reading, reading, ui)?;
    let options = args.writing.options_for_changed(&mesh);
    let progress = |done: f64| filtering.set(done);
    let mut report = Vec::new();
    let filtered = if args.denoise {
        let (filtered, thresholds) =
            denoised_with_progress(&mesh, &args.options(), &progress).with_context(|| name.clone())?;
        report_noise(&mut report, &mesh, &thresholds)?;
        filtered
    } else {
        let mut decomposition = Decomposition::new_with_progress(&mesh, &args.options(), &progress)
            .with_context(|| name.clone())?;
        let gains = gains(&args.gain, decomposition.num_levels()).context(name)?;
        report_levels(&mut report, &decomposition, &gains, mean_edge_length(&mesh))?;
        for (level, &gain) in gains.iter().enumerate().skip(1).filter(|(_, gain)| **gain != 1.0) {
            decomposition.scale_details(level, gain);
        }
        // Unit gains are the mesh itself, without rounding.
        if gains.iter().all(|&gain| gain == 1.0) { mesh } else { decomposition.reconstruct() }
    };
    writing.set(0.0);
    if let Some(Destination::File(path)) = &destination {
        new_shape::write(path, &filtered, attributes, &options, ui)
            .with_context(|| path.display().to_string())?;
    }
    drop(bar);
    if !ui.is_quiet() {
        io::stdout().lock().write_all(&report)?;
    }
    if let Some(destination) = &destination {
        say_written(destination, &size_of(&filtered), ui);
    }
    Ok(())
}

/// Mesh files only.
fn check(destination: &Destination) -> Result<(), WriteError> {
    match destination {
        Destination::File(path) if Format::from_path(path).is_some_and(Format::is_written) => Ok(()),
        _ => Err(WriteError::UnknownEnding),
    }
}

/// Factor of each level, that of the base mesh included, which is 1.
fn gains(wanted: &[Gain], num_levels: usize) -> Result<Vec<f64>, Failure> {
    let mut gains = vec![1.0; num_levels + 1];
    for gain in wanted {
        let levels = gain.levels(num_levels);
        if levels.is_empty() {
            let what =
                format!("--gain {gain} is for no level: there are details of levels 1 to {num_levels}");
            return Err(Failure::Usage(what));
        }
        gains[levels].iter_mut().for_each(|factor| *factor *= gain.factor);
    }
    Ok(gains)
}

fn report_levels(
    out: &mut dyn Write,
    decomposition: &Decomposition,
    gains: &[f64],
    mean_edge: f64,
) -> io::Result<()> {
    writeln!(out, "level   vertices   rms detail   in mean edges    gain")?;
    writeln!(out, "{:>5} {:>10}", 0, decomposition.num_vertices(0))?;
    for (level, gain) in gains.iter().enumerate().skip(1) {
        let (vertices, rms) = (decomposition.num_vertices(level), decomposition.rms(level));
        writeln!(out, "{level:>5} {vertices:>10} {rms:>12.4e} {:>15.4} {gain:>7}", rms / mean_edge)?;
    }
    Ok(())
}

fn report_noise(out: &mut dyn Write, mesh: &TriMesh, thresholds: &[Vec<Threshold>]) -> io::Result<()> {
    let finest: Vec<f64> = thresholds.iter().filter_map(|run| Some(run.first()?.noise)).collect();
    let noise = finest.iter().sum::<f64>() / finest.len().max(1) as f64;
    let in_edges = noise / mean_edge_length(mesh);
    writeln!(
        out,
        "noise in the finest details: {noise:.4e}, {in_edges:.4} mean edges, over {} runs",
        finest.len()
    )
}

fn prediction_parser() -> impl TypedValueParser<Value = Prediction> {
    PossibleValuesParser::new(["curved", "flat"])
        .map(|name| if name == "flat" { Prediction::Flat } else { Prediction::Curved })
}
