//! The stitching of the vertices that each pass brings (`format/SPEC.md`, section 7.6).

use super::payload::expect_sound;
use crate::entropy::range_coder::RangeEncoder;
use crate::passes::GridMesh;
use crate::passes::stitching::{self, StitchingModels};
use bitvec::vec::BitVec;

/// What is stitched so far.
pub(super) struct StitchingWriter<'a> {
    /// Vertex of the joined surface for each vertex of the full one.
    source: &'a [u32],
    models: StitchingModels,
    roots: Vec<u32>,
    /// Vertices before the present pass.
    num_seen: usize,
    /// For each stitched vertex, whether a pass has added it.
    has_come: BitVec,
}

impl<'a> StitchingWriter<'a> {
    pub(super) fn new(source: &'a [u32], num_joined: usize) -> Self {
        let has_come = BitVec::repeat(false, num_joined);
        Self { source, models: StitchingModels::default(), roots: Vec::new(), num_seen: 0, has_come }
    }

    /// Payload of the stitching after a pass, if one of its vertices is the same as one that is there.
    pub(super) fn code(&mut self, mesh: &GridMesh, vertex_source: &[u32]) -> Option<Vec<u8>> {
        if !self.repeats_vertices(vertex_source) {
            return None;
        }
        let names: Vec<u32> = vertex_source.iter().map(|&v| self.source[v as usize]).collect();
        let mut coder = RangeEncoder::new();
        expect_sound(stitching::code(&mut coder, &mut self.models, mesh, &mut self.roots, Some(&names)));
        Some(coder.finish())
    }

    /// Takes note of the vertices that are new; true if one of them is the same as another.
    fn repeats_vertices(&mut self, vertex_source: &[u32]) -> bool {
        let num_old = std::mem::replace(&mut self.num_seen, vertex_source.len());
        let mut is_stitched = false;
        for &v in &vertex_source[num_old..] {
            is_stitched |= self.has_come.replace(self.source[v as usize] as usize, true);
        }
        is_stitched
    }

    /// The stitching of the whole surface.
    pub(super) fn into_roots(self) -> Vec<u32> {
        self.roots
    }
}
