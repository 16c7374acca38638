//! The mesh a decoder holds, as callers see it.

use super::assemble::Extras;
use crate::bitstream::compensation::Compensation;
use crate::bitstream::grid::Grid;
use crate::mesh::TriMesh;
use crate::passes::compensation::Mover;

/// A borrowed view of the finest complete mesh: valid until the decoder takes more bytes.
#[derive(Clone, Copy)]
pub struct LevelMesh<'a> {
    pub(super) cells: &'a [[i32; 3]],
    pub(super) triangles: &'a [[u32; 3]],
    pub(super) grid: &'a Grid,
    pub(super) quantization_bits: u32,
    pub(super) level: u32,
    pub(super) compensation: Compensation,
    pub(super) extras: &'a Extras,
}

impl<'a> LevelMesh<'a> {
    /// Level of the mesh, 0 = base.
    pub fn level(&self) -> u32 {
        self.level
    }

    /// Bits per coordinate that are known so far.
    pub fn quantization_bits(&self) -> u32 {
        self.quantization_bits
    }

    /// Number of vertices.
    pub fn num_vertices(&self) -> usize {
        self.cells.len()
    }

    /// Number of triangles.
    pub fn num_triangles(&self) -> usize {
        self.triangles.len()
    }

    /// Vertex indices of the triangles, m × 3, counter-clockwise. Each directed edge occurs once.
    pub fn triangles(&self) -> &'a [[u32; 3]] {
        self.triangles
    }

    /// Grid cells of the vertices, n × 3, each below 2^[`quantization_bits`](Self::quantization_bits).
    pub fn quantized_positions(&self) -> &'a [[i32; 3]] {
        self.cells
    }

    /// The middle of a vertex's cell in model units: on the surface that was encoded, except for the bits not
    /// received yet.
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn dequantize(&self, vertex: usize) -> [f64; 3] {
        self.grid.position(self.cells[vertex], self.quantization_bits)
    }

    /// Whether vertices are shown off the middles of their cells, see [`positions`](Self::positions).
    pub fn has_shrinkage_compensation(&self) -> bool {
        self.compensation != Compensation::NONE
    }

    /// Positions in model units, in order. A coarse mesh whose vertices lie on a curved surface lies inside
    /// it. So until the last pass vertices are shown a little further out, by as much as the encoder found
    /// best, unless [`DecodeOptions::shrinkage_compensation`](crate::DecodeOptions::shrinkage_compensation) says otherwise.
    pub fn positions(&self) -> Vec<[f64; 3]> {
        let mut placing = PositionUpdater::new(self);
        placing.advance(self, usize::MAX);
        (0..self.num_vertices()).map(|v| placing.position(self, v)).collect()
    }

    /// The mesh that was encoded, as far as this level and the chunks received so far describe it. Vertices
    /// are stitched where the surface was cut, and triangles that then have fewer than three different
    /// vertices are left out. After the last pass come isolated vertices, degenerate faces, exact coordinates
    /// and the order of the file, if the stream has them.
    pub fn to_tri_mesh(&self) -> TriMesh {
        self.extras.assemble(self.grid, || self.positions(), self.num_vertices(), self.triangles)
    }

    /// The cut surface itself, in model units: a copy that owns its arrays.
    pub fn to_manifold_mesh(&self) -> TriMesh {
        TriMesh::from_decoded_parts(self.positions(), self.triangles.to_vec())
    }

    /// For each vertex of this cut surface its stitched vertex, and the number of those. This is the
    /// numbering before isolated vertices follow and any order is restored, that of
    /// [`to_tri_mesh`](Self::to_tri_mesh).
    pub fn stitched_vertices(&self) -> (Vec<u32>, usize) {
        let joined = self.extras.joined(self.cells.len());
        (joined.place, joined.first.len())
    }

    /// Checksum of counts, cells and triangles (`format/SPEC.md`, section 9): equal on every
    /// platform for the same prefix of a stream.
    pub fn checksum(&self) -> u32 {
        let mut hash = crc32fast::Hasher::new();
        for count in [self.num_vertices() as u32, self.num_triangles() as u32, self.quantization_bits] {
            hash.update(&count.to_le_bytes());
        }
        for &c in self.quantized_positions().iter().flatten() {
            hash.update(&c.to_le_bytes());
        }
        for &v in self.triangles().iter().flatten() {
            hash.update(&v.to_le_bytes());
        }
        hash.finalize()
    }
}

/// Positions of a [`LevelMesh`] for callers that have other things to do in time.
pub struct PositionUpdater(Option<Mover>);

impl PositionUpdater {
    /// Of `mesh`, and of no other.
    pub fn new(mesh: &LevelMesh) -> Self {
        Self(mesh.has_shrinkage_compensation().then(|| Mover::new(mesh.num_vertices())))
    }

    /// Goes on with at most `elements` vertices and triangles; once all positions are known, returns how many of these are
    /// left.
    pub fn advance(&mut self, mesh: &LevelMesh, elements: usize) -> Option<usize> {
        match &mut self.0 {
            Some(mover) => mover.advance(mesh.cells, mesh.triangles, elements),
            None => Some(elements),
        }
    }

    /// Position of a vertex in model units, one of [`LevelMesh::positions`].
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn position(&self, mesh: &LevelMesh, vertex: usize) -> [f64; 3] {
        let middle = mesh.dequantize(vertex);
        let Some(mover) = &self.0 else { return middle };
        let step = mesh.grid.step(mesh.quantization_bits);
        let moved = mover.moved(vertex, mesh.compensation);
        std::array::from_fn(|axis| middle[axis] + moved[axis] * step[axis])
    }
}

impl std::fmt::Debug for LevelMesh<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("LevelMesh")
            .field("level", &self.level)
            .field("quantization_bits", &self.quantization_bits)
            .field("vertices", &self.num_vertices())
            .field("triangles", &self.num_triangles())
            .finish()
    }
}
