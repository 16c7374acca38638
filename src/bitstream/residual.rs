//! An integer coded around a real prediction of it (`format/SPEC.md`, section 6.4).
//!
//! The prediction is a density: a centre and a scale. Its share of the mass on either side of each
//! binary decision goes into the mixer beside the adaptive contexts, which correct its shape.

use super::mixer::MixedBit;
use super::mixture::{Expert, Mixture, NUM_EXPERTS};
use super::range_coder::{BitCoder, PROBABILITY_ONE};
use super::tables::Tables;

/// Values of each context that the caller gives.
pub(crate) const CALLER_CONTEXTS: usize = 256;
/// Values of the sign context that the caller gives.
pub(crate) const SIGN_CONTEXTS: usize = 32;
/// Kinds of coordinate: two along the surface, one across it.
pub(crate) const NUM_KINDS: usize = 3;

const SCALE_BUCKETS: usize = 64;
const OFFSET_BUCKETS: usize = 8;
const EXPONENTS: usize = 32;
/// Mantissa bits below the leading one that have models; the rest follow the density alone.
const MODELLED_MANTISSA: u32 = 2;

/// What is known of an integer before it is coded.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Expectation<'a> {
    pub(crate) experts: &'a [Expert; NUM_EXPERTS],
    /// The expert from whose centre the integer is counted.
    pub(crate) best: usize,
    /// Base-2 logarithm of that expert's scale.
    pub(crate) log_scale: f64,
    /// Which of the [`NUM_KINDS`] kinds of number it is.
    pub(crate) kind: usize,
    /// Two contexts of [`CALLER_CONTEXTS`] values.
    pub(crate) contexts: [usize; 2],
    /// One of [`SIGN_CONTEXTS`] values; bit 0 is flipped with the sign.
    pub(crate) sign: usize,
}

/// Adaptive models of residuals.
pub(crate) struct ResidualModel {
    zero: MixedBit<3>,
    sign: MixedBit<2>,
    more: MixedBit<3>,
    mantissa: MixedBit<2>,
}

impl ResidualModel {
    const LIMIT: u32 = 250;

    pub(crate) fn new() -> Self {
        let by_scale = NUM_KINDS * SCALE_BUCKETS;
        Self {
            zero: MixedBit::new(
                [by_scale * OFFSET_BUCKETS, CALLER_CONTEXTS, CALLER_CONTEXTS],
                NUM_KINDS,
                0.5,
                Self::LIMIT,
            ),
            sign: MixedBit::new([by_scale * OFFSET_BUCKETS / 4, SIGN_CONTEXTS], NUM_KINDS, 0.7, Self::LIMIT),
            more: MixedBit::new(
                [by_scale * EXPONENTS, CALLER_CONTEXTS * EXPONENTS, CALLER_CONTEXTS * EXPONENTS],
                NUM_KINDS * EXPONENTS,
                0.4,
                Self::LIMIT,
            ),
            mantissa: MixedBit::new(
                [2 * SCALE_BUCKETS * EXPONENTS, 2 * EXPONENTS * NUM_KINDS],
                2,
                0.6,
                Self::LIMIT,
            ),
        }
    }

    /// Codes `value`; `None` if a stream names a number outside 32 bits.
    pub(crate) fn code<B: BitCoder>(
        &mut self,
        coder: &mut B,
        expected: &Expectation,
        value: i32,
    ) -> Option<i32> {
        let tables = Tables::get();
        let Expectation { experts, best, log_scale, kind, contexts, sign } = *expected;
        let centre = experts[best].centre;
        let base = round_half_up(centre);
        let nearest = base as f64;
        let fraction = centre - nearest;
        // Mirrored so that the centre never lies below the nearest integer: halves the contexts.
        let mirrored = fraction < 0.0;
        let offset = fraction.abs();
        let residual = if mirrored { base - i64::from(value) } else { i64::from(value) - base };

        let mut mixture = Mixture::new(tables, experts, nearest, mirrored);
        let total = mixture.total();
        let bucket = ((log_scale * 4.0 + 12.0) as usize).min(SCALE_BUCKETS - 1);
        let offset_bucket = ((offset * (2 * OFFSET_BUCKETS) as f64) as usize).min(OFFSET_BUCKETS - 1);
        let by_scale = kind * SCALE_BUCKETS + bucket;

        let (up, down) = (mixture.above(0.5), mixture.below(-0.5));
        let p_zero = (total - up - down) / total;
        let zero = self.zero.code(
            coder,
            tables,
            [by_scale * OFFSET_BUCKETS + offset_bucket, contexts[0], contexts[1]],
            &[tables.stretch_real(p_zero)],
            kind,
            residual == 0,
        );
        if zero {
            return i32::try_from(base).ok();
        }

        let flip = usize::from(mirrored);
        let positive = self.sign.code(
            coder,
            tables,
            [(by_scale >> 2) * OFFSET_BUCKETS + offset_bucket, sign ^ flip],
            &[tables.stretch_real(up / (up + down))],
            kind,
            residual > 0,
        );
        if !positive {
            mixture.flip();
        }
        let magnitude = residual.unsigned_abs();

        // Exponent, one step at a time: is the magnitude at least 2^(exponent + 1)?
        let mut exponent = 0_u32;
        let mut tail = if positive { up } else { down };
        loop {
            let next_tail = mixture.above((2_u64 << exponent) as f64 - 0.5);
            let e = exponent as usize;
            let more = self.more.code(
                coder,
                tables,
                [by_scale * EXPONENTS + e, contexts[0] * EXPONENTS + e, contexts[1] * EXPONENTS + e],
                &[tables.stretch_real(next_tail / tail)],
                kind * EXPONENTS + e,
                magnitude >= 2 << exponent,
            );
            if !more {
                tail -= next_tail;
                break;
            }
            tail = next_tail;
            exponent += 1;
            if exponent as usize == EXPONENTS {
                return None;
            }
        }

        // Mantissa, halving the interval [low, low + 2^exponent).
        let mut low = 1_u64 << exponent;
        let mut mass = tail;
        for depth in 0..exponent {
            let half = 1_u64 << (exponent - 1 - depth);
            let middle = low + half;
            let bit = magnitude >= middle;
            let upper = mixture.above(middle as f64 - 0.5) - mixture.above((middle + half) as f64 - 0.5);
            let p_upper = upper / mass;
            let upper_half = if depth < MODELLED_MANTISSA {
                let d = depth as usize * EXPONENTS + exponent as usize;
                self.mantissa.code(
                    coder,
                    tables,
                    [d * SCALE_BUCKETS + bucket, d * NUM_KINDS + kind],
                    &[tables.stretch_real(p_upper)],
                    depth as usize,
                    bit,
                )
            } else {
                let p1 = (p_upper * f64::from(PROBABILITY_ONE)) as u32;
                coder.code(bit, p1.clamp(PROBABILITY_ONE / 8, PROBABILITY_ONE / 2))
            };
            if upper_half {
                low = middle;
                mass = upper;
            } else {
                mass -= upper;
            }
        }
        let magnitude = low as i64;
        let residual = if positive { magnitude } else { -magnitude };
        i32::try_from(if mirrored { base - residual } else { base + residual }).ok()
    }
}

/// The integer nearest to `x`, halves upwards: ⌊x + ½⌋ without the library call that `floor` is
/// where the processor's own is not assumed.
#[inline]
fn round_half_up(x: f64) -> i64 {
    let shifted = x + 0.5;
    let truncated = shifted as i64;
    truncated - i64::from(truncated as f64 > shifted)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bitstream::range_coder::{RangeDecoder, RangeEncoder};

    fn experts(centre: f64, scale: f64) -> [Expert; NUM_EXPERTS] {
        [Expert { centre, scale, weight: 0.4 }; NUM_EXPERTS]
    }

    fn expectation(experts: &[Expert; NUM_EXPERTS]) -> Expectation<'_> {
        let log_scale = experts[1].scale.log2();
        Expectation { experts, best: 1, log_scale, kind: 1, contexts: [3, 5], sign: 2 }
    }

    #[test]
    fn every_value_returns() {
        let values = [0, 1, -1, 2, -2, 3, 17, -100, 4095, -70_000, 1 << 30, -(1 << 30)];
        let centres = [0.0, 0.49, -0.5, 0.5, 1e3, -7.25, 1e9, f64::from(1 << 30), -f64::from(1 << 30)];
        let scales = [0.05, 1.0, 30.0, 1e6];
        let mut cases = Vec::new();
        for value in values {
            for centre in centres {
                cases.extend(scales.map(|scale| (value, experts(centre, scale))));
            }
        }
        let mut encoder = RangeEncoder::new();
        let mut model = ResidualModel::new();
        for (value, experts) in &cases {
            let expected = &expectation(experts);
            assert_eq!(model.code(&mut encoder, expected, *value), Some(*value));
        }
        let bytes = encoder.finish();
        let mut decoder = RangeDecoder::new(&bytes);
        let mut model = ResidualModel::new();
        for (value, experts) in &cases {
            let expected = &expectation(experts);
            assert_eq!(model.code(&mut decoder, expected, 0), Some(*value), "{expected:?}");
        }
    }

    #[test]
    fn a_good_prediction_is_cheap() {
        let mut encoder = RangeEncoder::new();
        let mut model = ResidualModel::new();
        for i in 0..10_000 {
            model.code(&mut encoder, &expectation(&experts(f64::from(i) + 0.1, 0.1)), i);
        }
        assert!(encoder.finish().len() < 60);
    }
}
