//! Entries of faces.

use super::entry_coder::{EntryCoder, EntryScratch};
use super::star::Star;
use super::truth::Target;
use crate::entropy::context_mixer::PlainBits;
use crate::entropy::range_coder::BitCoder;
use crate::mesh::surface::NO_CORNER;
use crate::passes::{GridMesh, Malformed};
use crate::util::simd4::Lanes;

/// Codes the entries of faces.
pub(super) struct FaceCoder<'a> {
    pub(super) entry_coder: EntryCoder<'a>,
    pub(super) inherited: &'a mut PlainBits,
    pub(super) target: Target<'a>,
    pub(super) scratch: &'a mut FaceScratch,
}

/// Scratch space.
#[derive(Default)]
pub(super) struct FaceScratch {
    corners: Vec<u32>,
    /// What each triangle of the star has from the patch.
    inherited: Vec<u32>,
}

impl FaceCoder<'_> {
    /// A face of the base mesh, from those across its edges that come before it.
    pub(super) fn code_base<B: BitCoder>(&mut self, coder: &mut B, face: u32) -> Result<(), Malformed> {
        self.look_around(face, None, |across| across / 3 < face);
        self.code(coder, face, false)
    }

    /// The faces of a star, which have the entries of the patch that it replaced, or others.
    pub(super) fn code_star<B: BitCoder>(&mut self, coder: &mut B, star: Star) -> Result<(), Malformed> {
        self.gather(star);
        let is_kept = self.hand_on();
        let FaceScratch { inherited, .. } = &*self.scratch;
        let context = 10 + usize::from(inherited.iter().all(|&entry| entry == inherited[0]));
        if coder.is_guessing() || self.inherited.code(coder, context, is_kept) {
            return Ok(());
        }
        for i in 0..self.scratch.corners.len() {
            let (face, entry) = (self.scratch.corners[i] / 3, self.scratch.inherited[i]);
            let is_kept =
                self.target.wanted(face, self.entry_coder.entries).is(self.entry_coder.entries, entry);
            if !self.inherited.code(coder, 2 + context, is_kept) {
                self.code_exception(coder, star.vertex, face, entry)?;
            }
        }
        Ok(())
    }

    /// Reads what the patch had at each edge of the star.
    fn gather(&mut self, star: Star) {
        let surface = &self.target.mesh.surface;
        let FaceScratch { corners, inherited } = &mut *self.scratch;
        surface.fan(surface.corner_of[star.vertex as usize], corners);
        let entries = &self.entry_coder.entries.of;
        inherited.clear();
        inherited.extend(star.polygon(corners.len()).map(|corner| entries[corner as usize / 3]));
    }

    /// Gives these entries to the faces of the star; true if the truth allows all of them.
    fn hand_on(&mut self) -> bool {
        let entries = &mut *self.entry_coder.entries;
        let mut is_kept = true;
        for (&corner, &entry) in self.scratch.corners.iter().zip(&self.scratch.inherited) {
            is_kept &= self.target.allows(corner / 3, entries, entry);
            entries.of[corner as usize / 3] = entry;
        }
        is_kept
    }

    /// A face of the star of `vertex` that does not inherit, from what it would have inherited and from those across its
    /// edges that are not in a later star.
    fn code_exception<B: BitCoder>(
        &mut self,
        coder: &mut B,
        vertex: u32,
        face: u32,
        inherited: u32,
    ) -> Result<(), Malformed> {
        let surface = &self.target.mesh.surface;
        self.look_around(face, Some(inherited), |across| surface.vertex(across) <= vertex);
        self.code(coder, face, true)
    }

    /// What is known around a face: what it would have inherited, and the faces at those corners across its edges that
    /// are known.
    fn look_around(&mut self, face: u32, inherited: Option<u32>, is_known: impl Fn(u32) -> bool) {
        let mesh = self.target.mesh;
        let entries = &*self.entry_coder.entries;
        let EntryScratch { around, repeatable, .. } = &mut *self.entry_coder.scratch;
        let origin = mesh.positions[mesh.surface.vertex(3 * face) as usize];
        let own = middle(mesh, face, origin);
        repeatable.clear();
        around.begin_at(mesh, face);
        if let Some(inherited) = inherited {
            around.push(inherited, Lanes::ZERO);
        }
        for corner in 3 * face..3 * face + 3 {
            let across = mesh.surface.across(corner);
            if across != NO_CORNER && is_known(across) {
                let other = across / 3;
                around.push(entries.of[other as usize], middle(mesh, other, origin) - own);
            }
        }
    }

    fn code<B: BitCoder>(&mut self, coder: &mut B, face: u32, is_exception: bool) -> Result<(), Malformed> {
        let wanted = self.target.wanted(face, self.entry_coder.entries);
        self.entry_coder.entries.of[face as usize] = self.entry_coder.code(coder, wanted, is_exception)?;
        Ok(())
    }
}

/// The way from `origin` to the middle of a face.
fn middle(mesh: &GridMesh, face: u32, origin: [i32; 3]) -> Lanes {
    let mut sum = Lanes::ZERO;
    for v in mesh.surface.triangles[face as usize] {
        sum += Lanes::between(origin, mesh.positions[v as usize]);
    }
    sum * (1.0 / 3.0)
}
