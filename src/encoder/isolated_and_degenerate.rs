//! Vertices that no usable triangle has and triangles that name a vertex twice: which of them are kept, and in
//! which order.

use super::attributes::Elements;
use super::options::EncodeOptions;
use super::tie_break::Signatures;
use crate::bitstream::grid::Grid;
use crate::mesh::surface::turns;
use crate::mesh::{TriMesh, has_three_vertices};
use crate::util::morton::morton;
use bitvec::vec::BitVec;

/// What is kept of a mesh that is no part of the surface.
pub(super) struct LooseElements {
    /// Vertices of the mesh that follow those of the surface.
    pub(super) vertices: Vec<u32>,
    /// First corners of the triangles that follow those of the surface.
    pub(super) corners: Vec<u32>,
}

impl LooseElements {
    /// Those of a mesh, in its own order.
    pub(super) fn of(mesh: &TriMesh, options: &EncodeOptions) -> Self {
        Self { vertices: isolated_vertices(mesh, options), corners: degenerate_corners(mesh, options) }
    }

    pub(super) fn len(&self) -> usize {
        self.vertices.len() + self.corners.len()
    }

    pub(super) fn elements(&self) -> Elements<'_> {
        Elements { vertices: &self.vertices, corners: &self.corners }
    }

    /// Puts them in an order that does not depend on that of the mesh.
    pub(super) fn sort(&mut self, mesh: &TriMesh, grid: &Grid, signatures: Option<&Signatures>) {
        sort_vertices(&mut self.vertices, mesh, grid, signatures);
        sort_corners(&mut self.corners, mesh, grid, signatures);
    }
}

/// The vertices that no usable triangle has and that are to be kept.
fn isolated_vertices(mesh: &TriMesh, options: &EncodeOptions) -> Vec<u32> {
    let mut is_used: BitVec = BitVec::repeat(false, mesh.num_vertices());
    let mut is_named: BitVec = BitVec::repeat(options.keep_isolated, mesh.num_vertices());
    for triangle in mesh.triangles() {
        let set = if has_three_vertices(triangle) { &mut is_used } else { &mut is_named };
        if has_three_vertices(triangle) || options.keep_degenerate {
            triangle.iter().for_each(|&v| set.set(v as usize, true));
        }
    }
    (0..mesh.num_vertices() as u32).filter(|&v| is_named[v as usize] && !is_used[v as usize]).collect()
}

/// The first corners of the triangles that name a vertex twice and are to be kept.
fn degenerate_corners(mesh: &TriMesh, options: &EncodeOptions) -> Vec<u32> {
    let loose =
        (0..).zip(mesh.triangles()).filter(|(_, t)| options.keep_degenerate && !has_three_vertices(t));
    loose.map(|(face, _): (u32, _)| 3 * face).collect()
}

/// Puts vertices in the order of their cells, ties by their coordinates and attributes.
fn sort_vertices(vertices: &mut [u32], mesh: &TriMesh, grid: &Grid, signatures: Option<&Signatures>) {
    let at = |v: u32| mesh.positions()[v as usize];
    let signature = |v: u32| signatures.map(|s| s.vertices[v as usize]);
    vertices.sort_by_cached_key(|&v| (morton(grid.cell(at(v))), at(v).map(f64::to_bits), signature(v), v));
}

/// Turns each triangle to its least corner and sorts them by their cells, ties by their attributes.
fn sort_corners(corners: &mut [u32], mesh: &TriMesh, grid: &Grid, signatures: Option<&Signatures>) {
    let turn = |corner: u32| {
        let vertices = turns(corner).map(|c| mesh.triangles().as_flattened()[c as usize]);
        let cells = vertices.map(|v| grid.cell(mesh.positions()[v as usize]));
        (cells, signatures.map(|s| s.triangle(corner)))
    };
    for corner in corners.iter_mut() {
        *corner = turns(*corner).into_iter().min_by_key(|&turned| turn(turned)).unwrap_or(*corner);
    }
    corners.sort_by_cached_key(|&corner| turn(corner));
}
