//! Progressive codec for triangle meshes.
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

pub use bitstream::profile::Profile;
pub use decoder::{
    AttributeInfo, DecodeOptions, Decoder, LevelMesh, PassInfo, PassKind, PositionUpdater, Step, StreamInfo,
    TrailingInfo, TrailingKind, Update, decode,
};
#[cfg(feature = "encoder")]
pub use encoder::{EncodeOptions, Encoded, Progress, encode, encode_with_attributes, encode_with_progress};
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
