//! `lwc encode`: a mesh file becomes a stream.

pub mod args;
mod grid;
mod grid_report;
mod report;
mod unit;

use super::bar::Part;
use super::exit::Failure;
use super::input::{name_of, read_terrain};
use super::input_file::{self, holds_stream};
use super::losses;
use super::output::Destination;
use super::quantity::counted;
use super::ui::Ui;
use super::verify;
use anyhow::Context;
use args::Encode;
use lwc::io::{Format, MeshFile};
use lwc::losses::{Loss, LossKind, Losses, Stage};
use lwc::mesh::{Attribute, Attributes, Semantic};
use lwc::{EncodeOptions, Encoded, GridChoice};
use report::Report;
use std::io;
use std::path::Path;
use std::time::Instant;

/// Reads, encodes, verifies, writes, reports.
pub fn run(args: &Encode, ui: &Ui) -> anyhow::Result<()> {
    let destination = args.destination();
    args.check_output()?;
    for input in args.inputs() {
        check_input(input).with_context(|| name_of(input))?;
        destination.check(Some(input), false)?;
    }
    check_ending(&destination).with_context(|| destination.name())?;
    let asked = args.grid.asked(args.inputs())?;
    let start = Instant::now();
    let bar = ui.bar();
    let verifying = if args.verify { 30.0 } else { 0.0 };
    let [reading, encoding, verifying] =
        bar.split([("reading", 5.0), ("encoding", 85.0), ("verifying", verifying)]);
    let mut file = match args.terrain.options() {
        Some(options) => read_terrain(&args.input, &options, &args.reading, reading, ui)?,
        None => args.stream_input().read(reading, ui)?,
    };
    check_triangles(&file).with_context(|| args.input_name())?;
    let mut losses = file.report.losses();
    if args.no_attributes {
        losses.append(drop_attributes(&mut file));
    }
    let read_seconds = start.elapsed().as_secs_f64();

    let name = args.input_name();
    let start = Instant::now();
    let options = args.options(asked.choice(file.attributes.scene.as_ref()));
    let (encoded, options) = encode(&file, args, options, encoding).with_context(|| name.clone())?;
    let encode_seconds = start.elapsed().as_secs_f64();
    warn_about(&name, &encoded, ui);
    if let Some(note) = grid_report::note(options.grid, &encoded.info) {
        ui.note(&name, note);
    }
    if args.lossless {
        warn_of_what_is_not_finite(&name, &file.attributes, ui);
    }

    let mut verified = None;
    if args.verify {
        let start = Instant::now();
        verified = Some(verify::verify(&file, &options, &encoded, verifying).with_context(|| name.clone())?);
        ui.detail(&name, &format!("verified in {:.2} s", start.elapsed().as_secs_f64()));
    }
    drop(bar);
    losses.append(encoded.losses.clone());
    args.strictness.check_or_print(&losses, args.json, &destination).with_context(|| name.clone())?;
    destination.write(|out| out.write_all(&encoded.bytes))?;
    let (file, encoded) = (&file, &encoded);
    let report = Report { args, file, losses, verified, encoded, destination, read_seconds, encode_seconds };
    report.print(ui)
}

/// Without this check the message would be about its ending, or about the output in the same folder.
fn check_input(path: &Path) -> Result<(), Failure> {
    input_file::check(path)?;
    if holds_stream(path) {
        return Err(Failure::Input(io::Error::other("it is an lwc stream already")));
    }
    Ok(())
}

/// What has points alone is called that.
fn check_triangles(file: &MeshFile) -> Result<(), Failure> {
    let (points, triangles) = (file.mesh.num_vertices(), file.mesh.num_triangles());
    if triangles > 0 || points == 0 {
        return Ok(());
    }
    let points = counted(points, "point", "points");
    Err(Failure::Input(io::Error::other(format!(
        "a point cloud, which has no triangles to encode: {points}"
    ))))
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
fn encode(
    file: &MeshFile,
    args: &Encode,
    options: EncodeOptions,
    part: Part,
) -> Result<(Encoded, EncodeOptions), lwc::EncodeError> {
    let encode = |options: EncodeOptions, part: Part| {
        let progress = |now: lwc::Progress| part.set_stage(now.stage, now.fraction);
        let encoded = lwc::encode_with_attributes(&file.mesh, &file.attributes, &options, &progress)?;
        Ok((encoded, options))
    };
    let is_chosen = args.quantization_bits.is_some() || matches!(options.grid, GridChoice::Lattice(_));
    if !args.lossless || is_chosen {
        return encode(options, part);
    }
    let with = |i: usize| {
        let mut options = options.clone();
        options.quantization_bits = LOSSLESS_BITS[i];
        let place = |i: usize| i as f64 / LOSSLESS_BITS.len() as f64;
        encode(options, part.between(place(i), place(i + 1)))
    };
    let mut best = with(0)?;
    for i in 1..LOSSLESS_BITS.len() {
        let other = with(i)?;
        if other.0.bytes.len() < best.0.bytes.len() {
            best = other;
        }
    }
    Ok(best)
}

/// Takes the attributes out of a file, and says so.
fn drop_attributes(file: &mut MeshFile) -> Losses {
    let attributes = std::mem::take(&mut file.attributes);
    let names = attributes.list.iter().map(|attribute| attribute.name.clone());
    let libraries = attributes.material_libraries.first().map(|_| "mtllib".to_owned());
    let metadata = attributes.metadata.iter().map(|(key, _)| key.clone());
    let materials = attributes.gltf_materials.map(|_| "materials".to_owned());
    let dropped = |name| Loss::new(Stage::Encoding, LossKind::Dropped, name).requested();
    names.chain(libraries).chain(metadata).chain(materials).map(dropped).collect()
}

/// With `--lossless` even these are kept, and other programs may choke on them.
fn warn_of_what_is_not_finite(name: &str, attributes: &Attributes, ui: &Ui) {
    let is_usual = |a: &&Attribute| matches!(a.semantic, Semantic::Normal | Semantic::TexCoord(_));
    let is_finite = |a: &Attribute, entry: usize| {
        (0..a.num_components).all(|k| a.number(entry, k).is_none_or(f64::is_finite))
    };
    let not_finite = |a: &Attribute| (0..a.num_entries()).filter(|&entry| !is_finite(a, entry)).count();
    let num: usize = attributes.list.iter().filter(is_usual).map(not_finite).sum();
    if num > 0 {
        let values = counted(num, "normal or texture coordinate", "normals or texture coordinates");
        ui.warn(name, &format!("{values} kept: not finite"));
    }
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
            "in one piece: there is nothing to show before the last byte; `--levels 99` keeps levels",
        );
    }
    losses::warn(name, &encoded.losses, ui);
    let repeated_vertices = encoded.repair.repeated_vertices;
    if repeated_vertices > 0 {
        let vertices = counted(repeated_vertices, "vertex", "vertices");
        ui.detail(name, &format!("{vertices} repeated to cut the mesh where it is not manifold"));
    }
}
