//! Triangle meshes on flat arrays.

mod attribute;
mod build;
mod corners_at;
pub(crate) mod ears;
#[cfg(any(feature = "encoder", feature = "io"))]
pub(crate) mod edge_lengths;
#[cfg(feature = "encoder")]
pub(crate) mod repair;
mod scene;
#[cfg(any(feature = "io", feature = "render"))]
pub(crate) mod srgb;
pub(crate) mod surface;
mod tri_mesh;
#[cfg(any(feature = "encoder", feature = "metrics"))]
pub(crate) mod triangle;

pub use attribute::{
    Attribute, AttributeError, Attributes, ComponentType, Domain, GltfMaterials, MAX_COMPONENTS, NO_ENTRY,
    Semantic, Values,
};
pub(crate) use corners_at::CornersAt;
pub use scene::{IDENTITY, Instance, SceneTable};
pub(crate) use surface::Surface;
pub(crate) use tri_mesh::has_three_vertices;
pub use tri_mesh::{MeshError, TriMesh};
