//! `lwc decode`: a stream, or the beginning of one, becomes a mesh file.

use super::args::LimitArgs;
use super::exit::Failure;
use super::losses::{self, Strictness};
use super::mesh_out::MeshOut;
use super::output::{Destination, print_json_beside, say_written, size_of, with_ending};
use super::quantity;
use super::stream::{DecodedStream, StreamSource, Wanted, note_if_incomplete, note_if_no_level, reached};
use super::ui::Ui;
use super::writing::Writing;
use anyhow::Context;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use lwc::io::{Format, WriteError};
use lwc::losses::{Loss, Losses, Stage};
use lwc::mesh::Attributes;
use lwc::{DecodeError, DecodeOptions, Decoder, TriMesh};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Decode a stream, or as much of it as there is.
///
/// A stream that ends early gives a coarser mesh, with a note on standard error.
#[derive(Debug, clap::Args)]
pub struct Decode {
    /// Stream to decode; standard input if it is `-` or missing.
    #[arg(value_name = "FILE.lwc")]
    pub input: Option<PathBuf>,
    /// Mesh to write, `-` for standard output. The ending is the format: .obj .ply .stl .glb .gltf, or compressed, such as
    /// .obj.zst. Default, in the folder of model.lwc: model.level5.obj with `--level 5`, model.decoded.obj without.
    ///
    /// A file that exists is replaced once the new one is complete; the input is never replaced.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Stop at this level; 0 is the base mesh. Default: the finest.
    #[arg(short, long, value_name = "K", allow_negative_numbers = true)]
    pub level: Option<u32>,
    /// Leave the vertices of coarse levels where they are in the finest mesh. By default they are moved a little outwards,
    /// since coarse meshes shrink.
    #[arg(long)]
    pub no_shrinkage_compensation: bool,
    /// Decode the first N bytes only, e.g. 5000 or 20K. Default: all.
    #[arg(short, long, value_name = "N", value_parser = quantity::bytes, allow_negative_numbers = true)]
    pub bytes: Option<u64>,
    /// Format for standard output and for the default file name. Default: obj.
    #[arg(long, value_name = "FORMAT", value_parser = format_parser())]
    pub format: Option<Format>,
    /// Write the finest intact mesh of a damaged stream, and succeed with a warning.
    #[arg(long)]
    pub salvage: bool,
    #[command(flatten)]
    pub strictness: Strictness,
    /// Print one JSON object instead of the summary (to standard error with `-o -`).
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub limits: LimitArgs,
    // Last: its heading would cover what follows.
    #[command(flatten)]
    pub writing: Writing,
}

/// Reads and decodes at once, writes, reports.
pub fn run(args: &Decode, ui: &Ui) -> anyhow::Result<()> {
    let source = StreamSource::new(args.input.as_deref())?;
    let (chosen, format) = destination(args, source.path())?;
    if let Some(destination) = &chosen {
        destination.check(source.path(), format.is_text())?;
    }

    let options = DecodeOptions::new()
        .limits(args.limits.limits())
        .shrinkage_compensation(!args.no_shrinkage_compensation);
    let bar = ui.bar();
    let [decoding, writing] = bar.split([("decoding", 80.0), ("writing", 20.0)]);
    let wanted = Wanted::new(options, args.level);
    let DecodedStream { decoder, error } = source.decode(args.bytes, wanted, decoding, ui)?;
    let sound = sound_mesh(&decoder, error, args, &source.name(), ui);
    let (mesh, attributes) = sound.with_context(|| source.name())?;
    if let (Some(level), Some(info)) = (args.level, decoder.info()) {
        note_if_no_level(info, level, &source.name(), ui);
    }
    let destination = match (chosen, source.path()) {
        (None, Some(stream)) => beside(stream, args, &decoder, format)?,
        (chosen, _) => chosen.unwrap_or(Destination::Stdout),
    };
    writing.set(0.0);
    if destination == Destination::Stdout {
        bar.hide();
    }
    let options = args.writing.options_for_decoded(&decoder);
    let out = MeshOut::new((&mesh, &attributes), options, format).with_context(|| destination.name())?;
    let mut losses = decoder.losses();
    if args.strictness.strict {
        losses.append(out.losses().with_context(|| destination.name())?);
        args.strictness.check_or_print(&losses, args.json, &destination).with_context(|| source.name())?;
    }
    losses.append(out.write(&destination)?);
    drop(bar);
    Decoded { args, source: source.name(), decoder: &decoder, mesh: &mesh, destination, losses }.report(ui)
}

/// What is told at the end.
struct Decoded<'a> {
    args: &'a Decode,
    source: String,
    decoder: &'a Decoder,
    mesh: &'a TriMesh,
    destination: Destination,
    losses: Losses,
}

impl Decoded<'_> {
    fn report(&self, ui: &Ui) -> anyhow::Result<()> {
        let is_asked = self.args.level.is_some() || self.args.bytes.is_some();
        let as_asked = |loss: &Loss| match loss.stage {
            Stage::Decoding if is_asked => loss.clone().requested(),
            _ => loss.clone(),
        };
        let losses: Losses = self.losses.iter().map(as_asked).collect();
        losses::warn(&self.destination.name(), &losses, ui);
        if self.args.json {
            return Ok(print_json_beside(&self.destination, &self.to_json(&losses))?);
        }
        let how_far = reached(self.decoder).unwrap_or_default();
        say_written(&self.destination, &format!("{}, {how_far}", size_of(self.mesh)), ui);
        if let (Some(usual), Destination::File(_)) = (losses::usual(&losses), &self.destination) {
            ui.say(&usual);
        }
        Ok(())
    }

    fn to_json(&self, losses: &Losses) -> Value {
        let level = self.decoder.mesh().map(|mesh| (mesh.level(), mesh.quantization_bits()));
        json!({
            "input": self.source,
            "output": self.destination.path(),
            "vertices": self.mesh.num_vertices(),
            "triangles": self.mesh.num_triangles(),
            "level": level.map(|(level, _)| level),
            "levels": self.decoder.info().map(lwc::StreamInfo::finest_level),
            "quantization_bits": level.map(|(_, bits)| bits),
            "complete": self.decoder.is_complete(),
            "losses": losses::to_json(losses),
        })
    }
}

/// Where the mesh goes, if that is said, and as what.
fn destination(args: &Decode, source: Option<&Path>) -> anyhow::Result<(Option<Destination>, Format)> {
    let usage = |what: &str| anyhow::Error::from(Failure::Usage(what.into()));
    let Some(output) = &args.output else {
        source.ok_or_else(|| usage("a stream from standard input needs -o FILE, or -o -"))?;
        return Ok((None, args.format.unwrap_or(Format::Obj)));
    };
    let destination = Destination::new(output.clone());
    if destination == Destination::Stdout {
        return Ok((Some(destination), args.format.unwrap_or(Format::Obj)));
    }
    let by_ending = Format::from_path(output).filter(|format| format.is_written());
    let by_ending = by_ending.ok_or(WriteError::UnknownEnding).with_context(|| destination.name())?;
    if args.format.is_some_and(|format| format != by_ending) {
        return Err(usage("--format differs from the ending")).with_context(|| destination.name());
    }
    Ok((Some(destination), by_ending))
}

/// The usual file in the folder of the stream. If a level is asked for, its name says which one is there.
fn beside(stream: &Path, args: &Decode, decoder: &Decoder, format: Format) -> anyhow::Result<Destination> {
    let level = args.level.and_then(|_| decoder.mesh()).map(|mesh| mesh.level());
    let destination = Destination::File(default_output(stream, level, format));
    destination.check(Some(stream), format.is_text())?;
    Ok(destination)
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

fn format_parser() -> impl TypedValueParser<Value = Format> {
    let written = || Format::ALL.iter().copied().filter(|format| format.is_written());
    PossibleValuesParser::new(written().map(Format::extension))
        .try_map(move |name| written().find(|f| f.extension() == name).ok_or("unknown format"))
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
