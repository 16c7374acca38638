//! Weights of least squares, for encoders.

use super::arithmetic::log_size;
use super::placing::Observer;
use super::prediction::{Expected, Outlook};
use super::symbols::CLASSES;
use super::weights::{NUM_CUES, NUM_FEATURES, NUM_KINDS, NUM_SIDES, STEPS_PER_ONE, Weights};
use crate::passes::coordinate_prediction::ACROSS;
use crate::util::simd4::Lanes;

/// Distance over ring length at which misses begin to count less.
const ROBUST: f64 = 0.05;
/// Samples that the default weights are worth.
const DEFAULT_COUNTS: f64 = 4.0;

/// Sums of the normal equations of `N` weights.
#[derive(Clone)]
struct Moments<const N: usize> {
    products: [[f64; N]; N],
    right: [f64; N],
    count: f64,
}

impl<const N: usize> Moments<N> {
    const NONE: Self = Self { products: [[0.0; N]; N], right: [0.0; N], count: 0.0 };

    fn add(&mut self, inputs: [f64; N], output: f64, weight: f64) {
        for i in 0..N {
            (0..N).for_each(|j| self.products[i][j] += weight * inputs[i] * inputs[j]);
            self.right[i] += weight * inputs[i] * output;
        }
        self.count += 1.0;
    }

    /// The best weights in steps, drawn a little to the usual ones.
    fn solve(&self, usual: [i16; N]) -> [i16; N] {
        if self.count == 0.0 {
            return usual;
        }
        let (mut a, mut b) = (self.products, self.right);
        let trace: f64 = (0..N).map(|i| a[i][i]).sum();
        let pull = trace / (self.count * N as f64) * DEFAULT_COUNTS + 1e-9;
        for i in 0..N {
            a[i][i] += pull;
            b[i] += pull * f64::from(usual[i]) / f64::from(STEPS_PER_ONE);
        }
        // Positive definite: no pivots are looked for.
        for i in 0..N {
            for r in (0..N).filter(|&r| r != i) {
                let factor = a[r][i] / a[i][i];
                (i..N).for_each(|c| a[r][c] -= factor * a[i][c]);
                b[r] -= factor * b[i];
            }
        }
        std::array::from_fn(|i| {
            (b[i] / a[i][i] * f64::from(STEPS_PER_ONE)).round().clamp(-16_000.0, 16_000.0) as i16
        })
    }
}

/// Fits the weights of predictions.
pub(super) struct PredictionFit {
    moments: [[Moments<NUM_FEATURES>; NUM_SIDES]; CLASSES],
}

impl PredictionFit {
    pub(super) fn new() -> Self {
        Self { moments: [const { [Moments::NONE; NUM_SIDES] }; CLASSES] }
    }

    pub(super) fn apply(&self, weights: &mut Weights) {
        for (sides, moments) in weights.predictions.iter_mut().zip(&self.moments) {
            for (weights, moments) in sides.iter_mut().zip(moments) {
                *weights = moments.solve(*weights);
            }
        }
    }
}

impl Observer for PredictionFit {
    fn see_vertex(&mut self, outlook: &Outlook, place: Lanes) {
        let per_length = 1.0 / f64::from(outlook.length);
        let offset = place - outlook.mean;
        for (kind, &axis) in outlook.axes.iter().enumerate() {
            let is_across = kind == ACROSS;
            let framed = |p: Lanes| {
                let sheared = if is_across { outlook.slopes.dot3(p) } else { 0.0 };
                f64::from(p.0[axis] + sheared) * per_length
            };
            let output = framed(offset);
            let inputs = outlook.features.map(framed);
            let moments = &mut self.moments[outlook.class][usize::from(is_across)];
            moments.add(inputs, output, 1.0 / (ROBUST + output.abs()));
        }
    }
}

/// Fits the weights of expected sizes.
pub(super) struct SizeFit {
    moments: [Moments<NUM_CUES>; NUM_KINDS],
}

impl SizeFit {
    pub(super) fn new() -> Self {
        Self { moments: [const { Moments::NONE }; NUM_KINDS] }
    }

    pub(super) fn apply(&self, weights: &mut Weights) {
        for (weights, moments) in weights.sizes.iter_mut().zip(&self.moments) {
            *weights = moments.solve(*weights);
        }
    }
}

impl Observer for SizeFit {
    fn see_residual(&mut self, expected: &Expected, kind: usize, residual: i32) {
        self.moments[kind].add(expected.cues.map(f64::from), f64::from(log_size(residual as f32)), 1.0);
    }
}
