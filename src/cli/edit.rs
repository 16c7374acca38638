//! `lwc edit`: the details of a stream on a coarse mesh that was changed elsewhere.

use super::args::{LimitArgs, Reading};
use super::exit::Failure;
use super::input::read_mesh;
use super::new_shape;
use super::output::{Destination, say_written, size_of};
use super::stream::StreamSource;
use super::ui::Ui;
use super::writing::Writing;
use anyhow::Context;
use lwc::StreamInfo;
use lwc::io::{Format, WriteError};
use lwc::multiresolution::DetailTransfer;
use std::io;
use std::path::PathBuf;

/// Put the details of a stream back on one of its coarse levels that was edited.
///
/// Decode a level, move its vertices in any program that keeps vertices and triangles as they are, and give the
/// result here: every detail follows the surface that it stands on, so a bent model keeps its wrinkles. The
/// level is recognised by its number of vertices. Use .obj or .ply for it: .stl has no shared vertices, and .glb repeats
/// those at seams. The result has the attributes of the stream except its normals. Scenes need `encode --merge`.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Example:
  lwc decode model.lwc --level 9 -o coarse.obj     # then bend coarse.obj
  lwc edit model.lwc coarse.obj -o bent.obj")]
pub struct Edit {
    /// The whole stream.
    #[arg(value_name = "FILE.lwc")]
    pub stream: PathBuf,
    /// The changed mesh, with the vertices and triangles of a level.
    #[arg(value_name = "CHANGED")]
    pub changed: PathBuf,
    /// Mesh to write. The ending is the format: .obj .ply .stl .glb .gltf, or compressed, such as .obj.gz.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    #[command(flatten)]
    pub reading: Reading,
    #[command(flatten)]
    pub limits: LimitArgs,
    #[command(flatten)]
    pub writing: Writing,
}

/// A level is decoded with the meshes of a scene in their places, and has other vertices than the stream.
fn refuse_scene(bytes: &[u8]) -> Result<(), Failure> {
    match StreamInfo::read(bytes) {
        Ok(Some(info)) if info.scene().is_some() => {
            let what = "a scene cannot be edited; `lwc encode --merge` makes one mesh of it";
            Err(Failure::Input(io::Error::other(what)))
        }
        _ => Ok(()),
    }
}

/// Reads both, joins them, writes, reports.
pub fn run(args: &Edit, ui: &Ui) -> anyhow::Result<()> {
    let destination = Destination::new(args.output.clone());
    let Destination::File(path) = &destination else {
        return Err(Failure::Usage("an edited mesh needs a file, its ending is its format".into()).into());
    };
    let format = Format::from_path(path).filter(|format| format.is_written());
    format.ok_or(WriteError::UnknownEnding).with_context(|| destination.name())?;
    destination.check(Some(&args.changed), false)?;
    destination.check(Some(&args.stream), false)?;

    let bar = ui.bar();
    let [reading, decoding, editing, writing] =
        bar.split([("reading", 5.0), ("decoding", 75.0), ("editing", 10.0), ("writing", 10.0)]);
    let changed = read_mesh(&args.changed, &args.reading, reading, ui)?.mesh;
    let source = StreamSource::new(Some(&args.stream))?;
    let bytes = source.read()?;
    refuse_scene(&bytes).with_context(|| source.name())?;
    let (num_vertices, limits) = (changed.num_vertices(), args.limits.limits());
    let edition = DetailTransfer::new_with_progress(&bytes, num_vertices, limits, &|done| decoding.set(done))
        .with_context(|| source.name())?;
    editing.set(0.0);
    let level = edition.level();
    let attributes = edition.attributes().cloned();
    if attributes.is_none() {
        let what = "attributes left out: the stream has isolated vertices, degenerate triangles or an order of its own";
        ui.warn(&source.name(), what);
    }
    let mesh = edition.apply(&changed).with_context(|| args.changed.display().to_string())?;
    writing.set(0.0);
    let options = args.writing.options_for_changed(&changed);
    new_shape::write(path, &mesh, attributes.unwrap_or_default(), &options, ui)
        .with_context(|| destination.name())?;
    drop(bar);
    say_written(&destination, &format!("{}, details above level {level}", size_of(&mesh)), ui);
    Ok(())
}
