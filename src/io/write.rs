//! Meshes into files of any format.

use super::atomic::write_atomic;
#[cfg(feature = "gltf")]
use super::error::ReadError;
use super::error::WriteError;
use super::format::{Compression, Format, format_and_compression};
#[cfg(feature = "gltf")]
use super::gltf;
#[cfg(feature = "gltf")]
use super::mesh_file::MeshFile;
use super::mesh_file::WriteReport;
#[cfg(feature = "gltf")]
use super::scene::Scene;
use super::{obj, ply, stl};
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

/// As [`write()`], with those of the attributes that the format can hold.
///
/// # Errors
/// As [`write()`], and if an attribute does not fit the mesh.
pub fn write_with_attributes(
    path: impl AsRef<Path>,
    mesh: &TriMesh,
    attributes: &Attributes,
) -> Result<WriteReport, WriteError> {
    write_file(path.as_ref(), |out, format| write_with_attributes_to(out, mesh, attributes, format))
}

/// Writes a file by its ending, complete or not at all.
fn write_file(
    path: &Path,
    write: impl FnOnce(&mut dyn Write, Format) -> Result<WriteReport, WriteError>,
) -> Result<WriteReport, WriteError> {
    let known = format_and_compression(path).filter(|(format, _)| format.is_written());
    let (format, compression) = known.ok_or(WriteError::UnknownEnding)?;
    let mut report = WriteReport::default();
    write_atomic(path, |out| {
        report = match compression {
            Some(Compression::Zstd) => {
                let mut compressor = zstd::Encoder::new(out, zstd::DEFAULT_COMPRESSION_LEVEL)?;
                let report = write(&mut compressor, format)?;
                compressor.finish()?;
                report
            }
            Some(Compression::Gzip) => {
                let mut compressor = GzEncoder::new(out, flate2::Compression::default());
                let report = write(&mut compressor, format)?;
                compressor.finish()?;
                report
            }
            None => write(out, format)?,
        };
        Ok::<(), WriteError>(())
    })?;
    Ok(report)
}

/// Writes the meshes of a scene in their places, as glTF; in other formats, merged (see [`Scene::merge`]).
///
/// # Errors
/// As [`write_with_attributes`], and if the merged mesh is too large.
#[cfg(feature = "gltf")]
pub fn write_scene(path: impl AsRef<Path>, scene: &Scene) -> Result<WriteReport, WriteError> {
    write_file(path.as_ref(), |out, format| write_scene_to(out, scene, format))
}

/// As [`write_scene`], uncompressed.
///
/// # Errors
/// As [`write_scene`].
#[cfg(feature = "gltf")]
pub fn write_scene_to(mut out: impl Write, scene: &Scene, format: Format) -> Result<WriteReport, WriteError> {
    match format {
        Format::Glb => gltf::write_scene(&mut out, scene, gltf::Container::Glb),
        Format::Gltf => gltf::write_scene(&mut out, scene, gltf::Container::Text),
        _ => {
            let too_large = |error: ReadError| WriteError::Unrepresentable { message: error.to_string() };
            let MeshFile { mesh, attributes, .. } = scene.clone().merge().map_err(too_large)?;
            write_with_attributes_to(out, &mesh, &attributes, format)
        }
    }
}

/// Writes `mesh` in `format`, uncompressed. Writes are small: pass a buffered writer.
///
/// - OBJ: shortest decimal numbers that read back as the same float64.
/// - PLY: binary little-endian; `float` if every coordinate is a float32, else `double`.
/// - STL: binary; coordinates are rounded to float32 and vertices are no longer shared.
/// - glTF: coordinates are rounded to float32.
///
/// # Errors
/// If `out` fails, or the format cannot hold the mesh.
pub fn write_to(out: impl Write, mesh: &TriMesh, format: Format) -> Result<(), WriteError> {
    write_with_attributes_to(out, mesh, &Attributes::default(), format).map(drop)
}

/// As [`write_to`], with those of the attributes that the format can hold.
///
/// - OBJ: normals, texture coordinates and a colour per vertex, one set each; names of materials, groups and
///   objects.
/// - PLY: whatever belongs to vertices and faces and is no name, in its type; attributes of corners if they
///   have no seam, and one set of texture coordinates if they have.
/// - STL: nothing.
/// - glTF: normals, made unit vectors; texture coordinates, colours and what else vertices and corners have, in
///   its type if glTF has it there, else as float32; names of materials. Vertices are split at seams.
///
/// # Errors
/// As [`write_to`], and if an attribute does not fit the mesh.
pub fn write_with_attributes_to(
    mut out: impl Write,
    mesh: &TriMesh,
    attributes: &Attributes,
    format: Format,
) -> Result<WriteReport, WriteError> {
    for attribute in &attributes.list {
        let misfit = |error| format!("attribute {}: {error}", attribute.name);
        let misfit = |error| WriteError::Unrepresentable { message: misfit(error) };
        attribute.validate(mesh).map_err(misfit)?;
    }
    let report = match format {
        Format::Obj => obj::write(&mut out, mesh, attributes)?,
        Format::Ply => ply::write(&mut out, mesh, attributes)?,
        Format::Stl => {
            stl::write(&mut out, mesh)?;
            let ignored = attributes.list.iter().map(|attribute| attribute.name.clone()).collect();
            WriteReport { ignored, ..WriteReport::default() }
        }
        #[cfg(feature = "gltf")]
        Format::Glb => return gltf::write(&mut out, mesh, attributes, gltf::Container::Glb),
        #[cfg(feature = "gltf")]
        Format::Gltf => return gltf::write(&mut out, mesh, attributes, gltf::Container::Text),
        #[cfg(feature = "las")]
        Format::Las | Format::Laz => {
            let message = "point clouds are read and not written".to_owned();
            return Err(WriteError::Unrepresentable { message });
        }
    };
    Ok(WriteReport { ignored: [report.ignored, others_left_out(attributes, format)].concat(), ..report })
}

/// What a format that is not glTF leaves out of what the mesh has once for all.
fn others_left_out(attributes: &Attributes, format: Format) -> Vec<String> {
    let is_named = match format {
        Format::Obj => !attributes.material_libraries.is_empty(),
        Format::Ply => attributes.list.iter().any(|attribute| attribute.name == ply::TEXTURE_FILE),
        _ => false,
    };
    let mut left_out = Vec::new();
    if attributes.gltf_materials.is_some() && !is_named {
        left_out.push("materials except their names".to_owned());
    }
    // glTF keeps both.
    if format != Format::Ply {
        left_out.extend(attributes.metadata.iter().map(|(key, _)| key.clone()));
    }
    left_out
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
    write_with_attributes_to(out, mesh, &attributes, Format::Ply).map(drop)
}
