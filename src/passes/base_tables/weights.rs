//! Weights of predictions and of expected sizes: defaults, and what an encoder sends in addition.

use super::symbols::CLASSES;
use crate::entropy::numbers::Numbers;
use crate::entropy::range_coder::BitCoder;

/// Corrections of the mean of the parallelograms that have weights.
pub(super) const NUM_FEATURES: usize = 3;
/// What tells how large a residual is.
pub(super) const NUM_CUES: usize = 8;
/// Along the surface and across it.
pub(super) const NUM_SIDES: usize = 2;
/// Kinds of coordinates: two along the surface, one across it.
pub(super) const NUM_KINDS: usize = 3;
/// Steps of a weight to one.
pub(super) const STEPS_PER_ONE: f32 = 64.0;
/// Largest weight, in steps.
const MAX_STEPS: i64 = 1 << 14;

/// Weights in steps.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Weights {
    pub(super) predictions: [[[i16; NUM_FEATURES]; NUM_SIDES]; CLASSES],
    pub(super) sizes: [[i16; NUM_CUES]; NUM_KINDS],
}

impl Weights {
    /// Medians of the weights that are fitted to scans, CAD parts, models and terrain: `benches/weights.py` makes them.
    pub(super) const DEFAULT: Self = Self {
        predictions: [
            [[38, 19, 0], [28, 19, 0]],
            [[-2, 6, 0], [1, 21, 0]],
            [[-4, 4, 0], [4, 68, 0]],
            [[-4, 10, 15], [2, 59, 2]],
            [[-3, 20, 12], [2, 56, 18]],
            [[-1, 30, 1], [18, 19, 0]],
            [[19, 19, 0], [19, 19, 0]],
        ],
        sizes: [
            [130, 2, 5, 2, 21, 5, -61, 6],
            [108, 3, 2, 1, 22, 8, -62, 6],
            [81, -18, 20, 7, 5, 10, -18, 4],
        ],
    };

    /// Codes how far weights are from the defaults; `None` if what is read is beyond all bounds.
    pub(super) fn code<B: BitCoder>(coder: &mut B, wanted: Option<&Self>) -> Option<Self> {
        let mut weights = Self::DEFAULT;
        let wanted = wanted.unwrap_or(&Self::DEFAULT);
        if coder.code_raw(u32::from(*wanted != Self::DEFAULT), 1) == 0 {
            return Some(weights);
        }
        let mut numbers = Numbers::new(2);
        for (weight, wanted) in weights
            .predictions
            .as_flattened_mut()
            .as_flattened_mut()
            .iter_mut()
            .zip(wanted.predictions.as_flattened().as_flattened())
        {
            *weight = code_weight(coder, &mut numbers, 0, *weight, *wanted)?;
        }
        for (weight, wanted) in weights.sizes.as_flattened_mut().iter_mut().zip(wanted.sizes.as_flattened()) {
            *weight = code_weight(coder, &mut numbers, 1, *weight, *wanted)?;
        }
        Some(weights)
    }
}

fn code_weight<B: BitCoder>(
    coder: &mut B,
    numbers: &mut Numbers,
    context: usize,
    usual: i16,
    wanted: i16,
) -> Option<i16> {
    let more = numbers.code_signed(coder, context, i64::from(wanted) - i64::from(usual));
    let weight = i64::from(usual) + more;
    (-MAX_STEPS..=MAX_STEPS).contains(&weight).then_some(weight as i16)
}

/// The same weights as factors.
pub(super) struct Factors {
    pub(super) predictions: [[[f32; NUM_FEATURES]; NUM_SIDES]; CLASSES],
    pub(super) sizes: [[f32; NUM_CUES]; NUM_KINDS],
}

impl From<&Weights> for Factors {
    fn from(weights: &Weights) -> Self {
        let factor = |steps: i16| f32::from(steps) * (1.0 / STEPS_PER_ONE);
        Self {
            predictions: weights.predictions.map(|class| class.map(|side| side.map(factor))),
            sizes: weights.sizes.map(|kind| kind.map(factor)),
        }
    }
}
