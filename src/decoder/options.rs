//! What the caller of a decoder may choose.

use super::stream_info::{PassInfo, PassKind};
use crate::bitstream::compensation::Compensation;
use crate::limits::Limits;

/// How to decode.
#[derive(Clone, Copy, Debug, Default)]
pub struct DecodeOptions {
    level: Option<u32>,
    no_shrinkage_compensation: bool,
    pub(super) limits: Limits,
}

impl DecodeOptions {
    /// All levels, default limits.
    pub fn new() -> Self {
        Self::default()
    }

    /// Stops at M^`level`, with the precision it has when the next split begins. 0 is the base mesh; a
    /// level beyond the finest is the finest.
    pub fn level(mut self, level: u32) -> Self {
        self.level = Some(level);
        self
    }

    /// Whether coarse meshes are shown with their vertices a little off their places, so that they shrink less. Default
    /// true: closer to the surface by half a dB to one and a half on scans. Without it the vertices of each level are
    /// some of those of the finest.
    pub fn shrinkage_compensation(mut self, is_wanted: bool) -> Self {
        self.no_shrinkage_compensation = !is_wanted;
        self
    }

    /// Sets the limits.
    pub fn limits(mut self, limits: Limits) -> Self {
        self.limits = limits;
        self
    }

    /// Whether a pass is beyond the level that is wanted.
    pub(super) fn is_beyond(&self, pass: &PassInfo) -> bool {
        pass.kind == PassKind::Split && self.level.is_some_and(|level| pass.level > level)
    }

    /// How the mesh is shown after a pass.
    pub(super) fn compensation_after(&self, pass: &PassInfo) -> Compensation {
        if self.no_shrinkage_compensation { Compensation::NONE } else { pass.compensation }
    }
}
