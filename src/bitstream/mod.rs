//! What a stream is made of: chunks, headers, the table of passes (`format/SPEC.md`, sections 3 and 4). Of meshes it
//! knows scenes, materials and metadata only.

pub(crate) mod chunk;
pub(crate) mod chunk_index;
pub(crate) mod compensation;
pub(crate) mod grid;
pub(crate) mod header;
pub(crate) mod metadata;
pub(crate) mod pass_table;
pub(crate) mod profile;
pub(crate) mod scene;
