//! Meshes from files and streams.

use super::args::Reading;
use super::bar::Part;
use super::exit::Failure;
use super::input_file::{self, holds_stream, is_stream};
use super::losses;
use super::output::without_mesh_ending;
use super::quantity::counted;
use super::stream::{DecodedStream, StreamSource, Wanted, note_if_incomplete};
use super::ui::Ui;
use anyhow::Context;
use lwc::io::{Format, MeshFile, ReadError, Scene, TerrainOptions};
use lwc::mesh::Attributes;
use lwc::{DecodeError, DecodeOptions, TriMesh};
use std::io;
use std::path::Path;

/// Reads a mesh file, or standard input, and warns about what it leaves out.
pub fn read_mesh(path: &Path, reading: &Reading, part: Part, ui: &Ui) -> anyhow::Result<MeshFile> {
    let options = reading.options();
    let read = || match source(path, reading)? {
        Source::Stdin(format) => Ok(options.read_from(io::stdin().lock(), format)?),
        Source::File => Ok(options.read_with_progress(path, &|done| part.set(done))?),
    };
    read_with(path, read, ui)
}

/// As [`read_mesh`], with options that are there for point clouds only.
pub fn read_terrain(
    path: &Path,
    terrain: &TerrainOptions,
    reading: &Reading,
    part: Part,
    ui: &Ui,
) -> anyhow::Result<MeshFile> {
    let options = reading.options();
    let read = || {
        let source = source(path, reading)?;
        let format = if let Source::Stdin(format) = source { Some(format) } else { Format::from_path(path) };
        if !matches!(format, Some(Format::Las | Format::Laz)) {
            let what = "--classes, --longest-edge, --last-returns, --thin and --max-points are for point clouds, .las and .laz";
            return Err(Failure::Usage(what.to_owned()).into());
        }
        let progress = |done: f64| part.set(done);
        Ok(match source {
            Source::Stdin(format) => options.read_terrain_from(io::stdin().lock(), format, terrain)?,
            Source::File => options.read_terrain_with_progress(path, terrain, &progress)?,
        })
    };
    read_with(path, read, ui)
}

/// Where bytes come from.
#[derive(Clone, Copy)]
enum Source {
    Stdin(Format),
    File,
}

/// Standard input does not say what it is.
fn source(path: &Path, reading: &Reading) -> Result<Source, Failure> {
    if !input_file::is_stdin(path) {
        return Ok(Source::File);
    }
    let unknown =
        || Failure::Usage("say what it is with --format: obj, ply, stl, glb, gltf, las or laz".to_owned());
    Ok(Source::Stdin(reading.format.ok_or_else(unknown)?))
}

/// What to call an input.
pub fn name_of(path: &Path) -> String {
    if input_file::is_stdin(path) { "standard input".to_owned() } else { path.display().to_string() }
}

fn read_with(
    path: &Path,
    read: impl FnOnce() -> anyhow::Result<MeshFile>,
    ui: &Ui,
) -> anyhow::Result<MeshFile> {
    let name = name_of(path);
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
fn with_hint(error: anyhow::Error) -> anyhow::Error {
    let is_ratio = matches!(error.downcast_ref(), Some(ReadError::Ratio { .. }));
    if is_ratio { error.context("refused without --any-ratio") } else { error }
}

fn warn_about(name: &str, file: &MeshFile, ui: &Ui) {
    if file.mesh.num_triangles() == 0 && file.mesh.num_vertices() > 0 {
        let points = counted(file.mesh.num_vertices(), "point", "points");
        ui.warn(name, &format!("a point cloud: {points} without faces"));
    }
    losses::warn(name, &file.report.losses(), ui);
}

/// What a stream is made of.
pub struct StreamInput<'a> {
    /// At least one.
    pub paths: Vec<&'a Path>,
    /// Whether the meshes become one.
    pub merge: bool,
    pub has_textures: bool,
    pub reading: &'a Reading,
}

impl StreamInput<'_> {
    /// As [`read_mesh`], but the meshes of a scene keep to themselves unless they are to be merged.
    pub fn read(&self, part: Part, ui: &Ui) -> anyhow::Result<MeshFile> {
        let join = |scene: Scene| if self.merge || scene.is_single() { scene.merge() } else { scene.pack() };
        if let [path] = self.paths[..] {
            return read_with(path, || Ok(join(self.read_scene(path, part)?)?), ui);
        }
        let mut all = Scene::default();
        for (k, path) in self.paths.iter().enumerate() {
            let share = |k: usize| k as f64 / self.paths.len() as f64;
            let name = name_of(path);
            check(path).with_context(|| name.clone())?;
            let scene = self.read_scene(path, part.between(share(k), share(k + 1)));
            let mut scene = scene.map_err(with_hint).with_context(|| name.clone())?;
            scene.meshes.iter().for_each(|file| warn_about(&name, file, ui));
            name_instances(&mut scene, path);
            all.append(scene);
        }
        Ok(join(all)?)
    }

    fn read_scene(&self, path: &Path, part: Part) -> anyhow::Result<Scene> {
        let options = self.reading.options();
        let options = if self.has_textures { options } else { options.without_textures() };
        Ok(match source(path, self.reading)? {
            Source::Stdin(format) => options.read_scene_from(io::stdin().lock(), format)?,
            Source::File => options.read_scene_with_progress(path, &|done| part.set(done))?,
        })
    }
}

/// Gives the file's name to what has none.
fn name_instances(scene: &mut Scene, path: &Path) {
    let file = without_mesh_ending(path);
    let stem = file.file_name().unwrap_or_default().to_string_lossy();
    for instance in scene.instances.iter_mut().filter(|instance| instance.name.is_empty()) {
        instance.name = stem.clone().into_owned();
    }
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
