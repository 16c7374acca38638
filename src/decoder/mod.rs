//! From bytes to meshes, coarse to fine.

pub(crate) mod assemble;
mod attributes;
mod built_with;
pub(crate) mod environment;
pub(crate) mod forecast;
mod frame;
mod head;
mod level_mesh;
mod losses;
mod options;
mod passes;
mod push;
mod refused;
mod running;
mod snapshot;
mod state;
mod stream;
mod stream_info;
mod update;

pub use level_mesh::{LevelMesh, PositionUpdater};
pub use options::DecodeOptions;
pub use push::{Decoder, decode};
pub use stream_info::{AttributeInfo, PassInfo, PassKind, StreamInfo, TrailingInfo, TrailingKind};
pub use update::{Step, Update};
