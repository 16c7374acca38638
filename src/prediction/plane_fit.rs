//! What points around a vertex say about a function at the vertex itself: weighted means, and fits of an
//! affine or a conformal function in the tangent plane (`format/SPEC.md`, section 8.4).

use crate::util::simd4::Lanes;

/// Length that counts for no distance at all, in grid steps.
const SHORTEST: f32 = 0.25;
/// Share of the points' extent by which an affine fit is made stiff.
const STIFFNESS: f32 = 2e-3;

/// Points with their places in the tangent plane, seen from the vertex.
#[derive(Default)]
pub(crate) struct PlaneFit {
    /// Place and weight of each point.
    places: Vec<[f32; 3]>,
    /// Centre and total weight of the places.
    centre: [f32; 2],
    weight: f32,
    /// Second moments about the centre, xx, xy, yy.
    moments: [f32; 3],
}

/// Values of a conformal function at the vertex, and how well it fits.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Conformal {
    pub(crate) values: [f32; 2],
    /// What it explains of the points' variance; the larger of two fits is the better one.
    pub(crate) explained: f32,
    /// Root mean square of what it does not explain.
    pub(crate) misfit: f32,
}

impl PlaneFit {
    /// Takes the ways from the vertex to the points, projected along `normal`.
    pub(crate) fn set(&mut self, ways: impl Iterator<Item = Lanes>, normal: Lanes) {
        let axes = tangents(normal);
        self.places.clear();
        self.places.extend(ways.map(|way| {
            let squared = way.dot3(way);
            [way.dot3(axes[0]), way.dot3(axes[1]), 1.0 / (squared + SHORTEST)]
        }));
        let (mut sum, mut weight) = ([0.0_f32; 2], 0.0_f32);
        for [x, y, w] in &self.places {
            sum = [sum[0] + w * x, sum[1] + w * y];
            weight += w;
        }
        self.weight = weight;
        let share = if weight > 0.0 { 1.0 / weight } else { 0.0 };
        self.centre = [sum[0] * share, sum[1] * share];
        self.moments = [0.0; 3];
        for place in &mut self.places {
            let (x, y, w) = (place[0] - self.centre[0], place[1] - self.centre[1], place[2]);
            (place[0], place[1]) = (x, y);
            let [xx, xy, yy] = self.moments;
            self.moments = [xx + w * x * x, xy + w * x * y, yy + w * y * y];
        }
    }

    fn mean(&self, values: &[f32]) -> f32 {
        let mut sum = 0.0;
        for (place, value) in self.places.iter().zip(values) {
            sum += place[2] * value;
        }
        if self.weight > 0.0 { sum / self.weight } else { 0.0 }
    }

    /// Covariances of the values with x and y.
    fn slopes(&self, values: &[f32], mean: f32) -> [f32; 2] {
        let mut slopes = [0.0; 2];
        for (place, value) in self.places.iter().zip(values) {
            let d = place[2] * (value - mean);
            slopes = [slopes[0] + d * place[0], slopes[1] + d * place[1]];
        }
        slopes
    }

    /// The affine function that fits `values` best, at the vertex. One value for each point.
    pub(crate) fn affine(&self, values: &[f32]) -> f32 {
        let mean = self.mean(values);
        let [bx, by] = self.slopes(values, mean);
        let [xx, xy, yy] = self.moments;
        let ridge = (xx + yy) * STIFFNESS + 1e-9;
        let (xx, yy) = (xx + ridge, yy + ridge);
        let determinant = xx * yy - xy * xy;
        if determinant > 0.0 {
            let gx = (bx * yy - by * xy) / determinant;
            let gy = (by * xx - bx * xy) / determinant;
            mean - (gx * self.centre[0] + gy * self.centre[1])
        } else {
            mean
        }
    }

    /// The function z ↦ a z + b, or with `mirrored` of the conjugate of z, that fits two channels best.
    pub(crate) fn conformal(&self, channels: [&[f32]; 2], mirrored: bool) -> Conformal {
        let sign = if mirrored { -1.0 } else { 1.0 };
        let means = channels.map(|values| self.mean(values));
        let [ux, uy] = self.slopes(channels[0], means[0]);
        let [vx, vy] = self.slopes(channels[1], means[1]);
        let total = self.moments[0] + self.moments[2];
        if total.is_nan() || total <= 0.0 {
            return Conformal { values: means, explained: 0.0, misfit: 0.0 };
        }
        let re = (ux + sign * vy) / total;
        let im = (vx - sign * uy) / total;
        let [x, y] = [self.centre[0], sign * self.centre[1]];
        let explained = (re * re + im * im) * total;
        let mut variance = 0.0;
        for (k, place) in self.places.iter().enumerate() {
            let (u, v) = (channels[0][k] - means[0], channels[1][k] - means[1]);
            variance += place[2] * (u * u + v * v);
        }
        let misfit = (variance - explained).max(0.0) / self.weight;
        Conformal {
            values: [means[0] - (re * x - im * y), means[1] - (re * y + im * x)],
            explained,
            misfit: misfit.sqrt(),
        }
    }
}

/// Two unit vectors across `normal`, counter-clockwise seen from its tip.
fn tangents(normal: Lanes) -> [Lanes; 2] {
    let length = normal.dot3(normal).sqrt();
    let n = if length > 0.0 { normal * (1.0 / length) } else { Lanes([0.0, 0.0, 1.0, 0.0]) };
    let [x, y, z, _] = n.abs().0;
    let axis = if x <= y && x <= z {
        Lanes([1.0, 0.0, 0.0, 0.0])
    } else if y <= z {
        Lanes([0.0, 1.0, 0.0, 0.0])
    } else {
        Lanes([0.0, 0.0, 1.0, 0.0])
    };
    let first = n.cross(axis);
    let first = first * (1.0 / first.dot3(first).sqrt());
    [first, n.cross(first)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points() -> Vec<Lanes> {
        [[5.0, 1.0], [1.0, 6.0], [-4.0, 2.0], [-3.0, -5.0], [2.0, -4.0]]
            .map(|[x, y]| Lanes([x, y, 0.0, 0.0]))
            .to_vec()
    }

    fn fit(count: usize) -> PlaneFit {
        let mut fit = PlaneFit::default();
        fit.set(points().into_iter().take(count), Lanes([0.0, 0.0, 2.0, 0.0]));
        fit
    }

    #[test]
    fn affine_functions_are_found() {
        let values: Vec<f32> = points().iter().map(|p| 7.0 + 2.0 * p.0[0] - 3.0 * p.0[1]).collect();
        assert!((fit(5).affine(&values) - 7.0).abs() < 0.05);
        assert_eq!(fit(0).affine(&[]), 0.0);
    }

    #[test]
    fn two_points_tell_a_conformal_function() {
        let turned: Vec<[f32; 2]> =
            points().iter().map(|p| [1.0 + 2.0 * p.0[0] - p.0[1], 4.0 + p.0[0] + 2.0 * p.0[1]]).collect();
        let channels: [Vec<f32>; 2] = [0, 1].map(|k| turned.iter().map(|t| t[k]).collect());
        for count in [2, 5] {
            let found = [false, true]
                .map(|m| fit(count).conformal([&channels[0][..count], &channels[1][..count]], m));
            // The axes of the plane may lie any way round, but not mirrored.
            let [right, wrong] = found;
            assert!(
                (right.values[0] - 1.0).abs() < 1e-3 && (right.values[1] - 4.0).abs() < 1e-3,
                "{right:?}"
            );
            assert!(count == 2 || right.explained > wrong.explained);
        }
    }
}
