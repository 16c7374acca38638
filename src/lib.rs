//! Progressive codec for triangle meshes: one small stream that can be cut anywhere.
//!
//! The first part of a stream is a coarse mesh, each further byte refines it, and the last byte restores every vertex of
//! the quantized mesh and every triangle exactly. The levels follow *Lazy Wavelet Simplification using Scale-dependent
//! Dense Geometric Variability Descriptors*: a descriptor ranks the vertices, the least salient ones are removed level by
//! level, and what restores them is predicted from their neighbours and entropy coded.
//!
//! # Encode a mesh, decode a level
//!
//! ```
//! # #[cfg(feature = "encoder")] {
//! use lwc::{DecodeOptions, EncodeOptions, TriMesh};
//!
//! # let n = 33;
//! # let height = |x: f64, y: f64| (0.3 * x).sin() * (0.2 * y).cos();
//! # let vertex = |i: u32| (f64::from(i % n), f64::from(i / n));
//! # let positions = (0..n * n).map(vertex).map(|(x, y)| [x, y, height(x, y)]).collect();
//! # let squares = (0..n * n).filter(|v| v % n + 1 < n && v / n + 1 < n);
//! # let triangles = squares.flat_map(|v| [[v, v + 1, v + n], [v + 1, v + n + 1, v + n]]).collect();
//! // A terrain. positions: Vec<[f64; 3]> in model units; triangles: Vec<[u32; 3]>, counter-clockwise.
//! let mesh = TriMesh::new(positions, triangles)?;
//!
//! let mut options = EncodeOptions::default();
//! options.quantization_bits = 14;
//! let encoded = lwc::encode(&mesh, &options)?;
//!
//! let base = lwc::decode(&encoded.bytes, DecodeOptions::new().level(0))?;
//! let finest = lwc::decode(&encoded.bytes, DecodeOptions::new())?;
//! assert!(base.num_vertices() < 100);
//! assert_eq!((finest.num_vertices(), finest.num_triangles()), (1089, 2048));
//! # }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Refine a mesh while its bytes arrive
//!
//! A stream that ends early is a coarser mesh. A damaged one is an error, and the last complete mesh stays available.
//!
//! ```
//! use lwc::{Decoder, Limits};
//!
//! # let stream = include_bytes!("../format/golden/torus.lwc");
//! let mut decoder = Decoder::new(Limits::default()); // bounds what an untrusted stream may ask for
//! for piece in stream.chunks(500) {
//!     for update in decoder.push(piece)? {
//!         // Upload these vertices and triangles again; all others are as they were.
//!         println!("vertices {:?}, triangles {:?}", update.vertices, update.new_triangles);
//!     }
//!     if let Some(mesh) = decoder.mesh() {
//!         println!("{} triangles of level {}", mesh.num_triangles(), mesh.level());
//!     }
//! }
//! assert!(decoder.is_complete());
//! # Ok::<(), lwc::DecodeError>(())
//! ```
//!
//! # Where to go on
//!
//! - [`encode_with_attributes`] takes normals, texture coordinates, colours and other [attributes](mesh::Attribute) too;
//!   [`Decoder::to_tri_mesh_with_attributes`] gives them back.
//! - [`io`] reads and writes OBJ, PLY, STL and glTF, and reads LAS and LAZ.
//! - [`descriptors`] has the seven descriptors, [`multiresolution`] filters, denoises and edits by levels, [`metrics`]
//!   measures distances, [`render`] draws.
//! - Without default features the crate is the decoder of the surface alone. The feature `assets` adds attributes, scenes,
//!   stitching, exact values and order; `fast` the profile fast; `encoder`, `io`, `gltf`, `las`, `metrics`, `render` and
//!   `experiment` what their names say.
//! - The format is described in `format/SPEC.md`, the code in `docs/architecture.md`.
#![cfg_attr(docsrs, feature(doc_cfg))]

// Streams decode to the same bits everywhere because each operation on floats rounds once, to the size of its type.
#[cfg(all(target_arch = "x86", not(target_feature = "sse2")))]
compile_error!(
    "lwc needs SSE2 on 32-bit x86 (target i686, not i586): x87 registers keep more bits than f32 and f64 have, so that \
     streams would decode to other meshes than they were made of"
);

mod bitstream;
mod decoder;
#[cfg(feature = "encoder")]
pub mod descriptors;
#[cfg(feature = "encoder")]
mod encoder;
mod entropy;
mod error;
#[cfg(feature = "experiment")]
pub mod experiment;
#[cfg(feature = "fuzzing")]
#[doc(hidden)]
pub mod fuzzing;
#[cfg(feature = "io")]
pub mod io;
mod limits;
pub mod losses;
pub mod mesh;
#[cfg(feature = "metrics")]
pub mod metrics;
#[cfg(feature = "encoder")]
pub mod multiresolution;
mod prediction;
#[cfg(feature = "encoder")]
mod simplification;
mod util;

mod passes;
#[cfg(feature = "render")]
pub mod render;

pub use bitstream::grid::Lattice;
pub use bitstream::profile::Profile;
pub use decoder::{
    AttributeInfo, DecodeOptions, Decoder, LevelMesh, PassInfo, PassKind, PositionUpdater, Step, StreamInfo,
    TrailingInfo, TrailingKind, Update, decode,
};
#[cfg(feature = "encoder")]
pub use encoder::{
    EncodeOptions, Encoded, GridChoice, GridError, Progress, Remedy, encode, encode_with_attributes,
    encode_with_progress,
};
pub use error::DecodeError;
#[cfg(feature = "encoder")]
pub use error::EncodeError;
pub use limits::Limits;
#[cfg(feature = "encoder")]
pub use mesh::repair::RepairReport;
pub use mesh::{MeshError, TriMesh};
#[cfg(feature = "encoder")]
pub use simplification::partition::Partition;
#[cfg(feature = "encoder")]
pub use simplification::vertex_selection::Optimize;
