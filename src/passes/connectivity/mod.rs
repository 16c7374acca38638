//! Where the odd vertices of a level go (`format/SPEC.md`, section 7.2): the faces of the coarse
//! mesh are walked from gate to gate and grouped into patches.

mod polygon;

use super::patch::{CLOSED, Patches};
use super::work_budget::{SWEPT_PER_UNIT, WorkBudget};
use super::{EXHAUSTED, GridMesh, Malformed};
use crate::entropy::context_mixer::{MixedBit, Mixing, PlainBits};
use crate::entropy::range_coder::BitCoder;
use crate::entropy::streams::stream;
use crate::entropy::tables::{Tables, index_below};
use crate::mesh::Surface;
use crate::mesh::ears::MAX_VALENCE;
use crate::mesh::surface::{NO_CORNER, next, prev};
use crate::util::simd4::Cell;
use polygon::{FITS, Fit, Polygon, Triangle};
use std::collections::{HashMap, VecDeque};

/// What the encoder wants written, in the numbering of the coarse mesh.
#[derive(Default)]
pub(crate) struct ConnectivityTarget {
    /// Patch that a face belongs to, or [`NOT_IN_PATCH`].
    pub(crate) patch_of_face: Vec<u32>,
    /// Patch whose hole opens over the boundary edge that a corner faces.
    pub(crate) patch_open_at: HashMap<u32, u32>,
    /// Ear along the boundary edge that a corner faces.
    pub(crate) ear_at: HashMap<u32, u32>,
}

/// Mark of a face that belongs to no patch.
pub(crate) const NOT_IN_PATCH: u32 = u32::MAX;

/// Adaptive models, kept from level to level.
#[derive(Clone)]
pub(crate) struct ConnectivityModels {
    in_patch: MixedBit<6>,
    grow: MixedBit<6>,
    ear: PlainBits,
    open: PlainBits,
}

const LIMIT: u32 = 30;
/// Longest patch that contexts tell apart.
const MAX_SIZE: usize = 6;
/// Sizes of a patch, and whether it and the larger one fit the rule.
const STATES: usize = MAX_SIZE * FITS * FITS;
const GROW_SETS: usize = 2 * STATES;

impl ConnectivityModels {
    pub(crate) fn new(mixing: Mixing) -> Self {
        Self {
            in_patch: MixedBit::new(
                mixing,
                [FITS * FITS * 12, FITS * FITS * 8, 27 * 512, 512 * 3, 64 * 12, 16 * 8 * 16],
                8,
                0.0,
                LIMIT,
            ),
            grow: MixedBit::new(
                mixing,
                [
                    STATES * FITS * 4,
                    STATES * FITS * 8,
                    STATES * 64 * 4,
                    STATES * 64 * 4,
                    STATES * 64,
                    MAX_SIZE * 32 * 16,
                ],
                GROW_SETS,
                0.0,
                LIMIT,
            ),
            ear: PlainBits::new(3),
            open: PlainBits::new(1),
        }
    }
}

/// What is known at a vertex so far.
#[derive(Clone, Copy)]
struct Around {
    cell: Cell,
    /// In the coarse mesh.
    valence: u32,
    /// Faces that are not decided yet.
    undecided: u32,
    /// What the patches so far will add to the valence.
    gained: i16,
    /// The valence as it will be then, as far as the rule tells it apart.
    live: u8,
    /// Patches that touch the vertex.
    touched: u8,
}

impl Around {
    fn new(cell: [i32; 3], valence: u32) -> Self {
        let live = valence.min(MAX_VALENCE) as u8;
        Self { cell: Cell::new(cell), valence, undecided: 0, gained: 0, live, touched: 0 }
    }

    /// 0 if a patch touches the vertex; else 1 to 3, the fewer faces are left the higher: a maximal
    /// set of removed vertices leaves no vertex untouched. One face is left at least.
    #[inline(always)]
    fn urgency(&self) -> usize {
        if self.touched > 0 { 0 } else { 4 - self.undecided.min(3) as usize }
    }

    fn gain(&mut self, gained: i16) {
        self.gained = self.gained.saturating_add(gained);
        self.live = (self.valence as i32 + i32::from(self.gained)).clamp(0, MAX_VALENCE as i32) as u8;
    }

    fn touch(&mut self, gained: i16) {
        self.touched = self.touched.saturating_add(1);
        self.gain(gained);
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Face {
    Undecided = 0,
    Kept = 1,
    InPatch = 2,
}

/// Whether a patch would fit the rule if it grew over the edge that the corner `inside` faces.
#[derive(Clone, Copy)]
struct Growth {
    inside: u32,
    /// [`Fit::Unknown`] if it cannot grow there.
    fit: Fit,
}

impl Growth {
    /// Over no edge.
    const NONE: Self = Self { inside: NO_CORNER, fit: Fit::Unknown };
}

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

/// A walk between two slices of work: all of it that is not borrowed.
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

struct Walk<'a> {
    surface: &'a Surface,
    /// At each corner, and the corner across from each: as the surface has them, at hand.
    vertices: &'a [u32],
    opposite: &'a [u32],
    models: &'a mut ConnectivityModels,
    target: Option<&'a ConnectivityTarget>,
    count: usize,
    patches: Patches,
    faces: Vec<Face>,
    around: Vec<Around>,
    gates: VecDeque<u32>,
    /// Edges of the growing patch still to look at.
    frontier: Vec<u32>,
    /// First corner whose ear is not coded yet.
    next_corner: u32,
    /// No vertex before this one is at a face that can be a seed.
    next_seed: u32,
    polygon: Polygon,
    /// Whether the polygon fits the rule.
    fit: Fit,
    /// What is known of the edges that may be looked at next: those of the face at the gate, until the
    /// patch grows.
    growths: [Growth; 2],
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
        let surface = &mesh.surface;
        let frontier = Vec::new();
        Self {
            surface,
            vertices: surface.triangles.as_flattened(),
            opposite: &surface.opposite,
            models,
            target,
            count,
            patches,
            faces,
            around,
            gates,
            frontier,
            next_corner,
            next_seed,
            polygon: Polygon::default(),
            fit: Fit::Is,
            growths: [Growth::NONE; 2],
        }
    }

    fn pause(self) -> PausedWalk {
        let Self { count, patches, faces, around, gates, next_corner, next_seed, .. } = self;
        let num_counted = faces.len();
        PausedWalk { count, patches, faces, around, gates, num_counted, next_corner, next_seed }
    }

    /// Goes on until the walk is over (true) or the work is used up.
    fn code_some<B: BitCoder>(&mut self, coder: &mut B, work: &mut WorkBudget) -> Result<bool, Malformed> {
        Ok(self.code_ears(coder, work)? && self.code_patches(coder, work)?)
    }

    /// Vertices of valence two that hang on a boundary edge, in the order of the corners.
    fn code_ears<B: BitCoder>(&mut self, coder: &mut B, work: &mut WorkBudget) -> Result<bool, Malformed> {
        let end = self.opposite.len() as u32;
        while self.next_corner < end {
            let corner = self.next_corner;
            // Corners that face no boundary cost next to nothing.
            if corner.is_multiple_of(64) {
                if !work.take(1) {
                    return Ok(false);
                }
                let block = &self.opposite[corner as usize..];
                let block = &block[..block.len().min(64)];
                if !has_boundary(block) {
                    self.next_corner += block.len() as u32;
                    continue;
                }
            }
            self.next_corner += 1;
            if self.across(corner) != NO_CORNER {
                continue;
            }
            let ends = [next(corner), prev(corner)].map(|c| self.vertex(c) as usize);
            let context = ends.iter().filter(|&&v| self.around[v].touched > 0).count();
            let wanted = self.target.is_some_and(|t| t.ear_at.contains_key(&corner));
            if self.models.ear.code(coder, context, wanted) {
                self.check_room()?;
                self.patches.push_edge(self.surface, corner);
                self.patches.finish(0);
                ends.iter().for_each(|&v| self.around[v].touch(1));
            }
        }
        Ok(true)
    }

    fn check_room(&self) -> Result<(), Malformed> {
        if self.patches.len() == self.count {
            return Err(Malformed("a level has more vertices than announced"));
        }
        Ok(())
    }

    fn code_patches<B: BitCoder>(&mut self, coder: &mut B, work: &mut WorkBudget) -> Result<bool, Malformed> {
        while work.take(1) {
            if let Some(gate) = self.gates.pop_front() {
                if coder.is_exhausted() || coder.is_guessing() {
                    return Err(Malformed(EXHAUSTED));
                }
                let beyond = self.across(gate);
                if beyond != NO_CORNER && self.faces[(beyond / 3) as usize] == Face::Undecided {
                    self.decide(coder, beyond, false)?;
                }
            } else {
                let rest = &self.surface.corner_of[self.next_seed as usize..];
                let is_seed = |&corner: &u32| self.faces[(corner / 3) as usize] == Face::Undecided;
                let Some(skipped) = rest.iter().position(is_seed) else {
                    return Ok(true);
                };
                let corner = rest[skipped];
                self.next_seed += skipped as u32;
                self.decide(coder, self.seed_at(corner), true)?;
            }
        }
        Ok(false)
    }

    /// Where the walk of a component starts whose first vertex is at `corner`: at the edge to the
    /// vertex after it, if that is there.
    fn seed_at(&self, corner: u32) -> u32 {
        let second = self.vertex(corner) + 1;
        let there = |c: u32| (c != NO_CORNER).then_some(c);
        let lefts = std::iter::successors(Some(corner), |&c| there(self.surface.swing_left(c)));
        let rights = std::iter::successors(Some(corner), |&c| there(self.surface.swing_right(c)));
        let turn = |(i, c): (usize, u32)| (i == 0 || c != corner).then_some(c);
        let mut around = lefts.enumerate().map_while(turn).chain(rights.enumerate().map_while(turn));
        prev(around.find(|&c| self.vertex(next(c)) == second).unwrap_or(corner))
    }

    /// Codes whether the face of `corner` is in a patch, and the patch if so. `corner` faces the
    /// gate, unless the face is a seed.
    fn decide<B: BitCoder>(&mut self, coder: &mut B, corner: u32, is_seed: bool) -> Result<(), Malformed> {
        let face = corner / 3;
        let wanted = self.target.map_or(NOT_IN_PATCH, |t| t.patch_of_face[face as usize]);
        if B::HAS_STREAMS {
            let is_in_patch = coder.decide(self.face_stream(corner, is_seed), wanted != NOT_IN_PATCH);
            return self.settle(coder, corner, is_seed, wanted, is_in_patch);
        }
        let ends = [next(corner), prev(corner), corner].map(|c| self.at(c));
        let start = Triangle { cells: ends.map(|v| v.cell), valences: ends.map(|v| v.live) };
        let mut growths = [Growth::NONE; 2];
        if !is_seed {
            growths =
                [self.first_growth(&start, next(corner), 1), self.first_growth(&start, prev(corner), 2)];
        }
        let (contexts, set) = self.face_contexts(corner, is_seed, ends, growths.map(|growth| growth.fit));
        let is_wanted = wanted != NOT_IN_PATCH;
        let is_in_patch = self.models.in_patch.code(coder, Tables::get(), contexts, [], set, is_wanted);
        if is_in_patch {
            self.polygon.begin(&start, usize::from(!is_seed));
            self.fit = Fit::Is;
            self.growths = growths;
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
        let face = corner / 3;
        if !is_in_patch {
            self.keep(face);
            self.gates.push_back(next(corner));
            self.gates.push_back(prev(corner));
            if is_seed {
                self.gates.push_back(corner);
            }
            return Ok(());
        }
        self.check_room()?;
        self.take(face);
        self.frontier.extend([prev(corner), next(corner)]);
        if is_seed {
            self.frontier.push(corner);
        } else {
            self.patches.push_edge(self.surface, corner);
        }
        while let Some(inside) = self.frontier.pop() {
            if self.code_growth(coder, inside, wanted) {
                let entered = self.across(inside);
                self.take(entered / 3);
                self.frontier.extend([prev(entered), next(entered)]);
            } else {
                self.patches.push_edge(self.surface, inside);
                self.polygon.pass();
            }
        }
        self.finish_patch(coder, wanted)
    }

    #[inline(always)]
    fn vertex(&self, corner: u32) -> u32 {
        self.vertices[corner as usize]
    }

    #[inline(always)]
    fn across(&self, corner: u32) -> u32 {
        self.opposite[corner as usize]
    }

    /// What is known at the vertex of a corner.
    #[inline(always)]
    fn at(&self, corner: u32) -> &Around {
        &self.around[self.vertex(corner) as usize]
    }

    /// The corner beyond the edge that `inside` faces, if a patch can grow over it.
    fn undecided_across(&self, inside: u32) -> Option<u32> {
        let beyond = self.across(inside);
        let is_open = beyond != NO_CORNER && self.faces[(beyond / 3) as usize] == Face::Undecided;
        is_open.then_some(beyond)
    }

    /// What growing over edge `edge` of the first triangle would make of a patch.
    #[inline(always)]
    fn first_growth(&self, start: &Triangle, inside: u32, edge: usize) -> Growth {
        let Some(beyond) = self.undecided_across(inside) else { return Growth::NONE };
        let tip = self.at(beyond);
        Growth { inside, fit: start.fit_grown(edge, tip.cell, tip.live) }
    }

    /// What is known of growing over the edge that `inside` faces.
    #[inline(always)]
    fn known_fit(&self, inside: u32) -> Option<Fit> {
        self.growths.iter().find(|growth| growth.inside == inside).map(|growth| growth.fit)
    }

    fn keep(&mut self, face: u32) {
        self.faces[face as usize] = Face::Kept;
        for v in self.surface.triangles[face as usize] {
            self.around[v as usize].undecided -= 1;
        }
    }

    fn take(&mut self, face: u32) {
        self.faces[face as usize] = Face::InPatch;
        self.patches.push_face(face);
        for v in self.surface.triangles[face as usize] {
            let around = &mut self.around[v as usize];
            around.undecided -= 1;
            around.gain(-1);
        }
    }

    /// Codes whether the patch goes on across the edge that `inside` faces.
    fn code_growth<B: BitCoder>(&mut self, coder: &mut B, inside: u32, wanted: u32) -> bool {
        if B::HAS_STREAMS {
            let Some(beyond) = self.undecided_across(inside) else { return false };
            let grows = self.target.is_some_and(|t| t.patch_of_face[(beyond / 3) as usize] == wanted);
            return coder.decide(self.growth_stream(beyond), grows);
        }
        let Some(beyond) = self.undecided_across(inside) else { return false };
        let &Around { cell: tip, live: valence, .. } = self.at(beyond);
        let fit = self.known_fit(inside).unwrap_or_else(|| self.polygon.fit_grown(tip, valence));
        let after = self.frontier.last().and_then(|&after| self.known_fit(after)).unwrap_or(Fit::Unknown);
        let (contexts, set) = self.growth_contexts(inside, beyond, fit, after);
        let grows = self.target.is_some_and(|t| t.patch_of_face[(beyond / 3) as usize] == wanted);
        let grows = self.models.grow.code(coder, Tables::get(), contexts, [], set, grows);
        if grows {
            self.polygon.grow(tip, valence);
            self.fit = fit;
            self.growths = [Growth::NONE; 2];
        }
        grows
    }

    /// Codes over which edge the hole is open, and passes the polygon's edges on as gates.
    fn finish_patch<B: BitCoder>(&mut self, coder: &mut B, wanted: u32) -> Result<(), Malformed> {
        let mut open_edge = CLOSED;
        let (edges, _) = self.patches.unfinished();
        for (i, &corner) in edges.iter().enumerate() {
            if self.across(corner) == NO_CORNER && !self.patches.has_ear(corner) {
                let opens = self.target.is_some_and(|t| t.patch_open_at.get(&corner) == Some(&wanted));
                if self.models.open.code(coder, 0, opens) {
                    open_edge = i as u32;
                    break;
                }
            }
        }
        let degree = edges.len();
        for (i, &corner) in edges.iter().enumerate() {
            self.gates.push_back(corner);
            let v = self.vertex(next(corner)) as usize;
            let is_end =
                open_edge != CLOSED && (i as u32 == open_edge || i == (open_edge as usize + 1) % degree);
            self.around[v].touch(if is_end { 1 } else { 2 });
        }
        self.patches.finish(open_edge);
        Ok(())
    }

    /// Which stream says whether a face is in a patch.
    #[inline]
    fn face_stream(&self, corner: u32, is_seed: bool) -> usize {
        let tip = self.around[self.vertex(corner) as usize];
        let is_beside_patch = !is_seed && self.state_across(corner) == Face::InPatch as usize;
        let live = tip.live.saturating_sub(3).min(4) as usize;
        stream::IN_PATCH + (live * 2 + usize::from(tip.touched > 0)) * 2 + usize::from(is_beside_patch)
    }

    /// Which stream says whether a patch grows over the face of `beyond`.
    #[inline]
    fn growth_stream(&self, beyond: u32) -> usize {
        let (_, faces) = self.patches.unfinished();
        let far = self.around[self.vertex(beyond) as usize];
        let live = far.live.saturating_sub(4).min(2) as usize;
        stream::GROW + (faces.len().min(4) - 1) * 6 + live * 2 + usize::from(far.touched > 0)
    }

    fn state_across(&self, corner: u32) -> usize {
        match self.across(corner) {
            NO_CORNER => 3,
            o => self.faces[(o / 3) as usize] as usize,
        }
    }

    #[inline(always)]
    fn face_contexts(
        &self,
        corner: u32,
        is_seed: bool,
        ends: [&Around; 3],
        [first, second]: [Fit; 2],
    ) -> ([usize; 6], usize) {
        let source = if is_seed { 2 } else { self.state_across(corner).saturating_sub(1).min(1) };
        let around = self.state_across(next(corner)) * 4 + self.state_across(prev(corner));
        let urgency = ends.map(Around::urgency);
        let touched = ends.iter().fold(0, |t, e| t * 3 + usize::from(e.touched.min(2)));
        let live = ends.iter().fold(0, |t, e| t * 8 + bucket(e.live.into(), 3));
        let coarse = ends.iter().fold(0, |t, e| t * 8 + bucket(e.valence, 3));

        let [a, b, tip] = ends.map(|v| v.cell);
        let gate = a.squared_distance(b);
        let angle = Angle::new(tip, a, b);
        let shape = share(gate * 2.0, angle.squares[1] + angle.squares[0], 8);
        let beyond = self.across(corner);
        let (fold, angle_beyond) = if beyond == NO_CORNER {
            (7, 4)
        } else {
            let outside = self.at(beyond).cell;
            let cosine = Angle::new(outside, a, b).cosine();
            (share(outside.squared_distance(tip), gate * 3.0, 8), steps(cosine, 8))
        };
        let prospects = first as usize * FITS + second as usize;
        let contexts = [
            (prospects * 4 + urgency[2]) * 3 + source,
            prospects * 8 + live % 8,
            touched * 512 + live,
            coarse * 3 + source,
            (shape * 8 + fold) * 12 + urgency[2] * 3 + source,
            (steps(angle.cosine(), 16) * 8 + angle_beyond) * 16 + around,
        ];
        (contexts, urgency[0].max(urgency[1]).max(urgency[2]) * 2 + usize::from(source == 1))
    }

    #[inline(always)]
    fn growth_contexts(&self, inside: u32, beyond: u32, fit: Fit, after: Fit) -> ([usize; 6], usize) {
        let (_, faces) = self.patches.unfinished();
        let size = faces.len().min(MAX_SIZE) - 1;
        let corners = [next(inside), prev(inside), inside, beyond].map(|c| self.at(c));
        let [va, vb, vt, vf] = corners.map(|v| u32::from(v.live));
        let pair = |x: u32, y: u32| bucket(x, 2) * 8 + bucket(y, 2);
        let urgency = corners[3].urgency();
        let state = (size * FITS + self.fit as usize) * FITS + fit as usize;
        let outlook = state * FITS + after as usize;

        let [a, b, tip, far] = corners.map(|v| v.cell);
        let length = a.squared_distance(b);
        let flipped = tip.squared_distance(far);
        let (near_cosine, far_cosine) = (Angle::new(tip, a, b).cosine(), Angle::new(far, a, b).cosine());
        let contexts = [
            outlook * 4 + urgency,
            outlook * 8 + bucket(vf, 3),
            (state * 64 + pair(va.min(vb), va.max(vb))) * 4 + urgency,
            (state * 64 + pair(vt, vf)) * 4 + urgency,
            (state * 8 + steps(near_cosine, 4) + steps(far_cosine, 4)) * 8 + share(length, flipped, 8),
            (size * 32 + steps(0.5 * (near_cosine + far_cosine), 32)) * 16 + share(flipped, 3.0 * length, 16),
        ];
        (contexts, state * 2 + usize::from(urgency > 0))
    }
}

/// Whether one of the corners faces the boundary. Looks at all of them, as that is done side by side.
fn has_boundary(opposite: &[u32]) -> bool {
    opposite.iter().fold(false, |found, &o| found | (o == NO_CORNER))
}

/// `value − first` clamped to 0..8.
#[inline(always)]
fn bucket(value: u32, first: u32) -> usize {
    value.saturating_sub(first).min(7) as usize
}

/// x / (x + y) in `levels` equal steps; the middle if both vanish.
#[inline(always)]
fn share(x: f32, y: f32, levels: usize) -> usize {
    let sum = x + y;
    if sum > 0.0 { index_below(x / sum * levels as f32, levels) } else { levels / 2 }
}

/// The angle at a tip over the edge a–b.
struct Angle {
    /// Of the lengths of its sides.
    squares: [f32; 2],
    product: f32,
}

impl Angle {
    #[inline(always)]
    fn new(tip: Cell, a: Cell, b: Cell) -> Self {
        let (u, v) = (tip.to(a), tip.to(b));
        Self { squares: [u.dot3(u), v.dot3(v)], product: u.dot3(v) }
    }

    /// 0 if a side vanishes.
    #[inline(always)]
    fn cosine(&self) -> f32 {
        let length = (self.squares[0] * self.squares[1]).sqrt();
        if length > 0.0 { self.product / length } else { 0.0 }
    }
}

/// A cosine in `count` equal steps, the sharpest angle first.
#[inline(always)]
fn steps(cosine: f32, count: usize) -> usize {
    index_below((1.0 - cosine) * (0.5 * count as f32), count)
}
