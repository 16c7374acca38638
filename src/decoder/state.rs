//! What there is between two passes.

use crate::bitstream::profile::Profile;
use crate::entropy::context_mixer::Mixing;
use crate::passes::GridMesh;
use crate::passes::connectivity::ConnectivityModels;
use crate::passes::coordinates::CoordinateModels;
use crate::passes::refine::RefineModels;

/// The mesh and all that is learnt about it.
#[derive(Clone)]
pub(super) struct PassDecoder {
    pub(super) mesh: GridMesh,
    /// Made by the first pass, which has been checked against the limits then.
    pub(super) models: Option<Models>,
    pub(super) profile: Profile,
}

/// Adaptive models of splits and refinements.
#[derive(Clone)]
pub(super) struct Models {
    pub(super) connectivity: ConnectivityModels,
    pub(super) coordinates: CoordinateModels,
    pub(super) refine: RefineModels,
}

impl Models {
    pub(super) fn new(mixing: Mixing) -> Self {
        Self {
            connectivity: ConnectivityModels::new(mixing),
            coordinates: CoordinateModels::new(mixing),
            refine: RefineModels::new(mixing),
        }
    }
}
