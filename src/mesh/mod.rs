//! Triangle meshes on flat arrays.

mod tri_mesh;

pub use tri_mesh::{MeshError, TriMesh};
