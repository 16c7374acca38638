//! The walk from gate to gate, and what is coded on it.

use super::growth::{FirstGrowths, GrowingPatch};
use super::models::ConnectivityModels;
use super::polygon::Triangle;
use super::regions::{Around, Face, Regions};
use super::{ConnectivityTarget, NOT_IN_PATCH};
use crate::entropy::range_coder::BitCoder;
use crate::entropy::tables::Tables;
use crate::mesh::Surface;
use crate::mesh::surface::{NO_CORNER, next, prev};
use crate::passes::patch::{CLOSED, Patches};
use crate::passes::work_budget::{SWEPT_PER_UNIT, WorkBudget};
use crate::passes::{EXHAUSTED, GridMesh, Malformed};
use std::collections::VecDeque;

/// Codes the patches of one level: exactly `count` of them when decoding.
#[cfg(any(feature = "encoder", test))]
pub(crate) fn code<B: BitCoder>(
    coder: &mut B,
    models: &mut ConnectivityModels,
    mesh: &GridMesh,
    count: usize,
    target: Option<&ConnectivityTarget>,
) -> Result<Patches, Malformed> {
    let mut walk = PausedWalk::new(mesh, count);
    walk.code_some(coder, models, mesh, target, &mut WorkBudget::unlimited())?;
    walk.finish()
}

/// A walk between two slices of work: all that it owns.
#[derive(Default)]
pub(crate) struct PausedWalk {
    count: usize,
    patches: Patches,
    faces: Vec<Face>,
    around: Vec<Around>,
    gates: VecDeque<u32>,
    /// Faces whose corners `around` knows of.
    num_counted: usize,
    next_corner: u32,
    next_seed: u32,
}

impl PausedWalk {
    pub(crate) fn new(mesh: &GridMesh, count: usize) -> Self {
        let surface = &mesh.surface;
        let at = |(&valence, &cell)| Around::new(cell, valence);
        let around = surface.valence.iter().zip(&mesh.positions).map(at).collect();
        let faces = vec![Face::Undecided; surface.triangles.len()];
        Self { count, faces, around, ..Self::default() }
    }

    /// Goes on; true if the walk is over. `mesh` and `target` must be those it began with.
    pub(crate) fn code_some<B: BitCoder>(
        &mut self,
        coder: &mut B,
        models: &mut ConnectivityModels,
        mesh: &GridMesh,
        target: Option<&ConnectivityTarget>,
        work: &mut WorkBudget,
    ) -> Result<bool, Malformed> {
        if !self.count_corners(&mesh.surface, work) {
            return Ok(false);
        }
        let mut walk = Walk::resume(std::mem::take(self), mesh, models, target);
        let is_over = walk.code_some(coder, work);
        *self = walk.pause();
        is_over
    }

    fn count_corners(&mut self, surface: &Surface, work: &mut WorkBudget) -> bool {
        for block in surface.triangles[self.num_counted..].chunks(SWEPT_PER_UNIT) {
            if !work.take(1) {
                return false;
            }
            block.as_flattened().iter().for_each(|&v| self.around[v as usize].undecided += 1);
            self.num_counted += block.len();
        }
        true
    }

    /// What was found, once the walk is over.
    pub(crate) fn finish(self) -> Result<Patches, Malformed> {
        if self.patches.len() != self.count {
            return Err(Malformed("a level has fewer vertices than announced"));
        }
        Ok(self.patches)
    }
}

/// A walk that goes on.
struct Walk<'a> {
    regions: Regions<'a>,
    models: &'a mut ConnectivityModels,
    target: Option<&'a ConnectivityTarget>,
    /// Number of patches that are expected.
    count: usize,
    gates: VecDeque<u32>,
    /// First corner whose ear is not coded yet.
    next_corner: u32,
    /// No vertex before this one is at a face that can be a seed.
    next_seed: u32,
    patch: GrowingPatch,
}

impl<'a> Walk<'a> {
    fn resume(
        paused: PausedWalk,
        mesh: &'a GridMesh,
        models: &'a mut ConnectivityModels,
        target: Option<&'a ConnectivityTarget>,
    ) -> Self {
        let PausedWalk { count, patches, faces, around, gates, num_counted: _, next_corner, next_seed } =
            paused;
        let regions = Regions::new(&mesh.surface, faces, around, patches);
        let patch = GrowingPatch::default();
        Self { regions, models, target, count, gates, next_corner, next_seed, patch }
    }

    fn pause(self) -> PausedWalk {
        let Self { regions, count, gates, next_corner, next_seed, .. } = self;
        let Regions { patches, faces, around, .. } = regions;
        let num_counted = faces.len();
        PausedWalk { count, patches, faces, around, gates, num_counted, next_corner, next_seed }
    }

    /// Goes on until the walk is over (true) or the work is used up.
    fn code_some<B: BitCoder>(&mut self, coder: &mut B, work: &mut WorkBudget) -> Result<bool, Malformed> {
        Ok(self.code_ears(coder, work)? && self.code_patches(coder, work)?)
    }

    /// Vertices of valence two that hang on a boundary edge, in the order of the corners.
    fn code_ears<B: BitCoder>(&mut self, coder: &mut B, work: &mut WorkBudget) -> Result<bool, Malformed> {
        let end = self.regions.opposite.len() as u32;
        while self.next_corner < end {
            let corner = self.next_corner;
            // Corners that face no boundary cost next to nothing.
            if corner.is_multiple_of(64) {
                if !work.take(1) {
                    return Ok(false);
                }
                let block = &self.regions.opposite[corner as usize..];
                let block = &block[..block.len().min(64)];
                if !has_boundary(block) {
                    self.next_corner += block.len() as u32;
                    continue;
                }
            }
            self.next_corner += 1;
            if self.regions.across(corner) == NO_CORNER {
                self.code_ear(coder, corner)?;
            }
        }
        Ok(true)
    }

    /// Whether a vertex hangs on the boundary edge that a corner faces.
    fn code_ear<B: BitCoder>(&mut self, coder: &mut B, corner: u32) -> Result<(), Malformed> {
        let ends = [next(corner), prev(corner)].map(|c| self.regions.vertex(c) as usize);
        let context = ends.iter().filter(|&&v| self.regions.around[v].touched > 0).count();
        let wanted = self.target.is_some_and(|t| t.ear_at.contains_key(&corner));
        if self.models.ear.code(coder, context, wanted) {
            self.check_room()?;
            self.regions.patches.push_edge(self.regions.surface, corner);
            self.regions.patches.finish(0);
            ends.iter().for_each(|&v| self.regions.around[v].touch(1));
        }
        Ok(())
    }

    /// Checks that one more patch is expected.
    fn check_room(&self) -> Result<(), Malformed> {
        if self.regions.patches.len() == self.count {
            return Err(Malformed("a level has more vertices than announced"));
        }
        Ok(())
    }

    /// The faces beyond the gates, and those where each component starts.
    fn code_patches<B: BitCoder>(&mut self, coder: &mut B, work: &mut WorkBudget) -> Result<bool, Malformed> {
        while work.take(1) {
            if let Some(gate) = self.gates.pop_front() {
                if coder.is_exhausted() || coder.is_guessing() {
                    return Err(Malformed(EXHAUSTED));
                }
                if let Some(beyond) = self.regions.undecided_across(gate) {
                    self.decide(coder, beyond, false)?;
                }
            } else {
                let Some(seed) = self.next_seed() else { return Ok(true) };
                self.decide(coder, seed, true)?;
            }
        }
        Ok(false)
    }

    /// Where the walk goes on once no gate is left, if it does.
    fn next_seed(&mut self) -> Option<u32> {
        let rest = &self.regions.surface.corner_of[self.next_seed as usize..];
        let skipped = rest.iter().position(|&corner| self.regions.is_undecided(corner))?;
        self.next_seed += skipped as u32;
        Some(self.regions.seed_at(rest[skipped]))
    }

    /// Codes whether the face of `corner` is in a patch, and the patch if so. `corner` faces the
    /// gate, unless the face is a seed.
    fn decide<B: BitCoder>(&mut self, coder: &mut B, corner: u32, is_seed: bool) -> Result<(), Malformed> {
        let face = corner / 3;
        let wanted = self.target.map_or(NOT_IN_PATCH, |t| t.patch_of_face[face as usize]);
        let is_wanted = wanted != NOT_IN_PATCH;
        if B::HAS_STREAMS {
            let is_in_patch = coder.decide(self.regions.face_stream(corner, is_seed), is_wanted);
            return self.settle(coder, corner, is_seed, wanted, is_in_patch);
        }
        let ends = [next(corner), prev(corner), corner].map(|c| self.regions.at(c));
        let start = Triangle { cells: ends.map(|v| v.cell), valences: ends.map(|v| v.live) };
        let growths =
            if is_seed { FirstGrowths::NONE } else { FirstGrowths::of(&self.regions, &start, corner) };
        let (contexts, set) = self.regions.face_contexts(corner, is_seed, ends, growths.fits());
        let is_in_patch = self.models.in_patch.code(coder, Tables::get(), contexts, [], set, is_wanted);
        if is_in_patch {
            self.patch.begin(&start, usize::from(!is_seed), growths);
        }
        self.settle(coder, corner, is_seed, wanted, is_in_patch)
    }

    /// Keeps the face of `corner`, or makes a patch of it and what follows.
    #[inline(always)]
    fn settle<B: BitCoder>(
        &mut self,
        coder: &mut B,
        corner: u32,
        is_seed: bool,
        wanted: u32,
        is_in_patch: bool,
    ) -> Result<(), Malformed> {
        if is_in_patch {
            self.check_room()?;
            self.code_patch(coder, corner, is_seed, wanted);
        } else {
            self.keep(corner, is_seed);
        }
        Ok(())
    }

    /// Keeps the face of `corner`: the walk goes on over its other edges.
    #[inline(always)]
    fn keep(&mut self, corner: u32, is_seed: bool) {
        self.regions.keep(corner / 3);
        self.gates.push_back(next(corner));
        self.gates.push_back(prev(corner));
        if is_seed {
            self.gates.push_back(corner);
        }
    }

    /// Codes a patch that begins with the face of `corner`.
    #[inline(always)]
    fn code_patch<B: BitCoder>(&mut self, coder: &mut B, corner: u32, is_seed: bool, wanted: u32) {
        self.regions.take(corner / 3);
        self.patch.frontier.extend([prev(corner), next(corner)]);
        if is_seed {
            self.patch.frontier.push(corner);
        } else {
            self.regions.patches.push_edge(self.regions.surface, corner);
        }
        while let Some(inside) = self.patch.frontier.pop() {
            if self.code_growth(coder, inside, wanted) {
                let entered = self.regions.across(inside);
                self.regions.take(entered / 3);
                self.patch.frontier.extend([prev(entered), next(entered)]);
            } else {
                self.regions.patches.push_edge(self.regions.surface, inside);
                self.patch.pass();
            }
        }
        self.finish_patch(coder, wanted);
    }

    /// Codes whether the patch goes on across the edge that `inside` faces.
    fn code_growth<B: BitCoder>(&mut self, coder: &mut B, inside: u32, wanted: u32) -> bool {
        let Some(beyond) = self.regions.undecided_across(inside) else { return false };
        let is_wanted = self.target.is_some_and(|t| t.patch_of_face[(beyond / 3) as usize] == wanted);
        if B::HAS_STREAMS {
            return coder.decide(self.regions.growth_stream(beyond), is_wanted);
        }
        let &Around { cell: tip, live: valence, .. } = self.regions.at(beyond);
        let fit = self.patch.fit_grown(inside, tip, valence);
        let fits = [self.patch.fit, fit, self.patch.fit_after()];
        let (contexts, set) = self.regions.growth_contexts(inside, beyond, fits);
        let grows = self.models.grow.code(coder, Tables::get(), contexts, [], set, is_wanted);
        if grows {
            self.patch.grow(tip, valence, fit);
        }
        grows
    }

    /// Codes over which edge the hole is open, and passes the polygon's edges on as gates.
    fn finish_patch<B: BitCoder>(&mut self, coder: &mut B, wanted: u32) {
        let open_edge = self.code_open_edge(coder, wanted);
        let (edges, _) = self.regions.patches.unfinished();
        let degree = edges.len();
        for (i, &corner) in edges.iter().enumerate() {
            self.gates.push_back(corner);
            let v = self.regions.vertex(next(corner)) as usize;
            let is_end =
                open_edge != CLOSED && (i as u32 == open_edge || i == (open_edge as usize + 1) % degree);
            self.regions.around[v].touch(if is_end { 1 } else { 2 });
        }
        self.regions.patches.finish(open_edge);
    }

    /// The boundary edge of the polygon over which the hole is open, or [`CLOSED`].
    fn code_open_edge<B: BitCoder>(&mut self, coder: &mut B, wanted: u32) -> u32 {
        let (edges, _) = self.regions.patches.unfinished();
        for (i, &corner) in edges.iter().enumerate() {
            if self.regions.across(corner) == NO_CORNER && !self.regions.patches.has_ear(corner) {
                let opens = self.target.is_some_and(|t| t.patch_open_at.get(&corner) == Some(&wanted));
                if self.models.open.code(coder, 0, opens) {
                    return i as u32;
                }
            }
        }
        CLOSED
    }
}

/// Whether one of the corners faces the boundary. Looks at all of them, as that is done side by side.
fn has_boundary(opposite: &[u32]) -> bool {
    opposite.iter().fold(false, |found, &o| found | (o == NO_CORNER))
}
