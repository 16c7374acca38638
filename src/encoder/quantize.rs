//! The grid of the codec (`format/SPEC.md`, section 4.1): per-axis minimum, the longest side divided into 2^q − 1
//! steps, halves rounded up; or points of a lattice.

use crate::bitstream::grid::{Grid, Lattice, MAX_OFFSET, MAX_QUANTIZATION_BITS, Spread};
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
    let grid = cube_around(&Bounds::of(source.iter().map(|&v| at(v))), quantization_bits)?;
    let unit = unit_near(grid.side());
    Ok(Model {
        cells: source.iter().map(|&v| grid.cell(at(v))).collect(),
        positions: source.iter().map(|&v| at(v).map(|x| x * unit)).collect(),
        unit,
    })
}

/// The box around some points.
pub(crate) struct Bounds {
    low: [f64; 3],
    high: [f64; 3],
}

impl Bounds {
    /// That of points of which there is at least one.
    pub(crate) fn of(mut points: impl Iterator<Item = [f64; 3]>) -> Self {
        let first = points.next().unwrap_or_default();
        let (low, high) = points.fold((first, first), |(low, high), p| {
            (std::array::from_fn(|a| low[a].min(p[a])), std::array::from_fn(|a| high[a].max(p[a])))
        });
        Self { low, high }
    }

    /// Without −0, which sums lose.
    fn origin(&self) -> [f64; 3] {
        self.low.map(|l| l + 0.0)
    }
}

/// Rounds after which the side of a grid is left as it is.
const MAX_ROUNDS: usize = 64;

/// The cubic grid around points.
///
/// # Errors
/// If they span more than a double can hold.
pub(crate) fn cube_around(bounds: &Bounds, quantization_bits: u32) -> Result<Grid, EncodeError> {
    let Bounds { low, high } = *bounds;
    let longest = |high: [f64; 3]| (0..3).map(|a| high[a] - low[a]).fold(0.0, f64::max);
    let fits = |side: f64| side.is_finite() && low.iter().all(|l| (l + side).is_finite());
    let mut grid = Grid::cube(quantization_bits, bounds.origin(), longest(high));
    if !fits(grid.side()) {
        return Err(EncodeError::BoundingBox);
    }
    // The decoded points must span the same grid, so that encoding them again gives the same bytes; the
    // sum of origin and side is rounded.
    for _ in 0..MAX_ROUNDS {
        let again = longest(grid.position(grid.cell(high), quantization_bits));
        if again == grid.side() || !fits(again) {
            break;
        }
        grid = Grid::cube(quantization_bits, bounds.origin(), again);
    }
    Ok(grid)
}

/// The grid around points each of whose axes divides its own extent into as many steps as fit; `None` if they have no
/// extent, or too large or small a one.
pub(super) fn stretched_around(bounds: &Bounds, quantization_bits: u32) -> Option<Grid> {
    let origin = bounds.origin();
    let steps = f64::from((1_u32 << quantization_bits) - 1);
    let step_to = |high: [f64; 3]| -> [f64; 3] {
        let step: [f64; 3] = std::array::from_fn(|a| (high[a] - origin[a]) / steps);
        let largest = step.into_iter().fold(0.0, f64::max);
        step.map(|step| if step > 0.0 { step } else { largest })
    };
    let with = |step| {
        let spread = Spread::Lattice { lattice: Lattice { origin, step }, offset: [0; 3] };
        Some(Grid { quantization_bits, spread }).filter(Grid::is_sound)
    };
    let mut step = step_to(bounds.high);
    let mut grid = with(step)?;
    // As above: the decoded points must span the same grid.
    for _ in 0..MAX_ROUNDS {
        let again = step_to(grid.position(grid.cell(bounds.high), quantization_bits));
        if again == step {
            break;
        }
        (step, grid) = (again, with(again)?);
    }
    Some(grid)
}

/// The grid on a lattice around points, with as many bits as that takes.
///
/// # Errors
/// If 30 are not enough, or the points lie too far out to count the steps.
pub(super) fn on_lattice(bounds: &Bounds, lattice: Lattice) -> Result<Grid, EncodeError> {
    let (first, last) = (lattice.nearest(bounds.low), lattice.nearest(bounds.high));
    let most = f64::from((1_u32 << MAX_QUANTIZATION_BITS) - 1);
    let fits = |a: usize| {
        first[a].abs() <= MAX_OFFSET as f64
            && last[a].abs() <= MAX_OFFSET as f64
            && last[a] - first[a] <= most
    };
    if let Some(axis) = (0..3).find(|&axis| !fits(axis)) {
        return Err(too_fine(bounds, lattice, axis));
    }
    let cells = (0..3).map(|a| (last[a] - first[a]) as u32).fold(1, u32::max);
    let offset = first.map(|k| k as i64);
    let grid = Grid {
        quantization_bits: u32::BITS - cells.leading_zeros(),
        spread: Spread::Lattice { lattice, offset },
    };
    Some(grid).filter(Grid::is_sound).ok_or(EncodeError::BoundingBox)
}

/// What to say of a step that is too small for the points.
fn too_fine(bounds: &Bounds, Lattice { origin, step }: Lattice, axis: usize) -> EncodeError {
    let (low, high) = (bounds.low[axis], bounds.high[axis]);
    let most = f64::from((1_u32 << MAX_QUANTIZATION_BITS) - 2);
    let by_extent = high / most - low / most;
    let by_place = (low - origin[axis]).abs().max((high - origin[axis]).abs()) / MAX_OFFSET as f64;
    // Three digits are shown, of a number that is large enough however they are rounded.
    let smallest = 1.01 * by_extent.max(by_place);
    if !smallest.is_finite() {
        return EncodeError::BoundingBox;
    }
    EncodeError::StepTooSmall { axis: ['x', 'y', 'z'][axis], step: step[axis], smallest }
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
        let grid = cube_around(&Bounds::of(mesh.positions()[..3].iter().copied()), 2).unwrap();
        assert_eq!((grid.side(), grid.origin()), (3.0, [0.0, 10.0, -1.0]));
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
            let grid = cube_around(&Bounds::of(points.into_iter()), 20).unwrap();
            let side = grid.side();
            assert!((side - extent).abs() <= 4.0 * 7000.0 * f64::EPSILON, "{side} for {extent}");
            let decoded = points.map(|p| grid.position(grid.cell(p), 20));
            assert_eq!(cube_around(&Bounds::of(decoded.into_iter()), 20).unwrap(), grid);
            assert_eq!(decoded.map(|p| grid.cell(p)), points.map(|p| grid.cell(p)));
        }
    }

    #[test]
    fn axes_divide_their_own_extents_and_decoded_points_have_the_same_steps() {
        for (low, extent) in [
            ([6.9, 50.1, 100.0], [0.01, 0.02, 37.0]),
            ([0.1, -7.0, 0.3], [1000.0, 0.07, 0.14]),
            ([5e6, 1.0, -3.0], [0.3, 0.0, 1e-9]),
        ] {
            let high: [f64; 3] = std::array::from_fn(|a| low[a] + extent[a]);
            let grid = stretched_around(&Bounds { low, high }, 12).unwrap();
            let top = extent.map(|x| if x > 0.0 { 4095 } else { 0 });
            assert_eq!((grid.cell(low), grid.cell(high)), ([0; 3], top));
            let ends = [low, high].map(|p| grid.position(grid.cell(p), 12));
            assert_eq!(stretched_around(&Bounds::of(ends.into_iter()), 12).unwrap(), grid);
        }
        assert!(stretched_around(&Bounds { low: [1.0; 3], high: [1.0; 3] }, 12).is_none());
    }

    #[test]
    fn a_lattice_gets_the_bits_that_its_points_take() {
        let lattice = Lattice { origin: [0.5, 0.0, 0.0], step: [0.25, 1.0, 1.0] };
        let bits = |low, high| on_lattice(&Bounds { low, high }, lattice).map(|grid| grid.quantization_bits);
        assert_eq!(bits([-3.0; 3], [-3.0; 3]), Ok(1));
        assert_eq!(bits([-3.0; 3], [0.75, 0.0, 0.0]), Ok(4));
        assert_eq!(bits([-3.0; 3], [0.9, 0.0, 0.0]), Ok(5));
        let Err(EncodeError::StepTooSmall { axis: 'y', step: 1.0, smallest }) =
            bits([0.0; 3], [0.0, 1.1e9, 0.0])
        else {
            panic!("30 bits are not enough");
        };
        let enough = Lattice { step: [0.25, smallest, 1.0], ..lattice };
        let bounds = Bounds { low: [0.0; 3], high: [0.0, 1.1e9, 0.0] };
        assert_eq!(on_lattice(&bounds, enough).map(|grid| grid.quantization_bits), Ok(30));
        assert!(matches!(bits([1e16; 3], [1e16; 3]), Err(EncodeError::StepTooSmall { axis: 'x', .. })));
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
