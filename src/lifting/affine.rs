//! Affine prediction with weights learnt on the way: recursive least squares with forgetting
//! (`format/SPEC.md`, section 8.2).

use super::neighbourhood::{NUM_FEATURES, Outlook};
use super::vec3::Direction;

/// Weights before anything is learnt: on a smooth surface half way towards the parallelograms.
const INITIAL_WEIGHTS: [f64; NUM_FEATURES] = [0.5, 0.35, 0.0];
/// Variance of the initial weights over that of the noise.
const INITIAL_TRUST: f64 = 10.0;
const FORGETTING: f64 = 0.999;
/// Largest entry of the covariance; keeps forgetting from blowing it up where nothing is learnt.
const MAX_TRUST: f64 = 1e6;
/// Larger weights mean that the filter has lost its footing.
const MAX_WEIGHT: f64 = 1e3;

/// A recursive least-squares filter for the position of a vertex along one direction.
#[derive(Clone)]
pub(crate) struct AffineFilter {
    weights: [f64; NUM_FEATURES],
    covariance: [[f64; NUM_FEATURES]; NUM_FEATURES],
}

impl AffineFilter {
    pub(crate) fn new() -> Self {
        let mut covariance = [[0.0; NUM_FEATURES]; NUM_FEATURES];
        for (i, row) in covariance.iter_mut().enumerate() {
            row[i] = INITIAL_TRUST;
        }
        Self { weights: INITIAL_WEIGHTS, covariance }
    }

    /// Where the vertex should be along `direction`: the ring mean with its weighted corrections.
    pub(crate) fn predict(&self, outlook: &Outlook, direction: Direction) -> f64 {
        let x = outlook.features.map(|f| direction.of(f));
        direction.of(outlook.mean) + sum(self.weights, x)
    }

    /// Learns where it is. Lengths count relative to the ring.
    pub(crate) fn learn(&mut self, outlook: &Outlook, direction: Direction, truth: f64) {
        let per_length = 1.0 / outlook.length;
        let x = outlook.features.map(|f| direction.of(f) * per_length);
        let px: [f64; NUM_FEATURES] = std::array::from_fn(|i| sum(self.covariance[i], x));
        let gain = 1.0 / (1.0 + sum(x, px));
        let error = (truth - direction.of(outlook.mean)) * per_length - sum(self.weights, x);
        for i in 0..NUM_FEATURES {
            self.weights[i] += px[i] * gain * error;
            for j in 0..NUM_FEATURES {
                self.covariance[i][j] -= px[i] * px[j] * gain;
            }
        }
        if (0..NUM_FEATURES).all(|i| self.covariance[i][i] < MAX_TRUST) {
            self.covariance.iter_mut().flatten().for_each(|c| *c *= 1.0 / FORGETTING);
        }
        if !self.is_sound() {
            *self = Self::new();
        }
    }

    fn is_sound(&self) -> bool {
        self.weights.iter().all(|w| w.abs() < MAX_WEIGHT)
            && (0..NUM_FEATURES).all(|i| self.covariance[i][i] > 0.0)
    }
}

#[inline]
fn sum(a: [f64; NUM_FEATURES], b: [f64; NUM_FEATURES]) -> f64 {
    (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_weights_of_a_linear_rule() {
        let mut filter = AffineFilter::new();
        let rule = [0.8, -0.1, 0.3];
        let mut seed = 1_u32;
        let mut random = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(seed >> 8) / f64::from(1 << 24) - 0.5
        };
        let mut error = 0.0;
        for _ in 0..30_000 {
            let outlook = Outlook {
                mean: [random(), random(), random()],
                features: std::array::from_fn(|_| [random(), random(), random()]),
                normal: [0.0; 3],
                length: 1.0,
            };
            let direction = Direction::Along([random(), random(), random()]);
            let offset: f64 = (0..NUM_FEATURES).map(|i| rule[i] * direction.of(outlook.features[i])).sum();
            let truth = direction.of(outlook.mean) + offset;
            error = (filter.predict(&outlook, direction) - truth).abs();
            filter.learn(&outlook, direction, truth);
        }
        assert!(error < 1e-6, "{error}");
    }

    #[test]
    fn survives_nonsense() {
        let mut filter = AffineFilter::new();
        let outlook =
            Outlook { mean: [0.0; 3], features: [[1e200; 3]; NUM_FEATURES], normal: [0.0; 3], length: 1e-3 };
        for _ in 0..10 {
            filter.learn(&outlook, Direction::Along([1.0; 3]), 1e9);
        }
        let tame = Outlook { features: [[1.0; 3]; NUM_FEATURES], ..outlook };
        assert!(filter.predict(&tame, Direction::Along([1.0; 3])).is_finite());
    }
}
