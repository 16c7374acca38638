//! What rounding to the grid does to a mesh.

use super::quantize::unit_near;
use crate::bitstream::grid::Grid;
use crate::mesh::edge_lengths::{length, mean_edge_lengths};
use crate::mesh::{TriMesh, has_three_vertices};
use glam::DVec3;
use rayon::prelude::*;

/// More triangles than this share of all that collapse or turn over are too many.
const MOST_LOST: f64 = 0.01;

/// How far the finest mesh of a stream is from the mesh that was encoded. With [`lossless`](crate::EncodeOptions::lossless)
/// all but the step is 0.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct GridError {
    /// Sides of a cell of the grid, model units.
    pub step: [f64; 3],
    /// Largest distance of a vertex from its place in the finest mesh, model units.
    pub largest_error: f64,
    /// The largest distance over the mean length of the vertex's edges, where each counts once per triangle that has it.
    pub largest_error_in_edges: f64,
    /// Triangles of three different vertices that have an area in the mesh and none on the grid.
    pub triangles_collapsed: usize,
    /// Triangles that have an area on the grid, and face the other way there.
    pub triangles_turned: usize,
    /// Triangles of three different vertices.
    pub num_triangles: usize,
    /// What would do in place of a grid that is too coarse: see [`is_too_coarse`](Self::is_too_coarse).
    pub remedy: Option<Remedy>,
}

/// What to ask for in place of a grid that is too coarse.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Remedy {
    /// The fewest [`quantization_bits`](crate::EncodeOptions::quantization_bits) with which at most 1 % of the triangles are
    /// lost.
    Bits(u32),
    /// Steps of a lattice, model units.
    Step([f64; 3]),
}

impl GridError {
    /// Whether more than 1 % of the triangles collapse or turn over.
    pub fn is_too_coarse(&self) -> bool {
        self.losses().are_many()
    }

    /// Triangles that collapse or turn over.
    pub fn triangles_lost(&self) -> usize {
        self.losses().lost()
    }

    fn losses(&self) -> LostTriangles {
        let Self { triangles_collapsed: collapsed, triangles_turned: turned, num_triangles: all, .. } = *self;
        LostTriangles { collapsed, turned, all }
    }

    /// That of a mesh that is kept bit for bit.
    pub(super) fn none(grid: Grid) -> Self {
        Self {
            step: grid.step(grid.quantization_bits),
            largest_error: 0.0,
            largest_error_in_edges: 0.0,
            triangles_collapsed: 0,
            triangles_turned: 0,
            num_triangles: 0,
            remedy: None,
        }
    }

    /// That of a mesh on a grid. `loose`: vertices that are kept without triangles.
    pub(super) fn of(mesh: &TriMesh, loose: &[u32], grid: Grid, losses: LostTriangles) -> Self {
        let error = |vertex: usize| {
            let position = mesh.positions()[vertex];
            let place = grid.position(grid.cell(position), grid.quantization_bits);
            length([0, 1, 2].map(|axis| place[axis] - position[axis]))
        };
        let edges = mean_edge_lengths(mesh);
        let of_vertex = |vertex: usize| match edges[vertex] {
            None => [0.0; 2],
            Some(0.0) => [error(vertex), 0.0],
            Some(mean) => [error(vertex), error(vertex) / mean],
        };
        let largest = |a: [f64; 2], b: [f64; 2]| [a[0].max(b[0]), a[1].max(b[1])];
        let found = (0..mesh.num_vertices()).into_par_iter().map(of_vertex).reduce(|| [0.0; 2], largest);
        let [of_surface, in_edges] = found;
        let LostTriangles { collapsed, turned, all } = losses;
        Self {
            largest_error: loose.iter().map(|&v| error(v as usize)).fold(of_surface, f64::max),
            largest_error_in_edges: in_edges,
            triangles_collapsed: collapsed,
            triangles_turned: turned,
            num_triangles: all,
            ..Self::none(grid)
        }
    }
}

/// How many triangles a grid takes from a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct LostTriangles {
    pub(super) collapsed: usize,
    pub(super) turned: usize,
    /// Triangles of three different vertices.
    pub(super) all: usize,
}

impl LostTriangles {
    pub(super) fn of(mesh: &TriMesh, grid: &Grid) -> Self {
        let [x, y, z] = relative(grid.step(grid.quantization_bits));
        // How an area vector in cells is stretched to one in model units.
        let stretch = [y * z, z * x, x * y];
        // Near 1, so that products neither overflow nor vanish.
        let unit = unit_near(grid.side().min(longest_side(mesh)));
        let of_triangle = |triangle: &[u32; 3]| {
            let corners = triangle.map(|v| mesh.positions()[v as usize]);
            let (before, after) = (area(corners, unit), on_grid(corners.map(|p| grid.cell(p))));
            let has_area = before != [0.0; 3];
            let is_flat = after == [0; 3];
            let cosine: f64 = (0..3).map(|a| before[a] * (after[a] as f64 * stretch[a])).sum();
            let [collapsed, turned] = [has_area && is_flat, has_area && !is_flat && cosine <= 0.0];
            Self { collapsed: collapsed.into(), turned: turned.into(), all: 1 }
        };
        let usable = mesh.triangles().par_iter().filter(|t| has_three_vertices(t));
        usable.map(of_triangle).reduce(Self::default, Self::plus)
    }

    fn plus(self, other: Self) -> Self {
        Self {
            collapsed: self.collapsed + other.collapsed,
            turned: self.turned + other.turned,
            all: self.all + other.all,
        }
    }

    fn lost(self) -> usize {
        self.collapsed + self.turned
    }

    pub(super) fn are_many(self) -> bool {
        self.lost() as f64 > MOST_LOST * self.all as f64
    }
}

/// The longest side of the box around all vertices.
fn longest_side(mesh: &TriMesh) -> f64 {
    let (low, high) = mesh.bounding_box().unwrap_or_default();
    (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max)
}

/// Steps as shares of the largest; 1 if there is none.
pub(super) fn relative(step: [f64; 3]) -> [f64; 3] {
    let largest = step.into_iter().fold(0.0, f64::max);
    step.map(|step| if largest > 0.0 { step / largest } else { 1.0 })
}

/// Twice the area of a triangle, along its normal, in units of which a model unit has `unit`.
fn area([a, b, c]: [[f64; 3]; 3], unit: f64) -> [f64; 3] {
    let edge = |to: [f64; 3]| DVec3::from(std::array::from_fn(|axis| (to[axis] - a[axis]) * unit));
    edge(b).cross(edge(c)).to_array()
}

/// The same of a triangle in cells, exactly.
fn on_grid([a, b, c]: [[i32; 3]; 3]) -> [i64; 3] {
    let edge = |to: [i32; 3]| -> [i64; 3] { std::array::from_fn(|k| i64::from(to[k]) - i64::from(a[k])) };
    let (u, v) = (edge(b), edge(c));
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    const STRIP: [[u32; 3]; 2] = [[0, 1, 2], [1, 3, 2]];

    fn strip(width: f64) -> TriMesh {
        let positions = vec![[0.0; 3], [100.0, 0.0, 0.0], [0.0, width, 0.0], [100.0, width, 0.0]];
        TriMesh::new(positions, STRIP.to_vec()).unwrap()
    }

    fn measure(mesh: &TriMesh, grid: Grid) -> GridError {
        GridError::of(mesh, &[], grid, LostTriangles::of(mesh, &grid))
    }

    #[test]
    fn thin_triangles_collapse_on_a_coarse_grid_only() {
        let on = |bits| measure(&strip(0.1), Grid::cube(bits, [0.0; 3], 100.0));
        assert_eq!((on(4).triangles_collapsed, on(4).triangles_turned), (2, 0));
        assert!(on(4).is_too_coarse() && !on(12).is_too_coarse());
        assert_eq!(on(4).largest_error, 0.1);
        assert!((on(4).largest_error_in_edges - 0.1 / ((200.1 + 100.0) / 4.0)).abs() < 1e-3, "{:?}", on(4));
    }

    #[test]
    fn a_triangle_that_turns_is_not_one_that_collapses() {
        // The third corner jumps over the edge between the others: 0.6 and 1.4 both become 1.
        let positions = vec![[0.0; 3], [4.0, 1.4, 0.0], [2.0, 0.6, 0.0], [0.0, 4.0, 0.0]];
        let turned = TriMesh::new(positions, vec![[0, 1, 2], [0, 1, 3]]).unwrap();
        let found = measure(&turned, Grid::cube(3, [0.0; 3], 7.0));
        let counts = (found.triangles_collapsed, found.triangles_turned, found.num_triangles);
        assert_eq!(counts, (0, 1, 2), "{found:?}");
    }

    #[test]
    fn triangles_without_area_cannot_be_lost() {
        let flat = TriMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]], vec![[0, 1, 2]]).unwrap();
        let found = measure(&flat, Grid::cube(1, [0.0; 3], 2.0));
        assert_eq!((found.triangles_lost(), found.num_triangles), (0, 1));
    }

    #[test]
    fn a_grid_without_any_relation_to_the_mesh_takes_it_all() {
        let lost = |side| LostTriangles::of(&strip(0.1), &Grid::cube(4, [0.0; 3], side)).lost();
        assert_eq!([1e100, 1e200, 1e300].map(lost), [2; 3]);
    }

    #[test]
    fn sizes_do_not_matter() {
        for scale in [1e-300, 1e-160, 1.0, 1e150, 1e300] {
            let (positions, triangles) = strip(0.1).into_parts();
            let positions = positions.into_iter().map(|p| p.map(|x| x * scale)).collect();
            let mesh = TriMesh::new(positions, triangles).unwrap();
            let lost = |bits| LostTriangles::of(&mesh, &Grid::cube(bits, [0.0; 3], 100.0 * scale)).lost();
            assert_eq!((lost(4), lost(12)), (2, 0), "{scale}");
        }
    }
}
