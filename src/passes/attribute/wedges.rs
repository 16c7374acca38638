//! Entries of corners: one for each wedge at a vertex, from seam to seam.

use super::around::Known;
use super::entry_coder::EntryCoder;
use super::inheritance::Inheritance;
use super::seams::SeamModels;
use super::star::{Fan, Star};
use super::truth::Target;
use crate::entropy::context_mixer::PlainBits;
use crate::entropy::range_coder::BitCoder;
use crate::mesh::surface::{NO_CORNER, next, prev};
use crate::mesh::{NO_ENTRY, Surface};
use crate::passes::Malformed;
use crate::util::simd4::Lanes;

/// Triangles looked at on either side of a corner that does not inherit.
const MAX_TURNS: usize = 8;

/// Codes the entries of the corners at one vertex.
pub(super) struct WedgeCoder<'a> {
    pub(super) entry_coder: EntryCoder<'a>,
    pub(super) inherited: &'a mut PlainBits,
    pub(super) seams: &'a mut SeamModels,
    pub(super) target: Target<'a>,
    pub(super) scratch: &'a mut WedgeScratch,
}

/// Scratch space.
#[derive(Default)]
pub(super) struct WedgeScratch {
    corners: Vec<u32>,
    is_seam: Vec<bool>,
    inheritance: Inheritance,
}

impl WedgeCoder<'_> {
    /// The wedges at a vertex, and before that what a split does to those around it, if it brought the vertex.
    pub(super) fn code<B: BitCoder>(
        &mut self,
        coder: &mut B,
        vertex: u32,
        star: Option<Star>,
    ) -> Result<(), Malformed> {
        let surface = &self.target.mesh.surface;
        let WedgeScratch { corners, is_seam, inheritance } = &mut *self.scratch;
        let closed = surface.fan(surface.corner_of[vertex as usize], corners);
        let fan = Fan { vertex, corners, closed };
        if let Some(star) = star {
            inheritance.code(coder, self.inherited, self.target, self.entry_coder.entries, star, fan);
        }
        self.seams.code(coder, self.target, self.entry_coder.entries, fan, is_seam);
        self.code_entries(coder, vertex, closed)?;
        if star.is_some() {
            self.code_exceptions(coder, vertex)?;
        }
        Ok(())
    }

    /// Begins after a seam, then goes from seam to seam.
    fn code_entries<B: BitCoder>(
        &mut self,
        coder: &mut B,
        vertex: u32,
        closed: bool,
    ) -> Result<(), Malformed> {
        let WedgeScratch { corners, is_seam, .. } = &mut *self.scratch;
        let n = corners.len();
        let start = if closed { is_seam.iter().position(|&s| s).unwrap_or(0) } else { 0 };
        corners.rotate_left(start);
        is_seam.rotate_left(start);
        let is_whole = closed && !is_seam[1..].contains(&true);
        let mut begin = 0;
        while begin < n {
            let length = is_seam[begin + 1..].iter().position(|&s| s).map_or(n - begin, |k| k + 1);
            let wedge = &corners[begin..begin + length];
            self.entry_coder.look_around(self.target.mesh, vertex, wedge, is_whole);
            let wanted = self.target.wanted(wedge[0], self.entry_coder.entries);
            let entry = self.entry_coder.code(coder, wanted, false)?;
            wedge.iter().for_each(|&c| self.entry_coder.entries.of[c as usize] = entry);
            begin += length;
        }
        Ok(())
    }

    /// Entries of the corners of a star that do not inherit theirs.
    fn code_exceptions<B: BitCoder>(&mut self, coder: &mut B, vertex: u32) -> Result<(), Malformed> {
        for i in 0..self.scratch.inheritance.exceptions.len() {
            let (corner, inherited) = self.scratch.inheritance.exceptions[i];
            self.look_around_exception(corner);
            self.gather_repeatable(vertex, corner, inherited);
            let wanted = self.target.wanted(corner, self.entry_coder.entries);
            self.entry_coder.entries.of[corner as usize] = self.entry_coder.code(coder, wanted, true)?;
        }
        Ok(())
    }

    /// What is known around a corner of a star that does not inherit: the rest of its wedge at the vertex of the star.
    fn look_around_exception(&mut self, corner: u32) {
        let mesh = self.target.mesh;
        let surface = &mesh.surface;
        let entries = &*self.entry_coder.entries;
        let around = &mut self.entry_coder.scratch.around;
        let of = |c: u32| entries.of[c as usize];
        around.begin_at(mesh, corner / 3);
        let origin = mesh.positions[surface.vertex(corner) as usize];
        let way = |c: u32| Lanes::between(origin, mesh.positions[surface.vertex(c) as usize]);
        // One of its neighbours is at the vertex of the star, the other at the far end of the ring edge.
        let own = 3 * (corner / 3) + 2;
        let far = if next(corner) == own { prev(corner) } else { next(corner) };
        around.push(of(own), way(own));
        around.push(of(far), way(far));
        for &c in self.scratch.corners.iter().filter(|&&c| c != own && of(c) == of(own)) {
            for end in [next(c), prev(c)] {
                if of(end) != NO_ENTRY && surface.vertex(end) != surface.vertex(corner) {
                    around.tips.push(Known { entry: of(end), way: way(end) });
                }
            }
        }
    }

    /// Entries that such a corner may repeat: what it would have inherited, then those of other triangles at its vertex.
    fn gather_repeatable(&mut self, vertex: u32, corner: u32, inherited: u32) {
        let surface = &self.target.mesh.surface;
        let repeatable = &mut self.entry_coder.scratch.repeatable;
        repeatable.clear();
        repeatable.push(inherited);
        for turn in [Surface::swing_left, Surface::swing_right] {
            let mut c = corner;
            for _ in 0..MAX_TURNS {
                c = turn(surface, c);
                if c == NO_CORNER || c == corner {
                    break;
                }
                if surface.triangles[c as usize / 3].iter().all(|&v| v <= vertex) {
                    repeatable.push(self.entry_coder.entries.of[c as usize]);
                }
            }
        }
    }
}
