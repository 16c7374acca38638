//! What an encoder wants the rows to become.

use super::rows::Rows;
use crate::mesh::NO_ENTRY;
use crate::passes::GridMesh;

/// What an encoder wants a layer to become: rows of its own numbering.
#[derive(Clone, Copy)]
pub(crate) struct Truth<'a> {
    /// The row of each element of the mesh after the pass; only those that the pass brings are read.
    pub(crate) of: &'a [u32],
    /// All rows, channel by channel.
    pub(crate) rows: &'a [i32],
}

/// The row that is coded.
#[derive(Clone, Copy)]
pub(super) enum Wanted<'a> {
    /// A decoder will find out.
    Unknown,
    Missing,
    Row(&'a [i32]),
}

impl Wanted<'_> {
    pub(super) fn is(&self, rows: &Rows, row: u32) -> bool {
        match self {
            Wanted::Unknown => false,
            Wanted::Missing => row == NO_ENTRY,
            Wanted::Row(wanted) => row != NO_ENTRY && rows.get(row) == *wanted,
        }
    }
}

/// The mesh after a pass, and, for an encoder, the rows of its elements.
#[derive(Clone, Copy)]
pub(super) struct Target<'a> {
    pub(super) mesh: &'a GridMesh,
    pub(super) truth: Option<Truth<'a>>,
}

impl<'a> Target<'a> {
    /// The row of an element.
    pub(super) fn wanted(&self, element: u32, rows: &Rows) -> Wanted<'a> {
        let Some(Truth { of, rows: channels }) = self.truth else { return Wanted::Unknown };
        match of[element as usize] {
            NO_ENTRY => Wanted::Missing,
            row => Wanted::Row(&channels[row as usize * rows.num_channels..][..rows.num_channels]),
        }
    }

    /// Whether nothing speaks against this row of an element: the truth, or that there is none.
    pub(super) fn allows(&self, element: u32, rows: &Rows, row: u32) -> bool {
        self.truth.is_none() || self.wanted(element, rows).is(rows, row)
    }

    /// Whether two elements have different rows.
    pub(super) fn tells_apart(&self, a: u32, b: u32) -> bool {
        self.truth.is_some_and(|truth| truth.of[a as usize] != truth.of[b as usize])
    }
}
