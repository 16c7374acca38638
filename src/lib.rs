//! Progressive codec for triangle meshes.
#![cfg_attr(docsrs, feature(doc_cfg))]

#[cfg(feature = "encoder")]
pub mod descriptors;
#[cfg(feature = "io")]
pub mod io;
pub mod mesh;
#[cfg(feature = "metrics")]
pub mod metrics;

pub use mesh::{MeshError, TriMesh};
