//! `lwc describe`: a descriptor at every vertex, as numbers or colours.

use super::args::{Reading, Scale};
use super::bar::{Part, Vertices};
use super::exit::Failure;
use super::input::read_mesh;
use super::output::{Destination, has_ending, pixels_of, say_written, size_of};
use super::quantity::counted;
use super::render::args::{HeatArgs, Picture};
use super::render::heat_picture;
use super::ui::Ui;
use anyhow::Context;
use lwc::TriMesh;
use lwc::descriptors::{
    Features, FeaturesError, evaluate_with_features, evaluate_with_progress, mean_edge_length,
};
use lwc::io::MeshFile;
use lwc::render::{Heat, sequential};
use std::io::{self, Write};
use std::path::PathBuf;

/// Evaluate a descriptor at every vertex of a mesh.
///
/// As CSV: the header `vertex,value` and one line per vertex, in the order of the file, with all digits.
/// As PNG: a picture coloured by the values, with a legend. As PLY: the mesh with the same colours at its
/// vertices. Vertices without triangles have the value 0.
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
    pub heat: HeatArgs,
    #[command(flatten)]
    pub reading: Reading,
    #[command(flatten)]
    pub picture: Picture,
}

/// Reads, evaluates, writes.
pub fn run(args: &Describe, ui: &Ui) -> anyhow::Result<()> {
    let destination = Destination::new(args.output.clone());
    check_ending(&destination).with_context(|| destination.name())?;
    let is_text = matches!(Kind::of(&destination), Some(Kind::Table));
    destination.check(Some(&args.input), is_text)?;

    let bar = ui.bar();
    let descriptor = args.scale.descriptor.name();
    let [reading, evaluating, writing] =
        bar.split([("reading", 30.0), (descriptor, 60.0), ("writing", 10.0)]);
    let file = read_mesh(&args.input, &args.reading, reading, ui)?;
    let mean_edge = mean_edge_length(&file.mesh);
    let values = evaluate(&file, &args.scale, mean_edge, evaluating)
        .with_context(|| args.input.display().to_string())?;
    ui.detail(&args.input.display().to_string(), &format!("mean edge length {mean_edge}"));
    writing.set(0.0);
    if destination == Destination::Stdout {
        bar.hide();
    }
    let what = write(args, &file.mesh, &values, &destination, writing)?;
    drop(bar);
    say_written(&destination, &what, ui);
    Ok(())
}

/// Writes what the ending says, and returns what that is.
fn write(
    args: &Describe,
    mesh: &TriMesh,
    values: &[f64],
    destination: &Destination,
    part: Part,
) -> anyhow::Result<String> {
    match Kind::of(destination) {
        Some(Kind::Picture) => {
            let name = args.scale.descriptor.name();
            let picture = heat_picture(mesh, values, name, &args.heat, &args.picture, part)?;
            destination.write(|out| picture.write_png(out))?;
            Ok(pixels_of(&picture))
        }
        Some(Kind::Mesh) => {
            let heat = Heat::new(values, args.heat.clip);
            let colours: Vec<[u8; 3]> = heat.values.iter().map(|&value| sequential(value)).collect();
            destination.write(|out| lwc::io::write_ply_coloured(out, mesh, &colours))?;
            Ok(format!("{}, coloured by {}", size_of(mesh), args.scale.descriptor))
        }
        _ => {
            destination.write(|out| write_csv(out, values))?;
            Ok(counted(values.len(), "row", "rows"))
        }
    }
}

/// The descriptor at each vertex.
fn evaluate(file: &MeshFile, scale: &Scale, mean_edge: f64, part: Part) -> Result<Vec<f64>, FeaturesError> {
    let MeshFile { mesh, attributes, .. } = file;
    let (descriptor, window) = (scale.descriptor, scale.window.window());
    let vertices = Vertices::new(mesh.num_vertices(), part);
    let progress = |more: usize| vertices.add(more);
    let choices = &scale.descriptor_attributes;
    if choices.is_empty() {
        return Ok(evaluate_with_progress(descriptor, mesh, &window, mean_edge, &progress));
    }
    let features = Features::choose(mesh, attributes, choices)?;
    evaluate_with_features(descriptor, mesh, &features, &window, mean_edge, &progress)
}

/// What is written.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Table,
    Picture,
    Mesh,
}

impl Kind {
    /// By the ending; standard output gets a table.
    fn of(destination: &Destination) -> Option<Self> {
        let Destination::File(path) = destination else { return Some(Self::Table) };
        let endings = [("csv", Self::Table), ("png", Self::Picture), ("ply", Self::Mesh)];
        endings.into_iter().find(|(ending, _)| has_ending(path, ending)).map(|(_, kind)| kind)
    }
}

fn check_ending(destination: &Destination) -> Result<(), Failure> {
    let unknown = || Failure::Usage("unknown ending; descriptors are written as .csv, .png or .ply".into());
    Kind::of(destination).map(|_| ()).ok_or_else(unknown)
}

fn write_csv(out: &mut dyn Write, values: &[f64]) -> io::Result<()> {
    writeln!(out, "vertex,value")?;
    for (vertex, value) in values.iter().enumerate() {
        // Both forms have the fewest digits that read back as the same number.
        if *value == 0.0 || (1e-5..1e16).contains(value) {
            writeln!(out, "{vertex},{value}")?;
        } else {
            writeln!(out, "{vertex},{value:e}")?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_read_back_as_they_were() {
        let values = [0.0, 1.0, 0.1 + 0.2, 1e-300, f64::MAX, f64::from_bits(1), 123_456.789];
        let mut out = Vec::new();
        write_csv(&mut out, &values).unwrap();
        let text = String::from_utf8(out).unwrap();
        let mut lines = text.lines();
        assert_eq!(lines.next(), Some("vertex,value"));
        for (i, (line, value)) in lines.zip(values).enumerate() {
            let (vertex, written) = line.split_once(',').unwrap();
            assert_eq!((vertex.parse(), written.parse()), (Ok(i), Ok(value)));
            assert!(written.len() < 30);
        }
        assert!(text.starts_with("vertex,value\n0,0\n1,1\n"));
    }
}
