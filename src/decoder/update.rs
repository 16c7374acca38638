//! What a call of the decoder came to.

use super::stream_info::PassInfo;
use std::ops::Range;

/// What one finished pass changed.
///
/// Vertices and triangles keep their indices for ever: new ones are appended, triangles of a split
/// are rewritten in place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Update {
    /// The pass, and counts, level and precision after it.
    pub pass: PassInfo,
    /// Vertices with a new or different position.
    pub vertices: Range<u32>,
    /// Triangles that are new.
    pub new_triangles: Range<u32>,
    /// Older triangles with different vertices: ascending, disjoint ranges.
    pub rewritten_triangles: Vec<Range<u32>>,
}

/// What [`Decoder::step_within`](crate::Decoder::step_within) came to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Step {
    /// A pass is finished: the mesh has changed.
    Finished(Update),
    /// The work is used up before the pass is finished: the mesh is still that of the pass before.
    Unfinished,
    /// Bytes are missing, or nothing is left to do.
    Waiting,
}
