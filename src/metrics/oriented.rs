//! Boxes turned as the triangles within: long thin ones that lie across the axes, and large ones side by side as the leaves
//! of a book, fill little of a box along the axes (Gottschalk, Lin and Manocha, *OBBTree*, 1996).

use super::bounds::bounds;
use glam::{DMat3, DVec3};

/// Coordinates are at most 2: rounding moves a turned one by less.
const SLACK: f64 = 1e-14;

/// A turned box must have at most this share of the other's volume, both thickened by this share of the longest side.
const WORTHWHILE: f64 = 0.5;
const THICKNESS: f64 = 1e-3;

/// Triangles whose boxes have together less than this many times the surface of the box around them lie side by side.
const CROWDED: f64 = 3.0;

/// The box of the points whose coordinates along three axes are within limits.
#[derive(Clone, Copy)]
pub(super) struct OrientedBox {
    /// From the coordinates of points to those along the axes.
    turn: DMat3,
    low: DVec3,
    high: DVec3,
}

impl OrientedBox {
    /// Around `triangles`, if that is worth while where the box from `low` to `high` is around them, too.
    pub fn around(triangles: &[[DVec3; 3]], low: DVec3, high: DVec3) -> Option<Self> {
        let surface_of = |t: &[DVec3; 3]| surface(t[0].max(t[1]).max(t[2]) - t[0].min(t[1]).min(t[2]));
        let all: f64 = triangles.iter().map(surface_of).sum();
        if all < CROWDED * surface(high - low) {
            return None;
        }
        let turned = Self::along(turn_of(&triangles[triangles.len() / 2])?, triangles);
        let thickness = THICKNESS * (high - low).max_element();
        let volume = |extent: DVec3| (extent + thickness).element_product();
        (volume(turned.high - turned.low) <= WORTHWHILE * volume(high - low)).then_some(turned)
    }

    fn along(turn: DMat3, triangles: &[[DVec3; 3]]) -> Self {
        let (low, high) = bounds(triangles.as_flattened().iter().map(|&p| turn * p));
        Self { turn, low: low - SLACK, high: high + SLACK }
    }

    /// At most the squared distance of `point` from anything within.
    pub fn squared_distance(&self, point: DVec3) -> f64 {
        let turned = self.turn * point;
        (self.low - turned).max(turned - self.high).max(DVec3::ZERO).length_squared()
    }
}

/// Half of the surface of a box.
fn surface(extent: DVec3) -> f64 {
    extent.x * extent.y + extent.y * extent.z + extent.z * extent.x
}

/// The first axis is the longest edge, the last one the normal.
fn turn_of(&[a, b, c]: &[DVec3; 3]) -> Option<DMat3> {
    let edges = [b - a, c - b, a - c];
    let longest = edges.into_iter().max_by(|e, f| e.length_squared().total_cmp(&f.length_squared()))?;
    let along = longest.try_normalize()?;
    let cross = (b - a).cross(c - a);
    let normal = (cross - along * along.dot(cross)).try_normalize().unwrap_or(along.any_orthonormal_vector());
    Some(DMat3::from_cols(along, normal.cross(along), normal).transpose())
}

#[cfg(test)]
mod tests {
    use super::super::nearest::tests::points;
    use super::*;
    use crate::mesh::triangle::squared_distance;

    #[test]
    fn leaves_of_a_book_and_needles_are_worth_a_turned_box_and_a_patch_is_not() {
        let leaf = |k: i32| {
            let (sin, cos) = (0.7 + 1e-3 * f64::from(k)).sin_cos();
            [DVec3::ZERO, DVec3::Z, DVec3::new(cos, sin, 0.5)]
        };
        let needle =
            |k: i32| [DVec3::ZERO, DVec3::new(1.0, 1.0, 1e-3 * f64::from(k)), DVec3::new(1.0, 1.001, 0.5)];
        let patch = |k: i32| {
            let corner = DVec3::new(f64::from(k % 2), f64::from(k / 2), 0.0);
            [corner, corner + DVec3::X, corner + DVec3::Y]
        };
        let is_worthwhile = |shape: &dyn Fn(i32) -> [DVec3; 3]| {
            let triangles: Vec<_> = (0..4).map(shape).collect();
            let (low, high) = bounds(triangles.as_flattened().iter().copied());
            OrientedBox::around(&triangles, low, high).is_some()
        };
        assert!(is_worthwhile(&leaf));
        assert!(is_worthwhile(&needle));
        assert!(!is_worthwhile(&patch));
    }

    #[test]
    fn nothing_within_is_nearer_than_the_box() {
        let corners = points(300);
        let triangles = corners.as_chunks::<3>().0;
        for group in triangles.chunks(5) {
            let turn = turn_of(&group[2]).unwrap();
            let turned = OrientedBox::along(turn, group);
            for point in points(50).into_iter().map(|p| 2.0 * p - 0.5) {
                let nearest = group.iter().map(|t| squared_distance(point, t)).fold(f64::INFINITY, f64::min);
                assert!(turned.squared_distance(point) <= nearest);
            }
        }
        assert!(turn_of(&[DVec3::ONE; 3]).is_none());
        assert!(turn_of(&[DVec3::ONE, DVec3::ZERO, DVec3::ZERO]).unwrap().is_finite());
    }
}
