//! Mesh files: OBJ, PLY, STL, glTF (feature `gltf`) and terrain in LAS and LAZ (feature `las`), each also
//! compressed with zstd (`.zst`).
//!
//! The file formats stay at the edge of the crate: a file becomes a [`TriMesh`], its [`Attributes`] and a
//! [`ReadReport`], these become a file, and nothing else knows that files exist.
//!
//! Input is not trusted. No input makes a reader panic, and counts declared in a file never decide how much
//! is allocated: memory grows as the data that fills it is found, to a small multiple of the file's size. A `.zst` file
//! that unpacks out of all proportion is refused ([`ReadOptions`]), and OBJ, PLY and STL are unpacked in pieces.
//!
//! ```no_run
//! let file = lwc::io::read("horse.ply.zst")?;
//! println!("{} vertices, {:?}", file.mesh.num_vertices(), file.report);
//! lwc::io::write("horse.obj", &file.mesh)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod atomic;
mod builder;
mod error;
#[cfg(feature = "gltf")]
mod gltf;
#[cfg(feature = "las")]
mod las;
mod obj;
mod ply;
#[cfg(feature = "gltf")]
mod scene;
mod source;
mod stl;
mod text;
mod texture;
mod unpack;

#[cfg(feature = "gltf")]
pub use crate::mesh::Instance;
pub use atomic::{abandon_writes, write_atomic};
pub use error::{Place, ReadError, WriteError};
#[cfg(feature = "las")]
pub use las::TerrainOptions;
#[cfg(feature = "gltf")]
pub use scene::{SCENE_MESH, Scene};
pub use unpack::ReadOptions;

use crate::mesh::{Attribute, Attributes, Domain, Semantic, TriMesh, Values};
use source::Source;
use std::{io::Write, path::Path};

/// The largest file that is read, in bytes after decompression: 16 GiB.
///
/// A mesh of a hundred million vertices is smaller in every format but the wordiest OBJ.
pub const MAX_FILE_BYTES: u64 = 16 << 30;

/// A mesh file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// Wavefront OBJ: text, coordinates as decimal numbers.
    Obj,
    /// Stanford PLY: text or binary, float32 or float64.
    Ply,
    /// STL: triangles without shared vertices, float32.
    Stl,
    /// glTF 2.0 in one binary file, float32.
    #[cfg(feature = "gltf")]
    Glb,
    /// glTF 2.0 as text, with buffers inside or in other files, float32.
    #[cfg(feature = "gltf")]
    Gltf,
    /// LAS: points, which are triangulated in the plane. Is read and not written.
    #[cfg(feature = "las")]
    Las,
    /// LAZ: the same, compressed.
    #[cfg(feature = "las")]
    Laz,
}

/// `.obj, .ply, .stl`, of all formats that are wanted.
fn known_endings(is_wanted: impl Fn(Format) -> bool) -> String {
    let formats = Format::ALL.iter().copied().filter(|&format| is_wanted(format));
    let endings: Vec<String> = formats.map(|format| format!(".{}", format.extension())).collect();
    endings.join(", ")
}

impl Format {
    /// All formats that this build knows.
    pub const ALL: &[Self] = &[
        Self::Obj,
        Self::Ply,
        Self::Stl,
        #[cfg(feature = "gltf")]
        Self::Glb,
        #[cfg(feature = "gltf")]
        Self::Gltf,
        #[cfg(feature = "las")]
        Self::Las,
        #[cfg(feature = "las")]
        Self::Laz,
    ];

    /// Whether meshes can be written in it; all can be read.
    pub fn is_written(self) -> bool {
        match self {
            #[cfg(feature = "las")]
            Self::Las | Self::Laz => false,
            _ => true,
        }
    }

    /// Whether such a file can be looked at in a terminal.
    pub fn is_text(self) -> bool {
        match self {
            Self::Obj => true,
            #[cfg(feature = "gltf")]
            Self::Gltf => true,
            _ => false,
        }
    }

    /// The format that the ending of `path` names, in any case; a further `.zst` is looked past.
    /// `None` if the ending is not one of ours.
    pub fn from_path(path: impl AsRef<Path>) -> Option<Self> {
        format_and_compression(path.as_ref()).map(|(format, _)| format)
    }

    /// The usual ending of such a file, without the dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Obj => "obj",
            Self::Ply => "ply",
            Self::Stl => "stl",
            #[cfg(feature = "gltf")]
            Self::Glb => "glb",
            #[cfg(feature = "gltf")]
            Self::Gltf => "gltf",
            #[cfg(feature = "las")]
            Self::Las => "las",
            #[cfg(feature = "las")]
            Self::Laz => "laz",
        }
    }
}

/// Splits `model.ply.zst` into (PLY, compressed).
fn format_and_compression(path: &Path) -> Option<(Format, bool)> {
    let ending = |p: &Path| Some(p.extension()?.to_str()?.to_ascii_lowercase());
    let last = ending(path)?;
    let is_compressed = last == "zst";
    let named = if is_compressed { ending(path.file_stem()?.as_ref())? } else { last };
    let format = *Format::ALL.iter().find(|f| f.extension() == named)?;
    Some((format, is_compressed))
}

/// What a file held: the mesh, and what was changed or left out on the way.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct MeshFile {
    /// Vertices in the order of the file, unused ones included; triangles in the order of the file.
    pub mesh: TriMesh,
    /// Normals, texture coordinates, colours, materials and whatever else the file has; valid for the mesh.
    pub attributes: Attributes,
    /// What was changed or left out.
    pub report: ReadReport,
}

/// What a reader changed or left out. Degenerate triangles (a repeated index) are *not* left out.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct ReadReport {
    /// Faces of four or more corners that were cut into the fan of their first corner.
    pub polygons_triangulated: usize,
    /// Faces of fewer than three corners, left out.
    pub faces_skipped: usize,
    /// STL and glTF: corners or vertices that were joined with an earlier one at exactly the same place.
    pub corners_welded: usize,
    /// LAS only: points that are not vertices, because they lie above another, are not the last return, or
    /// were thinned out.
    pub points_left_out: usize,
    /// Names of what was in the file and is neither in the mesh nor in the attributes, each once, in order of
    /// appearance: OBJ statements (`l`), PLY properties that are lists (`vertex.bones`) and elements (`edge`).
    pub ignored: Vec<String>,
}

/// Reads a mesh file; the ending of `path` says which format (see [`Format::from_path`]).
///
/// A well-formed file without vertices or faces is a mesh without vertices or faces, not an error. The meshes
/// of a glTF scene become one, each in its place. Buffers of glTF in other files are read too, if they are in
/// the folder of `path` or below.
///
/// # Errors
/// If the file cannot be read, its ending is unknown, it is larger than [`MAX_FILE_BYTES`], or it is damaged.
/// The error names the place in the file and the cause; the caller knows the file's name and puts it in front.
pub fn read(path: impl AsRef<Path>) -> Result<MeshFile, ReadError> {
    ReadOptions::default().read(path)
}

/// Reads a file of several meshes, each in its own coordinates; one of a format without scenes is one mesh in
/// its place.
///
/// # Errors
/// As [`read`].
#[cfg(feature = "gltf")]
pub fn read_scene(path: impl AsRef<Path>) -> Result<Scene, ReadError> {
    ReadOptions::default().read_scene(path)
}

/// Reads a point cloud (`.las`, `.laz`, also `.zst`) and triangulates it in the plane.
///
/// # Errors
/// As [`read`]; the ending of any other format is an unknown one here.
#[cfg(feature = "las")]
pub fn read_terrain(path: impl AsRef<Path>, options: &TerrainOptions) -> Result<MeshFile, ReadError> {
    ReadOptions::default().read_terrain(path, options)
}

impl ReadOptions {
    /// As [`read()`].
    ///
    /// # Errors
    /// As [`read()`].
    pub fn read(&self, path: impl AsRef<Path>) -> Result<MeshFile, ReadError> {
        let path = path.as_ref();
        let (source, format) = self.open(path)?;
        match format {
            #[cfg(feature = "gltf")]
            Format::Glb | Format::Gltf => gltf::read(&source.into_bytes()?, path.parent())?.merge(),
            _ => read_source(source, format),
        }
    }

    /// As [`read_scene()`].
    ///
    /// # Errors
    /// As [`read()`].
    #[cfg(feature = "gltf")]
    pub fn read_scene(&self, path: impl AsRef<Path>) -> Result<Scene, ReadError> {
        let path = path.as_ref();
        let (source, format) = self.open(path)?;
        match format {
            Format::Glb | Format::Gltf => gltf::read(&source.into_bytes()?, path.parent()),
            _ => Ok(read_source(source, format)?.into()),
        }
    }

    /// As [`read_terrain()`].
    ///
    /// # Errors
    /// As [`read_terrain()`].
    #[cfg(feature = "las")]
    pub fn read_terrain(
        &self,
        path: impl AsRef<Path>,
        options: &TerrainOptions,
    ) -> Result<MeshFile, ReadError> {
        let (source, format) = self.open(path.as_ref())?;
        match format {
            Format::Las | Format::Laz => las::read(&source.into_bytes()?, options),
            _ => Err(ReadError::UnknownEnding),
        }
    }
}

/// As [`read_terrain`], from the (uncompressed) bytes of a file.
///
/// # Errors
/// As [`read`].
#[cfg(feature = "las")]
pub fn read_terrain_bytes(bytes: &[u8], options: &TerrainOptions) -> Result<MeshFile, ReadError> {
    las::read(bytes, options)
}

/// Reads a mesh from the (uncompressed) bytes of a file. Nothing else is read: glTF must have its buffers
/// inside.
///
/// # Errors
/// As [`read`].
pub fn read_bytes(bytes: &[u8], format: Format) -> Result<MeshFile, ReadError> {
    match format {
        #[cfg(feature = "gltf")]
        Format::Glb | Format::Gltf => gltf::read(bytes, None)?.merge(),
        #[cfg(feature = "las")]
        Format::Las | Format::Laz => las::read(bytes, &TerrainOptions::default()),
        _ => read_source(Source::of_bytes(bytes), format),
    }
}

/// Reads what need not be in memory as a whole; all else is.
fn read_source(mut source: Source, format: Format) -> Result<MeshFile, ReadError> {
    let found = match format {
        Format::Obj => obj::read(&mut source),
        Format::Ply => ply::read(&mut source),
        Format::Stl => stl::read(&mut source),
        #[cfg(any(feature = "gltf", feature = "las"))]
        _ => return read_bytes(&source.into_bytes()?, format),
    };
    // A fault of the disk is not one of the mesh.
    source.finish()?;
    found
}

/// What a writer left out because the format has no place for it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct WriteReport {
    /// Names of attributes that were left out.
    pub ignored: Vec<String>,
    /// Names of attributes that do not have a value everywhere, in a format that must: zeros were written.
    pub zeroed: Vec<String>,
}

/// Writes a mesh file; the ending of `path` says which format, a further `.zst` compresses it.
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
    let (format, is_compressed) = known.ok_or(WriteError::UnknownEnding)?;
    let mut report = WriteReport::default();
    write_atomic(path, |out| {
        if is_compressed {
            let mut compressor = zstd::Encoder::new(out, zstd::DEFAULT_COMPRESSION_LEVEL)?;
            report = write(&mut compressor, format)?;
            compressor.finish()?;
        } else {
            report = write(out, format)?;
        }
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
/// - PLY: whatever belongs to vertices and faces and is not a name, in its type; attributes of corners if
/// they
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
    let mut report = match format {
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
    if attributes.gltf_materials.is_some() {
        report.ignored.push("materials but their names".to_owned());
    }
    Ok(report)
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
