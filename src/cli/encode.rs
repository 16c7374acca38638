//! `lwc encode`: a mesh file becomes a stream.

use super::args::Encode;
use super::exit::Failure;
use super::input::{read_for_stream, read_terrain};
use super::output::{Destination, print_json, with_ending, without_mesh_ending};
use super::quantity::counted;
use super::ui::Ui;
use super::{passes, verify};
use anyhow::Context;
use lwc::io::{Format, MeshFile};
use lwc::{EncodeOptions, Encoded, RepairReport};
use serde_json::{Value, json};
use std::io::{self, Write};
use std::time::Instant;

impl Encode {
    /// The options of the library.
    pub fn options(&self) -> EncodeOptions {
        let mut options = EncodeOptions::default();
        options.descriptor = self.scale.descriptor;
        options.window = self.scale.window.window();
        options.descriptor_attributes.clone_from(&self.scale.descriptor_attributes);
        options.growth = self.growth;
        options.quantization_bits = self.quantization_bits.unwrap_or(options.quantization_bits);
        options.levels = self.levels.0;
        options.partition = self.partition;
        options.optimize = self.optimize;
        options.profile = self.profile;
        options.effort = self.effort;
        options.steps_per_edge = self.steps_per_edge;
        options.normal_bits = self.normal_bits;
        options.texcoord_bits = self.texcoord_bits;
        options.color_bits = self.color_bits;
        options.generic_bits = self.generic_bits;
        options.lossless = self.lossless;
        options.keep_isolated = self.keep_isolated;
        options.keep_degenerate = self.keep_degenerate;
        options.keep_order = self.keep_order;
        options
    }

    fn destination(&self) -> Destination {
        let beside = || with_ending(without_mesh_ending(&self.input), "lwc");
        Destination::new(self.output.clone().unwrap_or_else(beside))
    }
}

/// Reads, encodes, verifies, writes, reports.
pub fn run(args: &Encode, ui: &Ui) -> anyhow::Result<()> {
    let destination = args.destination();
    destination.check(Some(&args.input), false)?;
    check_ending(&destination).with_context(|| destination.name())?;
    let start = Instant::now();
    let mut file = match args.terrain.options() {
        Some(options) => read_terrain(&args.input, &options, &args.reading, ui)?,
        None => read_for_stream(&args.input, args.merge, &args.reading, ui)?,
    };
    let left_out = if args.no_attributes { drop_attributes(&mut file) } else { Vec::new() };
    let read_seconds = start.elapsed().as_secs_f64();

    let name = args.input.display().to_string();
    let start = Instant::now();
    let (encoded, options) = encode(&file, args, ui).with_context(|| name.clone())?;
    let encode_seconds = start.elapsed().as_secs_f64();
    warn_about(&name, &encoded, ui);

    if args.verify {
        let start = Instant::now();
        let _spinner = ui.spinner("verifying");
        verify::verify(&file.mesh, &file.attributes, &options, &encoded).with_context(|| name.clone())?;
        ui.detail(&name, &format!("verified in {:.2} s", start.elapsed().as_secs_f64()));
    }
    destination.write(|out| out.write_all(&encoded.bytes))?;
    let (file, encoded) = (&file, &encoded);
    let report = Report { args, file, left_out, encoded, destination, read_seconds, encode_seconds };
    report.print(ui)
}

/// A stream under the ending of a mesh would be taken for one, and often replaces it.
fn check_ending(destination: &Destination) -> Result<(), Failure> {
    match destination {
        Destination::File(path) if Format::from_path(path).is_some() => {
            Err(Failure::Usage("the ending is that of a mesh, but the output is a stream (.lwc)".into()))
        }
        _ => Ok(()),
    }
}

/// Grids that are tried if all floats are kept and nobody says how fine it should be: coordinates may lie on
/// one that the file does not tell.
const LOSSLESS_BITS: [u32; 3] = [12, 15, 18];

/// The smallest stream, and its options.
fn encode(file: &MeshFile, args: &Encode, ui: &Ui) -> Result<(Encoded, EncodeOptions), lwc::EncodeError> {
    let bar = ui.bar("encoding");
    let progress = |now: lwc::Progress| bar.set_stage(now.stage, now.fraction);
    let encode = |options: EncodeOptions| {
        let encoded = lwc::encode_with_attributes(&file.mesh, &file.attributes, &options, &progress)?;
        Ok((encoded, options))
    };
    let options = args.options();
    if !args.lossless || args.quantization_bits.is_some() {
        return encode(options);
    }
    let with = |bits: u32| {
        let mut options = options.clone();
        options.quantization_bits = bits;
        encode(options)
    };
    let mut best = with(LOSSLESS_BITS[0])?;
    for bits in &LOSSLESS_BITS[1..] {
        let other = with(*bits)?;
        if other.0.bytes.len() < best.0.bytes.len() {
            best = other;
        }
    }
    Ok(best)
}

/// Takes the attributes out of a file; returns their names.
fn drop_attributes(file: &mut MeshFile) -> Vec<String> {
    let attributes = std::mem::take(&mut file.attributes);
    let names = attributes.list.iter().map(|attribute| attribute.name.replace(' ', "/"));
    names.chain(attributes.material_libraries.first().map(|_| "mtllib".to_owned())).collect()
}

/// Fewer vertices need no beginnings.
const SMALL: u32 = 1000;

fn warn_about(name: &str, encoded: &Encoded, ui: &Ui) {
    if let [base, rest @ ..] = encoded.info.passes()
        && rest.is_empty()
        && base.vertices >= SMALL
    {
        ui.note(
            name,
            "in one piece: nothing shows before the last byte has come; `--levels 99` keeps levels",
        );
    }
    let RepairReport { degenerate_triangles, isolated_vertices, repeated_vertices } = encoded.repair;
    if encoded.values_dropped > 0 {
        let values = counted(encoded.values_dropped, "value", "values");
        ui.warn(name, &format!("{values} of attributes left out: not finite"));
    }
    if degenerate_triangles > 0 {
        let faces = counted(degenerate_triangles, "degenerate triangle", "degenerate triangles");
        ui.warn(name, &format!("{faces} dropped"));
    }
    if isolated_vertices > 0 {
        let vertices = counted(isolated_vertices, "vertex", "vertices");
        ui.warn(name, &format!("{vertices} without triangles dropped"));
    }
    if repeated_vertices > 0 {
        let vertices = counted(repeated_vertices, "vertex", "vertices");
        ui.detail(name, &format!("{vertices} repeated to cut the mesh where it is not manifold"));
    }
}

/// What is told at the end.
struct Report<'a> {
    args: &'a Encode,
    file: &'a MeshFile,
    /// Attributes that were not wanted.
    left_out: Vec<String>,
    encoded: &'a Encoded,
    destination: Destination,
    read_seconds: f64,
    encode_seconds: f64,
}

impl Report<'_> {
    fn print(&self, ui: &Ui) -> anyhow::Result<()> {
        let to_stdout = self.destination != Destination::Stdout;
        let mut out: Box<dyn Write> =
            if to_stdout { Box::new(io::stdout().lock()) } else { Box::new(io::stderr()) };
        if self.args.json {
            print_json(out, &self.to_json())?;
        } else if !ui.is_quiet() && (to_stdout || ui.is_verbose()) {
            self.print_summary(&mut out)?;
            if ui.is_verbose() {
                passes::print(&mut out, &self.encoded.info, self.num_bytes())?;
            }
            out.flush()?;
        }
        Ok(())
    }

    fn num_bytes(&self) -> u64 {
        self.encoded.bytes.len() as u64
    }

    /// Bytes of the input file as it is, compressed or not.
    fn input_bytes(&self) -> Option<u64> {
        Some(std::fs::metadata(&self.args.input).ok()?.len()).filter(|&bytes| bytes > 0)
    }

    fn ratio(&self) -> Option<f64> {
        Some(self.num_bytes() as f64 / self.input_bytes()? as f64)
    }

    fn print_summary(&self, out: &mut dyn Write) -> io::Result<()> {
        let (info, bytes) = (&self.encoded.info, self.num_bytes());
        let finest = info.passes().last();
        let input = self.args.input.display();
        writeln!(
            out,
            "{}: {}, {}, {} on the base mesh, {} bits",
            self.destination.name(),
            counted(
                finest.map_or(0, |p| p.vertices as usize - self.encoded.repair.repeated_vertices),
                "vertex",
                "vertices"
            ),
            counted(finest.map_or(0, |p| p.triangles as usize), "triangle", "triangles"),
            counted(info.finest_level() as usize, "level", "levels"),
            info.quantization_bits(),
        )?;
        let ratio = self.ratio().map_or(String::new(), |r| format!(", {:.1} % of {input}", 100.0 * r));
        let verified = if self.args.verify { ", verified" } else { "" };
        writeln!(
            out,
            "{bytes} bytes, {:.2} bits per vertex{ratio}, {:.2} s{verified}",
            passes::bits_per_vertex(bytes, info),
            self.read_seconds + self.encode_seconds,
        )
    }

    fn to_json(&self) -> Value {
        let (args, info, mesh) = (self.args, &self.encoded.info, &self.file.mesh);
        let (read, repair) = (&self.file.report, &self.encoded.repair);
        let finest = info.passes().last();
        let output = match &self.destination {
            Destination::Stdout => None,
            Destination::File(path) => Some(path.display().to_string()),
        };
        json!({
            "input": args.input.display().to_string(),
            "input_bytes": self.input_bytes(),
            "input_vertices": mesh.num_vertices(),
            "input_triangles": mesh.num_triangles(),
            "output": output,
            "bytes": self.num_bytes(),
            "bits_per_vertex": passes::bits_per_vertex(self.num_bytes(), info),
            "ratio": self.ratio(),
            "vertices": finest.map(|p| p.vertices),
            "triangles": finest.map(|p| p.triangles),
            "levels": info.finest_level(),
            "quantization_bits": info.quantization_bits(),
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
            "verified": args.verify,
            "polygons_triangulated": read.polygons_triangulated,
            "faces_skipped": read.faces_skipped,
            "corners_welded": read.corners_welded,
            "points_left_out": read.points_left_out,
            "ignored": self.file.report.ignored.iter().chain(&self.left_out).collect::<Vec<_>>(),
            "attributes": passes::attributes_to_json(info, &[]),
            "degenerate_triangles": repair.degenerate_triangles,
            "isolated_vertices": repair.isolated_vertices,
            "repeated_vertices": repair.repeated_vertices,
            "passes": passes::to_json(info, self.num_bytes()),
            "trailing": passes::trailing_to_json(info, self.num_bytes()),
        })
    }
}
