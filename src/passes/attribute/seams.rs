//! Where seams run at a vertex.

use super::entries::Entries;
use super::star::Fan;
use super::truth::Target;
use crate::entropy::context_mixer::PlainBits;
use crate::entropy::range_coder::BitCoder;
use crate::mesh::NO_ENTRY;
use crate::mesh::surface::{next, prev};
use crate::passes::GridMesh;

/// What is known of a seam at the far end of a spoke.
const RUNS: usize = 1;
const UNKNOWN: usize = 2;

#[derive(Clone)]
pub(super) struct SeamModels {
    has_seam: PlainBits,
    seam: PlainBits,
}

impl SeamModels {
    pub(super) fn new() -> Self {
        Self { has_seam: PlainBits::new(8), seam: PlainBits::new(9) }
    }

    /// Before which of the corners at a vertex a seam runs.
    pub(super) fn code<B: BitCoder>(
        &mut self,
        coder: &mut B,
        target: Target,
        entries: &Entries,
        fan: Fan,
        found: &mut Vec<bool>,
    ) {
        let n = fan.corners.len();
        let first = usize::from(!fan.closed);
        let at_end = |i: usize| fan.at_end(i, target.mesh, entries);
        let is_seam = |i: usize| target.tells_apart(fan.corners[i], fan.before(i));
        found.clear();
        found.resize(n, false);
        let ends = (first..n).filter(|&i| at_end(i) == RUNS).count().min(3);
        if coder.is_guessing() {
            // A seam that comes goes on.
            (first..n).for_each(|i| found[i] = ends > 1 && at_end(i) == RUNS);
            return;
        }
        let any = (first..n).any(is_seam);
        if !self.has_seam.code(coder, ends * 2 + usize::from(fan.closed), any) {
            return;
        }
        let mut count = 0;
        for (i, found) in found.iter_mut().enumerate().skip(first) {
            let context = at_end(i) * 3 + count.min(2);
            *found = self.seam.code(coder, context, is_seam(i));
            count += usize::from(*found);
        }
    }
}

impl Fan<'_> {
    /// The corner before corner `i`.
    fn before(&self, i: usize) -> u32 {
        let n = self.corners.len();
        self.corners[(i + n - 1) % n]
    }

    /// Whether a seam runs at the far end of the spoke before corner `i`, if that is known.
    fn at_end(&self, i: usize, mesh: &GridMesh, entries: &Entries) -> usize {
        let corner = self.corners[i];
        if mesh.surface.vertex(next(corner)) >= self.vertex {
            return UNKNOWN;
        }
        let [left, right] = [prev(self.before(i)), next(corner)].map(|c| entries.of[c as usize]);
        if (left == NO_ENTRY) != (right == NO_ENTRY) { UNKNOWN } else { usize::from(left != right) }
    }
}
