//! `lwc describe`: a descriptor at every vertex, as numbers or colours.

use super::args::{Reading, Scale};
use super::exit::Failure;
use super::input::read_mesh;
use super::output::{Destination, has_ending};
use super::render::args::{HeatArgs, Picture};
use super::render::heat_picture;
use super::ui::Ui;
use anyhow::Context;
use lwc::descriptors::{Features, evaluate_with_features, evaluate_with_progress, mean_edge_length};
use lwc::io::MeshFile;
use lwc::render::{Heat, sequential};
use std::io::{self, Write};
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

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

    let MeshFile { mesh, attributes, .. } = read_mesh(&args.input, &args.reading, ui)?;
    let choices = &args.scale.descriptor_attributes;
    let mean_edge = mean_edge_length(&mesh);
    let values = {
        let bar = ui.bar(args.scale.descriptor.name());
        let done = AtomicUsize::new(0);
        let progress = |more: usize| {
            let done = done.fetch_add(more, Ordering::Relaxed) + more;
            bar.set(done as f64 / mesh.num_vertices().max(1) as f64);
        };
        let (descriptor, window) = (args.scale.descriptor, args.scale.window.window());
        if choices.is_empty() {
            evaluate_with_progress(descriptor, &mesh, &window, mean_edge, &progress)
        } else {
            Features::choose(&mesh, &attributes, choices)
                .and_then(|features| {
                    evaluate_with_features(descriptor, &mesh, &features, &window, mean_edge, &progress)
                })
                .with_context(|| args.input.display().to_string())?
        }
    };
    ui.detail(&args.input.display().to_string(), &format!("mean edge length {mean_edge}"));
    match Kind::of(&destination) {
        Some(Kind::Picture) => {
            let picture =
                heat_picture(&mesh, &values, args.scale.descriptor.name(), &args.heat, &args.picture)?;
            destination.write(|out| picture.write_png(out))
        }
        Some(Kind::Mesh) => {
            let heat = Heat::new(&values, args.heat.clip);
            let colours: Vec<[u8; 3]> = heat.values.iter().map(|&value| sequential(value)).collect();
            destination.write(|out| lwc::io::write_ply_coloured(out, &mesh, &colours))
        }
        _ => destination.write(|out| write_csv(out, &values)),
    }
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
