//! What is known before each decision: contexts of the models, and the streams of the profile fast.

use super::models::MAX_SIZE;
use super::polygon::{FITS, Fit};
use super::regions::{Around, Face, Regions};
use crate::entropy::streams::stream;
use crate::entropy::tables::index_below;
use crate::mesh::surface::{NO_CORNER, next, prev};
use crate::util::simd4::Cell;

impl Regions<'_> {
    /// Which stream says whether a face is in a patch.
    #[inline]
    pub(super) fn face_stream(&self, corner: u32, is_seed: bool) -> usize {
        let tip = self.around[self.vertex(corner) as usize];
        let is_beside_patch = !is_seed && self.state_across(corner) == Face::InPatch as usize;
        let live = tip.live.saturating_sub(3).min(4) as usize;
        stream::IN_PATCH + (live * 2 + usize::from(tip.touched > 0)) * 2 + usize::from(is_beside_patch)
    }

    /// Which stream says whether a patch grows over the face of `beyond`.
    #[inline]
    pub(super) fn growth_stream(&self, beyond: u32) -> usize {
        let (_, faces) = self.patches.unfinished();
        let far = self.around[self.vertex(beyond) as usize];
        let live = far.live.saturating_sub(4).min(2) as usize;
        stream::GROW + (faces.len().min(4) - 1) * 6 + live * 2 + usize::from(far.touched > 0)
    }

    /// Of whether the face of `corner` is in a patch: contexts, and the set of weights.
    #[inline(always)]
    pub(super) fn face_contexts(
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

    /// Of whether the patch grows over the edge that `inside` faces: contexts, and the set of weights. `fits`: whether it
    /// fits the rule now, would then, and would over the edge after.
    #[inline(always)]
    pub(super) fn growth_contexts(&self, inside: u32, beyond: u32, fits: [Fit; 3]) -> ([usize; 6], usize) {
        let (_, faces) = self.patches.unfinished();
        let size = faces.len().min(MAX_SIZE) - 1;
        let corners = [next(inside), prev(inside), inside, beyond].map(|c| self.at(c));
        let [va, vb, vt, vf] = corners.map(|v| u32::from(v.live));
        let pair = |x: u32, y: u32| bucket(x, 2) * 8 + bucket(y, 2);
        let urgency = corners[3].urgency();
        let [now, grown, after] = fits.map(|fit| fit as usize);
        let state = (size * FITS + now) * FITS + grown;
        let outlook = state * FITS + after;

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
