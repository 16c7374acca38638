//! `cargo run --release --manifest-path benches/compare/Cargo.toml -- FOLDER --out DIR`: the whole comparison.

mod meshopt_codec;
mod model;
mod others;
mod report;
mod single;
mod stream;
mod variant;

use anyhow::Context;
use clap::Parser;
use model::Model;
use others::Others;
use std::path::{Path, PathBuf};
use stream::Measured;
use variant::Variant;

/// Compare lwc with Draco, meshoptimizer and zstd: whole files, beginnings of streams, speed.
///
/// Every codec gets the same triangles on the same grid, positions only. Draco is the command
/// `draco_encoder` with -cl 10; without it its columns are empty. DIR gets table.md and, per mesh, a chart
/// of quality over bytes.
#[derive(Debug, Parser)]
#[command(name = "lwc-compare")]
pub struct Args {
    /// Meshes, or folders of meshes (.obj .ply .stl, plain or compressed as .zst).
    #[arg(value_name = "MESH", required = true)]
    inputs: Vec<PathBuf>,
    /// Folder for table.md and the charts; it is made if it is not there.
    #[arg(short, long, value_name = "DIR")]
    out: PathBuf,
    /// Bits per coordinate.
    #[arg(long, default_value_t = 12, value_parser = clap::value_parser!(u32).range(4..=16))]
    bits: u32,
    /// Streams of lwc: size, levels (size, but never in one piece), balanced, lazy (the same, but coarse meshes are shown
    /// with their vertices where they lie), prefix, max, fast or algorithm1, each also with a descriptor, e.g. algorithm1:nfv.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', default_value = "size,balanced,prefix")]
    variants: Vec<Variant>,
    /// Leave out what needs distances: beginnings and charts.
    #[arg(long)]
    sizes_only: bool,
    /// Also the best of many single files of each size: meshoptimizer's simplification, then Draco.
    #[arg(long)]
    singles: bool,
    /// Timed repetitions, of which the fastest counts.
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..))]
    runs: u32,
}

/// All that is known of one mesh.
pub struct Row {
    model: Model,
    others: Others,
    streams: Vec<Measured>,
    /// Bytes and dB of single files, none dominated.
    singles: Vec<(usize, f64)>,
}

fn main() -> anyhow::Result<()> {
    let args = Args::parse();
    std::fs::create_dir_all(&args.out).with_context(|| args.out.display().to_string())?;
    if !others::has_draco() {
        eprintln!("draco_encoder is not installed: its columns are empty");
    }
    let mut rows = Vec::new();
    for path in mesh_files(&args.inputs)? {
        eprintln!("{}", path.display());
        match compare(&path, &args).with_context(|| path.display().to_string()) {
            Ok(row) => rows.push(row),
            Err(error) => eprintln!("skipped: {error:#}"),
        }
        // After each mesh, so that a long run can be looked at and stopped.
        report::write(&rows, &args)?;
    }
    print!("{}", std::fs::read_to_string(args.out.join("table.md"))?);
    Ok(())
}

fn compare(path: &Path, args: &Args) -> anyhow::Result<Row> {
    let model = Model::read(path, args.bits)?;
    let others = Others::measure(&model, args.runs)?;
    let budget = (!args.sizes_only).then(|| others.draco.unwrap_or(others.meshopt_zstd));
    let measure = |variant: &Variant| stream::measure(&model, *variant, budget, args.runs);
    let streams = args.variants.iter().map(measure).collect::<anyhow::Result<_>>()?;
    let singles = if args.singles && !args.sizes_only && others::has_draco() {
        single::best_files(&model)?
    } else {
        Vec::new()
    };
    Ok(Row { model, others, streams, singles })
}

/// The files named, and those of the folders named in order of their names.
fn mesh_files(inputs: &[PathBuf]) -> anyhow::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for input in inputs {
        if !input.is_dir() {
            files.push(input.clone());
            continue;
        }
        let entries = std::fs::read_dir(input).with_context(|| input.display().to_string())?;
        let paths: Result<Vec<PathBuf>, _> = entries.map(|entry| entry.map(|e| e.path())).collect();
        let mut found = paths?;
        found.retain(|path| path.is_file() && lwc::io::Format::from_path(path).is_some());
        found.sort();
        files.extend(found);
    }
    Ok(files)
}
