//! Weights of the inputs of a mixer, learnt by online logistic regression (`format/SPEC.md`, section 6.3).

use crate::util::simd4::Lanes;
use std::hint::black_box;

/// Step of the weights: FAST / (1 + n / DECAY) + SLOW after n bits.
const RATE_FAST: f32 = 0.05;
const RATE_SLOW: f32 = 0.008;
const RATE_DECAY: f32 = 256.0;

/// The weights of all inputs.
#[derive(Clone, Copy)]
pub(super) struct WeightSet {
    weights: [Lanes; 2],
    /// Bits it has seen.
    seen: u32,
}

impl WeightSet {
    pub(super) fn new(weights: [Lanes; 2]) -> Self {
        Self { weights, seen: 0 }
    }

    /// Log-odds of a one.
    #[inline(always)]
    pub(super) fn log_odds(&self, inputs: &[Lanes; 2]) -> f32 {
        // Through memory: compilers would take all products apart, as only sums of their lanes are wanted.
        let half = black_box(self.weights[0] * inputs[0] + self.weights[1] * inputs[1]);
        (half.0[0] + half.0[2]) + (half.0[1] + half.0[3])
    }

    /// Learns a bit of which these weights said that it is a one with probability `p` in 1/65536, `eagerness` times as
    /// fast as usual.
    #[inline(always)]
    pub(super) fn learn(&mut self, inputs: &[Lanes; 2], p: u32, bit: bool, eagerness: f32) {
        let rate = RATE_SLOW + RATE_FAST / (1.0 + self.seen as f32 * (1.0 / RATE_DECAY));
        self.seen = self.seen.saturating_add(1);
        let target = if bit { 1.0 } else { 0.0 };
        let step = (target - p as f32 * (1.0 / 65_536.0)) * (rate * eagerness);
        self.weights[0] += inputs[0] * step;
        self.weights[1] += inputs[1] * step;
    }
}
