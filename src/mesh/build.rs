//! From triangles to a [`Surface`]: adjacency by sorting, and the checks that make it one.

use super::surface::{NO_CORNER, Surface, next, prev};
use super::tri_mesh::has_three_vertices;
use crate::util::parallel::fill;
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
        Self::try_from_triangles(triangles, num_vertices).map_err(|(_, error)| error)
    }

    /// As [`from_triangles`](Self::from_triangles), with the triangles back if they are not a surface.
    pub(super) fn try_from_triangles(
        triangles: Vec<[u32; 3]>,
        num_vertices: usize,
    ) -> Result<Self, (Vec<[u32; 3]>, SurfaceError)> {
        let mut surface = Surface {
            opposite: vec![NO_CORNER; 3 * triangles.len()],
            corner_of: vec![NO_CORNER; num_vertices],
            valence: vec![0; num_vertices],
            triangles,
        };
        match surface.link_all().and_then(|()| surface.count_fans()) {
            Ok(()) => Ok(surface),
            Err(error) => Err((surface.triangles, error)),
        }
    }

    fn link_all(&mut self) -> Result<(), SurfaceError> {
        if let Some(f) = self.triangles.iter().position(|t| !has_three_vertices(t)) {
            return Err(SurfaceError::Degenerate(f as u32));
        }
        let edges = EdgeIndex::new(&self.triangles, self.corner_of.len());
        /// No corner either.
        const REPEATED: u32 = NO_CORNER - 1;
        let mut opposite = std::mem::take(&mut self.opposite);
        let ends = |corner: u32| (self.vertex(next(corner)), self.vertex(prev(corner)));
        let across = |corner: usize| {
            let (from, to) = ends(corner as u32);
            let is_repeated = edges.facing(from, to).nth(1).is_some();
            if is_repeated { REPEATED } else { edges.facing(to, from).next().unwrap_or(NO_CORNER) }
        };
        fill(&mut opposite, || (), |(), corner| across(corner));
        if let Some(corner) = opposite.iter().position(|&o| o == REPEATED) {
            let (from, to) = ends(corner as u32);
            return Err(SurfaceError::RepeatedEdge(from, to));
        }
        self.opposite = opposite;
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
        let mut valence = std::mem::take(&mut self.valence);
        // 0 if the corners are not one fan.
        fill(&mut valence, Vec::new, |corners, v| {
            let (corner, num_corners) = (self.corner_of[v], corners_at[v]);
            if corner == NO_CORNER {
                return 0;
            }
            let closed = self.fan(corner, corners);
            if corners.len() as u32 == num_corners { num_corners + u32::from(!closed) } else { 0 }
        });
        if let Some(v) = valence.iter().position(|&valence| valence == 0) {
            return Err(SurfaceError::NotOneFan(v as u32));
        }
        self.valence = valence;
        Ok(())
    }
}

/// A corner and the vertex to which the edge runs that it faces.
#[derive(Clone, Copy, Default)]
struct Facing {
    to: u32,
    corner: u32,
}

/// Corners by the directed edge they face: of each vertex those that face edges from it.
pub(crate) struct EdgeIndex {
    /// Where those of each vertex begin.
    first: Vec<u32>,
    facing: Vec<Facing>,
}

/// Groups up to this length are searched one by one; longer ones are sorted, as one vertex may have all faces.
const SHORT_GROUP: usize = 16;

impl EdgeIndex {
    /// `triangles` do not repeat a vertex.
    pub(crate) fn new(triangles: &[[u32; 3]], num_vertices: usize) -> Self {
        let mut first = vec![0_u32; num_vertices + 1];
        triangles.as_flattened().iter().for_each(|&v| first[v as usize + 1] += 1);
        (0..num_vertices).for_each(|v| first[v + 1] += first[v]);
        let mut end = first[..num_vertices].to_vec();
        let mut facing = vec![Facing::default(); 3 * triangles.len()];
        for (&[a, b, c], corner) in triangles.iter().zip((0..).step_by(3)) {
            for (from, to, corner) in [(b, c, corner), (c, a, corner + 1), (a, b, corner + 2)] {
                let end = &mut end[from as usize];
                facing[*end as usize] = Facing { to, corner };
                *end += 1;
            }
        }
        for v in 0..num_vertices {
            let group = &mut facing[first[v] as usize..first[v + 1] as usize];
            if group.len() > SHORT_GROUP {
                group.sort_unstable_by_key(|f| (f.to, f.corner));
            }
        }
        Self { first, facing }
    }

    /// The corners that face an edge from `from` to `to`, in ascending order.
    pub(crate) fn facing(&self, from: u32, to: u32) -> impl Iterator<Item = u32> {
        let [start, end] = [from as usize, from as usize + 1].map(|v| self.first[v] as usize);
        let mut group = &self.facing[start..end];
        if group.len() > SHORT_GROUP {
            let start = group.partition_point(|f| f.to < to);
            group = &group[start..];
            group = &group[..group.partition_point(|f| f.to == to)];
        }
        // Faces were met in ascending order, and each faces an edge from a vertex once.
        group.iter().filter(move |f| f.to == to).map(|f| f.corner)
    }
}
