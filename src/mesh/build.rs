//! From triangles to a [`Surface`]: adjacency by sorting, and the checks that make it one.

use super::corners_at::CornersAt;
use super::surface::{NO_CORNER, Surface, next, prev};
use super::tri_mesh::has_three_vertices;
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
        if let Some(f) = surface.triangles.iter().position(|t| !has_three_vertices(t)) {
            return Err(SurfaceError::Degenerate(f as u32));
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

/// Corners sorted by the directed edge they face: of each vertex those that face edges from it.
pub(crate) struct EdgeIndex(CornersAt);

impl EdgeIndex {
    pub(crate) fn new(triangles: &[[u32; 3]], num_vertices: usize) -> Self {
        let mut from = CornersAt::new(triangles, num_vertices);
        for v in 0..num_vertices as u32 {
            let corners = from.at_mut(v);
            corners.iter_mut().for_each(|c| *c = prev(*c));
            corners.sort_unstable_by_key(|&c| (vertex_at(triangles, prev(c)), c));
        }
        Self(from)
    }

    /// The corners that face an edge from `from` to `to`, in ascending order. `triangles` are those
    /// the index was made of.
    pub(crate) fn facing(&self, triangles: &[[u32; 3]], from: u32, to: u32) -> &[u32] {
        let group = self.0.at(from);
        let start = group.partition_point(|&c| vertex_at(triangles, prev(c)) < to);
        let end = start + group[start..].partition_point(|&c| vertex_at(triangles, prev(c)) == to);
        &group[start..end]
    }
}

fn vertex_at(triangles: &[[u32; 3]], corner: u32) -> u32 {
    triangles[(corner / 3) as usize][(corner % 3) as usize]
}
