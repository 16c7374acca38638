//! Where the odd vertices of a level go (`format/SPEC.md`, section 7.2): the faces of the coarse
//! mesh are walked from gate to gate and grouped into patches.
//!
//! [`walk`] visits the gates and codes what is decided there. [`regions`] has the faces and vertices as decided so far,
//! [`growth`] the patch that grows now, [`contexts`] what is known before each decision, [`models`] what is learnt.

mod contexts;
mod growth;
mod models;
mod polygon;
mod regions;
mod walk;

use std::collections::HashMap;

pub(crate) use models::ConnectivityModels;
pub(crate) use walk::PausedWalk;
#[cfg(any(feature = "encoder", test))]
pub(crate) use walk::code;

/// What the encoder wants written, in the numbering of the coarse mesh.
#[derive(Default)]
pub(crate) struct ConnectivityTarget {
    /// Patch that a face belongs to, or [`NOT_IN_PATCH`].
    pub(crate) patch_of_face: Vec<u32>,
    /// Patch whose hole opens over the boundary edge that a corner faces.
    pub(crate) patch_open_at: HashMap<u32, u32>,
    /// Ear along the boundary edge that a corner faces.
    pub(crate) ear_at: HashMap<u32, u32>,
}

/// Mark of a face that belongs to no patch.
pub(crate) const NOT_IN_PATCH: u32 = u32::MAX;
