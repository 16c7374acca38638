//! Files of several meshes.

mod append;
mod merge;
mod pack;
mod unify;

pub use pack::SCENE_MESH;

use super::{MeshFile, ReadReport};
use crate::mesh::{GltfMaterials, IDENTITY, Instance};

/// Several meshes, and where each of them is.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Scene {
    /// Each mesh once, in its own coordinates.
    pub meshes: Vec<MeshFile>,
    /// A mesh may be in several places, or nowhere.
    pub instances: Vec<Instance>,
    /// How the materials of all meshes look.
    pub gltf_materials: Option<GltfMaterials>,
    /// What was left out of the scene; the meshes have their own reports.
    pub report: ReadReport,
    /// Units of each mesh to a unit of the stream that the scene comes from; empty if it comes from none.
    pub(super) scales: Vec<f64>,
    /// The size of the file, which the size of what is made of it must be in proportion to.
    pub(super) num_bytes: usize,
}

impl From<MeshFile> for Scene {
    fn from(mut file: MeshFile) -> Self {
        let gltf_materials = file.attributes.gltf_materials.take();
        let instances = vec![Instance { mesh: 0, name: String::new(), transform: IDENTITY }];
        Self { meshes: vec![file], instances, gltf_materials, ..Self::default() }
    }
}

impl Scene {
    /// The step of the grid of a mesh, given that of the stream.
    pub(super) fn step_of(&self, mesh: usize, step: Option<f64>) -> Option<f64> {
        step.map(|step| step * self.scales.get(mesh).copied().unwrap_or(1.0))
    }

    /// Whether it is one mesh that is where its coordinates say.
    pub fn is_single(&self) -> bool {
        matches!(&self.instances[..], [instance] if instance.transform == IDENTITY) && self.meshes.len() == 1
    }
}
