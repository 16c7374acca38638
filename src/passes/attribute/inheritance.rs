//! Entries that the corners of a star have from the patch that it replaced.

use super::entries::Entries;
use super::star::{Fan, Star};
use super::truth::Target;
use crate::entropy::context_mixer::PlainBits;
use crate::entropy::range_coder::BitCoder;
use crate::mesh::NO_ENTRY;
use crate::mesh::surface::{NO_CORNER, next, prev};
use crate::passes::GridMesh;

/// What a corner inherits is not what the triangle outside has.
const TORN: usize = 1;

/// A corner at the end of a ring edge.
#[derive(Clone, Copy)]
struct Inherited {
    corner: u32,
    /// The corner of its triangle at the star's vertex.
    facing: u32,
    /// What the patch had there.
    entry: u32,
    /// Whether one triangle of the patch had this edge and the next: it had one entry for two corners of the star, and the
    /// encoder kept the one of the triangle after.
    is_cut_off: bool,
}

/// The corners of a star that inherit entries.
#[derive(Default)]
pub(super) struct Inheritance {
    list: Vec<Inherited>,
    /// Corners that do not inherit, and what they would have.
    pub(super) exceptions: Vec<(u32, u32)>,
}

impl Inheritance {
    /// Star triangle i has at both ends of its ring edge what the patch had there, or something else: an entry of its own,
    /// which is not coded yet.
    pub(super) fn code<B: BitCoder>(
        &mut self,
        coder: &mut B,
        inherited: &mut PlainBits,
        target: Target,
        entries: &mut Entries,
        star: Star,
        fan: Fan,
    ) {
        self.gather(entries, star, fan);
        let (is_kept, num_torn) = self.hand_on(target, entries, star.vertex);
        let is_kept = coder.is_guessing() || inherited.code(coder, num_torn.min(3), is_kept);
        self.exceptions.clear();
        if !is_kept {
            self.code_exceptions(coder, inherited, target, entries, star.vertex);
        }
        self.exceptions.iter().for_each(|&(corner, _)| entries.of[corner as usize] = NO_ENTRY);
    }

    /// Reads what the patch had.
    fn gather(&mut self, entries: &Entries, star: Star, Fan { corners, closed, .. }: Fan) {
        let n = corners.len();
        let polygon = || star.polygon(n);
        let after = polygon().skip(1).chain(polygon().take(1));
        self.list.clear();
        for (i, (inside, after)) in polygon().zip(after).enumerate() {
            let is_same = inside / 3 == after / 3 && (closed || i + 1 < n) && !star.is_ear();
            let of_patch =
                if star.is_ear() { [prev(inside), next(inside)] } else { [next(inside), prev(inside)] };
            let [first, second] = of_patch.map(|c| entries.of[c as usize]);
            let facing = corners[i];
            self.list.push(Inherited { corner: next(facing), facing, entry: first, is_cut_off: false });
            self.list.push(Inherited { corner: prev(facing), facing, entry: second, is_cut_off: is_same });
        }
    }

    /// Gives the entries to the corners of the star. Returns whether the truth allows all of them, and how many of those that
    /// were cut off are torn.
    fn hand_on(&self, target: Target, entries: &mut Entries, vertex: u32) -> (bool, usize) {
        let mut is_kept = true;
        let mut num_torn = 0;
        for one in &self.list {
            entries.of[one.corner as usize] = one.entry;
            is_kept &= target.allows(one.corner, entries, one.entry);
            num_torn += usize::from(one.is_cut_off && one.fit_outside(target.mesh, entries, vertex) == TORN);
        }
        (is_kept, num_torn)
    }

    /// Codes which corners do not inherit.
    fn code_exceptions<B: BitCoder>(
        &mut self,
        coder: &mut B,
        inherited: &mut PlainBits,
        target: Target,
        entries: &Entries,
        vertex: u32,
    ) {
        for one in &self.list {
            let fit = one.fit_outside(target.mesh, entries, vertex);
            let context = 4 + 3 * usize::from(one.is_cut_off) + fit;
            let is_kept = target.wanted(one.corner, entries).is(entries, one.entry);
            if !inherited.code(coder, context, is_kept) {
                self.exceptions.push((one.corner, one.entry));
            }
        }
    }
}

impl Inherited {
    /// Whether the entry is what the triangle outside has at the same vertex: 0 if so, [`TORN`] if not, 2 if that is not
    /// known.
    fn fit_outside(&self, mesh: &GridMesh, entries: &Entries, vertex: u32) -> usize {
        let across = mesh.surface.across(self.facing);
        if across == NO_CORNER || mesh.surface.vertex(across) > vertex {
            return 2;
        }
        let outside = if self.corner == next(self.facing) { prev(across) } else { next(across) };
        if entries.of[outside as usize] == self.entry { 0 } else { TORN }
    }
}
