//! What chunks cost a decoder, from counts alone (`format/SPEC.md`, section 10): encoders make sure that
//! their bytes earn it, decoders refuse streams that do not.
//!
//! A unit is one edge or triangle looked at. Each number is a bound on what a
//! [`WorkBudget`](super::work_budget::WorkBudget) counts.

use crate::bitstream::header::{Action, Pass};

/// Units that any stream may take.
const FREE: u64 = 1 << 18;
/// Units that a byte earns.
const PER_BYTE: u64 = 128;

/// Units of a base mesh for each face: gates of the growth, edges at its vertices.
const BASE_PER_TRIANGLE: u64 = 10;
/// Units of a refinement for each face: edges at its vertices.
const REFINE_PER_TRIANGLE: u64 = 6;
/// Units of a split for each face before: its gates in the walk.
const WALK_PER_TRIANGLE: u64 = 5;
/// Units of a split for each face after: stars are made, and looked at.
const STARS_PER_TRIANGLE: u64 = 2;
/// Units of a split for each vertex it adds: its position is predicted and decoded, which takes longer than a
/// look.
const PLACE_PER_VERTEX: u64 = 12;
/// Units of a stitching chunk for each vertex there is: all are sorted by their cells.
const STITCHING_PER_VERTEX: u64 = 4;
/// Units of each exact position, of each element with exact values and of each of their components.
const EXACT_PER_VERTEX: u64 = 12;
const VALUES_PER_ELEMENT: u64 = 4;
const VALUES_PER_COMPONENT: u64 = 4;
/// Units of the place of each vertex and each triangle in the file.
const ORDER_PER_ELEMENT: u64 = 12;
/// Units of an isolated vertex or a degenerate face, and of what other chunks say about it.
const LOOSE_EACH: u64 = 4 + EXACT_PER_VERTEX + ORDER_PER_ELEMENT;

/// Units that a stream may take by the end of this many bytes.
pub(crate) fn earned(bytes: u64) -> u64 {
    FREE + PER_BYTE * bytes
}

/// Elements of the mesh before a pass or after it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Counts {
    pub(crate) vertices: u64,
    pub(crate) triangles: u64,
}

impl Counts {
    /// After a pass.
    pub(crate) fn after(self, pass: &Pass) -> Self {
        let (vertices, triangles) = (u64::from(pass.vertices), u64::from(pass.triangles));
        Self { vertices: self.vertices + vertices, triangles: self.triangles + triangles }
    }
}

/// Units of a pass that begins with a mesh of `before`. `channels`: of all attributes whose values follow.
pub(crate) fn pass(row: &Pass, before: Counts, channels: u64) -> u64 {
    let after = before.after(row);
    let new = u64::from(row.vertices);
    match row.action {
        Action::Base { .. } => (BASE_PER_TRIANGLE + channels * REFINE_PER_TRIANGLE) * after.triangles,
        Action::Refine => REFINE_PER_TRIANGLE * after.triangles,
        Action::Split => {
            let stars = (STARS_PER_TRIANGLE + channels) * (after.triangles + new);
            WALK_PER_TRIANGLE * before.triangles + stars + PLACE_PER_VERTEX * new
        }
    }
}

/// Units of the stitching after a pass.
pub(crate) fn stitching(after: Counts) -> u64 {
    STITCHING_PER_VERTEX * after.vertices
}

/// Units of exact positions.
pub(crate) fn exact(finest: Counts) -> u64 {
    EXACT_PER_VERTEX * finest.vertices
}

/// Units of the exact values of an attribute for this many elements.
pub(crate) fn values(elements: u64, components: u64) -> u64 {
    (VALUES_PER_ELEMENT + VALUES_PER_COMPONENT * components) * elements
}

/// Units of the order of the file.
pub(crate) fn order(finest: Counts) -> u64 {
    ORDER_PER_ELEMENT * (finest.vertices + finest.triangles)
}

/// Units of this many isolated vertices and degenerate triangles.
pub(crate) fn loose(count: u64) -> u64 {
    LOOSE_EACH * count
}

/// What the chunks so far cost, and what their payloads earned.
#[cfg(any(feature = "encoder", test))]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Ledger {
    pub(crate) cost: u64,
    pub(crate) bytes: u64,
}

#[cfg(any(feature = "encoder", test))]
impl Ledger {
    /// Bytes that are missing until all is earned.
    pub(crate) fn missing(&self) -> u64 {
        self.cost.saturating_sub(earned(self.bytes)).div_ceil(PER_BYTE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_split_costs_the_whole_mesh_and_what_it_brings() {
        let grid = Counts { vertices: 40_401, triangles: 80_000 };
        let ear = Pass { action: Action::Split, vertices: 1, triangles: 1, bytes: 12 };
        assert_eq!(pass(&ear, grid, 0), 5 * 80_000 + 2 * 80_002 + 12);
        let base =
            Pass { action: Action::Base { quantization_bits: 9 }, vertices: 4, triangles: 4, bytes: 9 };
        assert_eq!(pass(&base, Counts::default(), 2), (10 + 2 * 6) * 4);
    }

    #[test]
    fn what_is_missing_is_missing_to_the_byte() {
        let ledger = |cost, bytes| Ledger { cost, bytes }.missing();
        assert_eq!(ledger(FREE, 0), 0);
        assert_eq!(ledger(FREE + 1, 0), 1);
        assert_eq!(ledger(FREE + 10 * PER_BYTE, 4), 6);
        assert_eq!(ledger(FREE + 10 * PER_BYTE, 40), 0);
    }
}
