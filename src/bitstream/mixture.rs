//! Densities of integers: several experts, each a centre and a scale (`format/SPEC.md`, section 6.4).

use super::tables::Tables;

/// Experts of a mixture.
pub(crate) const NUM_EXPERTS: usize = 3;

/// Widths and weight of the two logistic densities that make an expert, relative to its scale.
const NARROW: f64 = 0.8;
const WIDE: f64 = 2.4;
const NARROW_SHARE: f64 = 0.75;
/// Mass that an expert gives to any value, however far.
const LEAST_MASS: f64 = 1e-9;

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
    /// Mass on one integer.
    pub(crate) fn mass_of(&self, tables: &Tables, value: i32) -> f64 {
        let distance = (f64::from(value) - self.centre).abs();
        let mass = |width: f64| {
            let step = 1.0 / (width * self.scale);
            tables.tail((distance - 0.5) * step) - tables.tail((distance + 0.5) * step)
        };
        NARROW_SHARE * mass(NARROW) + (1.0 - NARROW_SHARE) * mass(WIDE) + LEAST_MASS
    }
}

/// Sum of experts, seen from an origin in one direction.
pub(crate) struct Mixture<'a> {
    tables: &'a Tables,
    /// Centre, 1 / narrow width, 1 / wide width, weight.
    parts: [[f64; 4]; NUM_EXPERTS],
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
            let step = 1.0 / e.scale;
            [if mirrored { -centre } else { centre }, step * (1.0 / NARROW), step * (1.0 / WIDE), e.weight]
        });
        Self { tables, parts }
    }

    /// Turns the direction around.
    pub(crate) fn flip(&mut self) {
        self.parts.iter_mut().for_each(|p| p[0] = -p[0]);
    }

    /// All mass.
    pub(crate) fn total(&self) -> f64 {
        (self.parts[0][3] + self.parts[1][3]) + self.parts[2][3]
    }

    /// Mass above `x`.
    #[inline]
    pub(crate) fn above(&self, x: f64) -> f64 {
        let part = |p: &[f64; 4]| {
            let d = x - p[0];
            p[3] * (NARROW_SHARE * self.tables.tail(d * p[1])
                + (1.0 - NARROW_SHARE) * self.tables.tail(d * p[2]))
        };
        (part(&self.parts[0]) + part(&self.parts[1])) + part(&self.parts[2])
    }

    /// Mass below `x`.
    #[inline]
    pub(crate) fn below(&self, x: f64) -> f64 {
        let part = |p: &[f64; 4]| {
            let d = p[0] - x;
            p[3] * (NARROW_SHARE * self.tables.tail(d * p[1])
                + (1.0 - NARROW_SHARE) * self.tables.tail(d * p[2]))
        };
        (part(&self.parts[0]) + part(&self.parts[1])) + part(&self.parts[2])
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
                assert!((mixture.above(x) + mixture.below(x) - mixture.total()).abs() < 1e-9);
            }
            let above = mixture.above(0.5);
            mixture.flip();
            assert!((mixture.below(-0.5) - above).abs() < 1e-12);
        }
        let sum: f64 = (-400..400).map(|v| experts[1].mass_of(tables, v)).sum();
        assert!((sum - 1.0).abs() < 1e-3);
    }
}
