//! Densities of integers: several experts, each a centre and a scale (`format/SPEC.md`, section 6.4).

use super::tables::Tables;
use crate::util::simd4::Lanes;

/// Guesses at an integer; lane `i` is what expert `i` says. A lane may stay empty, with weight 0.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Mixture {
    /// Most likely value, within ±2³⁰ of the origin that the integer is counted from.
    pub(crate) centre: Lanes,
    /// One over the typical distance from it.
    pub(crate) sharpness: Lanes,
    /// Trust in the expert; they need not add up to one.
    pub(crate) weight: Lanes,
}

impl Mixture {
    /// A single expert, which predicts 0.
    pub(crate) fn around_zero(scale: f32) -> Self {
        let weight = Lanes([1.0, 0.0, 0.0, 0.0]);
        Self { centre: Lanes::splat(0.0), sharpness: Lanes::splat(1.0 / scale), weight }
    }

    /// The expert with the highest peak, the first one if equal.
    #[inline(always)]
    pub(crate) fn best(&self) -> usize {
        let peak = (self.weight * self.sharpness).0;
        let pair = |i: usize| if peak[i + 1] > peak[i] { i + 1 } else { i };
        let (a, b) = (pair(0), pair(2));
        if peak[b] > peak[a] { b } else { a }
    }

    /// The same seen from `origin`, downwards if `mirrored`.
    #[inline(always)]
    pub(crate) fn seen_from(&self, origin: f32, mirrored: bool) -> Self {
        let centre = self.centre - Lanes::splat(origin);
        Self { centre: centre * if mirrored { -1.0 } else { 1.0 }, ..*self }
    }

    /// All mass.
    #[inline(always)]
    pub(crate) fn total(&self) -> f32 {
        self.weight.sum()
    }

    /// Mass above `x`.
    #[inline(always)]
    pub(crate) fn above(&self, tables: &Tables, x: f32) -> f32 {
        (self.weight * tables.tail((Lanes::splat(x) - self.centre) * self.sharpness)).sum()
    }

    /// Mass below `x`.
    #[inline(always)]
    pub(crate) fn below(&self, tables: &Tables, x: f32) -> f32 {
        (self.weight * tables.tail((self.centre - Lanes::splat(x)) * self.sharpness)).sum()
    }

    /// How well each expert did, up to a common factor: its weight times a density with heavy tails at
    /// the decoded value. Cheaper than the exact mass, and as good for weighing experts.
    #[inline(always)]
    pub(crate) fn scores(&self, value: f32) -> Lanes {
        /// Variance of the rounding to integers.
        const ROUNDING: f32 = 1.0 / 12.0;
        let distance = self.centre - Lanes::splat(value);
        let precision = self.sharpness * self.sharpness;
        // scale³ / (scale² + rounding + distance²)², with the scale divided out.
        let spread = Lanes::splat(1.0) + (distance * distance + Lanes::splat(ROUNDING)) * precision;
        self.weight * self.sharpness.zip(spread, |s, r| s / (r * r))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn masses_add_up() {
        let mixture = Mixture {
            centre: Lanes([3.2, -1.0, 3.0, 0.0]),
            sharpness: Lanes([1.5, 0.25, 10.0, 1.0]),
            weight: Lanes([0.5, 0.3, 0.3, 0.0]),
        };
        let tables = Tables::get();
        for mirrored in [false, true] {
            let seen = mixture.seen_from(3.0, mirrored);
            for x in [-20.0, -0.5, 0.0, 0.5, 7.0] {
                assert!((seen.above(tables, x) + seen.below(tables, x) - seen.total()).abs() < 1e-6);
            }
            let other = mixture.seen_from(3.0, !mirrored);
            assert!((seen.above(tables, 0.5) - other.below(tables, -0.5)).abs() < 1e-6);
        }
        assert_eq!(mixture.best(), 2);
    }

    #[test]
    fn the_closer_and_the_surer_expert_scores_higher() {
        let mixture = Mixture {
            centre: Lanes([3.0, 5.0, 3.0, 9.0]),
            sharpness: Lanes([1.0, 1.0, 0.25, 0.25]),
            weight: Lanes::splat(0.5),
        };
        let [near, far, vague, vague_far] = mixture.scores(3.0).0;
        assert!(near > far && near > vague && vague > vague_far);
        let [sharp, _, _, vague] = Mixture { centre: Lanes::splat(9.0), ..mixture }.scores(3.0).0;
        assert!(vague > sharp);
    }
}
