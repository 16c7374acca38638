//! The order in which a decoder meets the patches of a level, known before there are any: the walk
//! of `format/SPEC.md`, section 7.2, over the surface with its odd vertices. Holes are closed in the
//! reverse order, so that a decoder finds around each patch the valences that chose its triangles.

use super::SurfaceEditor;
use crate::mesh::Surface;
use crate::mesh::surface::{NO_CORNER, next, prev};
use bitvec::vec::BitVec;
use std::collections::VecDeque;

/// An edge of each component whose ends always stay: there the walks begin.
pub(crate) struct Anchors {
    edges: Vec<[u32; 2]>,
    fixed: BitVec,
    stitched: BitVec,
}

impl Anchors {
    /// Takes the first edge of the first triangle of each component. The stitched vertices `stitched` stay as
    /// well.
    pub(crate) fn new(surface: &Surface, stitched: BitVec) -> Self {
        let mut seen: BitVec = BitVec::repeat(false, surface.triangles.len());
        let mut fixed = stitched.clone();
        let mut edges = Vec::new();
        let mut stack = Vec::new();
        for face in 0..surface.triangles.len() {
            if seen[face] {
                continue;
            }
            let [a, b, _] = surface.triangles[face];
            edges.push([a, b]);
            fixed.set(a as usize, true);
            fixed.set(b as usize, true);
            seen.set(face, true);
            stack.push(face as u32);
            while let Some(f) = stack.pop() {
                for c in 3 * f..3 * f + 3 {
                    let o = surface.across(c);
                    if o != NO_CORNER && !seen[(o / 3) as usize] {
                        seen.set((o / 3) as usize, true);
                        stack.push(o / 3);
                    }
                }
            }
        }
        Self { edges, fixed, stitched }
    }

    /// True for vertices that no partition may take.
    pub(crate) fn is_stitched(&self, vertex: u32) -> bool {
        self.stitched[vertex as usize]
    }

    pub(crate) fn contain(&self, vertex: u32) -> bool {
        self.fixed[vertex as usize]
    }

    /// The corners that face the anchors, one for each that is there.
    pub(crate) fn corners<'a>(&'a self, surface: &'a Surface) -> impl Iterator<Item = u32> + 'a {
        self.edges.iter().filter_map(|&[a, b]| {
            let mut fan = Vec::new();
            let start = surface.corner_of[a as usize];
            if start == NO_CORNER {
                return None;
            }
            surface.fan(start, &mut fan);
            fan.into_iter().find(|&c| surface.vertex(next(c)) == b).map(prev)
        })
    }
}

/// The odd vertices in the order in which the walk meets them: of each the corner that faces the
/// gate. `faces` are the slots that hold one.
pub(crate) fn patch_order(
    shrinking: &SurfaceEditor,
    faces: &[u32],
    odd: &BitVec,
    anchors: &Anchors,
) -> Vec<u32> {
    let surface = &shrinking.surface;
    let mut walk = Walk {
        surface,
        odd,
        decided: BitVec::repeat(false, surface.triangles.len()),
        gates: VecDeque::new(),
        fan: Vec::new(),
        order: Vec::new(),
    };
    let rest = faces.iter().map(|f| 3 * f);
    for seed in anchors.corners(surface).chain(rest) {
        let face = (seed / 3) as usize;
        if walk.decided[face] {
            continue;
        }
        let corners = [seed, next(seed), prev(seed)];
        let seed = corners.into_iter().find(|&c| odd[surface.vertex(c) as usize]).unwrap_or(seed);
        walk.meet(seed, true);
        while let Some(gate) = walk.gates.pop_front() {
            let beyond = surface.across(gate);
            if beyond != NO_CORNER && !walk.decided[(beyond / 3) as usize] {
                walk.meet(beyond, false);
            }
        }
    }
    walk.order
}

struct Walk<'a> {
    surface: &'a Surface,
    odd: &'a BitVec,
    decided: BitVec,
    /// Corners that face edges to look across, from inside.
    gates: VecDeque<u32>,
    fan: Vec<u32>,
    order: Vec<u32>,
}

impl Walk<'_> {
    fn meet(&mut self, corner: u32, is_seed: bool) {
        if !self.odd[self.surface.vertex(corner) as usize] {
            self.decided.set((corner / 3) as usize, true);
            self.gates.extend([next(corner), prev(corner)]);
            if is_seed {
                self.gates.push_back(corner);
            }
            return;
        }
        self.order.push(corner);
        self.surface.fan(corner, &mut self.fan);
        let first = self.fan.iter().position(|&c| c == corner).unwrap_or(0);
        self.fan.rotate_left(first);
        for &c in &self.fan {
            self.decided.set((c / 3) as usize, true);
            self.gates.push_back(c);
        }
    }
}
