//! What is told of a stream that was written.

use super::args::Encode;
use super::grid_report;
use crate::cli::losses;
use crate::cli::output::{Destination, print_json_beside};
use crate::cli::passes;
use crate::cli::quantity::counted;
use crate::cli::ui::Ui;
use lwc::Encoded;
use lwc::io::MeshFile;
use lwc::losses::Losses;
use serde_json::{Value, json};
use std::io;

/// What is told at the end.
pub struct Report<'a> {
    pub args: &'a Encode,
    pub file: &'a MeshFile,
    /// From the file to the stream.
    pub losses: Losses,
    /// What was verified, if anything.
    pub verified: Option<String>,
    pub encoded: &'a Encoded,
    pub destination: Destination,
    pub read_seconds: f64,
    pub encode_seconds: f64,
}

impl Report<'_> {
    pub fn print(&self, ui: &Ui) -> anyhow::Result<()> {
        if self.args.json {
            print_json_beside(&self.destination, &self.with_inputs(self.to_json()))?;
        } else if self.destination != Destination::Stdout || ui.is_verbose() {
            ui.say(&self.summary());
            if let Some(usual) = losses::usual(&self.losses) {
                ui.say(&usual);
            }
            if ui.is_verbose() {
                passes::print(io::stderr(), &self.encoded.info, self.num_bytes())?;
            }
        }
        Ok(())
    }

    fn num_bytes(&self) -> u64 {
        self.encoded.bytes.len() as u64
    }

    /// Bytes of the input files as they are, compressed or not.
    fn input_bytes(&self) -> Option<u64> {
        let size = |path| Some(std::fs::metadata(path).ok()?.len());
        self.args.inputs().map(size).sum::<Option<u64>>().filter(|&bytes| bytes > 0)
    }

    /// Bytes of the images that are in the stream.
    fn texture_bytes(&self) -> usize {
        let materials = self.file.attributes.gltf_materials.as_ref();
        materials.map_or(0, |materials| materials.images.iter().map(Vec::len).sum())
    }

    fn ratio(&self) -> Option<f64> {
        Some(self.num_bytes() as f64 / self.input_bytes()? as f64)
    }

    /// Two lines, or three.
    fn summary(&self) -> String {
        let (info, bytes, repair) = (&self.encoded.info, self.num_bytes(), &self.encoded.repair);
        let finest = info.passes().last();
        let vertices = finest.map_or(0, |p| p.vertices as usize - repair.repeated_vertices);
        let ratio = self.ratio().map(|r| format!(", {:.1} % of {}", 100.0 * r, self.args.input_name()));
        let steps = || format!(": steps of {}", grid_report::step(self.encoded.grid_error.step));
        let grid = (!self.args.lossless).then(steps);
        let textures = match self.texture_bytes() {
            0 => String::new(),
            bytes => format!(", {bytes} of them textures"),
        };
        format!(
            "{}: {}, {}, {} on the base mesh, {} bits{}\n{bytes} bytes{textures}, {:.2} bits per vertex{}, {:.2} s{}",
            self.destination.name(),
            counted(vertices, "vertex", "vertices"),
            counted(finest.map_or(0, |p| p.triangles as usize), "triangle", "triangles"),
            counted(info.finest_level() as usize, "level", "levels"),
            info.quantization_bits(),
            grid.unwrap_or_default(),
            passes::bits_per_vertex(bytes, info),
            ratio.unwrap_or_default(),
            self.read_seconds + self.encode_seconds,
            self.verified.as_ref().map_or(String::new(), |what| format!("\nverified: {what}")),
        )
    }

    /// Adds what was read.
    fn with_inputs(&self, mut json: Value) -> Value {
        json["inputs"] = self.args.inputs().map(|input| input.display().to_string()).collect();
        json["texture_bytes"] = self.texture_bytes().into();
        json
    }

    fn to_json(&self) -> Value {
        let (args, info, mesh) = (self.args, &self.encoded.info, &self.file.mesh);
        let (repair, error) = (&self.encoded.repair, &self.encoded.grid_error);
        let finest = info.passes().last();
        json!({
            "input": args.input.display().to_string(),
            "input_bytes": self.input_bytes(),
            "input_vertices": mesh.num_vertices(),
            "input_triangles": mesh.num_triangles(),
            "output": self.destination.path(),
            "bytes": self.num_bytes(),
            "bits_per_vertex": passes::bits_per_vertex(self.num_bytes(), info),
            "ratio": self.ratio(),
            "vertices": finest.map(|p| p.vertices),
            "triangles": finest.map(|p| p.triangles),
            "levels": info.finest_level(),
            "quantization_bits": info.quantization_bits(),
            "step": error.step,
            "largest_error": error.largest_error,
            "largest_error_in_edges": error.largest_error_in_edges,
            "triangles_collapsed": error.triangles_collapsed,
            "triangles_turned": error.triangles_turned,
            "descriptor": args.scale.descriptor.name(),
            "rings": args.scale.window.rings,
            "radius": args.scale.window.radius,
            "growth": args.growth,
            "partition": args.partition.name(),
            "optimize": args.optimize.name(),
            "profile": info.profile().name(),
            "effort": args.effort,
            "steps_per_edge": args.steps_per_edge,
            "read_seconds": self.read_seconds,
            "encode_seconds": self.encode_seconds,
            "verified": self.verified,
            "losses": losses::to_json(&self.losses),
            "attributes": passes::attributes_to_json(info, &[]),
            "repeated_vertices": repair.repeated_vertices,
            "passes": passes::to_json(info, self.num_bytes()),
            "trailing": passes::trailing_to_json(info, self.num_bytes()),
        })
    }
}
