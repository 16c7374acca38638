//! One attribute on the present mesh, and what a pass brings of it (`format/SPEC.md`, section 7.11).

use super::declaration::Declaration;
use super::entries::Entries;
use super::entry_coder::{EntryCoder, EntryModels, EntryScratch};
use super::faces::{FaceCoder, FaceScratch};
use super::seams::SeamModels;
use super::star::Star;
use super::truth::{Target, Truth};
use super::wedges::{WedgeCoder, WedgeScratch};
use crate::entropy::context_mixer::{Mixing, PlainBits};
use crate::entropy::range_coder::BitCoder;
use crate::mesh::Domain;
use crate::passes::patch::Patches;
use crate::passes::work_budget::WorkBudget;
use crate::passes::{EXHAUSTED, GridMesh, Malformed};

/// What a pass has brought.
#[derive(Clone, Copy)]
pub(crate) struct Brought<'a> {
    pub(crate) mesh: &'a GridMesh,
    /// The patches of a split, of which the mesh has as many as it has vertices from `first` on; `None`: it is the base
    /// mesh.
    pub(crate) patches: Option<&'a Patches>,
    /// The first vertex that is new.
    pub(crate) first: usize,
}

/// The entries of one attribute and all that is learnt about them.
#[derive(Clone)]
pub(crate) struct Layer {
    pub(crate) entries: Entries,
    models: EntryModels,
    /// Is a star as it inherits; is an element of it.
    inherited: PlainBits,
    seams: SeamModels,
}

/// Scratch space of a layer.
#[derive(Default)]
pub(crate) struct Desk {
    entries: EntryScratch,
    /// Corners at a vertex.
    fan: Vec<u32>,
    wedges: WedgeScratch,
    faces: FaceScratch,
}

impl Layer {
    pub(crate) fn new(declaration: &Declaration, mixing: Mixing) -> Self {
        Self {
            entries: Entries::new(declaration.domain, declaration.num_channels()),
            models: EntryModels::new(declaration, mixing),
            inherited: PlainBits::new(14),
            seams: SeamModels::new(),
        }
    }

    /// Goes on with the elements that a pass has brought, at `place`: a vertex or face of the base mesh, or a patch of
    /// a split; true if all are done.
    ///
    /// # Errors
    /// If the payload ends too early or names a value outside its range.
    pub(crate) fn code_some<B: BitCoder>(
        &mut self,
        coder: &mut B,
        brought: Brought,
        place: &mut usize,
        truth: Option<Truth>,
        work: &mut WorkBudget,
        desk: &mut Desk,
    ) -> Result<bool, Malformed> {
        let Brought { mesh, patches, first } = brought;
        let surface = &mesh.surface;
        let (num_vertices, num_faces) = (surface.corner_of.len(), surface.triangles.len());
        self.entries.resize(num_vertices, num_faces);
        let by_faces = patches.is_none() && self.entries.domain == Domain::Triangle;
        let count = if by_faces { num_faces } else { num_vertices - first };
        let target = Target { mesh, truth };
        while *place < count {
            let units = if by_faces { 3 } else { surface.valence[first + *place] as usize };
            if !work.take(units * self.entries.num_channels) {
                return Ok(false);
            }
            if coder.is_exhausted() {
                return Err(Malformed(EXHAUSTED));
            }
            let vertex = (first + *place) as u32;
            let star = patches.map(|patches| Star { patches, patch: *place, vertex });
            match (self.entries.domain, star) {
                (Domain::Vertex, _) => self.code_vertex(coder, target, vertex, desk)?,
                (Domain::Corner, star) => self.wedges(target, desk).code(coder, vertex, star)?,
                (Domain::Triangle, None) => self.faces(target, desk).code_base(coder, *place as u32)?,
                (Domain::Triangle, Some(star)) => self.faces(target, desk).code_star(coder, star)?,
            }
            *place += 1;
        }
        self.entries.compact();
        Ok(true)
    }

    fn code_vertex<B: BitCoder>(
        &mut self,
        coder: &mut B,
        target: Target,
        vertex: u32,
        desk: &mut Desk,
    ) -> Result<(), Malformed> {
        let surface = &target.mesh.surface;
        let closed = surface.fan(surface.corner_of[vertex as usize], &mut desk.fan);
        let Self { entries, models, .. } = self;
        let wanted = target.wanted(vertex, entries);
        let mut entry_coder = EntryCoder { entries, models, scratch: &mut desk.entries };
        entry_coder.look_around(target.mesh, vertex, &desk.fan, closed);
        self.entries.of[vertex as usize] = entry_coder.code(coder, wanted, false)?;
        Ok(())
    }

    fn wedges<'a>(&'a mut self, target: Target<'a>, desk: &'a mut Desk) -> WedgeCoder<'a> {
        let Self { entries, models, inherited, seams } = self;
        let entry_coder = EntryCoder { entries, models, scratch: &mut desk.entries };
        WedgeCoder { entry_coder, inherited, seams, target, scratch: &mut desk.wedges }
    }

    fn faces<'a>(&'a mut self, target: Target<'a>, desk: &'a mut Desk) -> FaceCoder<'a> {
        let Self { entries, models, inherited, .. } = self;
        let entry_coder = EntryCoder { entries, models, scratch: &mut desk.entries };
        FaceCoder { entry_coder, inherited, target, scratch: &mut desk.faces }
    }
}
