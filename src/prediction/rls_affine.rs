//! Affine prediction with weights learnt on the way: recursive least squares with forgetting
//! (`format/SPEC.md`, section 8.2).

use super::ring_context::NUM_FEATURES;

/// Weights before anything is learnt: on a smooth surface half way towards the parallelograms.
const INITIAL_WEIGHTS: [f32; NUM_FEATURES] = [0.5, 0.35, 0.0];
/// Variance of the initial weights over that of the noise.
const INITIAL_TRUST: f32 = 10.0;
const FORGETTING: f32 = 0.999;
/// Largest entry of the covariance; keeps forgetting from blowing it up where nothing is learnt.
const MAX_TRUST: f32 = 1e4;
/// Larger weights mean that the filter has lost its footing.
const MAX_WEIGHT: f32 = 1e3;

/// A recursive least-squares filter for one coordinate of a vertex relative to its ring mean.
#[derive(Clone)]
pub(crate) struct AffineFilter {
    weights: [f32; NUM_FEATURES],
    /// Symmetric: xx, xy, xz, yy, yz, zz.
    covariance: [f32; 6],
}

impl AffineFilter {
    pub(crate) fn new() -> Self {
        let v = INITIAL_TRUST;
        Self { weights: INITIAL_WEIGHTS, covariance: [v, 0.0, 0.0, v, 0.0, v] }
    }

    #[inline(always)]
    pub(crate) fn weights(&self) -> [f32; NUM_FEATURES] {
        self.weights
    }

    /// Learns that features `x` came with `truth`; both as shares of the ring's length.
    #[inline(always)]
    pub(crate) fn learn(&mut self, x: [f32; NUM_FEATURES], truth: f32) {
        let [xx, xy, xz, yy, yz, zz] = self.covariance;
        let px = [sum([xx, xy, xz], x), sum([xy, yy, yz], x), sum([xz, yz, zz], x)];
        let gain = 1.0 / (1.0 + sum(x, px));
        let error = truth - sum(self.weights, x);
        let g = px.map(|p| p * gain);
        for (weight, g) in self.weights.iter_mut().zip(g) {
            *weight += g * error;
        }
        let grow = if xx < MAX_TRUST && yy < MAX_TRUST && zz < MAX_TRUST { 1.0 / FORGETTING } else { 1.0 };
        self.covariance = [
            (xx - px[0] * g[0]) * grow,
            (xy - px[0] * g[1]) * grow,
            (xz - px[0] * g[2]) * grow,
            (yy - px[1] * g[1]) * grow,
            (yz - px[1] * g[2]) * grow,
            (zz - px[2] * g[2]) * grow,
        ];
        if !self.is_sound() {
            *self = Self::new();
        }
    }

    #[inline(always)]
    fn is_sound(&self) -> bool {
        let [a, b, c] = self.weights;
        let [xx, _, _, yy, _, zz] = self.covariance;
        (a.abs() < MAX_WEIGHT)
            & (b.abs() < MAX_WEIGHT)
            & (c.abs() < MAX_WEIGHT)
            & (xx > 0.0)
            & (yy > 0.0)
            & (zz > 0.0)
    }
}

#[inline(always)]
fn sum(a: [f32; NUM_FEATURES], b: [f32; NUM_FEATURES]) -> f32 {
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
            (seed >> 8) as f32 / (1 << 23) as f32 - 1.0
        };
        for _ in 0..300 {
            let x = [random(), random(), random()];
            filter.learn(x, sum(rule, x));
        }
        for (found, wanted) in filter.weights().iter().zip(rule) {
            assert!((found - wanted).abs() < 1e-3, "{found} for {wanted}");
        }
    }

    #[test]
    fn survives_nonsense() {
        let mut filter = AffineFilter::new();
        for _ in 0..10 {
            filter.learn([1e30; 3], 1e9);
        }
        assert!(filter.weights().iter().all(|w| w.abs() < MAX_WEIGHT));
        filter.learn([f32::NAN; 3], 1.0);
        assert_eq!(filter.weights(), INITIAL_WEIGHTS);
    }
}
