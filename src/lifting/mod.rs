//! Prediction of a vertex from its neighbours: kernels that encoder and decoder share
//! (`format/SPEC.md`, section 8). Basic arithmetic in a fixed order only.

pub(crate) mod affine;
pub(crate) mod consensus;
pub(crate) mod filter;
pub(crate) mod neighbourhood;
pub(crate) mod plane_fit;
