//! From bytes to meshes, coarse to fine.

pub(crate) mod assemble;
mod attributes;
mod frame;
mod level_mesh;
mod passes;
mod push;
mod running;

pub use frame::{AttributeInfo, PassInfo, PassKind, StreamInfo, TrailingInfo, TrailingKind};
pub use level_mesh::{LevelMesh, Placing};
pub use push::{DecodeOptions, Decoder, Step, Update, decode};
