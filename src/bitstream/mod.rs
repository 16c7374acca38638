//! Bytes, chunks, and the entropy coder. Knows no mesh.

pub(crate) mod bits;
pub(crate) mod budget;
pub(crate) mod bytes;
pub(crate) mod chunk;
pub(crate) mod chunk_index;
pub(crate) mod compensation;
pub(crate) mod header;
pub(crate) mod mixer;
pub(crate) mod mixture;
pub(crate) mod pass_table;
pub(crate) mod profile;
pub(crate) mod range_coder;
pub(crate) mod residual;
pub(crate) mod scene;
mod specialists;
pub(crate) mod streams;
pub(crate) mod tables;
