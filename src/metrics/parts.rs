//! Triangles in parts: the box around a long thin one is mostly empty, and fifty thousand that meet in one vertex would all
//! have to be looked at from everywhere.

use glam::DVec3;

/// The longest edge of a part, in square roots of the area of its triangle: those up to about eight times as long as wide stay
/// whole.
const LONGEST: f64 = 4.0;

/// Parts of one triangle, and of all on average.
const MAX_PARTS: usize = 64;
const MAX_MEAN_PARTS: usize = 8;

/// The box of a part of a triangle.
#[derive(Clone, Copy)]
pub(super) struct Part {
    pub low: DVec3,
    pub high: DVec3,
    pub triangle: u32,
}

impl Part {
    fn around(points: &[DVec3], triangle: u32) -> Self {
        let low = points.iter().fold(DVec3::INFINITY, |low, &p| low.min(p));
        let high = points.iter().fold(DVec3::NEG_INFINITY, |high, &p| high.max(p));
        Self { low, high, triangle }
    }
}

/// All triangles, long ones cut across until their parts are not long or there are too many.
pub(super) fn split(triangles: &[[DVec3; 3]]) -> Vec<Part> {
    let wanted: Vec<usize> = triangles.iter().map(num_parts_of).collect();
    let num_parts = |most: usize| wanted.iter().map(|&wanted| wanted.min(most)).sum::<usize>();
    let is_affordable = |&most: &usize| num_parts(most) <= MAX_MEAN_PARTS * triangles.len();
    let most = (1..=MAX_PARTS).rev().find(is_affordable).unwrap_or(1);
    let mut parts = Vec::with_capacity(num_parts(most));
    for ((corners, &wanted), triangle) in triangles.iter().zip(&wanted).zip(0..) {
        cut(corners, triangle, wanted.min(most), &mut parts);
    }
    parts
}

/// How many parts a triangle is to have.
fn num_parts_of(&[a, b, c]: &[DVec3; 3]) -> usize {
    let longest = (b - a).length().max((c - b).length()).max((a - c).length());
    let size = LONGEST * (0.5 * (b - a).cross(c - a).length()).sqrt();
    if longest <= size { 1 } else { (longest / size).ceil().min(MAX_PARTS as f64) as usize }
}

/// Cuts a triangle across its longest edge into parts of equal length.
fn cut(corners: &[DVec3; 3], triangle: u32, count: usize, parts: &mut Vec<Part>) {
    if count == 1 {
        parts.push(Part::around(corners, triangle));
        return;
    }
    let [a, b, c] = longest_first(*corners);
    let along = (c - a).dot(b - a) / (b - a).length_squared();
    let along = along.clamp(0.0, 1.0);
    // Where a cut meets the two other edges.
    let across = |t: f64| {
        if t <= along && along > 0.0 {
            a + (c - a) * (t / along)
        } else {
            b + (c - b) * ((1.0 - t) / (1.0 - along))
        }
    };
    // Rounding moves each of these by less.
    let slack = DVec3::splat(16.0 * f64::EPSILON * a.abs().max(b.abs()).max(c.abs()).max_element());
    for k in 0..count {
        let [from, to] = [k, k + 1].map(|k| k as f64 / count as f64);
        let mut points = vec![a + (b - a) * from, a + (b - a) * to, across(from), across(to)];
        if (from..=to).contains(&along) {
            points.push(c);
        }
        let Part { low, high, .. } = Part::around(&points, triangle);
        parts.push(Part { low: low - slack, high: high + slack, triangle });
    }
}

/// The corners, the longest edge between the first two.
fn longest_first([a, b, c]: [DVec3; 3]) -> [DVec3; 3] {
    match [(b - a).length_squared(), (c - b).length_squared(), (a - c).length_squared()] {
        [ab, bc, ca] if ab >= bc && ab >= ca => [a, b, c],
        [_, bc, ca] if bc >= ca => [b, c, a],
        _ => [c, a, b],
    }
}

/// The triangle of each part, and the triangles, in the order in which the parts name them first.
pub(super) fn renumbered(parts: &[Part], triangles: &[[DVec3; 3]]) -> (Vec<u32>, Vec<[DVec3; 3]>) {
    let mut number = vec![u32::MAX; triangles.len()];
    let mut ordered = Vec::with_capacity(triangles.len());
    let mut name = |part: &Part| {
        let number = &mut number[part.triangle as usize];
        if *number == u32::MAX {
            *number = ordered.len() as u32;
            ordered.push(triangles[part.triangle as usize]);
        }
        *number
    };
    (parts.iter().map(&mut name).collect(), ordered)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_triangles_come_in_parts_and_others_whole() {
        let [origin, x, y] = [DVec3::ZERO, DVec3::X, DVec3::Y];
        assert_eq!(split(&[[origin, x, y], [origin; 3], [origin, 7.0 * x, y]]).len(), 3);
        let needle = |k: i32| [x + 1e-4 * f64::from(k) * y, origin, x + 1e-4 * f64::from(k + 1) * y];
        let needles: Vec<_> = (0..100).map(needle).collect();
        let parts = split(&needles);
        assert_eq!(parts.len(), 800);
        assert!(parts.iter().all(|part| (part.high - part.low).x < 0.126));
        let (of, ordered) = renumbered(&parts, &needles);
        assert_eq!((of.len(), ordered.len()), (800, 100));
        // A few among many may have more parts.
        let mut mixed = vec![[origin, x, y]; 1000];
        mixed.push([origin, x, x]);
        assert_eq!(split(&mixed).len(), 1000 + MAX_PARTS);
    }

    #[test]
    fn every_point_of_a_triangle_is_in_the_box_of_a_part() {
        let points = super::super::nearest::tests::points(300);
        for corners in points.as_chunks::<3>().0 {
            let thin = [corners[0], corners[1], corners[0].lerp(corners[1], 0.3) + 1e-3 * corners[2]];
            let parts = split(&[thin; 1]);
            for k in 0..200 {
                let [u, v] = [f64::from(k) / 200.0, f64::from(k * 7 % 200) / 200.0];
                let [u, v] = if u + v > 1.0 { [1.0 - u, 1.0 - v] } else { [u, v] };
                let point = thin[0] + (thin[1] - thin[0]) * u + (thin[2] - thin[0]) * v;
                let is_in = |part: &Part| point.cmpge(part.low).all() && point.cmple(part.high).all();
                assert!(parts.iter().any(is_in));
            }
        }
    }
}
