//! Polygons as triangles.
//!
//! The fan of the first corner is right for every convex polygon, and for all others that can be seen as a whole from
//! there. The rest are cut by ears (G. H. Meisters, *Polygons have ears*, 1975) in the plane of their normal.
//!
//! The cutting is our own. The crate `earcut` leaves out corners that lie on an edge, where the next polygon may
//! have its own: closed surfaces get holes. It also reads through pointers that nothing checks.

use std::collections::VecDeque;

/// Triangles may turn their back by this share of the polygon's area: corners on an edge are never quite on it.
const FLAT: f64 = 1e-6;
/// Corners that are looked at in all polygons of a file: this many, and more for each corner of a polygon.
const MIN_WORK: u64 = 1 << 26;
const WORK_PER_CORNER: u64 = 256;

/// How a polygon is cut.
#[derive(Debug, PartialEq)]
pub(super) enum Cut {
    /// Into the fan of the first corner.
    Fan,
    /// Into these triangles of its corners, two fewer than there are corners.
    Ears(Vec<[u32; 3]>),
    /// Into the fan, triangles of which overlap: the polygon crosses itself, or would take too much work.
    Overlapping,
}

/// Cuts the polygons of a file.
pub(super) struct Cutter {
    work_left: u64,
}

impl Default for Cutter {
    fn default() -> Self {
        Self { work_left: MIN_WORK }
    }
}

impl Cutter {
    /// `corners`: at least four.
    pub fn cut(&mut self, corners: &[[f64; 3]]) -> Cut {
        if fan_fits(corners, 1.0) {
            return Cut::Fan;
        }
        // Squares of squares of lengths may be beyond what a float64 holds.
        let scale = extent(corners).recip();
        if !scale.is_finite() || has_no_area(corners, scale) || fan_fits(corners, scale) {
            return Cut::Fan;
        }
        self.work_left += WORK_PER_CORNER * corners.len() as u64;
        let ears = flattened(corners, scale).and_then(|flat| Ears::new(flat).cut(&mut self.work_left));
        ears.map_or(Cut::Overlapping, Cut::Ears)
    }
}

/// As [`fan_fits`], for what most polygons are.
#[inline]
pub(super) fn quad_fits([a, b, c, d]: [&[f64; 3]; 4]) -> bool {
    let from_first = |p: &[f64; 3]| [0, 1, 2].map(|k| p[k] - a[k]);
    let [b, c, d] = [b, c, d].map(from_first);
    let areas = [cross(b, c), cross(c, d)];
    let normal = [0, 1, 2].map(|k| areas[0][k] + areas[1][k]);
    let square = dot(normal, normal);
    square > 0.0 && areas.iter().all(|&area| dot(area, normal) >= -FLAT * square)
}

/// Half the largest distance of a corner from the first, along an axis.
fn extent(corners: &[[f64; 3]]) -> f64 {
    let half = |c: &[f64; 3]| [0, 1, 2].map(|k| (c[k] / 2.0 - corners[0][k] / 2.0).abs());
    corners.iter().flat_map(half).fold(0.0, f64::max)
}

/// Twice the vector areas of the triangles of the fan, after scaling.
fn fan_areas(corners: &[[f64; 3]], scale: f64) -> impl Iterator<Item = [f64; 3]> {
    let from_first = move |c: &[f64; 3]| [0, 1, 2].map(|k| c[k] * scale - corners[0][k] * scale);
    corners[1..].windows(2).map(move |pair| cross(from_first(&pair[0]), from_first(&pair[1])))
}

/// The normal of M. E. Newell: the vector area, which is that of any cut into triangles.
fn normal(corners: &[[f64; 3]], scale: f64) -> [f64; 3] {
    fan_areas(corners, scale).fold([0.0; 3], |sum, area| [0, 1, 2].map(|k| sum[k] + area[k]))
}

/// Whether all triangles of the fan look to where the polygon does.
fn fan_fits(corners: &[[f64; 3]], scale: f64) -> bool {
    let normal = normal(corners, scale);
    let square = dot(normal, normal);
    square > 0.0 && fan_areas(corners, scale).all(|area| dot(area, normal) >= -FLAT * square)
}

/// Whether all corners are on a line, which no cut makes better.
fn has_no_area(corners: &[[f64; 3]], scale: f64) -> bool {
    fan_areas(corners, scale).all(|area| dot(area, area) < 1e-24)
}

/// The corners in the plane of the normal, counter-clockwise; `None` if there is no normal.
fn flattened(corners: &[[f64; 3]], scale: f64) -> Option<Vec<[f64; 2]>> {
    let normal = normal(corners, scale);
    let length = dot(normal, normal).sqrt();
    if !(length > 0.0 && length.is_finite()) {
        return None;
    }
    let normal = normal.map(|c| c / length);
    // The axis that the normal is furthest away from.
    let smallest = (0..3).min_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs())).unwrap_or(0);
    let axis = std::array::from_fn(|k| if k == smallest { 1.0 } else { 0.0 });
    let u = cross(axis, normal);
    let v = cross(normal, u);
    let in_plane = |c: &[f64; 3]| {
        let c = [0, 1, 2].map(|k| c[k] * scale - corners[0][k] * scale);
        [dot(c, u), dot(c, v)]
    };
    Some(corners.iter().map(in_plane).collect())
}

/// What is left of a polygon in the plane.
struct Ears {
    points: Vec<[f64; 2]>,
    previous: Vec<u32>,
    next: Vec<u32>,
    is_cut: Vec<bool>,
    /// Corners that are not convex, which alone can lie in an ear. Some of them become convex.
    reflex: Vec<u32>,
    /// Doubled areas that are none.
    flat: f64,
}

impl Ears {
    fn new(points: Vec<[f64; 2]>) -> Self {
        let n = points.len() as u32;
        let doubled_area: f64 =
            (1..points.len() - 1).map(|k| area(points[0], points[k], points[k + 1])).sum();
        let mut ears = Self {
            previous: (0..n).map(|k| (k + n - 1) % n).collect(),
            next: (0..n).map(|k| (k + 1) % n).collect(),
            is_cut: vec![false; points.len()],
            reflex: Vec::new(),
            flat: 1e-12 * doubled_area,
            points,
        };
        ears.reflex = (0..n).filter(|&corner| !ears.is_convex(corner)).collect();
        ears
    }

    /// All triangles; `None` if no ear is found, or after too much work.
    fn cut(mut self, work_left: &mut u64) -> Option<Vec<[u32; 3]>> {
        let num_triangles = self.points.len() - 2;
        let mut triangles = Vec::with_capacity(num_triangles);
        let mut waiting: VecDeque<u32> = (0..self.points.len() as u32).collect();
        let mut num_before = 0;
        while triangles.len() < num_triangles {
            let Some(corner) = waiting.pop_front() else {
                // Cutting an ear can make others of its neighbours only, but for rounding.
                if triangles.len() == num_before {
                    return None;
                }
                num_before = triangles.len();
                waiting.extend((0..self.points.len() as u32).filter(|&k| !self.is_cut[k as usize]));
                continue;
            };
            *work_left = work_left.checked_sub(self.reflex.len() as u64 + 1)?;
            if !self.is_cut[corner as usize] && self.is_ear(corner) {
                triangles.push(self.around(corner));
                waiting.extend(self.remove(corner));
            }
        }
        Some(triangles)
    }

    /// A corner between its neighbours.
    fn around(&self, corner: u32) -> [u32; 3] {
        [self.previous[corner as usize], corner, self.next[corner as usize]]
    }

    fn is_convex(&self, corner: u32) -> bool {
        let [a, b, c] = self.around(corner).map(|k| self.points[k as usize]);
        area(a, b, c) > self.flat
    }

    /// Whether the triangle of a corner is a part of the polygon, with nothing in it or at its edges.
    fn is_ear(&self, corner: u32) -> bool {
        let [a, b, c] = self.around(corner).map(|k| self.points[k as usize]);
        let is_in_the_way = |&other: &u32| {
            let p = self.points[other as usize];
            let is_inside = area(a, b, p) >= 0.0 && area(b, c, p) >= 0.0 && area(c, a, p) >= -self.flat;
            // Where a polygon touches itself, corners are at one place.
            is_inside && ![a, b, c].contains(&p) && !self.is_cut[other as usize]
        };
        area(a, b, c) > self.flat && !self.reflex.iter().any(is_in_the_way)
    }

    /// Cuts a corner off; gives its neighbours.
    fn remove(&mut self, corner: u32) -> [u32; 2] {
        let [previous, _, next] = self.around(corner);
        self.is_cut[corner as usize] = true;
        self.next[previous as usize] = next;
        self.previous[next as usize] = previous;
        for neighbour in [previous, next] {
            if self.is_convex(neighbour)
                && let Some(at) = self.reflex.iter().position(|&other| other == neighbour)
            {
                self.reflex.swap_remove(at);
            }
        }
        [previous, next]
    }
}

/// Rewrites what the corners of a fan have, three for each triangle, for other triangles of the same polygon.
pub(super) fn recut(fan: &mut [u32], triangles: &[[u32; 3]]) {
    let last = fan.len() / 3 + 1;
    let of_corner = |k: usize| match k {
        0 => fan[0],
        _ if k == last => fan[3 * (k - 2) + 2],
        _ => fan[3 * (k - 1) + 1],
    };
    let all: Vec<u32> = (0..=last).map(of_corner).collect();
    for (value, &corner) in fan.iter_mut().zip(triangles.as_flattened()) {
        *value = all[corner as usize];
    }
}

/// Twice the area of a triangle, positive counter-clockwise.
fn area(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn in_plane(points: &[[f64; 2]]) -> Vec<[f64; 3]> {
        points.iter().map(|&[x, y]| [x, y, 2.0 * x - 3.0 * y]).collect()
    }

    fn ears(corners: &[[f64; 3]]) -> Vec<[u32; 3]> {
        match Cutter::default().cut(corners) {
            Cut::Ears(triangles) => triangles,
            other => panic!("{other:?}"),
        }
    }

    /// Twice the sum of all areas in the plane of x and y; what overlaps counts several times.
    fn covered(points: &[[f64; 2]], triangles: &[[u32; 3]]) -> f64 {
        triangles.iter().map(|t| t.map(|k| points[k as usize])).map(|[a, b, c]| area(a, b, c).abs()).sum()
    }

    #[test]
    fn what_the_first_corner_sees_is_a_fan() {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let arrow = [[0.0, 0.0], [2.0, 0.0], [1.0, 1.0], [0.0, 2.0]];
        let dart = [[0.0, 0.0], [2.0, -1.0], [4.0, 0.0], [2.0, 4.0]];
        for points in [square, arrow, dart] {
            let [a, b, c, d] = &in_plane(&points)[..] else { panic!() };
            assert!(quad_fits([a, b, c, d]));
            assert_eq!(Cutter::default().cut(&in_plane(&points)), Cut::Fan);
            for factor in [1e-200, 1e200] {
                let scaled = points.map(|point| point.map(|c| c * factor));
                assert_eq!(Cutter::default().cut(&in_plane(&scaled)), Cut::Fan, "{factor}");
            }
        }
        // Bent along the diagonal, as quads of scanned surfaces are.
        assert_eq!(
            Cutter::default().cut(&[[0.0; 3], [1.0, 0.0, 0.9], [1.0, 1.0, 0.0], [0.0, 1.0, 0.9]]),
            Cut::Fan
        );
    }

    #[test]
    fn a_notch_gets_the_other_diagonal() {
        let notch = [[2.0, 0.0], [0.0, 2.0], [0.5, 0.5], [0.0, 0.0]];
        for factor in [1e-200, 1.0, 1e200] {
            let notch = notch.map(|point| point.map(|c| c * factor));
            for start in 0..4 {
                let points: Vec<_> = (0..4).map(|k| notch[(k + start) % 4]).collect();
                let cut = Cutter::default().cut(&in_plane(&points));
                let [a, b, c, d] = &in_plane(&points)[..] else { panic!() };
                // At the other scales a second look is needed.
                assert_eq!(quad_fits([a, b, c, d]), start % 2 == 0 && factor == 1.0);
                if start % 2 == 0 {
                    assert_eq!(cut, Cut::Fan);
                    continue;
                }
                let Cut::Ears(triangles) = cut else { panic!("{cut:?}") };
                let mut used = triangles.concat();
                used.sort_unstable();
                assert_eq!(used, [0, 1, 1, 2, 3, 3]);
            }
        }
    }

    #[test]
    fn combs_are_covered_once_and_keep_corners_on_edges() {
        let mut points = Vec::new();
        for tooth in 0..50 {
            let x = f64::from(tooth);
            points.extend([[x, 0.0], [x + 0.25, 5.0], [x + 0.5, 5.0], [x + 0.75, 0.0]]);
        }
        points.extend((0..=50).rev().map(|k| [f64::from(k), -1.0]));
        points.reverse();
        let doubled: f64 = (1..points.len() - 1).map(|k| area(points[0], points[k], points[k + 1])).sum();
        let triangles = ears(&in_plane(&points));
        assert_eq!(triangles.len(), points.len() - 2);
        assert!((covered(&points, &triangles) - doubled.abs()).abs() < 1e-9);
        let flat = triangles.iter().filter(|t| covered(&points, &[**t]) < 1e-9).count();
        assert_eq!(flat, 0);
    }

    #[test]
    fn a_polygon_around_a_hole_is_covered_once() {
        let points = [
            [0.0, 0.0],
            [4.0, 0.0],
            [4.0, 4.0],
            [0.0, 4.0],
            [0.0, 0.0],
            [1.0, 1.0],
            [1.0, 3.0],
            [3.0, 3.0],
            [3.0, 1.0],
            [1.0, 1.0],
        ];
        let triangles = ears(&in_plane(&points));
        assert_eq!((triangles.len(), covered(&points, &triangles)), (8, 24.0));
    }

    #[test]
    fn what_crosses_itself_or_has_no_area_is_a_fan() {
        let bow_tie = [[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 3.0]];
        assert_eq!(Cutter::default().cut(&in_plane(&bow_tie)), Cut::Overlapping);
        assert_eq!(Cutter::default().cut(&[[1.0; 3]; 5]), Cut::Fan);
        let line: Vec<_> = (0..6).map(|k| [f64::from(k); 3]).collect();
        assert_eq!(Cutter::default().cut(&line), Cut::Fan);
        assert!(!matches!(
            Cutter::default().cut(&[[f64::MAX; 3], [-f64::MAX; 3], [0.0; 3], [1.0; 3]]),
            Cut::Ears(_)
        ));
    }

    #[test]
    fn work_ends() {
        // A spiral of two arms: hardly a corner sees another.
        let turn = |k: u32, r: f64| {
            let angle = f64::from(k) * 0.05;
            [(angle + r) * angle.cos(), (angle + r) * angle.sin()]
        };
        let n = 40_000;
        let points: Vec<_> = (0..n).map(|k| turn(k, 1.0)).chain((0..n).rev().map(|k| turn(k, 3.0))).collect();
        let mut cutter = Cutter::default();
        assert_eq!(cutter.cut(&in_plane(&points)), Cut::Overlapping);
        let notch = [[0.0, 2.0], [0.5, 0.5], [0.0, 0.0], [2.0, 0.0]];
        assert!(matches!(cutter.cut(&in_plane(&notch)), Cut::Ears(_)));
    }

    #[test]
    fn values_of_corners_follow_them() {
        let mut fan = [10, 11, 12, 10, 12, 13, 10, 13, 14];
        recut(&mut fan, &[[1, 2, 3], [1, 3, 4], [4, 0, 1]]);
        assert_eq!(fan, [11, 12, 13, 11, 13, 14, 14, 10, 11]);
    }
}
