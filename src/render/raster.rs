//! Which triangle is seen at each sample: a depth buffer over horizontal bands, one band per task.

use super::band::{BAND_ROWS, Band};
use super::projected::{Drawn, Projected};
use crate::util::count::Count;
use rayon::prelude::*;
use std::collections::HashSet;

/// Absence of a triangle.
pub(super) const NOTHING: u32 = u32::MAX;

/// The nearest triangle at the middle of each sample.
pub(super) struct Visible {
    pub(super) width: usize,
    pub(super) height: usize,
    /// Triangle, or [`NOTHING`].
    pub(super) triangle: Vec<u32>,
    /// Nearness where there is a triangle.
    pub(super) near: Vec<f32>,
}

impl Visible {
    /// Draws `triangles` on `width` by `height` samples; of equally near ones the first is seen. Counts the rows.
    pub(super) fn new(triangles: &[Projected], width: usize, height: usize, count: &Count) -> Self {
        let mut visible = Self {
            width,
            height,
            triangle: vec![NOTHING; width * height],
            near: vec![f32::NEG_INFINITY; width * height],
        };
        let order = drawing_order(triangles, width, height);
        let bands = visible.triangle.par_chunks_mut(BAND_ROWS * width);
        bands.zip(visible.near.par_chunks_mut(BAND_ROWS * width)).enumerate().for_each(
            |(band, (seen, near))| {
                let num_rows = seen.len() / width;
                let mut band = Band::new(band * BAND_ROWS, width, seen, near);
                for drawn in &order {
                    band.draw(&triangles[drawn.triangle as usize], drawn);
                }
                count.add(num_rows);
            },
        );
        visible
    }
}

/// If the boxes of the triangles have more samples than this for each of the picture, much is hidden.
const DEEP: f64 = 8.0;

/// The triangles on the picture; the near ones first if there are many on top of each other, and equal ones once.
fn drawing_order(triangles: &[Projected], width: usize, height: usize) -> Vec<Drawn> {
    let drawn = |(t, triangle): (&Projected, u32)| {
        let rows = t.samples(1, height);
        let is_seen = !rows.is_empty() && !t.samples(0, width).is_empty();
        is_seen.then_some(Drawn { triangle, begin: rows.start as u32, end: rows.end as u32 })
    };
    let numbers = (0..triangles.len() as u32).into_par_iter();
    let mut order: Vec<Drawn> = triangles.par_iter().zip(numbers).filter_map(drawn).collect();
    let samples = |d: &Drawn| {
        f64::from(d.end - d.begin) * triangles[d.triangle as usize].samples(0, width).len() as f64
    };
    if order.iter().map(samples).sum::<f64>() > DEEP * (width * height) as f64 {
        let mut known = HashSet::new();
        order.retain(|d| known.insert(triangles[d.triangle as usize].0.map(|p| p.map(f64::to_bits))));
        let nearest = |d: &Drawn| triangles[d.triangle as usize].range(2).1;
        order.par_sort_by(|d, e| nearest(e).total_cmp(&nearest(d)));
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(triangles: &[Projected], width: usize, height: usize) -> Visible {
        Visible::new(triangles, width, height, &Count::new(height, &|_| ()))
    }

    fn square(low: f64, high: f64, near: f64) -> [Projected; 2] {
        let p = |x: f64, y: f64| [x, y, near];
        let [a, b, c, d] = [p(low, low), p(high, low), p(high, high), p(low, high)];
        [Projected([a, b, c]), Projected([c, a, d])]
    }

    #[test]
    fn a_square_has_its_samples_and_the_nearer_one_wins() {
        let triangles = [square(10.0, 60.0, 1.0), square(30.0, 50.0, 2.0), square(20.0, 40.0, 0.0)].concat();
        let visible = drawn(&triangles, 100, 90);
        let count =
            |range: std::ops::Range<u32>| visible.triangle.iter().filter(|t| range.contains(t)).count();
        assert_eq!((count(0..2), count(2..4), count(4..6)), (2500 - 400, 400, 0));
        assert_eq!(visible.triangle[35 * 100 + 40], 2);
    }

    #[test]
    fn what_lies_outside_is_left_out() {
        let visible = drawn(&square(-20.0, 500.0, 0.0), 40, 70);
        assert!(visible.triangle.iter().all(|&t| t != NOTHING));
        let flat = Projected([[0.0, 0.0, 0.0], [30.0, 30.0, 0.0], [60.0, 60.0, 0.0]]);
        let visible = drawn(&[flat, Projected([[-9.0; 3], [-1.0; 3], [-5.0, -2.0, 0.0]])], 40, 70);
        assert!(visible.triangle.iter().all(|&t| t == NOTHING));
    }

    #[test]
    fn sides_are_as_far_as_they_are() {
        let triangle = Projected([[0.0, 0.0, 0.0], [40.0, 0.0, 0.0], [0.0, 30.0, 0.0]]);
        let weights = triangle.weights(5.0, 3.0).unwrap();
        assert!((triangle.distance_to_sides(weights) - 3.0).abs() < 1e-12);
        assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    }

    /// All samples of all boxes, one after the other.
    fn by_brute_force(triangles: &[Projected], width: usize, height: usize) -> (Vec<u32>, Vec<f32>) {
        let mut seen = vec![NOTHING; width * height];
        let mut near = vec![f32::NEG_INFINITY; width * height];
        for (triangle, index) in triangles.iter().zip(0..) {
            let columns = triangle.samples(0, width);
            for row in triangle.samples(1, height) {
                let (x, y) = (columns.start as f64 + 0.5, row as f64 + 0.5);
                let Some((begin, after)) = triangle.weights(x, y).zip(triangle.weights(x + 1.0, y)) else {
                    break;
                };
                let step: [f64; 3] = std::array::from_fn(|i| after[i] - begin[i]);
                for (along, column) in columns.clone().enumerate() {
                    let weights: [f64; 3] = std::array::from_fn(|i| begin[i] + along as f64 * step[i]);
                    let nearer = (0..3).map(|i| weights[i] * triangle.0[i][2]).sum::<f64>() as f32;
                    let sample = row * width + column;
                    if weights.iter().all(|&w| w >= -1e-9) && nearer > near[sample] {
                        (near[sample], seen[sample]) = (nearer, index);
                    }
                }
            }
        }
        (seen, near)
    }

    #[test]
    fn what_is_hidden_is_left_out_and_nothing_else() {
        let mut state = 1_u64;
        let mut unit = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 / (1_u64 << 24) as f64
        };
        let (width, height) = (150, 110);
        let mut point = |size: f64| [size * unit() - 20.0, size * unit() - 20.0, 100.0 * unit()];
        // Large ones at random, slivers from one point, some small ones and some several times.
        let mut triangles: Vec<Projected> =
            (0..300).map(|_| Projected([0; 3].map(|_| point(200.0)))).collect();
        triangles.extend((0..300).map(|_| {
            let far = point(180.0);
            Projected([[60.0, 50.0, 70.0], far, [far[0] + 0.3, far[1] - 0.2, far[2]]])
        }));
        triangles.extend((0..300).map(|_| Projected([0; 3].map(|_| point(180.0).map(|c| 0.1 * c + 30.0)))));
        triangles.extend_from_within(100..200);
        for triangles in [&triangles[..], &triangles[..4], &triangles[300..310], &triangles[..20].repeat(30)]
        {
            let visible = drawn(triangles, width, height);
            assert!((visible.triangle, visible.near) == by_brute_force(triangles, width, height));
        }
    }
}
