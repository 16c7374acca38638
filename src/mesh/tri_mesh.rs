//! The one mesh type that travels between files, encoder, decoder and metrics.

use thiserror::Error;

/// An indexed triangle mesh in model units.
///
/// Any index soup is allowed: boundaries, several components, repeated or degenerate triangles,
/// non-manifold edges and vertices, unused vertices. What is guaranteed is that every index is in
/// range and every coordinate finite.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriMesh {
    positions: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
}

/// Why a pair of arrays is not a mesh.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshError {
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} refers to vertex {index}, but there are {num_vertices}")]
    IndexOutOfRange {
        /// Zero-based triangle.
        triangle: usize,
        /// The index it holds.
        index: u32,
        /// Vertices in the mesh.
        num_vertices: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} has a coordinate that is not finite")]
    NotFinite {
        /// Zero-based vertex.
        vertex: usize,
    },
    /// More than `u32::MAX - 1` vertices or triangles.
    #[error("{count} vertices or triangles are more than 32-bit indices can name")]
    TooLarge {
        /// The larger of the two counts.
        count: usize,
    },
}

impl TriMesh {
    /// Takes `positions` (n × 3, model units) and `triangles` (m × 3, counter-clockwise).
    ///
    /// # Errors
    /// If an index is out of range, a coordinate is not finite, or there are too many elements.
    pub fn new(positions: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        let count = positions.len().max(triangles.len());
        if count >= u32::MAX as usize {
            return Err(MeshError::TooLarge { count });
        }
        for (vertex, p) in positions.iter().enumerate() {
            if !p.iter().all(|c| c.is_finite()) {
                return Err(MeshError::NotFinite { vertex });
            }
        }
        for (triangle, t) in triangles.iter().enumerate() {
            if let Some(&index) = t.iter().find(|&&i| i as usize >= positions.len()) {
                return Err(MeshError::IndexOutOfRange { triangle, index, num_vertices: positions.len() });
            }
        }
        Ok(Self { positions, triangles })
    }

    /// Arrays that are known to make a mesh.
    pub(crate) fn from_valid_parts(positions: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>) -> Self {
        debug_assert!(triangles.iter().flatten().all(|&v| (v as usize) < positions.len()));
        Self { positions, triangles }
    }

    /// Arrays of a decoder. It has checked them where they came in; a triangle that names no vertex all the same does
    /// not come out.
    pub(crate) fn from_decoded_parts(positions: Vec<[f64; 3]>, mut triangles: Vec<[u32; 3]>) -> Self {
        let is_sound = |t: &[u32; 3]| t.iter().all(|&v| (v as usize) < positions.len());
        debug_assert!(triangles.iter().all(is_sound));
        triangles.retain(is_sound);
        Self::from_valid_parts(positions, triangles)
    }

    /// Vertex positions, n × 3, model units.
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    /// Vertex indices of the triangles, m × 3, counter-clockwise.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Number of vertices, unused ones included.
    pub fn num_vertices(&self) -> usize {
        self.positions.len()
    }

    /// Number of triangles.
    pub fn num_triangles(&self) -> usize {
        self.triangles.len()
    }

    /// Gives back the two arrays.
    pub fn into_parts(self) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
        (self.positions, self.triangles)
    }

    /// Smallest and largest corner of the box around all vertices, `None` without vertices.
    pub fn bounding_box(&self) -> Option<([f64; 3], [f64; 3])> {
        let first = *self.positions.first()?;
        Some(self.positions.iter().fold((first, first), |(lo, hi), p| {
            (std::array::from_fn(|a| lo[a].min(p[a])), std::array::from_fn(|a| hi[a].max(p[a])))
        }))
    }
}
/// Whether a triangle names three different vertices.
pub(crate) fn has_three_vertices(&[a, b, c]: &[u32; 3]) -> bool {
    a != b && b != c && c != a
}
