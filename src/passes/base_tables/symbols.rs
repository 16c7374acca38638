//! The alphabets of a base mesh in tables, and the contexts of their symbols.

use crate::entropy::ans::models::Group;
use crate::entropy::ans::token::NUM_TOKENS;

/// What lies beyond a gate.
pub(super) const TIPS: usize = 0;
/// How far along the boundary a vertex is that lies there.
pub(super) const STEPS: usize = 1;
/// Coordinates of the first vertex of a component.
pub(super) const JUMPS: usize = 2;
/// Residuals of all others.
pub(super) const RESIDUALS: usize = 3;

/// Steps along the boundary in each direction that have symbols.
pub(super) const MAX_STEPS: usize = 16;
/// The symbol of a vertex that is none of these.
pub(super) const BEYOND: u8 = 2 * MAX_STEPS as u8;

pub(super) const GROUPS: &[Group] = &[
    Group { alphabet: 5, attributes: TipContext::SIZES, most_tables: 48 },
    Group { alphabet: BEYOND as usize + 1, attributes: &[1], most_tables: 1 },
    Group { alphabet: NUM_TOKENS, attributes: &[1], most_tables: 1 },
    Group { alphabet: NUM_TOKENS, attributes: ResidualContext::SIZES, most_tables: 48 },
];

/// What is known of a gate.
pub(super) struct TipContext {
    /// Triangles so far at the pivot, the gate's other end and their neighbours along the boundary.
    pub(super) pivot: usize,
    pub(super) end: usize,
    pub(super) before: usize,
    pub(super) after: usize,
    /// What lay beyond the gate before.
    pub(super) last: usize,
    /// Whether pivot and end lie at the boundary of the mesh.
    pub(super) bounds: usize,
}

impl TipContext {
    /// What is mostly the same comes first: contexts that are met are side by side then.
    const SIZES: &[usize] = &[4, 10, 5, 8, 8, 4];

    pub(super) fn index(&self) -> usize {
        let Self { pivot, end, before, after, last, bounds } = *self;
        let index = (bounds * 10 + pivot.min(9)) * 5 + end.min(4);
        let index = (index * 8 + before.min(7)) * 8 + after.min(7);
        index * 4 + last
    }
}

/// Expected sizes of residuals, fractions of centres and classes that residuals' contexts tell apart.
pub(super) const LEVELS: usize = 40;
pub(super) const FRACTIONS: usize = 4;
pub(super) const CLASSES: usize = 7;
/// Places of the coordinate that may repeat, and numbers of neighbours with it.
pub(super) const REPEATS: usize = 10;
pub(super) const COUNTS: usize = 3;

/// What is known of a residual.
#[derive(Clone, Copy, Default)]
pub(super) struct ResidualContext {
    pub(super) kind: usize,
    pub(super) level: usize,
    pub(super) fraction: usize,
    pub(super) class: usize,
    pub(super) repeated: usize,
    pub(super) count: usize,
}

impl ResidualContext {
    const SIZES: &[usize] = &[REPEATS, COUNTS, 3, LEVELS, FRACTIONS, CLASSES];
    /// The attributes that take a search through the neighbours.
    pub(super) const OF_REPEATED: [usize; 2] = [0, 1];

    #[inline(always)]
    pub(super) fn index(&self) -> usize {
        let Self { kind, level, fraction, class, repeated, count } = *self;
        let index = (repeated * COUNTS + count) * 3 + kind;
        ((index * LEVELS + level) * FRACTIONS + fraction) * CLASSES + class
    }
}
