//! Mesh files: OBJ, PLY, STL, glTF (feature `gltf`) and terrain in LAS and LAZ (feature `las`), each also
//! compressed with zstd (`.zst`) or gzip (`.gz`).
//!
//! The file formats stay at the edge of the crate: a file becomes a [`TriMesh`](crate::TriMesh), its
//! [`Attributes`](crate::mesh::Attributes) and a
//! [`ReadReport`], these become a file, and nothing else knows that files exist.
//!
//! Input is not trusted. No input makes a reader panic, and counts declared in a file never decide how much
//! is allocated: memory grows as the data that fills it is found, to a small multiple of the file's size. A `.zst` or `.gz` file
//! that unpacks out of all proportion is refused ([`ReadOptions`]), and OBJ, PLY and STL are unpacked in pieces.
//!
//! ```no_run
//! let file = lwc::io::read("horse.ply.zst")?;
//! println!("{} vertices, {:?}", file.mesh.num_vertices(), file.report);
//! lwc::io::write("horse.obj", &file.mesh)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod atomic;
// Without glTF there is no place for what a model names.
#[cfg_attr(not(feature = "gltf"), allow(dead_code))]
mod beside;
mod builder;
#[cfg(feature = "gltf")]
mod common_type;
mod convert;
mod counter;
mod error;
mod foreign;
mod format;
#[cfg(feature = "gltf")]
mod gltf;
mod gzip;
#[cfg(feature = "las")]
mod las;
#[cfg(feature = "gltf")]
mod materials;
mod mesh_file;
mod obj;
mod plan;
mod ply;
mod polygon;
mod read;
mod read_losses;
#[cfg(feature = "gltf")]
mod scene;
mod source;
mod stl;
mod text;
mod unpack;
mod write;
mod write_options;

#[cfg(feature = "gltf")]
pub use crate::mesh::Instance;
pub use atomic::{abandon_writes, write_atomic};
pub use error::{Place, ReadError, WriteError};
pub use format::Format;
#[cfg(feature = "las")]
pub use las::TerrainOptions;
pub use mesh_file::{MeshFile, ReadReport};
#[cfg(feature = "gltf")]
pub use read::read_scene;
pub use read::{read, read_bytes};
#[cfg(feature = "las")]
pub use read::{read_terrain, read_terrain_bytes};
#[cfg(feature = "gltf")]
pub use scene::{SCENE_MESH, Scene};
pub use unpack::{MAX_FILE_BYTES, ReadOptions};
pub use write::{write, write_ply_coloured, write_to, write_with_attributes, write_with_attributes_to};
#[cfg(feature = "gltf")]
pub use write::{write_scene, write_scene_to};
pub use write_options::{ColorSpace, ColorType, PositionType, STEP_SHARE, UpAxis, WriteOptions};
