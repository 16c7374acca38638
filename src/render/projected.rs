//! Triangles where they are on the picture.

/// A triangle on the picture: columns, rows and nearness of its corners, in samples.
#[derive(Clone, Copy)]
pub(super) struct Projected(pub(super) [[f64; 3]; 3]);

impl Projected {
    /// Twice the signed area; a positive sign is clockwise on the picture.
    pub(super) fn area(&self) -> f64 {
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

    pub(super) fn range(&self, axis: usize) -> (f64, f64) {
        let [a, b, c] = self.0.map(|corner| corner[axis]);
        (a.min(b).min(c), a.max(b).max(c))
    }

    /// Samples along `axis` whose middles lie within, and within `0..count`.
    pub(super) fn samples(&self, axis: usize, count: usize) -> std::ops::Range<usize> {
        let (low, high) = self.range(axis);
        // Casts saturate at 0.
        let begin = (low - 0.5).ceil() as usize;
        let end = if high < 0.5 { 0 } else { (high - 0.5).floor() as usize + 1 };
        begin..end.min(count)
    }
}

/// A triangle that is on the picture, with the rows it has there.
pub(super) struct Drawn {
    pub(super) triangle: u32,
    pub(super) begin: u32,
    pub(super) end: u32,
}
