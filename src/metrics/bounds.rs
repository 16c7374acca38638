//! The box around points.

use glam::DVec3;

/// The least and the greatest coordinates of some points.
pub(super) fn bounds(points: impl Iterator<Item = DVec3>) -> (DVec3, DVec3) {
    let none = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    points.fold(none, |(low, high), p| (low.min(p), high.max(p)))
}
