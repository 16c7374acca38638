//! `lwc decode`: a stream, or the beginning of one, becomes a mesh file.

use super::args::Decode;
use super::exit::Failure;
use super::input::{DecodedStream, StreamSource, note_if_incomplete, reached};
use super::output::{Destination, with_ending};
use super::quantity::counted;
use super::ui::Ui;
use anyhow::Context;
use lwc::io::{Format, Scene, WriteError, WriteReport};
use lwc::mesh::Attributes;
use lwc::{DecodeError, DecodeOptions, Decoder, TriMesh};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Reads and decodes at once, writes, reports.
pub fn run(args: &Decode, ui: &Ui) -> anyhow::Result<()> {
    let source = StreamSource::new(args.input.as_deref())?;
    let (destination, format) = destination(args, source.path())?;
    destination.check(source.path(), format.is_text())?;

    let mut options = DecodeOptions::new()
        .limits(args.limits.limits())
        .shrinkage_compensation(!args.no_shrinkage_compensation);
    if let Some(level) = args.level {
        options = options.level(level);
    }
    let DecodedStream { decoder, error } = source.decode(args.bytes, options, ui)?;
    let sound = sound_mesh(&decoder, error, args, &source.name(), ui);
    let (mesh, attributes) = sound.with_context(|| source.name())?;
    note_what_is_missing(&decoder, args, &source.name(), ui);
    let report = write(&destination, format, &mesh, &attributes)?;
    for (names, what) in [(&report.ignored, "not kept"), (&report.zeroed, "zeros where there was no value")] {
        if !names.is_empty() {
            ui.warn(&destination.name(), &format!("{what}: {}", names.join(", ")));
        }
    }

    if !ui.is_quiet() && destination != Destination::Stdout {
        let name = destination.name();
        let vertices = counted(mesh.num_vertices(), "vertex", "vertices");
        let faces = counted(mesh.num_triangles(), "triangle", "triangles");
        let how_far = reached(&decoder).unwrap_or_default();
        writeln!(io::stdout(), "{name}: {vertices}, {faces}, {how_far}")?;
    }
    Ok(())
}

/// Where the mesh goes, and as what.
fn destination(args: &Decode, source: Option<&Path>) -> Result<(Destination, Format), anyhow::Error> {
    let usage = |what: &str| anyhow::Error::from(Failure::Usage(what.into()));
    let Some(output) = &args.output else {
        let source = source.ok_or_else(|| usage("a stream from standard input needs -o FILE, or -o -"))?;
        let format = args.format.unwrap_or(Format::Obj);
        return Ok((Destination::File(default_output(source, args.level, format)), format));
    };
    let destination = Destination::new(output.clone());
    if destination == Destination::Stdout {
        return Ok((destination, args.format.unwrap_or(Format::Obj)));
    }
    let by_ending = Format::from_path(output).filter(|format| format.is_written());
    let by_ending = by_ending.ok_or(WriteError::UnknownEnding).with_context(|| destination.name())?;
    if args.format.is_some_and(|format| format != by_ending) {
        return Err(usage("--format differs from the ending")).with_context(|| destination.name());
    }
    Ok((destination, by_ending))
}

/// `model.lwc` → `model.level5.obj` or `model.decoded.obj`: never the name of the model itself.
fn default_output(stream: &Path, level: Option<u32>, format: Format) -> PathBuf {
    let what = level.map_or("decoded".to_owned(), |level| format!("level{level}"));
    let is_usual = stream.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("lwc"));
    let model = if is_usual { stream.with_extension("") } else { stream.to_owned() };
    with_ending(model, &format!("{what}.{}", format.extension()))
}

/// The mesh of a stream without fault, as far as it goes; with `--salvage` the finest that came before the fault.
fn sound_mesh(
    decoder: &Decoder,
    error: Option<DecodeError>,
    args: &Decode,
    name: &str,
    ui: &Ui,
) -> Result<(TriMesh, Attributes), DecodeError> {
    let Some(error) = error else {
        note_if_incomplete(decoder, args.bytes, name, ui);
        return decoder.preview_with_attributes().ok_or(DecodeError::NoMesh);
    };
    match decoder.to_tri_mesh_with_attributes().filter(|_| args.salvage) {
        Some(sound) => {
            ui.warn(name, &format!("{error}; salvaged {}", reached(decoder).unwrap_or_default()));
            Ok(sound)
        }
        None => Err(error),
    }
}

fn note_what_is_missing(decoder: &Decoder, args: &Decode, name: &str, ui: &Ui) {
    let finest = decoder.info().map_or(0, lwc::StreamInfo::finest_level);
    if let Some(level) = args.level.filter(|&level| level > finest) {
        ui.note(name, &format!("there is no level {level}, the finest is {finest}"));
    }
}

fn write(
    destination: &Destination,
    format: Format,
    mesh: &TriMesh,
    attributes: &Attributes,
) -> anyhow::Result<WriteReport> {
    let scene = Scene::unpack(mesh, attributes).with_context(|| destination.name())?;
    if let Destination::File(path) = destination {
        let written = match &scene {
            Some(scene) => lwc::io::write_scene(path, scene),
            None => lwc::io::write_with_attributes(path, mesh, attributes),
        };
        return written.with_context(|| destination.name());
    }
    let mut report = WriteReport::default();
    destination.write(|out| {
        report = match &scene {
            Some(scene) => lwc::io::write_scene_to(out, scene, format)?,
            None => lwc::io::write_with_attributes_to(out, mesh, attributes, format)?,
        };
        Ok::<(), WriteError>(())
    })?;
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn default_names_are_never_those_of_the_model() {
        let name = |stream: &str, level, format| default_output(Path::new(stream), level, format);
        assert_eq!(name("a/horse.lwc", None, Format::Obj), Path::new("a/horse.decoded.obj"));
        assert_eq!(name("v1.2.lwc", Some(5), Format::Ply), Path::new("v1.2.level5.ply"));
        assert_eq!(name("early.cut", Some(0), Format::Obj), Path::new("early.cut.level0.obj"));
    }
}
