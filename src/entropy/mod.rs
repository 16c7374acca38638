//! Coders of bits and symbols, and the models that say how likely they are (`format/SPEC.md`, section 6). Knows no
//! mesh and no chunks.

pub(crate) mod ans;
pub(crate) mod bits;
pub(crate) mod context_mixer;
mod counter;
pub(crate) mod mixture;
pub(crate) mod numbers;
pub(crate) mod range_coder;
pub(crate) mod residual;
mod specialists;
pub(crate) mod streams;
pub(crate) mod tables;
mod weights;
