//! One level of a surface that shrinks, as a mesh without gaps.

use super::SurfaceEditor;
use super::surface_editor::FREE;
use crate::mesh::{Surface, TriMesh};
use rayon::prelude::*;

/// Triangles whose sides are added up by one thread.
const BLOCK: usize = 1 << 12;

/// The vertices and triangles of one level, renumbered without gaps.
pub(crate) struct Level {
    /// The vertex of each place.
    pub(crate) vertices: Vec<u32>,
    /// The slot of each triangle.
    pub(crate) faces: Vec<u32>,
    /// The triangles, by places.
    pub(crate) triangles: Vec<[u32; 3]>,
}

impl Level {
    /// What is there of a surface.
    pub(crate) fn collect(shrinking: &SurfaceEditor) -> Self {
        let Surface { corner_of, triangles, .. } = &shrinking.surface;
        Self::among(shrinking, 0..corner_of.len() as u32, 0..triangles.len() as u32)
    }

    /// What is left of this level.
    pub(crate) fn coarser(&self, shrinking: &SurfaceEditor) -> Self {
        Self::among(shrinking, self.vertices.iter().copied(), self.faces.iter().copied())
    }

    /// What is there among these vertices and slots, which ascend.
    fn among(
        shrinking: &SurfaceEditor,
        vertices: impl Iterator<Item = u32> + Send,
        slots: impl Iterator<Item = u32> + Send,
    ) -> Self {
        let surface = &shrinking.surface;
        let name_vertices = || {
            let mut left = Vec::with_capacity(shrinking.num_vertices());
            left.extend(vertices.filter(|&v| shrinking.contains(v)));
            let mut name = vec![u32::MAX; surface.corner_of.len()];
            left.iter().zip(0..).for_each(|(&v, i)| name[v as usize] = i);
            (name, left)
        };
        let find_faces = || {
            let mut left = Vec::with_capacity(shrinking.num_faces());
            left.extend(slots.filter(|&slot| surface.triangles[slot as usize] != FREE));
            left
        };
        let ((name, vertices), faces) = rayon::join(name_vertices, find_faces);
        let named = |&slot: &u32| surface.triangles[slot as usize].map(|v| name[v as usize]);
        let triangles = faces.par_iter().map(named).collect();
        Self { vertices, faces, triangles }
    }

    /// Calls `see` with the level as a separate mesh; `positions` are those of the whole surface.
    pub(crate) fn with_mesh<T>(&mut self, positions: &[[f64; 3]], see: impl FnOnce(&TriMesh) -> T) -> T {
        let triangles = std::mem::take(&mut self.triangles);
        let compact = self.vertices.iter().map(|&v| positions[v as usize]).collect();
        let mesh = TriMesh::from_valid_parts(compact, triangles);
        let seen = see(&mesh);
        self.triangles = mesh.into_parts().1;
        seen
    }

    /// Mean length of the sides of all triangles, in steps.
    pub(crate) fn mean_edge(&self, cells: &[[i32; 3]]) -> f64 {
        let at = |v: u32| cells[self.vertices[v as usize] as usize];
        let length = |p: [i32; 3], q: [i32; 3]| {
            (0..3).map(|a| (f64::from(p[a]) - f64::from(q[a])).powi(2)).sum::<f64>().sqrt()
        };
        let sides = |t: &[u32; 3]| {
            let [a, b, c] = t.map(at);
            length(a, b) + length(b, c) + length(c, a)
        };
        // Blocks make the sum independent of the number of threads.
        let blocks = self.triangles.par_chunks(BLOCK).map(|block| block.iter().map(sides).sum::<f64>());
        let sum: f64 = blocks.collect::<Vec<f64>>().into_iter().sum();
        sum / (3 * self.triangles.len().max(1)) as f64
    }
}
