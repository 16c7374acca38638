//! Which pass comes when, and with how many bits.

use super::coarsen::Hierarchy;
use super::options::EncodeOptions;

/// The quantization bits of each pass. Splits bring back the records of the hierarchy, coarsest first.
pub(super) struct Schedule {
    pub(super) base_bits: u32,
    /// Number of refinements after the base mesh, then after each split.
    pub(super) refinements: Vec<u32>,
}

/// A bit then buys about as much in a refinement as in a split: a split costs some 5 bits per vertex
/// there is and takes 2 dB off the error, a refinement 2 bits and takes 6 dB off that of rounding.
const ROUNDING_SHARE: f64 = 0.25;

/// The schedules of a hierarchy that the options try. Without a split there is one only.
pub(super) fn tried(
    hierarchy: &Hierarchy,
    options: &EncodeOptions,
    quantization_bits: u32,
) -> impl Iterator<Item = Schedule> {
    let most = if hierarchy.records.is_empty() { 1 } else { usize::MAX };
    let tried = options.steps_tried().into_iter().take(most);
    tried.map(move |steps| plan(hierarchy, quantization_bits, steps))
}

/// Each split comes with the bits its level needs; what is missing then follows the last split.
/// Without a split all bits are in the base mesh.
///
/// With `steps_per_edge` a level needs as many bits as make its mean edge that many grid steps long.
/// Else it needs as many as keep the error of rounding (a twelfth of the squared step, the largest one) below
/// [`ROUNDING_SHARE`] of that of the level's shape.
fn plan(hierarchy: &Hierarchy, quantization_bits: u32, steps_per_edge: Option<f64>) -> Schedule {
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
    let refinements_after = |level: usize| {
        let wanted = if level < num_levels { needed(level + 1) } else { quantization_bits };
        let before = current;
        current = current.max(wanted);
        current - before
    };
    let refinements = (0..=num_levels).map(refinements_after).collect();
    Schedule { base_bits, refinements }
}
