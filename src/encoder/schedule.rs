//! Which pass comes when, and with how many bits.

use super::coarsen::Hierarchy;

/// One pass of the plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// Brings back the record of this index.
    Split(usize),
    Refine,
}

/// Order of the passes after the base mesh.
pub(super) struct Schedule {
    pub(super) base_bits: u32,
    pub(super) steps: Vec<Step>,
}

/// A bit then buys about as much in a refinement as in a split: a split costs some 5 bits per vertex
/// there is and takes 2 dB off the error, a refinement 2 bits and takes 6 dB off that of rounding.
const ROUNDING_SHARE: f64 = 0.25;

/// Each split comes with the precision its level needs; what is missing then follows the last split.
/// Without a split there is nothing to come later for.
///
/// With `steps_per_edge` a level needs as many bits as make its mean edge that many grid steps long.
/// Else it needs as many as keep the error of rounding (a twelfth of the squared step) below
/// [`ROUNDING_SHARE`] of that of the level's shape.
pub(super) fn plan(hierarchy: &Hierarchy, quantization_bits: u32, steps_per_edge: Option<f64>) -> Schedule {
    let needed = |level: usize| {
        let hidden = match steps_per_edge {
            Some(steps) => libm::log2((hierarchy.mean_edges[level] / steps).max(1.0)),
            None => 0.5 * libm::log2((12.0 * ROUNDING_SHARE * hierarchy.errors[level]).max(1.0)),
        };
        quantization_bits.saturating_sub(hidden as u32).max(1)
    };
    let num_levels = hierarchy.records.len();
    let base_bits = if num_levels > 0 { needed(0) } else { quantization_bits };
    let mut current = base_bits;
    let mut steps = Vec::new();
    for level in 1..=num_levels {
        while current < needed(level) {
            steps.push(Step::Refine);
            current += 1;
        }
        steps.push(Step::Split(num_levels - level));
    }
    steps.extend((current..quantization_bits).map(|_| Step::Refine));
    Schedule { base_bits, steps }
}
