//! Which grid a mesh gets: the cube around it, a lattice of its own, or one that the caller names.

use super::grid_choice::GridChoice;
use super::grid_error::{GridError, LostTriangles, Remedy};
use super::options::EncodeOptions;
use super::quantize::{Bounds, cube_around, on_lattice, stretched_around};
use crate::bitstream::grid::{Grid, Lattice};
use crate::error::EncodeError;
use crate::mesh::TriMesh;

/// The grid of a mesh whose vertices that are kept span `bounds`, and what it costs. `loose`: vertices that are kept
/// without triangles.
///
/// # Errors
/// If the mesh spans more than a double can hold, or more steps of a lattice than 30 bits count.
pub(super) fn choose(
    mesh: &TriMesh,
    options: &EncodeOptions,
    bounds: &Bounds,
    loose: &[u32],
) -> Result<(Grid, GridError), EncodeError> {
    let bits = options.quantization_bits;
    let grid = match options.grid {
        GridChoice::Lattice(lattice) => on_lattice(bounds, lattice)?,
        GridChoice::Auto | GridChoice::Cube => cube_around(bounds, bits)?,
    };
    if options.lossless {
        return Ok((grid, GridError::none(grid)));
    }
    let losses = LostTriangles::of(mesh, &grid);
    if !losses.are_many() {
        return Ok((grid, GridError::of(mesh, loose, grid, losses)));
    }
    if options.grid == GridChoice::Auto
        && let Some((grid, losses)) = stretched(mesh, bounds, bits)
    {
        return Ok((grid, GridError::of(mesh, loose, grid, losses)));
    }
    let remedy = remedy(mesh, options, bounds);
    Ok((grid, GridError { remedy, ..GridError::of(mesh, loose, grid, losses) }))
}

/// A grid whose axes divide their own extents, if few triangles are lost on it.
fn stretched(mesh: &TriMesh, bounds: &Bounds, bits: u32) -> Option<(Grid, LostTriangles)> {
    let grid = stretched_around(bounds, bits)?;
    let losses = LostTriangles::of(mesh, &grid);
    (!losses.are_many()).then_some((grid, losses))
}

/// What to ask for in place of a grid that is too coarse.
fn remedy(mesh: &TriMesh, options: &EncodeOptions, bounds: &Bounds) -> Option<Remedy> {
    let is_enough = |grid: &Grid| !LostTriangles::of(mesh, grid).are_many();
    let on_cube = |bits: u32| cube_around(bounds, bits).is_ok_and(|grid| is_enough(&grid));
    let may_stretch = options.grid == GridChoice::Auto;
    match options.grid {
        GridChoice::Lattice(Lattice { origin, step }) => {
            let finer = |halvings| step.map(|step| step * 0.5_f64.powi(halvings));
            let grids = (1..).map(finer).map_while(|step| {
                let grid = on_lattice(bounds, Lattice { origin, step }).ok()?;
                Some((step, grid))
            });
            let (step, _) = grids.take(30).find(|(_, grid)| is_enough(grid))?;
            Some(Remedy::Step(step))
        }
        GridChoice::Auto | GridChoice::Cube => {
            let enough =
                |&bits: &u32| on_cube(bits) || may_stretch && stretched(mesh, bounds, bits).is_some();
            (options.quantization_bits + 1..=30).find(enough).map(Remedy::Bits)
        }
    }
}
