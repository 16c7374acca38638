//! The mesh a decoder holds, as callers see it.

use crate::TriMesh;
use crate::bitstream::header::Grid;

/// A borrowed view of the finest complete mesh: valid until the decoder takes more bytes.
#[derive(Clone, Copy)]
pub struct LevelMesh<'a> {
    pub(super) cells: &'a [[i32; 3]],
    pub(super) triangles: &'a [[u32; 3]],
    pub(super) grid: &'a Grid,
    pub(super) precision: u32,
    pub(super) level: u32,
}

impl<'a> LevelMesh<'a> {
    /// Level of the mesh, 0 = base.
    pub fn level(&self) -> u32 {
        self.level
    }

    /// Bits per coordinate that are known so far.
    pub fn precision(&self) -> u32 {
        self.precision
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

    /// Grid cells of the vertices, n × 3, each below 2^[`precision`](Self::precision).
    pub fn cells(&self) -> &'a [[i32; 3]] {
        self.cells
    }

    /// Position of one vertex in model units: the middle of its cell.
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn position(&self, vertex: usize) -> [f64; 3] {
        self.grid.position(self.cells[vertex], self.precision)
    }

    /// Positions in model units, in order.
    pub fn positions(&self) -> impl ExactSizeIterator<Item = [f64; 3]> + 'a {
        let view = *self;
        (0..self.num_vertices()).map(move |v| view.position(v))
    }

    /// A copy that owns its arrays.
    pub fn to_tri_mesh(&self) -> TriMesh {
        TriMesh::from_valid_parts(self.positions().collect(), self.triangles().to_vec())
    }

    /// Checksum of counts, cells and triangles (`format/SPEC.md`, section 9): equal on every
    /// platform for the same prefix of a stream.
    pub fn checksum(&self) -> u32 {
        let mut hash = crc32fast::Hasher::new();
        for count in [self.num_vertices() as u32, self.num_triangles() as u32, self.precision] {
            hash.update(&count.to_le_bytes());
        }
        for &c in self.cells().iter().flatten() {
            hash.update(&c.to_le_bytes());
        }
        for &v in self.triangles().iter().flatten() {
            hash.update(&v.to_le_bytes());
        }
        hash.finalize()
    }
}

impl std::fmt::Debug for LevelMesh<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("LevelMesh")
            .field("level", &self.level)
            .field("precision", &self.precision)
            .field("vertices", &self.num_vertices())
            .field("triangles", &self.num_triangles())
            .finish()
    }
}
