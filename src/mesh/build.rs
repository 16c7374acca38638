//! From triangles to a [`Surface`]: adjacency by sorting, and the checks that make it one.

use super::surface::{NO_CORNER, Surface, next, prev};
use thiserror::Error;

/// Why triangles are not an oriented surface.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum SurfaceError {
    /// A triangle names a vertex twice.
    #[error("triangle {0} repeats a vertex")]
    Degenerate(u32),
    /// Two triangles have the same directed edge.
    #[error("two triangles run along the edge from vertex {0} to {1}")]
    RepeatedEdge(u32, u32),
    /// The triangles at a vertex are not one fan, or there are none.
    #[error("the triangles at vertex {0} are not one fan")]
    NotOneFan(u32),
}

impl Surface {
    /// Links `triangles` over their shared edges. Indices must be below `num_vertices`.
    ///
    /// # Errors
    /// If the triangles are not an oriented 2-manifold (with boundary) that uses each vertex.
    pub fn from_triangles(triangles: Vec<[u32; 3]>, num_vertices: usize) -> Result<Self, SurfaceError> {
        let mut surface = Surface {
            opposite: vec![NO_CORNER; 3 * triangles.len()],
            corner_of: vec![NO_CORNER; num_vertices],
            valence: vec![0; num_vertices],
            triangles,
        };
        for (f, &[a, b, c]) in surface.triangles.iter().enumerate() {
            if a == b || b == c || c == a {
                return Err(SurfaceError::Degenerate(f as u32));
            }
        }
        surface.link_all()?;
        surface.count_fans()?;
        Ok(surface)
    }

    fn link_all(&mut self) -> Result<(), SurfaceError> {
        let edges = EdgeIndex::new(&self.triangles, self.corner_of.len());
        for corner in 0..self.opposite.len() as u32 {
            let (from, to) = (self.vertex(next(corner)), self.vertex(prev(corner)));
            if edges.facing(&self.triangles, from, to).len() > 1 {
                return Err(SurfaceError::RepeatedEdge(from, to));
            }
            if let Some(&twin) = edges.facing(&self.triangles, to, from).first() {
                self.opposite[corner as usize] = twin;
            }
        }
        Ok(())
    }

    fn count_fans(&mut self) -> Result<(), SurfaceError> {
        let mut corners_at = vec![0_u32; self.corner_of.len()];
        for (f, triangle) in self.triangles.iter().enumerate() {
            for (i, &v) in triangle.iter().enumerate() {
                corners_at[v as usize] += 1;
                self.corner_of[v as usize] = (3 * f + i) as u32;
            }
        }
        let mut corners = Vec::new();
        for (v, &num_corners) in corners_at.iter().enumerate() {
            let corner = self.corner_of[v];
            if corner == NO_CORNER {
                return Err(SurfaceError::NotOneFan(v as u32));
            }
            let closed = self.fan(corner, &mut corners);
            if corners.len() as u32 != num_corners {
                return Err(SurfaceError::NotOneFan(v as u32));
            }
            self.valence[v] = num_corners + u32::from(!closed);
        }
        Ok(())
    }
}

/// Corners sorted by the directed edge they face.
pub(crate) struct EdgeIndex {
    offsets: Vec<u32>,
    corners: Vec<u32>,
}

impl EdgeIndex {
    pub(crate) fn new(triangles: &[[u32; 3]], num_vertices: usize) -> Self {
        let mut offsets = vec![0_u32; num_vertices + 1];
        for &v in triangles.iter().flatten() {
            offsets[v as usize + 1] += 1;
        }
        for v in 0..num_vertices {
            offsets[v + 1] += offsets[v];
        }
        let mut fill = offsets.clone();
        let mut corners = vec![0; 3 * triangles.len()];
        for corner in 0..3 * triangles.len() as u32 {
            let from = vertex_at(triangles, next(corner)) as usize;
            corners[fill[from] as usize] = corner;
            fill[from] += 1;
        }
        for v in 0..num_vertices {
            corners[offsets[v] as usize..offsets[v + 1] as usize]
                .sort_unstable_by_key(|&c| (vertex_at(triangles, prev(c)), c));
        }
        Self { offsets, corners }
    }

    /// The corners that face an edge from `from` to `to`, in ascending order. `triangles` are those
    /// the index was made of.
    pub(crate) fn facing(&self, triangles: &[[u32; 3]], from: u32, to: u32) -> &[u32] {
        let v = from as usize;
        let group = &self.corners[self.offsets[v] as usize..self.offsets[v + 1] as usize];
        let start = group.partition_point(|&c| vertex_at(triangles, prev(c)) < to);
        let end = start + group[start..].partition_point(|&c| vertex_at(triangles, prev(c)) == to);
        &group[start..end]
    }
}

fn vertex_at(triangles: &[[u32; 3]], corner: u32) -> u32 {
    triangles[(corner / 3) as usize][(corner % 3) as usize]
}
