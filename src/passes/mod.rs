//! The passes of a stream, written once for encoder and decoder over [`BitCoder`]: what is coded,
//! in which order, under which contexts (`format/SPEC.md`, section 7).
//!
//! The encoder hands the truth in as a `target`; the decoder has none and gets it back.
//!
//! [`BitCoder`]: crate::entropy::range_coder::BitCoder

pub(crate) mod attribute;
pub(crate) mod base;
pub(crate) mod base_positions;
pub(crate) mod base_tables;
mod base_traversal;
pub(crate) mod coding_context;
pub(crate) mod compensation;
pub(crate) mod connectivity;
pub(crate) mod coordinate_prediction;
pub(crate) mod coordinates;
pub(crate) mod coordinates_fast;
pub(crate) mod cost;
pub(crate) mod exact;
pub(crate) mod float_values;
pub(crate) mod isolated_and_degenerate;
pub(crate) mod order;
pub(crate) mod patch;
pub(crate) mod refine;
pub(crate) mod stitching;
pub(crate) mod values;
pub(crate) mod work_budget;

use crate::mesh::Surface;

/// The mesh that passes refine.
#[derive(Clone, Debug, Default)]
pub(crate) struct GridMesh {
    pub(crate) surface: Surface,
    /// Grid cell of each vertex at the present precision.
    pub(crate) positions: Vec<[i32; 3]>,
    /// Per vertex, along and across the surface: log2 of (residual / edge length), in eighths.
    pub(crate) roughness: Vec<[i8; 2]>,
}

impl GridMesh {
    /// Makes room for exactly this much more.
    #[cfg(feature = "encoder")]
    pub(crate) fn reserve(&mut self, vertices: usize, faces: usize) {
        self.reserve_vertices(vertices);
        self.surface.triangles.reserve_exact(faces);
        self.surface.opposite.reserve_exact(3 * faces);
    }

    pub(crate) fn reserve_vertices(&mut self, vertices: usize) {
        self.positions.reserve_exact(vertices);
        self.roughness.reserve_exact(vertices);
        self.surface.corner_of.reserve_exact(vertices);
        self.surface.valence.reserve_exact(vertices);
    }
}

/// The error of a payload that ends too early.
pub(crate) const EXHAUSTED: &str = "a pass needs more bytes than it has";

/// A payload names something that no encoder writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Malformed(pub(crate) &'static str);
