//! What is learnt about patches, and how many contexts there are.

use super::polygon::FITS;
use crate::entropy::context_mixer::{MixedBit, Mixing, PlainBits};

/// Adaptive models, kept from level to level.
#[derive(Clone)]
pub(crate) struct ConnectivityModels {
    pub(super) in_patch: MixedBit<6>,
    pub(super) grow: MixedBit<6>,
    pub(super) ear: PlainBits,
    pub(super) open: PlainBits,
}

const LIMIT: u32 = 30;
/// Longest patch that contexts tell apart.
pub(super) const MAX_SIZE: usize = 6;
/// Sizes of a patch, and whether it and the larger one fit the rule.
const STATES: usize = MAX_SIZE * FITS * FITS;
const GROW_SETS: usize = 2 * STATES;

impl ConnectivityModels {
    pub(crate) fn new(mixing: Mixing) -> Self {
        Self {
            in_patch: MixedBit::new(
                mixing,
                [FITS * FITS * 12, FITS * FITS * 8, 27 * 512, 512 * 3, 64 * 12, 16 * 8 * 16],
                8,
                0.0,
                LIMIT,
            ),
            grow: MixedBit::new(
                mixing,
                [
                    STATES * FITS * 4,
                    STATES * FITS * 8,
                    STATES * 64 * 4,
                    STATES * 64 * 4,
                    STATES * 64,
                    MAX_SIZE * 32 * 16,
                ],
                GROW_SETS,
                0.0,
                LIMIT,
            ),
            ear: PlainBits::new(3),
            open: PlainBits::new(1),
        }
    }
}
