//! Prediction of a vertex from its neighbours: kernels that encoder and decoder share
//! (`format/SPEC.md`, section 8). Basic arithmetic in a fixed order only.

pub(crate) mod plane_fit;
pub(crate) mod ring_context;
pub(crate) mod rls;
pub(crate) mod rls_affine;
pub(crate) mod robust_estimate;
