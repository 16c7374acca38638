//! Recursive least squares with forgetting, over any number of features: the filter of
//! [`rls_affine`](super::rls_affine) for what is not a coordinate (`format/SPEC.md`, sections 8.2 and 8.4).

/// Variance of the initial weights over that of the noise.
const INITIAL_TRUST: f32 = 10.0;
const FORGETTING: f32 = 0.999;
/// Largest entry of the covariance.
const MAX_TRUST: f32 = 1e4;
/// Larger weights mean that the filter has lost its footing.
const MAX_WEIGHT: f32 = 1e3;

/// A linear predictor that learns its weights.
#[derive(Clone)]
pub(crate) struct Filter<const N: usize> {
    initial: [f32; N],
    weights: [f32; N],
    /// Symmetric.
    covariance: [[f32; N]; N],
}

impl<const N: usize> Filter<N> {
    pub(crate) fn new(initial: [f32; N]) -> Self {
        let row = |i: usize| std::array::from_fn(|j| if i == j { INITIAL_TRUST } else { 0.0 });
        Self { initial, weights: initial, covariance: std::array::from_fn(row) }
    }

    pub(crate) fn weights(&self) -> [f32; N] {
        self.weights
    }

    /// Learns that features `x` came with `truth`.
    pub(crate) fn learn(&mut self, x: [f32; N], truth: f32) {
        let y: [f32; N] = std::array::from_fn(|i| sum(self.covariance[i], x));
        let gain = 1.0 / (1.0 + sum(x, y));
        let error = truth - sum(self.weights, x);
        let g = y.map(|y| y * gain);
        let may_grow = (0..N).all(|i| self.covariance[i][i] < MAX_TRUST);
        let grow = if may_grow { 1.0 / FORGETTING } else { 1.0 };
        for i in 0..N {
            self.weights[i] += g[i] * error;
            for (j, g) in g.into_iter().enumerate().skip(i) {
                let c = (self.covariance[i][j] - y[i] * g) * grow;
                self.covariance[i][j] = c;
                self.covariance[j][i] = c;
            }
        }
        let is_sound = (0..N).all(|i| self.weights[i].abs() < MAX_WEIGHT && self.covariance[i][i] > 0.0);
        if !is_sound {
            *self = Self::new(self.initial);
        }
    }
}

/// Scalar product, first to last.
pub(crate) fn sum<const N: usize>(a: [f32; N], b: [f32; N]) -> f32 {
    let mut sum = a[0] * b[0];
    for i in 1..N {
        sum += a[i] * b[i];
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_weights_of_a_linear_rule_and_survives_nonsense() {
        let mut filter = Filter::new([0.5, 0.0, 0.0, 0.0]);
        let rule = [0.8, -0.1, 0.3, 2.0];
        let mut seed = 1_u32;
        let mut random = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 8) as f32 / (1 << 23) as f32 - 1.0
        };
        for _ in 0..400 {
            let x = [random(), random(), random(), random()];
            filter.learn(x, sum(rule, x));
        }
        for (found, wanted) in filter.weights().iter().zip(rule) {
            assert!((found - wanted).abs() < 5e-3, "{found} for {wanted}");
        }
        filter.learn([f32::NAN; 4], 1.0);
        assert_eq!(filter.weights(), [0.5, 0.0, 0.0, 0.0]);
    }
}
