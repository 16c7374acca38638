//! From bytes to meshes, coarse to fine.

pub(crate) mod assemble;
mod attributes;
mod built_with;
pub(crate) mod environment;
pub(crate) mod forecast;
mod frame;
mod head;
mod info;
mod level_mesh;
mod passes;
mod push;
mod refused;
mod running;
mod state;

pub use frame::{AttributeInfo, PassInfo, PassKind, StreamInfo, TrailingInfo, TrailingKind};
pub use level_mesh::{LevelMesh, PositionUpdater};
pub use push::{DecodeOptions, Decoder, Step, Update, decode};
