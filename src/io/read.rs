//! Meshes from files of any format.

use super::beside::Folder;
use super::error::ReadError;
use super::foreign;
use super::format::Format;
#[cfg(feature = "gltf")]
use super::gltf;
#[cfg(feature = "las")]
use super::las::{self, TerrainOptions};
use super::mesh_file::MeshFile;
#[cfg(feature = "gltf")]
use super::scene::Scene;
use super::source::Source;
use super::unpack::ReadOptions;
use super::{obj, ply, stl};
use std::io::Read;
use std::path::Path;

/// Reads a mesh file; the ending of `path` says which format (see [`Format::from_path`]).
///
/// A well-formed file without vertices or faces is a mesh without vertices or faces, not an error. The meshes
/// of a glTF scene become one, each in its place. Buffers of glTF in other files are read too, if they are in
/// the folder of `path` or below.
///
/// # Errors
/// If the file cannot be read, its ending is unknown, it is larger than [`MAX_FILE_BYTES`](super::MAX_FILE_BYTES), or it is
/// damaged.
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
        self.read_with_progress(path, &|_| ())
    }

    /// As [`read()`], calling `progress` with the share of the work done, 0 to 1.
    ///
    /// # Errors
    /// As [`read()`].
    pub fn read_with_progress(
        &self,
        path: impl AsRef<Path>,
        progress: &dyn Fn(f64),
    ) -> Result<MeshFile, ReadError> {
        let path = path.as_ref();
        let (source, format) = self.open(path, progress)?;
        let file = self.mesh(source, format, &mut Folder::of(path, self.textures))?;
        progress(1.0);
        Ok(file)
    }

    /// Reads a mesh from bytes that are in no file, such as those of standard input, packed with gzip or zstd if
    /// they look so. Nothing else is read: glTF must have its buffers inside.
    ///
    /// # Errors
    /// As [`read()`].
    pub fn read_from(&self, reader: impl Read, format: Format) -> Result<MeshFile, ReadError> {
        self.mesh(self.open_reader(reader, &|_| ())?, format, &mut Folder::none(self.textures))
    }

    fn mesh(&self, source: Source, format: Format, folder: &mut Folder) -> Result<MeshFile, ReadError> {
        #[cfg(feature = "gltf")]
        return self.scene(source, format, folder)?.merge();
        #[cfg(not(feature = "gltf"))]
        Ok(read_source(source, format, folder)?.0)
    }

    /// As [`read_scene()`].
    ///
    /// # Errors
    /// As [`read()`].
    #[cfg(feature = "gltf")]
    pub fn read_scene(&self, path: impl AsRef<Path>) -> Result<Scene, ReadError> {
        self.read_scene_with_progress(path, &|_| ())
    }

    /// As [`read_scene()`], calling `progress` with the share of the work done, 0 to 1.
    ///
    /// # Errors
    /// As [`read()`].
    #[cfg(feature = "gltf")]
    pub fn read_scene_with_progress(
        &self,
        path: impl AsRef<Path>,
        progress: &dyn Fn(f64),
    ) -> Result<Scene, ReadError> {
        let path = path.as_ref();
        let (source, format) = self.open(path, progress)?;
        let scene = self.scene(source, format, &mut Folder::of(path, self.textures))?;
        progress(1.0);
        Ok(scene)
    }

    /// As [`ReadOptions::read_from`], for several meshes.
    ///
    /// # Errors
    /// As [`read()`].
    #[cfg(feature = "gltf")]
    pub fn read_scene_from(&self, reader: impl Read, format: Format) -> Result<Scene, ReadError> {
        self.scene(self.open_reader(reader, &|_| ())?, format, &mut Folder::none(self.textures))
    }

    #[cfg(feature = "gltf")]
    fn scene(&self, source: Source, format: Format, folder: &mut Folder) -> Result<Scene, ReadError> {
        let mut scene = match format {
            Format::Glb | Format::Gltf => gltf::read(&source.into_bytes()?, folder)?,
            _ => {
                let (file, num_bytes) = read_source(source, format, folder)?;
                Scene { num_bytes, ..file.into() }
            }
        };
        if !self.textures
            && let Some(materials) = &mut scene.gltf_materials
            && gltf::strip_textures(materials)
        {
            scene.report.ignore("textures");
        }
        Ok(scene)
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
        self.read_terrain_with_progress(path, options, &|_| ())
    }

    /// As [`read_terrain()`], calling `progress` with the share of the work done, 0 to 1.
    ///
    /// # Errors
    /// As [`read_terrain()`].
    #[cfg(feature = "las")]
    pub fn read_terrain_with_progress(
        &self,
        path: impl AsRef<Path>,
        options: &TerrainOptions,
        progress: &dyn Fn(f64),
    ) -> Result<MeshFile, ReadError> {
        let (source, format) = self.open(path.as_ref(), progress)?;
        let file = self.terrain(source, format, options)?;
        progress(1.0);
        Ok(file)
    }

    /// As [`ReadOptions::read_from`], for point clouds.
    ///
    /// # Errors
    /// As [`read_terrain()`].
    #[cfg(feature = "las")]
    pub fn read_terrain_from(
        &self,
        reader: impl Read,
        format: Format,
        options: &TerrainOptions,
    ) -> Result<MeshFile, ReadError> {
        self.terrain(self.open_reader(reader, &|_| ())?, format, options)
    }

    #[cfg(feature = "las")]
    fn terrain(
        &self,
        source: Source,
        format: Format,
        options: &TerrainOptions,
    ) -> Result<MeshFile, ReadError> {
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
    foreign::check(&bytes[..bytes.len().min(foreign::HEAD_BYTES)])?;
    ReadOptions::default().mesh(Source::of_bytes(bytes), format, &mut Folder::none(true))
}

/// Reads what is no scene; also says how many bytes that is. OBJ, PLY and STL need not be in memory as a whole.
fn read_source(
    mut source: Source,
    format: Format,
    folder: &mut Folder,
) -> Result<(MeshFile, usize), ReadError> {
    let found = match format {
        Format::Obj => obj::read(&mut source, folder),
        Format::Ply => ply::read(&mut source, folder),
        Format::Stl => stl::read(&mut source),
        #[cfg(feature = "gltf")]
        Format::Glb | Format::Gltf => {
            let bytes = source.into_bytes()?;
            return Ok((gltf::read(&bytes, folder)?.merge()?, bytes.len()));
        }
        #[cfg(feature = "las")]
        Format::Las | Format::Laz => {
            let bytes = source.into_bytes()?;
            return Ok((las::read(&bytes, &TerrainOptions::default())?, bytes.len()));
        }
    };
    let num_bytes = source.offset();
    // A fault of the disk is not one of the mesh.
    source.finish()?;
    Ok((found?, num_bytes))
}
