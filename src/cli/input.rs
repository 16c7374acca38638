//! Meshes from files and streams.

use super::args::Reading;
use super::bar::Part;
use super::exit::Failure;
use super::input_file::{self, holds_stream, is_stream};
use super::losses;
use super::quantity::counted;
use super::stream::{DecodedStream, StreamSource, Wanted, note_if_incomplete};
use super::ui::Ui;
use anyhow::Context;
use lwc::io::{Format, MeshFile, ReadError, Scene, TerrainOptions};
use lwc::mesh::Attributes;
use lwc::{DecodeError, DecodeOptions, TriMesh};
use std::io;
use std::path::Path;

/// Reads a mesh file and warns about what it leaves out.
pub fn read_mesh(path: &Path, reading: &Reading, part: Part, ui: &Ui) -> anyhow::Result<MeshFile> {
    read_with(path, || reading.options().read_with_progress(path, &|done| part.set(done)), ui)
}

/// As [`read_mesh`], with options that are there for point clouds only.
pub fn read_terrain(
    path: &Path,
    options: &TerrainOptions,
    reading: &Reading,
    part: Part,
    ui: &Ui,
) -> anyhow::Result<MeshFile> {
    if !matches!(Format::from_path(path), Some(Format::Las | Format::Laz)) {
        let what = "--last-returns, --thin and --max-points are for point clouds, .las and .laz".to_owned();
        return Err(Failure::Usage(what)).with_context(|| path.display().to_string());
    }
    let progress = |done: f64| part.set(done);
    read_with(path, || reading.options().read_terrain_with_progress(path, options, &progress), ui)
}

fn read_with(
    path: &Path,
    read: impl FnOnce() -> Result<MeshFile, ReadError>,
    ui: &Ui,
) -> anyhow::Result<MeshFile> {
    let name = path.display().to_string();
    check(path).with_context(|| name.clone())?;
    let file = read().map_err(with_hint).with_context(|| name.clone())?;
    warn_about(&name, &file, ui);
    Ok(file)
}

/// Whether it is a file that may be a mesh.
fn check(path: &Path) -> Result<(), Failure> {
    input_file::check(path)?;
    if holds_stream(path) {
        let what = "it is an lwc stream, not a mesh; `lwc decode` makes a mesh of it";
        return Err(Failure::Input(io::Error::other(what)));
    }
    Ok(())
}

/// An error, and what to do about it.
fn with_hint(error: ReadError) -> anyhow::Error {
    let is_ratio = matches!(error, ReadError::Ratio { .. });
    let error = anyhow::Error::from(error);
    if is_ratio { error.context("refused without --any-ratio") } else { error }
}

fn warn_about(name: &str, file: &MeshFile, ui: &Ui) {
    if file.mesh.num_triangles() == 0 && file.mesh.num_vertices() > 0 {
        let points = counted(file.mesh.num_vertices(), "point", "points");
        ui.warn(name, &format!("a point cloud: {points} without faces"));
    }
    losses::warn(name, &file.report.losses(), ui);
}

/// As [`read_mesh`], but the meshes of a scene keep to themselves unless they are to be merged: what a stream
/// holds.
pub fn read_for_stream(
    path: &Path,
    merge: bool,
    reading: &Reading,
    part: Part,
    ui: &Ui,
) -> anyhow::Result<MeshFile> {
    let read = || {
        let scene = reading.options().read_scene_with_progress(path, &|done| part.set(done))?;
        if merge || scene.is_single() { scene.merge() } else { scene.pack() }
    };
    read_with(path, read, ui)
}

/// A mesh that was decoded with all its parts in their places, if it is a scene.
pub fn in_place(mesh: TriMesh, attributes: Attributes) -> Result<MeshFile, ReadError> {
    if let Some(scene) = Scene::unpack(&mesh, &attributes)? {
        return scene.merge();
    }
    let mut file = MeshFile::default();
    (file.mesh, file.attributes) = (mesh, attributes);
    Ok(file)
}

/// Reads a mesh file, or decodes the finest mesh of a stream if that is what the ending says.
pub fn read_mesh_or_stream(
    path: &Path,
    limits: lwc::Limits,
    reading: &Reading,
    part: Part,
    ui: &Ui,
) -> anyhow::Result<TriMesh> {
    if !is_stream(path) {
        return Ok(read_mesh(path, reading, part, ui)?.mesh);
    }
    let source = StreamSource::File(path.to_owned());
    let wanted = Wanted::new(DecodeOptions::new().limits(limits), None);
    let DecodedStream { decoder, error } = source.decode(None, wanted, part, ui)?;
    if let Some(error) = error {
        return Err(error).with_context(|| source.name());
    }
    let (mesh, attributes) =
        decoder.preview_with_attributes().ok_or(DecodeError::NoMesh).with_context(|| source.name())?;
    note_if_incomplete(&decoder, None, &source.name(), ui);
    Ok(in_place(mesh, attributes).with_context(|| source.name())?.mesh)
}
