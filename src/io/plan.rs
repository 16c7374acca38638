//! What is written, before it is: all that is lost is known by then.

use super::convert::dropped;
#[cfg(feature = "gltf")]
use super::error::ReadError;
use super::error::WriteError;
use super::format::Format;
#[cfg(feature = "gltf")]
use super::gltf;
#[cfg(feature = "gltf")]
use super::mesh_file::MeshFile;
#[cfg(feature = "gltf")]
use super::scene::Scene;
use super::write_options::WriteOptions;
use super::{obj, ply, stl};
use crate::losses::Losses;
use crate::mesh::{Attributes, TriMesh};
use std::io::Write;

/// What is written may be out of proportion to the stream that it comes from, since somebody asked for it, as if that had
/// this many bytes: 2²⁸ vertices and triangles of all instances.
#[cfg(feature = "gltf")]
const MIN_NUM_BYTES: usize = 1 << 24;

/// A file that can be written.
pub(super) struct Plan<'a> {
    file: File<'a>,
    /// What it does not have of the mesh.
    pub losses: Losses,
}

enum File<'a> {
    Obj(Box<obj::Plan<'a>>),
    Ply(ply::Plan<'a>),
    Stl(stl::Plan<'a>),
    #[cfg(feature = "gltf")]
    Gltf(gltf::Plan, gltf::Container),
}

impl<'a> Plan<'a> {
    /// The file of a mesh.
    ///
    /// # Errors
    /// If the format cannot hold the mesh, or an attribute does not fit it.
    pub fn new(
        mesh: &'a TriMesh,
        attributes: &'a Attributes,
        format: Format,
        options: &WriteOptions,
    ) -> Result<Self, WriteError> {
        for attribute in &attributes.list {
            let misfit = |error| format!("attribute {}: {error}", attribute.name);
            let misfit = |error| WriteError::Unrepresentable { message: misfit(error) };
            attribute.validate(mesh).map_err(misfit)?;
        }
        let mut losses = Losses::default();
        let file = match format {
            Format::Obj => File::Obj(Box::new(obj::Plan::new(mesh, attributes, options, &mut losses)?)),
            Format::Ply => File::Ply(ply::Plan::new(mesh, attributes, options, &mut losses)?),
            Format::Stl => File::Stl(stl::Plan::new(mesh, attributes, &mut losses)?),
            #[cfg(feature = "gltf")]
            Format::Glb | Format::Gltf => {
                let plan = gltf::Plan::new(mesh, attributes, options, &mut losses)?;
                File::Gltf(plan, container(format))
            }
            #[cfg(feature = "las")]
            Format::Las | Format::Laz => {
                let message = "point clouds are read and not written".to_owned();
                return Err(WriteError::Unrepresentable { message });
            }
        };
        losses.append(others_left_out(attributes, &file));
        Ok(Self { file, losses })
    }

    /// The file of a scene; `merged` is what [`Plan::merged`] made of it.
    ///
    /// # Errors
    /// If the format cannot hold it.
    #[cfg(feature = "gltf")]
    pub fn of_scene(
        scene: &Scene,
        merged: Option<&'a MeshFile>,
        format: Format,
        options: &WriteOptions,
    ) -> Result<Self, WriteError> {
        if let Some(MeshFile { mesh, attributes, report, .. }) = merged {
            let mut plan = Self::new(mesh, attributes, format, options)?;
            plan.losses.append(lost_by_merging(scene, &report.ignored));
            return Ok(plan);
        }
        let mut losses = Losses::default();
        let plan = gltf::Plan::of_scene(scene, options, &mut losses)?;
        Ok(Self { file: File::Gltf(plan, container(format)), losses })
    }

    /// One mesh of all meshes of a scene, for formats that have no scenes.
    ///
    /// # Errors
    /// If it is too large.
    #[cfg(feature = "gltf")]
    pub fn merged(scene: &Scene, format: Format) -> Result<Option<MeshFile>, WriteError> {
        if matches!(format, Format::Glb | Format::Gltf) {
            return Ok(None);
        }
        let too_large = |error: ReadError| WriteError::Unrepresentable { message: error.to_string() };
        let mut scene = scene.clone();
        scene.num_bytes = scene.num_bytes.max(MIN_NUM_BYTES);
        scene.merge().map(Some).map_err(too_large)
    }

    /// Writes the file.
    ///
    /// # Errors
    /// If `out` fails, or the file is too large for its format.
    pub fn write(self, out: &mut impl Write) -> Result<Losses, WriteError> {
        match self.file {
            File::Obj(plan) => plan.write(out)?,
            File::Ply(plan) => plan.write(out)?,
            File::Stl(plan) => plan.write(out)?,
            #[cfg(feature = "gltf")]
            File::Gltf(plan, container) => plan.write(out, container)?,
        }
        Ok(self.losses)
    }
}

/// What the merged mesh does not have of the scene, given what it says that it has not of the file.
#[cfg(feature = "gltf")]
fn lost_by_merging(scene: &Scene, ignored: &[String]) -> Losses {
    let reports = || scene.meshes.iter().map(|file| &file.report).chain([&scene.report]);
    let is_new = |name: &&String| !reports().any(|report| report.ignored.contains(name));
    ignored.iter().filter(is_new).map(|name| dropped(name, "")).collect()
}

#[cfg(feature = "gltf")]
fn container(format: Format) -> gltf::Container {
    if format == Format::Gltf { gltf::Container::Text } else { gltf::Container::Glb }
}

/// What a format does not have of what the mesh has once for all.
fn others_left_out(attributes: &Attributes, file: &File) -> Losses {
    let (has_materials, has_metadata) = match file {
        // OBJ has names of files, which are not written.
        File::Obj(_) | File::Stl(_) => (false, false),
        File::Ply(_) => (false, true),
        #[cfg(feature = "gltf")]
        File::Gltf(..) => (true, true),
    };
    let materials = attributes.gltf_materials.iter().map(|_| "materials except their names");
    let metadata = attributes.metadata.iter().map(|(key, _)| key.as_str());
    let (materials, metadata) = (materials.filter(|_| !has_materials), metadata.filter(|_| !has_metadata));
    let materials = materials.map(|name| dropped(name, "glTF keeps them"));
    materials.chain(metadata.map(|key| dropped(key, "glTF and PLY keep it"))).collect()
}
