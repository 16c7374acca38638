//! Which patches restore a level's vertices, found before the level below is coded: the walk looks at no
//! model of coordinates, and the encoder knows where the vertices will be.

use super::numbering::Numbering;
use super::payload::expect_sound;
use crate::entropy::context_mixer::Mixing;
use crate::entropy::range_coder::{BitCoder, RangeEncoder};
use crate::mesh::Surface;
use crate::mesh::surface::{NO_CORNER, next, prev};
use crate::passes::GridMesh;
use crate::passes::connectivity::{self, ConnectivityModels, ConnectivityTarget, NOT_IN_PATCH};
use crate::passes::patch::Patches;
use crate::simplification::LevelRecord;
use std::collections::HashMap;

/// The patches of a level, coded.
pub(super) struct Found {
    /// Coordinates go on here.
    pub(super) coder: RangeEncoder,
    pub(super) patches: Patches,
    /// Entry of the record that each patch stands for.
    pub(super) odd: Vec<u32>,
}

/// Codes connectivity, one level ahead.
pub(super) struct PatchSearch {
    models: ConnectivityModels,
    /// Scratch: patch of each slot of the full surface.
    patch_of_slot: Vec<u32>,
    /// The mesh as it will be.
    mesh: GridMesh,
}

impl PatchSearch {
    pub(super) fn new(num_faces: usize, mixing: Mixing) -> Self {
        let patch_of_slot = vec![NOT_IN_PATCH; num_faces];
        Self { models: ConnectivityModels::new(mixing), patch_of_slot, mesh: GridMesh::default() }
    }

    /// Takes a copy of the surface from which [`find_ahead`](Self::find_ahead) starts: the vertices on it are not
    /// placed yet.
    pub(super) fn follow(&mut self, surface: &Surface) {
        let Surface { triangles, opposite, corner_of, valence } = &mut self.mesh.surface;
        triangles.clone_from(&surface.triangles);
        opposite.clone_from(&surface.opposite);
        corner_of.clone_from(&surface.corner_of);
        valence.clone_from(&surface.valence);
    }

    /// The patches that restore the vertices of `record` on the surface that was last followed, where
    /// `hidden` bits of the `cells` are not known.
    pub(super) fn find_ahead(
        &mut self,
        cells: &[[i32; 3]],
        hidden: u32,
        numbering: &Numbering,
        record: &LevelRecord,
    ) -> Found {
        let mut mesh = std::mem::take(&mut self.mesh);
        mesh.positions.clear();
        mesh.positions
            .extend(numbering.vertex_source.iter().map(|&v| cells[v as usize].map(|c| c >> hidden)));
        let found = self.find(&mesh, numbering, record);
        self.mesh = mesh;
        found
    }

    /// The patches that bring back the vertices of `record`.
    pub(super) fn find(&mut self, mesh: &GridMesh, numbering: &Numbering, record: &LevelRecord) -> Found {
        let mut coder = RangeEncoder::new();
        let (patches, odd) = self.find_with(&mut coder, mesh, numbering, record);
        Found { coder, patches, odd }
    }

    /// The same with any coder: the patches, and the entry of the record that each stands for.
    pub(super) fn find_with<B: BitCoder>(
        &mut self,
        coder: &mut B,
        mesh: &GridMesh,
        numbering: &Numbering,
        record: &LevelRecord,
    ) -> (Patches, Vec<u32>) {
        let target = self.target(&mesh.surface, numbering, record);
        let patches = connectivity::code(coder, &mut self.models, mesh, record.len(), Some(&target));
        let patches = expect_sound(patches);
        let odd = (0..patches.len()).map(|j| odd_of(&target, &patches, j)).collect();
        (patches, odd)
    }

    /// Translates a record into the decoder's numbering.
    fn target(
        &mut self,
        surface: &Surface,
        numbering: &Numbering,
        record: &LevelRecord,
    ) -> ConnectivityTarget {
        let mut open: HashMap<(u32, u32), u32> = HashMap::new();
        for (odd, removed) in record.iter().enumerate() {
            removed.patch().iter().for_each(|&slot| self.patch_of_slot[slot as usize] = odd as u32);
            if !removed.is_closed() {
                let last = removed.ring[removed.ring.len() - 1];
                open.insert((last, removed.ring[0]), odd as u32);
            }
        }
        let patch_of_face = numbering.face_source.iter().map(|&s| self.patch_of_slot[s as usize]).collect();
        record
            .iter()
            .for_each(|r| r.patch().iter().for_each(|&s| self.patch_of_slot[s as usize] = NOT_IN_PATCH));

        let mut target = ConnectivityTarget { patch_of_face, ..Default::default() };
        if !open.is_empty() {
            for corner in (0..surface.opposite.len() as u32).filter(|&c| surface.across(c) == NO_CORNER) {
                let [from, to] =
                    [next(corner), prev(corner)].map(|c| numbering.vertex_source[surface.vertex(c) as usize]);
                if let Some(&odd) = open.get(&(from, to)) {
                    let is_ear = record.get(odd as usize).patch().is_empty();
                    let map = if is_ear { &mut target.ear_at } else { &mut target.patch_open_at };
                    map.insert(corner, odd);
                }
            }
        }
        target
    }
}

/// The record entry that a patch stands for.
fn odd_of(target: &ConnectivityTarget, patches: &Patches, patch: usize) -> u32 {
    match patches.faces(patch).first() {
        Some(&face) => target.patch_of_face[face as usize],
        None => target.ear_at[&patches.edges(patch)[0]],
    }
}
