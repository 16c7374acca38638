//! Which vertices share an edge, as one flat table.

use crate::mesh::TriMesh;

/// Neighbours of every vertex over the undirected edges of the non-degenerate faces.
pub(super) struct Adjacency {
    /// Row v of `neighbours` is `offsets[v]..offsets[v + 1]`.
    offsets: Vec<usize>,
    neighbours: Vec<u32>,
}

/// A face that names three different vertices.
pub(super) fn is_proper(&[a, b, c]: &[u32; 3]) -> bool {
    a != b && b != c && c != a
}

impl Adjacency {
    /// Counting sort of the face corners by vertex, then removal of the repeated entries of each row.
    pub(super) fn new(mesh: &TriMesh) -> Self {
        let n = mesh.num_vertices();
        // Counts are kept one place to the right, so that after filling `ends[v]` is the end of row v.
        let mut ends = vec![0usize; n + 1];
        for t in mesh.triangles().iter().filter(|t| is_proper(t)) {
            for &v in t {
                ends[v as usize + 1] += 2;
            }
        }
        for v in 0..n {
            ends[v + 1] += ends[v];
        }
        let mut neighbours = vec![0u32; ends[n]];
        for t in mesh.triangles().iter().filter(|t| is_proper(t)) {
            for (v, u, w) in [(t[0], t[1], t[2]), (t[1], t[2], t[0]), (t[2], t[0], t[1])] {
                let at = ends[v as usize];
                neighbours[at] = u;
                neighbours[at + 1] = w;
                ends[v as usize] = at + 2;
            }
        }

        let mut offsets = Vec::with_capacity(n + 1);
        let mut seen_from = vec![u32::MAX; n];
        let (mut begin, mut kept) = (0, 0);
        for v in 0..n {
            offsets.push(kept);
            for i in begin..ends[v] {
                let u = neighbours[i];
                neighbours[kept] = u;
                kept += usize::from(seen_from[u as usize] != v as u32);
                seen_from[u as usize] = v as u32;
            }
            begin = ends[v];
        }
        offsets.push(kept);
        neighbours.truncate(kept);
        Self { offsets, neighbours }
    }

    /// Distinct neighbours of `v`, in the order in which the faces name them.
    #[inline]
    pub(super) fn of(&self, v: usize) -> &[u32] {
        &self.neighbours[self.offsets[v]..self.offsets[v + 1]]
    }

    pub(super) fn num_vertices(&self) -> usize {
        self.offsets.len() - 1
    }
}
