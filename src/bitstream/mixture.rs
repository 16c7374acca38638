//! Densities of integers: several experts, each a centre and a scale (`format/SPEC.md`, section 6.4).

use super::tables::Tables;

/// Experts of a mixture.
pub(crate) const NUM_EXPERTS: usize = 3;

/// One guess at an integer.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Expert {
    /// Most likely value, within ±2³⁰.
    pub(crate) centre: f64,
    /// Typical distance from it.
    pub(crate) scale: f64,
    /// Trust in the expert; those of a mixture need not add up to one.
    pub(crate) weight: f64,
}

impl Expert {
    /// How well the expert did, up to a factor: trust times a density with heavy flanks at the value
    /// that came. Cheaper than the exact mass, and as good for weighing experts.
    #[inline]
    pub(crate) fn score(&self, value: f64) -> f64 {
        /// Variance of the rounding to integers.
        const ROUNDING: f64 = 1.0 / 12.0;
        let distance = value - self.centre;
        let variance = self.scale * self.scale;
        let spread = variance + ROUNDING + distance * distance;
        self.weight * self.scale * variance / (spread * spread)
    }
}

/// Sum of experts, seen from an origin in one direction.
pub(crate) struct Mixture<'a> {
    tables: &'a Tables,
    /// Centre, 1 / scale, weight.
    parts: [[f64; 3]; NUM_EXPERTS],
}

impl<'a> Mixture<'a> {
    /// Puts `origin` at 0; downwards if `mirrored`.
    pub(crate) fn new(
        tables: &'a Tables,
        experts: &[Expert; NUM_EXPERTS],
        origin: f64,
        mirrored: bool,
    ) -> Self {
        let parts = std::array::from_fn(|i| {
            let e = &experts[i];
            let centre = e.centre - origin;
            [if mirrored { -centre } else { centre }, 1.0 / e.scale, e.weight]
        });
        Self { tables, parts }
    }

    /// Turns the direction around.
    pub(crate) fn flip(&mut self) {
        self.parts.iter_mut().for_each(|p| p[0] = -p[0]);
    }

    /// All mass.
    pub(crate) fn total(&self) -> f64 {
        (self.parts[0][2] + self.parts[1][2]) + self.parts[2][2]
    }

    /// Mass above `x`.
    #[inline]
    pub(crate) fn above(&self, x: f64) -> f64 {
        let part = |[centre, step, weight]: [f64; 3]| weight * self.tables.tail((x - centre) * step);
        (part(self.parts[0]) + part(self.parts[1])) + part(self.parts[2])
    }

    /// Mass below `x`.
    #[inline]
    pub(crate) fn below(&self, x: f64) -> f64 {
        let part = |[centre, step, weight]: [f64; 3]| weight * self.tables.tail((centre - x) * step);
        (part(self.parts[0]) + part(self.parts[1])) + part(self.parts[2])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn masses_add_up() {
        let experts = [
            Expert { centre: 3.2, scale: 1.5, weight: 0.5 },
            Expert { centre: -1.0, scale: 4.0, weight: 0.3 },
            Expert { centre: 3.0, scale: 0.1, weight: 0.3 },
        ];
        let tables = Tables::get();
        for mirrored in [false, true] {
            let mut mixture = Mixture::new(tables, &experts, 3.0, mirrored);
            for x in [-20.0, -0.5, 0.0, 0.5, 7.0] {
                assert!((mixture.above(x) + mixture.below(x) - mixture.total()).abs() < 1e-6);
            }
            let above = mixture.above(0.5);
            mixture.flip();
            assert!((mixture.below(-0.5) - above).abs() < 1e-12);
        }
    }

    #[test]
    fn the_closer_and_the_surer_expert_scores_higher() {
        let expert = |centre, scale| Expert { centre, scale, weight: 0.5 };
        assert!(expert(3.0, 1.0).score(3.0) > expert(5.0, 1.0).score(3.0));
        assert!(expert(3.0, 1.0).score(3.0) > expert(3.0, 4.0).score(3.0));
        assert!(expert(9.0, 4.0).score(3.0) > expert(9.0, 1.0).score(3.0));
    }
}
