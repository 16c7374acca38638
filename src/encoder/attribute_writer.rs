//! The values of attributes after each pass.

use super::attributes::Quantized;
use super::coarsen::Hierarchy;
use super::payload::padded;
use crate::entropy::context_mixer::Mixing;
use crate::entropy::range_coder::RangeEncoder;
use crate::mesh::{Domain, NO_ENTRY};
use crate::passes::GridMesh;
use crate::passes::attribute::declaration::MAX_VALUES_PER_BYTE;
use crate::passes::attribute::{Brought, Desk, Entries, Layer, Truth};
use crate::passes::patch::{Patches, Star};
use crate::passes::work_budget::WorkBudget;
use crate::simplification::LevelRecord;
use crate::simplification::record::Removed;

/// The decoder's layers, and what they should become.
pub(super) struct AttributeWriter<'a> {
    quantized: &'a Quantized,
    layers: Vec<Layer>,
    /// Per attribute the entry of each element, in the decoder's numbering.
    truth: Vec<Vec<u32>>,
    payloads: Vec<Vec<u8>>,
}

impl<'a> AttributeWriter<'a> {
    pub(super) fn new(quantized: &'a Quantized, mixing: Mixing) -> Self {
        let layers =
            quantized.list.iter().map(|attribute| Layer::new(&attribute.declaration, mixing)).collect();
        Self { quantized, layers, truth: vec![Vec::new(); quantized.list.len()], payloads: Vec::new() }
    }

    /// The decoder's entries of each attribute.
    pub(super) fn entries(&self) -> Vec<&Entries> {
        self.layers.iter().map(|layer| &layer.entries).collect()
    }

    /// A payload per pass, all empty without attributes.
    pub(super) fn into_payloads(self) -> Vec<Vec<u8>> {
        self.payloads
    }

    /// The base mesh, whose vertices and triangles are these of the full surface.
    pub(super) fn base(
        &mut self,
        mesh: &GridMesh,
        hierarchy: &Hierarchy,
        vertex_source: &[u32],
        face_source: &[u32],
    ) {
        let triangles = &mesh.surface.triangles;
        for (attribute, truth) in self.quantized.list.iter().zip(&mut self.truth) {
            let Some(track) = attribute.track else { continue };
            let entries = hierarchy.seams.entries(track);
            if attribute.declaration.domain == Domain::Triangle {
                truth.extend(face_source.iter().map(|&slot| entries[slot as usize]));
                continue;
            }
            for (triangle, &slot) in triangles.iter().zip(face_source) {
                let there = hierarchy.slots.triangles[slot as usize];
                truth.extend(triangle.map(|v| {
                    let source = vertex_source[v as usize];
                    let place = there.iter().position(|&u| u == source).unwrap_or(0);
                    entries[3 * slot as usize + place]
                }));
            }
        }
        self.code(mesh, None, 0, vertex_source);
    }

    /// Notes the entries at the star of a vertex that was brought back; `shift`: which of the removed faces is the first of
    /// the star.
    pub(super) fn restore(&mut self, star: &Star, record: &LevelRecord, removed: &Removed, shift: usize) {
        for (attribute, truth) in self.quantized.list.iter().zip(&mut self.truth) {
            let Some(track) = attribute.track else { continue };
            let entries = record.entries(track);
            for (i, &face) in star.faces.iter().enumerate() {
                let place = removed.first_face + (shift + i) % removed.faces.len();
                let face = face as usize;
                if attribute.declaration.domain == Domain::Triangle {
                    truth.resize(truth.len().max(face + 1), NO_ENTRY);
                    truth[face] = entries[place];
                } else {
                    truth.resize(truth.len().max(3 * face + 3), NO_ENTRY);
                    truth[3 * face..3 * face + 3].copy_from_slice(&entries[3 * place..3 * place + 3]);
                }
            }
        }
    }

    /// A split, all stars of which are restored.
    pub(super) fn split(&mut self, mesh: &GridMesh, patches: &Patches, first: usize, vertex_source: &[u32]) {
        self.code(mesh, Some(patches), first, vertex_source);
    }

    /// Nothing comes with a refinement.
    pub(super) fn refine(&mut self) {
        self.payloads.push(Vec::new());
    }

    fn code(&mut self, mesh: &GridMesh, patches: Option<&Patches>, first: usize, vertex_source: &[u32]) {
        if self.layers.is_empty() {
            self.payloads.push(Vec::new());
            return;
        }
        let brought = Brought { mesh, patches, first };
        let mut coder = RangeEncoder::new();
        let mut desk = Desk::default();
        let mut num_channels = 0;
        for ((attribute, layer), truth) in
            self.quantized.list.iter().zip(&mut self.layers).zip(&mut self.truth)
        {
            if attribute.track.is_none() {
                let missing = vertex_source[truth.len()..].iter();
                truth.extend(missing.map(|&v| attribute.of[v as usize]));
            }
            let truth = Truth { of: truth, entries: &attribute.entries };
            let work = &mut WorkBudget::unlimited();
            let done = layer.code_some(&mut coder, brought, &mut 0, Some(truth), work, &mut desk);
            debug_assert_eq!(done, Ok(true));
            num_channels += attribute.declaration.num_channels() as u64;
        }
        let vertices = (mesh.positions.len() - first) as u64;
        let mut payload = padded(coder.finish(), vertices * num_channels, MAX_VALUES_PER_BYTE);
        // No byte at all would mean that nothing comes with the pass.
        payload.resize(payload.len().max(1), 0);
        self.payloads.push(payload);
    }
}
