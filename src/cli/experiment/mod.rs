//! `lwc experiment`: section 6 of the paper on meshes of the user's choice.

pub mod args;
mod charts;
mod ranking;
mod results;

use super::bar::Part;
use super::input::read_mesh;
use super::output::is_compressed;
use super::quantity::counted;
use super::ui::Ui;
use anyhow::Context;
use args::Experiment as Args;
use lwc::TriMesh;
use lwc::descriptors::Descriptor;
use lwc::experiment::Experiment;
use results::{Results, Run, Subject};
use std::io::{self, Write};
use std::path::Path;

/// Runs what is not there yet, mesh after mesh and descriptor after descriptor: each has all cores for
/// its descriptor, and its times are its own.
pub fn run(args: &Args, ui: &Ui) -> anyhow::Result<()> {
    let mut results = Results::open(&args.output, (&args.settings()).into())?;
    let weights: Vec<f64> = args.meshes.iter().map(|path| weight(path)).collect();
    let total: f64 = weights.iter().sum();
    let bar = ui.bar();
    let [whole] = bar.split([("experiment", 1.0)]);
    let mut before = 0.0;
    for (path, weight) in args.meshes.iter().zip(&weights) {
        let part = whole.between(before / total, (before + weight) / total);
        let [reading, running] = part.split([("reading", 2.0), ("experiment", 98.0)]);
        let mesh = read_mesh(path, &args.reading, reading, ui)?.mesh;
        run_mesh(args, path, &mesh, &mut results, running, ui)?;
        before += weight;
    }
    drop(bar);
    ranking::print(&mut io::stdout().lock(), &results)?;
    let runs = counted(results.runs.len(), "run", "runs");
    let meshes = counted(results.by_subject().len(), "mesh", "meshes");
    ui.say(&format!("{}: results.json and results.csv of {runs}, charts of {meshes}", args.output.display()));
    Ok(())
}

/// Bytes of a file, as a measure of its work; a compressed one counts more.
fn weight(path: &Path) -> f64 {
    let bytes = std::fs::metadata(path).map_or(1, |metadata| metadata.len().max(1)) as f64;
    if is_compressed(path) { 2.0 * bytes } else { bytes }
}

fn run_mesh(
    args: &Args,
    path: &Path,
    mesh: &TriMesh,
    results: &mut Results,
    part: Part,
    ui: &Ui,
) -> anyhow::Result<()> {
    let subject = Subject::new(path, mesh, args.noise());
    let missing = |d: &&Descriptor| !results.contains(&subject, **d);
    let missing: Vec<Descriptor> = args.descriptors.0.iter().filter(missing).copied().collect();
    if !missing.is_empty() {
        let experiment = Experiment::new(mesh, args.noise()).with_context(|| path.display().to_string())?;
        for (i, &descriptor) in missing.iter().enumerate() {
            let progress = |fraction: f64| {
                part.set((i as f64 + fraction) / missing.len() as f64);
            };
            let steps = experiment.run(descriptor, &args.settings(), &progress);
            let run = Run { subject: subject.clone(), descriptor: descriptor.name().into(), steps };
            ui.beside_bar(|| print(&run))?;
            results.runs.push(run);
            results.save(&args.output)?;
        }
    }
    let groups = results.by_subject();
    match groups.iter().find(|(found, _)| **found == subject) {
        Some((_, runs)) => charts::write(&args.output, &subject, runs),
        None => Ok(()),
    }
}

fn print(run: &Run) -> io::Result<()> {
    let first = run.steps.first();
    writeln!(
        io::stdout().lock(),
        "{:<24} {:<12} {} steps, mean apd {:.5}, odd {:.1} %, first window {:.1}, {:.2} s of it {:.2} s descriptor",
        run.subject.title(),
        run.descriptor,
        run.steps.len(),
        run.mean_apd(),
        100.0 * run.mean_odd_share(),
        first.map_or(0.0, |step| step.mean_window),
        run.seconds(),
        run.descriptor_seconds(),
    )
}
