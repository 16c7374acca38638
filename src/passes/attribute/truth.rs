//! What an encoder wants the entries to become.

use super::entries::Entries;
use crate::mesh::NO_ENTRY;
use crate::passes::GridMesh;

/// What an encoder wants a layer to become: entries of its own numbering.
#[derive(Clone, Copy)]
pub(crate) struct Truth<'a> {
    /// The entry of each element of the mesh after the pass; only those that the pass brings are read.
    pub(crate) of: &'a [u32],
    /// All entries, channel by channel.
    pub(crate) entries: &'a [i32],
}

/// The entry that is coded.
#[derive(Clone, Copy)]
pub(super) enum Wanted<'a> {
    /// A decoder will find out.
    Unknown,
    Missing,
    Entry(&'a [i32]),
}

impl Wanted<'_> {
    pub(super) fn is(&self, entries: &Entries, entry: u32) -> bool {
        match self {
            Wanted::Unknown => false,
            Wanted::Missing => entry == NO_ENTRY,
            Wanted::Entry(wanted) => entry != NO_ENTRY && entries.get(entry) == *wanted,
        }
    }
}

/// The mesh after a pass, and, for an encoder, the entries of its elements.
#[derive(Clone, Copy)]
pub(super) struct Target<'a> {
    pub(super) mesh: &'a GridMesh,
    pub(super) truth: Option<Truth<'a>>,
}

impl<'a> Target<'a> {
    /// The entry of an element.
    pub(super) fn wanted(&self, element: u32, entries: &Entries) -> Wanted<'a> {
        let Some(Truth { of, entries: channels }) = self.truth else { return Wanted::Unknown };
        match of[element as usize] {
            NO_ENTRY => Wanted::Missing,
            entry => {
                Wanted::Entry(&channels[entry as usize * entries.num_channels..][..entries.num_channels])
            }
        }
    }

    /// Whether an element may have this entry: it is the true one, or there is no truth.
    pub(super) fn allows(&self, element: u32, entries: &Entries, entry: u32) -> bool {
        self.truth.is_none() || self.wanted(element, entries).is(entries, entry)
    }

    /// Whether two elements have different entries.
    pub(super) fn tells_apart(&self, a: u32, b: u32) -> bool {
        self.truth.is_some_and(|truth| truth.of[a as usize] != truth.of[b as usize])
    }
}
