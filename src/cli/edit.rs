//! `lwc edit`: the details of a stream on a coarse mesh that was changed elsewhere.

use super::args::{LimitArgs, Reading};
use super::exit::Failure;
use super::input::{StreamSource, read_mesh};
use super::output::Destination;
use super::quantity::counted;
use super::ui::Ui;
use anyhow::Context;
use lwc::io::{Format, WriteError};
use lwc::multiresolution::DetailTransfer;
use std::io::{self, Read, Write};
use std::path::PathBuf;

/// Put the details of a stream back on one of its coarse levels that was edited.
///
/// Decode a level, move its vertices in any program that keeps vertices and faces as they are, and give the
/// result here: every detail follows the surface that it stands on, so a bent model keeps its wrinkles. The
/// level is recognised by its number of vertices.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Example:
  lwc decode model.lwc --level 9 -o coarse.obj     # then bend coarse.obj
  lwc edit model.lwc coarse.obj -o bent.obj")]
pub struct Edit {
    /// The whole stream.
    #[arg(value_name = "FILE.lwc")]
    pub stream: PathBuf,
    /// The changed mesh, with the vertices and faces of a level.
    #[arg(value_name = "CHANGED")]
    pub changed: PathBuf,
    /// Mesh to write. The ending is the format: .obj .ply .stl .glb .gltf, or compressed, such as .obj.zst.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    #[command(flatten)]
    pub reading: Reading,
    #[command(flatten)]
    pub limits: LimitArgs,
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

    let changed = read_mesh(&args.changed, &args.reading, ui)?.mesh;
    let source = StreamSource::new(Some(&args.stream))?;
    let mut bytes = Vec::new();
    source.open()?.read_to_end(&mut bytes).map_err(Failure::Input).with_context(|| source.name())?;
    let spinner = ui.spinner("editing");
    let edition = DetailTransfer::new(&bytes, changed.num_vertices(), args.limits.limits())
        .with_context(|| source.name())?;
    let level = edition.level();
    let mesh = edition.apply(&changed).with_context(|| args.changed.display().to_string())?;
    drop(spinner);
    lwc::io::write(path, &mesh).with_context(|| destination.name())?;
    if !ui.is_quiet() {
        let vertices = counted(mesh.num_vertices(), "vertex", "vertices");
        writeln!(io::stdout(), "{}: {vertices}, details above level {level}", destination.name())?;
    }
    Ok(())
}
