//! The grid of the codec (`format/SPEC.md`, section 4.1): per-axis minimum, the longest side divided into 2^q − 1
//! steps, halves rounded up.

use crate::bitstream::header::Grid;
use crate::error::EncodeError;
use crate::mesh::TriMesh;

/// Bits of a grid that is finer than float32, on which the sides of faces are compared where no stream sets
/// a grid.
pub(crate) const LEGALITY_BITS: u32 = 30;

/// The vertices of a surface, on the grid and off it.
pub(crate) struct Model {
    pub(crate) cells: Vec<[i32; 3]>,
    /// Coordinates of the input times `unit`.
    pub(crate) positions: Vec<[f64; 3]>,
    /// A power of two that brings the side near 1, so that squares neither overflow nor vanish.
    pub(crate) unit: f64,
}

/// Quantizes the vertices `source` of `mesh`; there is at least one.
pub(crate) fn quantize(mesh: &TriMesh, source: &[u32], quantization_bits: u32) -> Result<Model, EncodeError> {
    let at = |v: u32| mesh.positions()[v as usize];
    let grid = grid_around(source.iter().map(|&v| at(v)), quantization_bits)?;
    let unit = unit_near(grid.side);
    Ok(Model {
        cells: source.iter().map(|&v| grid.cell(at(v))).collect(),
        positions: source.iter().map(|&v| at(v).map(|x| x * unit)).collect(),
        unit,
    })
}

/// Rounds after which the side of a grid is left as it is.
const MAX_ROUNDS: usize = 64;

/// The grid of some points, of which there is at least one.
///
/// # Errors
/// If they span more than a double can hold.
pub(crate) fn grid_around(
    mut points: impl Iterator<Item = [f64; 3]>,
    quantization_bits: u32,
) -> Result<Grid, EncodeError> {
    let first = points.next().unwrap_or_default();
    let (low, high) = points.fold((first, first), |(low, high), p| {
        (std::array::from_fn(|a| low[a].min(p[a])), std::array::from_fn(|a| high[a].max(p[a])))
    });
    let longest = |high: [f64; 3]| (0..3).map(|a| high[a] - low[a]).fold(0.0, f64::max);
    let fits = |side: f64| side.is_finite() && low.iter().all(|l| (l + side).is_finite());
    let mut grid = Grid { quantization_bits, origin: low.map(|l| l + 0.0), side: longest(high) };
    if !fits(grid.side) {
        return Err(EncodeError::BoundingBox);
    }
    // The decoded points must span the same grid, so that encoding them again gives the same bytes; the
    // sum of origin and side is rounded.
    for _ in 0..MAX_ROUNDS {
        let again = longest(grid.position(grid.cell(high), quantization_bits));
        if again == grid.side || !fits(again) {
            break;
        }
        grid.side = again;
    }
    Ok(grid)
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
        let model = quantize(&mesh, &[0, 1, 2], 2).unwrap();
        assert_eq!(model.cells, [[0, 0, 0], [3, 1, 0], [2, 0, 0]]);
        let grid = grid_around(mesh.positions()[..3].iter().copied(), 2).unwrap();
        assert_eq!((grid.side, grid.origin), (3.0, [0.0, 10.0, -1.0]));
    }

    #[test]
    fn decoded_points_have_the_same_grid_and_cells() {
        // Sums that are rounded: origins that are not binary fractions, three sides of one length.
        let mut seed = 1_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 40) as f64 / 1e3 - 7000.0
        };
        for _ in 0..2000 {
            let low: [f64; 3] = std::array::from_fn(|_| random());
            let extent = random().abs() / 10.0 + 0.1;
            let points = [low, low.map(|l| l + extent), low.map(|l| l + extent / 3.0)];
            let grid = grid_around(points.into_iter(), 20).unwrap();
            assert!((grid.side - extent).abs() <= 4.0 * 7000.0 * f64::EPSILON, "{} for {extent}", grid.side);
            let decoded = points.map(|p| grid.position(grid.cell(p), 20));
            assert_eq!(grid_around(decoded.into_iter(), 20).unwrap(), grid);
            assert_eq!(decoded.map(|p| grid.cell(p)), points.map(|p| grid.cell(p)));
        }
    }

    #[test]
    fn any_size_fits() {
        for size in [0.0, 1e-320, 1e-42, 1.0, 1e200, 8e307] {
            let mesh =
                TriMesh::new(vec![[0.0; 3], [size, 0.0, 0.0], [0.0, size, 0.0]], vec![[0, 1, 2]]).unwrap();
            let model = quantize(&mesh, &[0, 1, 2], 30).unwrap();
            let top = if size > 0.0 { (1 << 30) - 1 } else { 0 };
            assert_eq!(model.cells, [[0, 0, 0], [top, 0, 0], [0, top, 0]], "{size}");
        }
        let mesh = TriMesh::new(vec![[-1e308; 3], [1e308; 3], [0.0; 3]], vec![[0, 1, 2]]).unwrap();
        assert!(matches!(quantize(&mesh, &[0, 1, 2], 12), Err(EncodeError::BoundingBox)));
    }
}
