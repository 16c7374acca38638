//! Where cells lie in model units (`format/SPEC.md`, section 4.1).

/// Largest number of bits per coordinate.
pub(crate) const MAX_QUANTIZATION_BITS: u32 = 30;
/// Largest offset of a grid on a lattice: the sum with a cell and a half is exact.
pub(crate) const MAX_OFFSET: i64 = 1 << 51;

/// Points at equal distances along each axis: point k is at `origin + k · step`.
///
/// Streams on one lattice have their vertices at points of it, computed in this order in `f64`: where two of them mean the
/// same point, they give it the same bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// Point 0, model units. It may be anywhere.
    pub origin: [f64; 3],
    /// Distance of neighbours along each axis, model units, above 0.
    pub step: [f64; 3],
}

impl Lattice {
    /// The number of the closest point along each axis, halves rounded up.
    #[cfg(feature = "encoder")]
    #[inline]
    pub(crate) fn nearest(&self, position: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| ((position[axis] - self.origin[axis]) / self.step[axis] + 0.5).floor())
    }

    /// Whether all of its numbers are.
    pub(crate) fn is_sound(&self) -> bool {
        self.origin.iter().all(|x| x.is_finite()) && self.step.iter().all(|&s| s.is_finite() && s > 0.0)
    }
}

/// How cells are spread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Spread {
    /// Cell `c` of the full grid stands for `origin + c / (2^bits − 1) · side`.
    Cube { origin: [f64; 3], side: f64 },
    /// Cell `c` of the full grid is point `offset + c` of a lattice.
    Lattice { lattice: Lattice, offset: [i64; 3] },
}

/// The grid of a stream.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Grid {
    pub(crate) quantization_bits: u32,
    pub(crate) spread: Spread,
}

impl Grid {
    #[cfg(any(feature = "encoder", test))]
    pub(crate) fn cube(quantization_bits: u32, origin: [f64; 3], side: f64) -> Self {
        Self { quantization_bits, spread: Spread::Cube { origin, side } }
    }

    /// The largest cell of the full grid.
    pub(crate) fn last_cell(&self) -> u32 {
        (1 << self.quantization_bits) - 1
    }

    /// Middle of the cells of the full grid that share the bits of `cell`, of which there are `quantization_bits`.
    pub(crate) fn position(&self, cell: [i32; 3], quantization_bits: u32) -> [f64; 3] {
        let hidden = self.quantization_bits - quantization_bits;
        let half = (f64::from(1_u32 << hidden) - 1.0) * 0.5;
        let fine = cell.map(|c| f64::from(c << hidden) + half);
        // One expression for both: a sum with 0 and a quotient by 1 are exact.
        let (origin, offset, steps, length) = match self.spread {
            Spread::Cube { origin, side } => (origin, [0; 3], f64::from(self.last_cell()), [side; 3]),
            Spread::Lattice { lattice, offset } => (lattice.origin, offset, 1.0, lattice.step),
        };
        std::array::from_fn(|axis| origin[axis] + (offset[axis] as f64 + fine[axis]) / steps * length[axis])
    }

    /// Sides of the cells of so many bits.
    pub(crate) fn step(&self, quantization_bits: u32) -> [f64; 3] {
        let merged = f64::from(1_u32 << (self.quantization_bits - quantization_bits));
        match self.spread {
            Spread::Cube { side, .. } => [side / f64::from(self.last_cell()) * merged; 3],
            Spread::Lattice { lattice, .. } => lattice.step.map(|step| step * merged),
        }
    }

    /// Half the sides of a cell of the full grid.
    pub(crate) fn half_step(&self) -> [f64; 3] {
        self.step(self.quantization_bits).map(|step| step * 0.5)
    }

    /// Where the first cell is.
    pub(crate) fn origin(&self) -> [f64; 3] {
        match self.spread {
            Spread::Cube { origin, .. } => origin,
            Spread::Lattice { .. } => self.position([0; 3], self.quantization_bits),
        }
    }

    /// How long the grid is along its longest axis.
    pub(crate) fn side(&self) -> f64 {
        match self.spread {
            Spread::Cube { side, .. } => side,
            Spread::Lattice { lattice, .. } => {
                lattice.step.into_iter().fold(0.0, f64::max) * f64::from(self.last_cell())
            }
        }
    }

    /// Whether it has so many bits and all of its positions are finite.
    pub(crate) fn is_sound(&self) -> bool {
        if !(1..=MAX_QUANTIZATION_BITS).contains(&self.quantization_bits) {
            return false;
        }
        match self.spread {
            Spread::Cube { origin, side } => {
                let ends = || origin.iter().all(|o| o.is_finite() && (o + side).is_finite());
                side.is_finite() && side >= 0.0 && ends()
            }
            Spread::Lattice { lattice, offset } => {
                let is_exact = offset.iter().all(|k| (-MAX_OFFSET..=MAX_OFFSET).contains(k));
                let last = self.last_cell() as i32;
                // Products and sums are monotonous: what lies between two finite ends is finite.
                let ends = || [[0; 3], [last; 3]].map(|cell| self.position(cell, self.quantization_bits));
                lattice.is_sound() && is_exact && ends().as_flattened().iter().all(|x| x.is_finite())
            }
        }
    }

    /// The cell of the full grid that is closest, halves rounded up.
    #[cfg(feature = "encoder")]
    pub(crate) fn cell(&self, position: [f64; 3]) -> [i32; 3] {
        let steps = f64::from(self.last_cell());
        match self.spread {
            Spread::Cube { origin, side } => std::array::from_fn(|axis| {
                let offset = position[axis] - origin[axis];
                let scaled = offset * steps / side;
                // Near the largest double the product overflows where the quotient does not.
                let scaled = if scaled.is_finite() { scaled } else { offset / side * steps };
                if side > 0.0 { (scaled + 0.5).floor().clamp(0.0, steps) as i32 } else { 0 }
            }),
            Spread::Lattice { lattice, offset } => {
                let nearest = lattice.nearest(position);
                std::array::from_fn(|axis| (nearest[axis] - offset[axis] as f64).clamp(0.0, steps) as i32)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn on(lattice: Lattice, offset: [i64; 3]) -> Grid {
        Grid { quantization_bits: 10, spread: Spread::Lattice { lattice, offset } }
    }

    #[test]
    fn a_point_of_a_lattice_has_the_same_bits_whatever_the_offset() {
        let lattice = Lattice { origin: [0.1, -7.3, 1e6], step: [0.1, 0.003, 1.0 / 3.0] };
        let (near, far) = (on(lattice, [-500, 0, 70]), on(lattice, [17, -900, 3]));
        for (cell, same) in [([600, 3, 5], [83, 903, 72]), ([1000, 0, 0], [483, 900, 67])] {
            assert_eq!(
                near.position(cell, 10).map(f64::to_bits),
                far.position(same, 10).map(f64::to_bits),
                "{cell:?}"
            );
        }
        assert_eq!(near.position([0; 3], 10), [0.1 + -500.0 * 0.1, -7.3, 1e6 + 70.0 / 3.0]);
    }

    #[test]
    fn coarse_cells_are_in_the_middle_of_fine_ones() {
        let grid = on(Lattice { origin: [0.0; 3], step: [1.0, 2.0, 0.5] }, [8, -8, 0]);
        assert_eq!(grid.position([1, 0, 2], 8), [8.0 + 5.5, 2.0 * (-8.0 + 1.5), 0.5 * 9.5]);
        assert_eq!(grid.step(8), [4.0, 8.0, 2.0]);
        assert_eq!((grid.origin(), grid.side()), ([8.0, -16.0, 0.0], 2046.0));
    }

    #[cfg(feature = "encoder")]
    #[test]
    fn positions_return_to_their_cells() {
        let grid = on(Lattice { origin: [0.1, -7.3, 1e6], step: [0.1, 0.003, 1.0 / 3.0] }, [-500, 2, 70]);
        for cell in [[0; 3], [1, 2, 3], [1023; 3], [511, 512, 513]] {
            assert_eq!(grid.cell(grid.position(cell, 10)), cell);
        }
    }
}
