//! The grid of the codec (`NOTES`, "Grid": per-axis minimum, the longest side divided into 2^q − 1
//! steps, halves rounded up).

use crate::bitstream::header::Grid;
use crate::{EncodeError, TriMesh};

/// Bits of a grid that is finer than float32, on which the sides of faces are compared where no stream sets
/// a grid.
pub(crate) const LEGALITY_BITS: u32 = 30;

/// The vertices of a surface, on the grid and off it.
pub(crate) struct Model {
    pub(crate) grid: Grid,
    pub(crate) cells: Vec<[i32; 3]>,
    /// Coordinates of the input times `unit`.
    pub(crate) positions: Vec<[f64; 3]>,
    /// A power of two that brings the side near 1, so that squares neither overflow nor vanish.
    pub(crate) unit: f64,
}

impl Model {
    /// Steps of the grid to a unit of `positions`; 0 if all vertices share one place.
    pub(super) fn steps_per_unit(&self) -> f64 {
        let side = self.grid.side * self.unit;
        if side > 0.0 { f64::from((1_u32 << self.grid.precision) - 1) / side } else { 0.0 }
    }
}

/// Quantises the vertices `source` of `mesh`; there is at least one.
pub(crate) fn quantise(mesh: &TriMesh, source: &[u32], precision: u32) -> Result<Model, EncodeError> {
    let at = |v: u32| mesh.positions()[v as usize];
    let first = at(source[0]);
    let (low, high) = source.iter().map(|&v| at(v)).fold((first, first), |(low, high), p| {
        (std::array::from_fn(|a| low[a].min(p[a])), std::array::from_fn(|a| high[a].max(p[a])))
    });
    let side = (0..3).map(|a| high[a] - low[a]).fold(0.0, f64::max);
    if !(side.is_finite() && low.iter().all(|l| (l + side).is_finite())) {
        return Err(EncodeError::BoundingBox);
    }
    let steps = f64::from((1_u32 << precision) - 1);
    let cell = |x: f64, low: f64| {
        let scaled = (x - low) * steps / side;
        let scaled = if scaled.is_finite() { scaled } else { (x - low) / side * steps };
        if side > 0.0 { (scaled + 0.5).floor().clamp(0.0, steps) as i32 } else { 0 }
    };
    let unit = unit_near(side);
    Ok(Model {
        grid: Grid { precision, origin: low.map(|l| l + 0.0), side },
        cells: source.iter().map(|&v| std::array::from_fn(|a| cell(at(v)[a], low[a]))).collect(),
        positions: source.iter().map(|&v| at(v).map(|x| x * unit)).collect(),
        unit,
    })
}

/// A power of two that brings `side` near 1.
pub(crate) fn unit_near(side: f64) -> f64 {
    power_of_two_near(1.0 / side.max(f64::MIN_POSITIVE))
}

/// The power of two at or below a positive number, within what a double can hold as a normal.
fn power_of_two_near(x: f64) -> f64 {
    let exponent = (x.to_bits() >> 52 & 0x7ff).clamp(1, 2046);
    f64::from_bits(exponent << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_go_up_and_ends_meet_the_grid() {
        let positions = vec![[0.0, 10.0, -1.0], [3.0, 10.5, -1.0], [1.5, 10.0, -1.0], [99.0; 3]];
        let mesh = TriMesh::new(positions, vec![[0, 1, 2]]).unwrap();
        let model = quantise(&mesh, &[0, 1, 2], 2).unwrap();
        assert_eq!(model.cells, [[0, 0, 0], [3, 1, 0], [2, 0, 0]]);
        assert_eq!((model.grid.side, model.grid.origin), (3.0, [0.0, 10.0, -1.0]));
    }

    #[test]
    fn any_size_fits() {
        for size in [0.0, 1e-320, 1e-42, 1.0, 1e200, 8e307] {
            let mesh =
                TriMesh::new(vec![[0.0; 3], [size, 0.0, 0.0], [0.0, size, 0.0]], vec![[0, 1, 2]]).unwrap();
            let model = quantise(&mesh, &[0, 1, 2], 30).unwrap();
            let top = if size > 0.0 { (1 << 30) - 1 } else { 0 };
            assert_eq!(model.cells, [[0, 0, 0], [top, 0, 0], [0, top, 0]], "{size}");
        }
        let mesh = TriMesh::new(vec![[-1e308; 3], [1e308; 3], [0.0; 3]], vec![[0, 1, 2]]).unwrap();
        assert!(matches!(quantise(&mesh, &[0, 1, 2], 12), Err(EncodeError::BoundingBox)));
    }
}
