//! `lwc describe`: a descriptor at every vertex.

use super::args::Describe;
use super::exit::Failure;
use super::input::read_mesh;
use super::output::Destination;
use super::ui::Ui;
use anyhow::Context;
use lwc::descriptors::{evaluate_with_progress, mean_edge_length};
use std::io::{self, Write};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Reads, evaluates, writes a table.
pub fn run(args: &Describe, ui: &Ui) -> anyhow::Result<()> {
    let destination = Destination::new(args.output.clone());
    check_ending(&destination).with_context(|| destination.name())?;
    destination.check(Some(&args.input), true)?;

    let mesh = read_mesh(&args.input, ui)?.mesh;
    let mean_edge = mean_edge_length(&mesh);
    let values = {
        let bar = ui.bar(args.scale.descriptor.name());
        let done = AtomicUsize::new(0);
        let progress = |more: usize| {
            let done = done.fetch_add(more, Ordering::Relaxed) + more;
            bar.set(done as f64 / mesh.num_vertices().max(1) as f64);
        };
        evaluate_with_progress(args.scale.descriptor, &mesh, &args.scale.window(), mean_edge, &progress)
    };
    ui.detail(&args.input.display().to_string(), &format!("mean edge length {mean_edge}"));
    destination.write(|out| write_csv(out, &values))
}

fn check_ending(destination: &Destination) -> Result<(), Failure> {
    match destination {
        Destination::File(path) if !path.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv")) => {
            Err(Failure::Usage("unknown ending; descriptors are written as .csv only".into()))
        }
        _ => Ok(()),
    }
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
