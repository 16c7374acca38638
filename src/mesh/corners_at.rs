//! Which corners each vertex has, of any triangles.

/// Corners at each vertex, ascending.
pub(crate) struct CornersAt {
    /// Where those of each vertex begin.
    first: Vec<u32>,
    corners: Vec<u32>,
}

impl CornersAt {
    /// Triangles may repeat a vertex. Indices must be below `num_vertices`.
    pub(crate) fn new(triangles: &[[u32; 3]], num_vertices: usize) -> Self {
        let mut first = vec![0_u32; num_vertices + 1];
        triangles.as_flattened().iter().for_each(|&v| first[v as usize + 1] += 1);
        (0..num_vertices).for_each(|v| first[v + 1] += first[v]);
        let mut end = first.clone();
        let mut corners = vec![0_u32; 3 * triangles.len()];
        for (corner, &v) in triangles.as_flattened().iter().enumerate() {
            corners[end[v as usize] as usize] = corner as u32;
            end[v as usize] += 1;
        }
        Self { first, corners }
    }

    pub(crate) fn at(&self, v: u32) -> &[u32] {
        &self.corners[self.first[v as usize] as usize..self.first[v as usize + 1] as usize]
    }
}
