//! From the decoder's numbering of vertices and triangles to that of the full surface.

use super::coarsen::Hierarchy;
use crate::passes::base_positions::Base;
use crate::passes::patch::Star;
use crate::simplification::LevelRecord;
use crate::simplification::record::Removed;

/// How the decoder's numbering maps to that of the full surface.
pub(super) struct Numbering {
    /// Vertex of the full surface that each vertex is.
    pub(super) vertex_source: Vec<u32>,
    /// Slot of the full surface that each triangle has.
    pub(super) face_source: Vec<u32>,
}

impl Numbering {
    /// Of the base mesh.
    pub(super) fn of_base(coded: &Base, hierarchy: &Hierarchy) -> Self {
        let vertices = coded.vertex_source.iter().map(|&v| hierarchy.base_vertices[v as usize]);
        let faces = coded.corner_source.iter().map(|&c| hierarchy.base_faces[c as usize / 3]);
        Self { vertex_source: vertices.collect(), face_source: faces.collect() }
    }

    /// Appends the vertices of these entries of a record.
    pub(super) fn extend(&mut self, record: &LevelRecord, odd: &[u32]) {
        self.vertex_source.extend(odd.iter().map(|&o| record.get(o as usize).vertex));
    }

    /// Notes the slots of the triangles of a star, of `num_faces` on the mesh. Returns which of the removed faces the
    /// first one is.
    pub(super) fn note_star(&mut self, star: &Star, removed: &Removed, num_faces: usize) -> usize {
        self.face_source.resize(num_faces, 0);
        let first = self.vertex_source[star.ring[0] as usize];
        let shift = removed.ring.iter().position(|&v| v == first).unwrap_or(0);
        for (i, &face) in star.faces.iter().enumerate() {
            self.face_source[face as usize] = removed.faces[(shift + i) % removed.faces.len()];
        }
        shift
    }
}
