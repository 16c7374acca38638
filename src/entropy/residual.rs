//! An integer coded around a real prediction of it (`format/SPEC.md`, section 6.4).
//!
//! The prediction is a density: a centre and a scale. Its share of the mass on either side of each
//! binary decision goes into the mixer with the adaptive contexts, which correct its shape.

use super::context_mixer::{MixedBit, Mixing};
use super::mixture::Mixture;
use super::range_coder::{BitCoder, PROBABILITY_ONE};
use super::tables::{Tables, index_below, round_half_up};

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
pub(crate) struct Expectation {
    /// The integer from which everything is counted.
    pub(crate) origin: i32,
    pub(crate) mixture: Mixture,
    /// The expert whose centre is rounded, and the base-2 logarithm of its scale.
    pub(crate) best: usize,
    pub(crate) log_scale: f32,
    /// Which of the [`NUM_KINDS`] kinds of number it is.
    pub(crate) kind: usize,
    /// Two contexts of [`CALLER_CONTEXTS`] values.
    pub(crate) contexts: [usize; 2],
    /// One of [`SIGN_CONTEXTS`] values; bit 0 is flipped with the sign.
    pub(crate) sign: usize,
}

/// Adaptive models of residuals.
#[derive(Clone)]
pub(crate) struct ResidualModel {
    zero: MixedBit<3>,
    sign: MixedBit<2>,
    more: MixedBit<3>,
    mantissa: MixedBit<2>,
}

impl ResidualModel {
    const LIMIT: u32 = 250;

    pub(crate) fn new(mixing: Mixing) -> Self {
        let by_scale = NUM_KINDS * SCALE_BUCKETS;
        Self {
            zero: MixedBit::new(
                mixing,
                [by_scale * OFFSET_BUCKETS, CALLER_CONTEXTS, CALLER_CONTEXTS],
                NUM_KINDS,
                0.5,
                Self::LIMIT,
            ),
            sign: MixedBit::new(
                mixing,
                [by_scale * OFFSET_BUCKETS / 4, SIGN_CONTEXTS],
                NUM_KINDS,
                0.7,
                Self::LIMIT,
            ),
            more: MixedBit::new(
                mixing,
                [by_scale * EXPONENTS, CALLER_CONTEXTS * EXPONENTS, CALLER_CONTEXTS * EXPONENTS],
                NUM_KINDS * EXPONENTS,
                0.4,
                Self::LIMIT,
            ),
            mantissa: MixedBit::new(
                mixing,
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
        let Expectation { origin, ref mixture, best, log_scale, kind, contexts, sign } = *expected;
        let centre = mixture.centre.0[best];
        let nearest = round_half_up(centre);
        let fraction = centre - nearest as f32;
        let base = i64::from(origin) + i64::from(nearest);
        // Mirrored so that the centre never lies below the nearest integer: halves the contexts.
        let mirrored = fraction < 0.0;
        let offset = fraction.abs();
        let residual = if mirrored { base - i64::from(value) } else { i64::from(value) - base };

        let mixture = mixture.seen_from(nearest as f32, mirrored);
        let total = mixture.total();
        let bucket = index_below(log_scale * 4.0 + 12.0, SCALE_BUCKETS);
        let offset_bucket = index_below(offset * (2 * OFFSET_BUCKETS) as f32, OFFSET_BUCKETS);
        let by_scale = kind * SCALE_BUCKETS + bucket;

        let (up, down) = (mixture.above(tables, 0.5), mixture.below(tables, -0.5));
        let p_zero = (total - up - down) / total;
        let zero = self.zero.code(
            coder,
            tables,
            [by_scale * OFFSET_BUCKETS + offset_bucket, contexts[0], contexts[1]],
            [tables.stretch_real(p_zero)],
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
            [tables.stretch_real(up / (up + down))],
            kind,
            residual > 0,
        );
        let mixture = mixture.seen_from(0.0, !positive);
        let magnitude = residual.unsigned_abs();

        // Is the magnitude, at least 2^exponent, also at least 2^(exponent + 1)? `outer` and `beyond` are the masses above
        // these bounds. Far from all experts they may be 0 and a quotient infinite or NaN: `stretch_real` and the cast
        // below map both to the same entry on both sides (SPEC 6.4).
        let mut exponent = 0_u32;
        let mut outer = if positive { up } else { down };
        let mut beyond;
        loop {
            beyond = mixture.above(tables, (2_u64 << exponent) as f32 - 0.5);
            let e = exponent as usize;
            let more = self.more.code(
                coder,
                tables,
                [by_scale * EXPONENTS + e, contexts[0] * EXPONENTS + e, contexts[1] * EXPONENTS + e],
                [tables.stretch_real(beyond / outer)],
                kind * EXPONENTS + e,
                magnitude >= 2 << exponent,
            );
            if !more {
                break;
            }
            outer = beyond;
            exponent += 1;
            if exponent as usize == EXPONENTS {
                return None;
            }
        }

        // Mantissa, halving the interval [low, low + 2^exponent).
        let mut low = 1_u64 << exponent;
        for depth in 0..exponent {
            let middle = low + (1_u64 << (exponent - 1 - depth));
            let bit = magnitude >= middle;
            let upper = mixture.above(tables, middle as f32 - 0.5);
            let share = (upper - beyond) / (outer - beyond);
            let upper_half = if depth < MODELLED_MANTISSA {
                let d = depth as usize * EXPONENTS + exponent as usize;
                self.mantissa.code(
                    coder,
                    tables,
                    [d * SCALE_BUCKETS + bucket, d * NUM_KINDS + kind],
                    [tables.stretch_real(share)],
                    depth as usize,
                    bit,
                )
            } else {
                let p1 = (share * PROBABILITY_ONE as f32) as u32;
                coder.code(bit, p1.clamp(PROBABILITY_ONE / 8, PROBABILITY_ONE / 2))
            };
            if upper_half {
                low = middle;
                outer = upper;
            } else {
                beyond = upper;
            }
        }
        let magnitude = low as i64;
        let residual = if positive { magnitude } else { -magnitude };
        i32::try_from(if mirrored { base - residual } else { base + residual }).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::entropy::range_coder::{RangeDecoder, RangeEncoder};
    use crate::util::simd4::Lanes;

    fn expectation(origin: i32, centre: f32, scale: f32) -> Expectation {
        let mixture = Mixture {
            centre: Lanes::splat(centre),
            sharpness: Lanes::splat(1.0 / scale),
            weight: Lanes::splat(0.3),
        };
        Expectation { origin, mixture, best: 1, log_scale: scale.log2(), kind: 1, contexts: [3, 5], sign: 2 }
    }

    #[test]
    fn every_value_returns() {
        let values = [0, 1, -1, 2, -2, 3, 17, -100, 4095, -70_000, 1 << 30, -(1 << 30)];
        let origins = [0, 1000, 1 << 30, -(1 << 30)];
        let centres = [0.0, 0.49, -0.5, 0.5, 1e3, -7.25, 1e9, -1e9];
        let scales = [0.05, 1.0, 30.0, 1e6];
        let mut cases = Vec::new();
        for value in values {
            for origin in origins {
                for centre in centres {
                    cases.extend(scales.map(|scale| (value, expectation(origin, centre, scale))));
                }
            }
        }
        let mut encoder = RangeEncoder::new();
        let mut model = ResidualModel::new(Mixing::Plain);
        for (value, expected) in &cases {
            assert_eq!(model.code(&mut encoder, expected, *value), Some(*value));
        }
        let bytes = encoder.finish();
        let mut decoder = RangeDecoder::new(&bytes);
        let mut model = ResidualModel::new(Mixing::Plain);
        for (value, expected) in &cases {
            assert_eq!(model.code(&mut decoder, expected, 0), Some(*value), "{expected:?}");
        }
    }

    #[test]
    fn a_good_prediction_is_cheap() {
        let mut encoder = RangeEncoder::new();
        let mut model = ResidualModel::new(Mixing::Plain);
        for i in 0..10_000 {
            model.code(&mut encoder, &expectation(i, 0.1, 0.1), i);
        }
        assert!(encoder.finish().len() < 60);
    }
}
