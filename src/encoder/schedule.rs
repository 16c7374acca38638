//! Which pass comes when, and with how many bits.

use super::analysis::Hierarchy;

/// One pass of the plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// Brings back the record of this index.
    Split(usize),
    Refine,
}

/// Order of the passes after the base mesh.
pub(super) struct Schedule {
    pub(super) base_precision: u32,
    pub(super) steps: Vec<Step>,
}

/// Each split comes with as many bits as make its mean edge `steps_per_edge` grid steps long; what
/// is missing then follows the last split. Without a split there is nothing to come later for.
pub(super) fn plan(hierarchy: &Hierarchy, precision: u32, steps_per_edge: f64) -> Schedule {
    let needed = |mean_edge: f64| {
        let hidden = (mean_edge / steps_per_edge).max(1.0).log2().floor();
        precision.saturating_sub(hidden as u32).max(1)
    };
    let has_splits = !hierarchy.records.is_empty();
    let base_precision = if has_splits { needed(hierarchy.mean_edges[0]) } else { precision };
    let mut current = base_precision;
    let mut steps = Vec::new();
    for (level, &mean_edge) in hierarchy.mean_edges.iter().enumerate().skip(1) {
        while current < needed(mean_edge) {
            steps.push(Step::Refine);
            current += 1;
        }
        steps.push(Step::Split(hierarchy.records.len() - level));
    }
    steps.extend((current..precision).map(|_| Step::Refine));
    Schedule { base_precision, steps }
}
