//! From a mesh to the surface that is encoded: usable triangles on the grid, in an order that does not depend on the
//! file, cut where they are not manifold.

use super::attributes::{self, Elements, Quantized};
use super::canonical_order::{self, Ordered};
use super::choose_grid;
use super::coarsen::Placed;
use super::grid_error::GridError;
use super::isolated_and_degenerate::LooseElements;
use super::options::Input;
use super::quantize::Bounds;
use super::tie_break::Signatures;
use crate::bitstream::grid::Grid;
use crate::descriptors::{Features, FeaturesError};
use crate::error::EncodeError;
use crate::mesh::repair::{RepairReport, cut};
use crate::mesh::{Surface, TriMesh, has_three_vertices};
use bitvec::vec::BitVec;
use std::cell::OnceCell;

/// Stitched vertices are never removed unless they are a larger share of all: the base would be too large.
const MOST_STITCHED: f64 = 0.25;

/// How the vertices of the cut surface came about, and what else is kept of the mesh.
pub(super) struct GridSurface {
    pub(super) grid: Grid,
    pub(super) grid_error: GridError,
    pub(super) ordered: Ordered,
    /// Vertex of `ordered` for each vertex. Ascending.
    pub(super) source: Vec<u32>,
    /// Cell of each vertex at full precision.
    pub(super) cells: Vec<[i32; 3]>,
    pub(super) loose: LooseElements,
    pub(super) repair: RepairReport,
}

impl GridSurface {
    /// Chooses the grid, orders the usable triangles and cuts them into a surface.
    ///
    /// # Errors
    /// If there is no usable triangle, there are too many, or they span more than a double can hold.
    pub(super) fn of(input: Input) -> Result<(Surface, Self), EncodeError> {
        let Input { mesh, options, .. } = input;
        let num_usable = check_size(mesh)?;
        let mut loose = LooseElements::of(mesh, options);
        let (grid, grid_error) = choose_grid::choose(mesh, options, &bounds(mesh, &loose), &loose.vertices)?;
        let (ordered, triangles) = order(input, &grid, &mut loose);
        let (surface, source) = cut(triangles, ordered.cells.len());
        check_count(source.len())?;
        let repair = RepairReport {
            degenerate_triangles: if options.keep_degenerate { 0 } else { mesh.num_triangles() - num_usable },
            isolated_vertices: mesh.num_vertices() - ordered.cells.len() - loose.vertices.len(),
            repeated_vertices: source.len() - ordered.cells.len(),
        };
        let cells = source.iter().map(|&v| ordered.cells[v as usize]).collect();
        Ok((surface, Self { grid, grid_error, ordered, source, cells, loose, repair }))
    }

    /// The vertices where the grid has them.
    pub(super) fn placed(&self) -> Placed<'_> {
        Placed { cells: &self.cells, grid: &self.grid }
    }

    /// The attributes as integers, and those that the descriptor is to see.
    ///
    /// # Errors
    /// If one does not fit the mesh or the descriptor, or there are too many.
    pub(super) fn quantize_attributes(
        &self,
        input: Input,
    ) -> Result<(Quantized, Option<Features>), EncodeError> {
        let vertices = &self.vertices()[..];
        let elements = Elements { vertices, corners: &self.ordered.corner_source };
        let quantized = attributes::quantize(input, elements, self.loose.elements())?;
        let features =
            features(input, vertices).map_err(|e| EncodeError::DescriptorAttributes(e.to_string()))?;
        Ok((quantized, features))
    }

    /// The vertices that are never removed, so that their stitching is there from the start and no level has a crack.
    pub(super) fn stitched(&self) -> BitVec {
        let source = &self.source;
        let is_stitched = |i: usize| {
            (i > 0 && source[i - 1] == source[i]) || source.get(i + 1).is_some_and(|&next| next == source[i])
        };
        let stitched: BitVec = (0..source.len()).map(is_stitched).collect();
        if stitched.count_ones() as f64 > MOST_STITCHED * source.len() as f64 {
            return BitVec::repeat(false, source.len());
        }
        stitched
    }

    /// Vertex of the mesh for each vertex.
    fn vertices(&self) -> Vec<u32> {
        self.source.iter().map(|&v| self.ordered.vertex_source[v as usize]).collect()
    }
}

/// The number of usable triangles, if the format can hold the mesh.
fn check_size(mesh: &TriMesh) -> Result<usize, EncodeError> {
    let num_usable = mesh.triangles().iter().filter(|t| has_three_vertices(t)).count();
    if num_usable == 0 {
        return Err(EncodeError::NoTriangles);
    }
    if num_usable.max(mesh.num_vertices()) >= MOST_ELEMENTS {
        return Err(EncodeError::TooLarge(num_usable));
    }
    Ok(num_usable)
}

/// Indices of corners fit in 32 bits, with one to spare.
const MOST_ELEMENTS: usize = (u32::MAX / 4) as usize;

/// Checks the number of vertices after the cut.
fn check_count(num_vertices: usize) -> Result<(), EncodeError> {
    if num_vertices >= MOST_ELEMENTS { Err(EncodeError::TooLarge(num_vertices)) } else { Ok(()) }
}

/// The box around all that is kept.
fn bounds(mesh: &TriMesh, loose: &LooseElements) -> Bounds {
    let usable = mesh.triangles().iter().filter(|t| has_three_vertices(t));
    Bounds::of(usable.flatten().chain(&loose.vertices).map(|&v| mesh.positions()[v as usize]))
}

/// Orders the usable triangles, their vertices and the loose elements. Signatures are made where places do not tell all
/// of them apart, and once.
fn order(input: Input, grid: &Grid, loose: &mut LooseElements) -> (Ordered, Vec<[u32; 3]>) {
    let once = OnceCell::new();
    let make_signatures = || {
        let (vertices, corners) = surface_elements(input.mesh);
        let surface = Elements { vertices: &vertices, corners: &corners };
        Signatures::new(input, surface, loose.elements())
    };
    let signatures = || once.get_or_init(make_signatures).as_ref();
    let ordered = canonical_order::order(input.mesh, grid, &signatures);
    if loose.len() > 0 {
        let signatures = signatures();
        loose.sort(input.mesh, grid, signatures);
    }
    ordered
}

/// The vertices that usable triangles have, and the first corner of each of these.
fn surface_elements(mesh: &TriMesh) -> (Vec<u32>, Vec<u32>) {
    let usable = || (0..).zip(mesh.triangles()).filter(|(_, t)| has_three_vertices(t));
    let mut is_used = vec![false; mesh.num_vertices()];
    usable().for_each(|(_, t): (u32, _)| t.iter().for_each(|&v| is_used[v as usize] = true));
    let vertices = (0..).zip(is_used).filter_map(|(v, is_used)| is_used.then_some(v)).collect();
    (vertices, usable().map(|(face, _)| 3 * face).collect())
}

/// The attributes that the descriptor is to see at the `vertices` of the mesh.
fn features(input: Input, vertices: &[u32]) -> Result<Option<Features>, FeaturesError> {
    let Input { mesh, attributes, options } = input;
    if options.descriptor_attributes.is_empty() {
        return Ok(None);
    }
    let descriptor = options.descriptor;
    if !descriptor.knows_attributes() {
        return Err(FeaturesError::Descriptor { descriptor });
    }
    let features = Features::choose(mesh, attributes, &options.descriptor_attributes)?;
    Ok(Some(features.of_vertices(vertices)))
}
