//! `lwc compare`: how far two surfaces are apart.

use super::args::{LimitArgs, Reading};
use super::input::read_mesh_or_stream;
use super::output::print_json;
use super::quantity;
use super::ui::Ui;
use anyhow::Context;
use lwc::metrics::{CompareOptions, Comparison, Distance, compare_with_progress};
use serde_json::{Value, json};
use std::io::{self, Write};
use std::path::PathBuf;

/// Measure the distance between two surfaces.
///
/// Root mean square and maximum of the distance to the nearest point of the other surface, in both directions.
/// Each file is a mesh (.obj .ply .stl .glb .gltf .las .laz, or compressed, such as .obj.gz) or a stream (.lwc).
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

/// Reads both, measures, reports.
pub fn run(args: &Compare, ui: &Ui) -> anyhow::Result<()> {
    let bar = ui.bar();
    let [first, second, measuring] = bar.split([("reading", 8.0), ("reading", 8.0), ("measuring", 84.0)]);
    let a = read_mesh_or_stream(&args.a, args.limits.limits(), &args.reading, first, ui)?;
    let b = read_mesh_or_stream(&args.b, args.limits.limits(), &args.reading, second, ui)?;
    let mut options = CompareOptions::new();
    options.samples = args.samples.map(|samples| samples as usize);
    measuring.set(0.0);
    let found = compare_with_progress(&a, &b, &options, &|done| measuring.set(done))
        .with_context(|| format!("{}, {}", args.a.display(), args.b.display()))?;
    drop(bar);
    if args.json {
        print_json(io::stdout().lock(), &to_json(args, &found))?;
    } else {
        print(io::stdout().lock(), &found)?;
    }
    Ok(())
}

fn is_identical(found: &Comparison) -> bool {
    found.max() == 0.0
}

fn print(mut out: impl Write, found: &Comparison) -> io::Result<()> {
    writeln!(out, "         {:>14} {:>14}", "rms", "max")?;
    let both = Distance { rms: found.rms(), max: found.max() };
    for (name, Distance { rms, max }) in
        [("a to b", found.forward), ("b to a", found.backward), ("larger", both)]
    {
        writeln!(out, "{name:<8} {rms:>14.6e} {max:>14.6e}")?;
    }
    if is_identical(found) {
        writeln!(out, "diagonal {:>14.6e}, the surfaces are identical", found.diagonal)
    } else {
        let share = found.rms_relative();
        writeln!(
            out,
            "diagonal {:>14.6e}, rms / diagonal {share:.6e}, {:.2} dB",
            found.diagonal,
            found.psnr_db()
        )
    }
}

fn to_json(args: &Compare, found: &Comparison) -> Value {
    let distance = |d: Distance| json!({ "rms": d.rms, "max": d.max });
    // Numbers that are not finite become null.
    json!({
        "a": args.a.display().to_string(),
        "b": args.b.display().to_string(),
        "a_to_b": distance(found.forward),
        "b_to_a": distance(found.backward),
        "rms": found.rms(),
        "max": found.max(),
        "diagonal": found.diagonal,
        "rms_relative": found.rms_relative(),
        "max_relative": if found.max() == 0.0 { 0.0 } else { found.max() / found.diagonal },
        "db": found.psnr_db(),
        "identical": is_identical(found),
    })
}
