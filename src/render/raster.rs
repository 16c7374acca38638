//! Which triangle is seen at each sample: a depth buffer over horizontal bands, one band per task.

use rayon::prelude::*;

/// Rows of a band.
const BAND_ROWS: usize = 32;

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

/// A triangle on the picture: columns, rows and nearness of its corners, in samples.
#[derive(Clone, Copy)]
pub(super) struct Projected(pub(super) [[f64; 3]; 3]);

impl Projected {
    /// Twice the signed area; a positive sign is clockwise on the picture.
    fn area(&self) -> f64 {
        let [a, b, c] = self.0;
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    }

    /// Weights of the corners at a place; `None` for a triangle without area.
    pub(super) fn weights(&self, x: f64, y: f64) -> Option<[f64; 3]> {
        let [a, b, c] = self.0;
        let scale = 1.0 / self.area();
        let part =
            |p: [f64; 3], q: [f64; 3]| ((q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0])) * scale;
        scale.is_finite().then(|| [part(b, c), part(c, a), part(a, b)])
    }

    /// Distance of the place with these `weights` from the nearest side, in samples.
    pub(super) fn distance_to_sides(&self, weights: [f64; 3]) -> f64 {
        let area = self.area().abs();
        let side = |i: usize| {
            let (p, q) = (self.0[(i + 1) % 3], self.0[(i + 2) % 3]);
            weights[i] * area / (q[0] - p[0]).hypot(q[1] - p[1])
        };
        (0..3).map(side).fold(f64::INFINITY, f64::min)
    }

    fn range(&self, axis: usize) -> (f64, f64) {
        let [a, b, c] = self.0.map(|corner| corner[axis]);
        (a.min(b).min(c), a.max(b).max(c))
    }

    /// Samples along `axis` whose middles lie within, and within `0..count`.
    fn samples(&self, axis: usize, count: usize) -> std::ops::Range<usize> {
        let (low, high) = self.range(axis);
        // Casts saturate at 0.
        let begin = (low - 0.5).ceil() as usize;
        let end = if high < 0.5 { 0 } else { (high - 0.5).floor() as usize + 1 };
        begin..end.min(count)
    }
}

impl Visible {
    /// Draws `triangles` on `width` by `height` samples; of equally near ones the first is seen.
    pub(super) fn new(triangles: &[Projected], width: usize, height: usize) -> Self {
        let rows: Vec<(u32, u32)> = triangles
            .par_iter()
            .map(|t| t.samples(1, height))
            .map(|range| (range.start.min(height) as u32, range.end as u32))
            .collect();
        let mut visible = Self {
            width,
            height,
            triangle: vec![NOTHING; width * height],
            near: vec![f32::NEG_INFINITY; width * height],
        };
        let bands = visible.triangle.par_chunks_mut(BAND_ROWS * width);
        bands.zip(visible.near.par_chunks_mut(BAND_ROWS * width)).enumerate().for_each(
            |(band, (seen, near))| {
                let first_row = band * BAND_ROWS;
                let end_row = first_row + seen.len() / width;
                for (i, &(begin, end)) in rows.iter().enumerate() {
                    let band_rows = first_row.max(begin as usize)..end_row.min(end as usize);
                    if !band_rows.is_empty() {
                        draw(&triangles[i], i as u32, band_rows, first_row, width, seen, near);
                    }
                }
            },
        );
        visible
    }
}

/// Draws the rows `rows` of a triangle into a band that begins at row `first_row`.
fn draw(
    triangle: &Projected,
    index: u32,
    rows: std::ops::Range<usize>,
    first_row: usize,
    width: usize,
    seen: &mut [u32],
    near: &mut [f32],
) {
    let columns = triangle.samples(0, width);
    if columns.is_empty() {
        return;
    }
    let nearness = triangle.0.map(|corner| corner[2]);
    // Weights are linear along a row.
    let at = |x: f64, y: f64| triangle.weights(x, y);
    for row in rows {
        let (x, y) = (columns.start as f64 + 0.5, row as f64 + 0.5);
        let (Some(begin), Some(after)) = (at(x, y), at(x + 1.0, y)) else { return };
        let step: [f64; 3] = std::array::from_fn(|i| after[i] - begin[i]);
        let line = (row - first_row) * width;
        for column in columns.clone() {
            let along = (column - columns.start) as f64;
            let weights: [f64; 3] = std::array::from_fn(|i| begin[i] + along * step[i]);
            if weights.iter().any(|&w| w < -1e-9) {
                continue;
            }
            let nearer = (0..3).map(|i| weights[i] * nearness[i]).sum::<f64>() as f32;
            let sample = line + column;
            if nearer > near[sample] {
                near[sample] = nearer;
                seen[sample] = index;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(low: f64, high: f64, near: f64) -> [Projected; 2] {
        let p = |x: f64, y: f64| [x, y, near];
        let [a, b, c, d] = [p(low, low), p(high, low), p(high, high), p(low, high)];
        [Projected([a, b, c]), Projected([c, a, d])]
    }

    #[test]
    fn a_square_has_its_samples_and_the_nearer_one_wins() {
        let triangles = [square(10.0, 60.0, 1.0), square(30.0, 50.0, 2.0), square(20.0, 40.0, 0.0)].concat();
        let visible = Visible::new(&triangles, 100, 90);
        let count =
            |range: std::ops::Range<u32>| visible.triangle.iter().filter(|t| range.contains(t)).count();
        assert_eq!((count(0..2), count(2..4), count(4..6)), (2500 - 400, 400, 0));
        assert_eq!(visible.triangle[35 * 100 + 40], 2);
    }

    #[test]
    fn what_lies_outside_is_left_out() {
        let visible = Visible::new(&square(-20.0, 500.0, 0.0), 40, 70);
        assert!(visible.triangle.iter().all(|&t| t != NOTHING));
        let flat = Projected([[0.0, 0.0, 0.0], [30.0, 30.0, 0.0], [60.0, 60.0, 0.0]]);
        let visible = Visible::new(&[flat, Projected([[-9.0; 3], [-1.0; 3], [-5.0, -2.0, 0.0]])], 40, 70);
        assert!(visible.triangle.iter().all(|&t| t == NOTHING));
    }

    #[test]
    fn sides_are_as_far_as_they_are() {
        let triangle = Projected([[0.0, 0.0, 0.0], [40.0, 0.0, 0.0], [0.0, 30.0, 0.0]]);
        let weights = triangle.weights(5.0, 3.0).unwrap();
        assert!((triangle.distance_to_sides(weights) - 3.0).abs() < 1e-12);
        assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    }
}
