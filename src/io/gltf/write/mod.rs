//! Writing glTF 2.0: one primitive for each material of a mesh, one buffer.

mod buffer;
mod columns;
mod container;
mod document;
mod nodes;
mod origin;
mod primitives;
mod trs;

pub(in crate::io) use container::Container;
pub(in crate::io) use document::Plan;
