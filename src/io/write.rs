//! Meshes into files of any format.

use super::atomic::write_atomic;
use super::error::WriteError;
use super::format::{Compression, Format, format_and_compression};
use super::plan::Plan;
#[cfg(feature = "gltf")]
use super::scene::Scene;
use super::write_options::{ColorType, WriteOptions};
use crate::losses::Losses;
use crate::mesh::{Attribute, Attributes, Domain, Semantic, TriMesh, Values};
use flate2::write::GzEncoder;
use std::io::Write;
use std::path::Path;

/// Writes a mesh file; the ending of `path` says which format, a further `.gz` or `.zst` compresses it.
///
/// The file appears complete or not at all (see [`write_atomic`]).
///
/// # Errors
/// If the file cannot be written, its ending is unknown, or the format cannot hold the mesh.
pub fn write(path: impl AsRef<Path>, mesh: &TriMesh) -> Result<(), WriteError> {
    write_with_attributes(path, mesh, &Attributes::default()).map(drop)
}

/// As [`write()`], with those of the attributes that the format can hold. Gives what is lost.
///
/// # Errors
/// As [`write()`], and if an attribute does not fit the mesh.
pub fn write_with_attributes(
    path: impl AsRef<Path>,
    mesh: &TriMesh,
    attributes: &Attributes,
) -> Result<Losses, WriteError> {
    WriteOptions::new().write(path, mesh, attributes)
}

/// Writes the meshes of a scene in their places, as glTF; in other formats, merged (see [`Scene::merge`]).
///
/// # Errors
/// As [`write_with_attributes`], and if the merged mesh is too large.
#[cfg(feature = "gltf")]
pub fn write_scene(path: impl AsRef<Path>, scene: &Scene) -> Result<Losses, WriteError> {
    WriteOptions::new().write_scene(path, scene)
}

/// As [`write_scene`], uncompressed.
///
/// # Errors
/// As [`write_scene`].
#[cfg(feature = "gltf")]
pub fn write_scene_to(out: impl Write, scene: &Scene, format: Format) -> Result<Losses, WriteError> {
    WriteOptions::new().write_scene_to(out, scene, format)
}

/// Writes `mesh` in `format`, uncompressed. Writes are small: pass a buffered writer.
///
/// - OBJ: shortest decimal numbers that read back as the same float64.
/// - PLY: binary little-endian; `float` if every coordinate is a float32, else `double`.
/// - STL: binary; coordinates are rounded to float32 and vertices are no longer shared.
/// - glTF: coordinates are rounded to float32, around an origin of their own where they are large.
///
/// # Errors
/// If `out` fails, or the format cannot hold the mesh.
pub fn write_to(out: impl Write, mesh: &TriMesh, format: Format) -> Result<(), WriteError> {
    write_with_attributes_to(out, mesh, &Attributes::default(), format).map(drop)
}

/// As [`write_to`], with those of the attributes that the format can hold. Gives what is lost. [`WriteOptions`] does the
/// same in other ways.
///
/// - OBJ: normals, texture coordinates and a colour per vertex, one set each; names of materials, groups and
///   objects.
/// - PLY: whatever belongs to vertices and faces and is no name, in its type; colours as `uchar`, normals and texture
///   coordinates as `float`; attributes of corners if they have no seam, and one set of texture coordinates if they have.
/// - STL: nothing.
/// - glTF: normals, made unit vectors; texture coordinates, colours and what else vertices and corners have, in
///   its type if glTF has it there, else as float32; names of materials. Vertices are split at seams.
///
/// Colours are turned from sRGB to linear ones where they go to glTF, and back. Where a format must have a value and there
/// is none, colours are white, normals those of the surface, and other numbers 0.
///
/// # Errors
/// As [`write_to`], and if an attribute does not fit the mesh.
pub fn write_with_attributes_to(
    out: impl Write,
    mesh: &TriMesh,
    attributes: &Attributes,
    format: Format,
) -> Result<Losses, WriteError> {
    WriteOptions::new().write_to(out, mesh, attributes, format)
}

/// Writes `mesh` as PLY with a colour per vertex (properties `red`, `green` and `blue`), else as
/// [`write_to`].
///
/// # Errors
/// If `out` fails, or there is not one colour per vertex.
pub fn write_ply_coloured(out: impl Write, mesh: &TriMesh, colours: &[[u8; 3]]) -> Result<(), WriteError> {
    if colours.len() != mesh.num_vertices() {
        let message = format!("{} colours for {} vertices", colours.len(), mesh.num_vertices());
        return Err(WriteError::Unrepresentable { message });
    }
    let values = Values::U8(colours.as_flattened().to_vec());
    let colour = Attribute::new("red green blue", Semantic::Color(0), Domain::Vertex, 3, values);
    let attributes = Attributes { list: vec![colour], ..Attributes::default() };
    let options = WriteOptions::new().color_type(ColorType::Uchar);
    options.write_to(out, mesh, &attributes, Format::Ply).map(drop)
}

impl WriteOptions {
    /// Writes a mesh file, as [`write_with_attributes`]. Gives what is lost.
    ///
    /// # Errors
    /// As [`write_with_attributes`].
    pub fn write(
        &self,
        path: impl AsRef<Path>,
        mesh: &TriMesh,
        attributes: &Attributes,
    ) -> Result<Losses, WriteError> {
        write_file(path.as_ref(), |format| Plan::new(mesh, attributes, format, self))
    }

    /// Writes a mesh, as [`write_with_attributes_to`]. Gives what is lost.
    ///
    /// # Errors
    /// As [`write_with_attributes_to`].
    pub fn write_to(
        &self,
        mut out: impl Write,
        mesh: &TriMesh,
        attributes: &Attributes,
        format: Format,
    ) -> Result<Losses, WriteError> {
        Plan::new(mesh, attributes, format, self)?.write(&mut out)
    }

    /// What [`WriteOptions::write`] would lose. Nothing is written.
    ///
    /// # Errors
    /// If the format cannot hold the mesh, or an attribute does not fit it.
    pub fn losses_of(
        &self,
        mesh: &TriMesh,
        attributes: &Attributes,
        format: Format,
    ) -> Result<Losses, WriteError> {
        Ok(Plan::new(mesh, attributes, format, self)?.losses)
    }

    /// Writes the file of a scene, as [`write_scene`]. Gives what is lost.
    ///
    /// # Errors
    /// As [`write_scene`].
    #[cfg(feature = "gltf")]
    pub fn write_scene(&self, path: impl AsRef<Path>, scene: &Scene) -> Result<Losses, WriteError> {
        let path = path.as_ref();
        let merged = Plan::merged(scene, written_format(path)?.0)?;
        write_file(path, |format| Plan::of_scene(scene, merged.as_ref(), format, self))
    }

    /// Writes a scene, as [`write_scene_to`]. Gives what is lost.
    ///
    /// # Errors
    /// As [`write_scene_to`].
    #[cfg(feature = "gltf")]
    pub fn write_scene_to(
        &self,
        mut out: impl Write,
        scene: &Scene,
        format: Format,
    ) -> Result<Losses, WriteError> {
        let merged = Plan::merged(scene, format)?;
        Plan::of_scene(scene, merged.as_ref(), format, self)?.write(&mut out)
    }

    /// What [`WriteOptions::write_scene`] would lose. Nothing is written.
    ///
    /// # Errors
    /// If the format cannot hold the scene.
    #[cfg(feature = "gltf")]
    pub fn losses_of_scene(&self, scene: &Scene, format: Format) -> Result<Losses, WriteError> {
        let merged = Plan::merged(scene, format)?;
        Ok(Plan::of_scene(scene, merged.as_ref(), format, self)?.losses)
    }
}

/// The format that the ending of a file says, and whether it is compressed.
fn written_format(path: &Path) -> Result<(Format, Option<Compression>), WriteError> {
    format_and_compression(path).filter(|(format, _)| format.is_written()).ok_or(WriteError::UnknownEnding)
}

/// Writes a file by its ending, complete or not at all.
fn write_file<'a>(
    path: &Path,
    plan: impl FnOnce(Format) -> Result<Plan<'a>, WriteError>,
) -> Result<Losses, WriteError> {
    let (format, compression) = written_format(path)?;
    let plan = plan(format)?;
    let mut losses = Losses::default();
    write_atomic(path, |out| {
        losses = match compression {
            Some(Compression::Zstd) => {
                let mut compressor = zstd::Encoder::new(out, zstd::DEFAULT_COMPRESSION_LEVEL)?;
                let losses = plan.write(&mut compressor)?;
                compressor.finish()?;
                losses
            }
            Some(Compression::Gzip) => {
                let mut compressor = GzEncoder::new(out, flate2::Compression::default());
                let losses = plan.write(&mut compressor)?;
                compressor.finish()?;
                losses
            }
            None => plan.write(&mut &mut *out)?,
        };
        Ok::<(), WriteError>(())
    })?;
    Ok(losses)
}
