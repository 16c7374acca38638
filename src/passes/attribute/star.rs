//! The corners at a vertex, and the patch that its star replaced.

use crate::passes::patch::Patches;

/// The corners at a vertex, counter-clockwise.
#[derive(Clone, Copy)]
pub(super) struct Fan<'a> {
    pub(super) vertex: u32,
    pub(super) corners: &'a [u32],
    pub(super) closed: bool,
}

/// The star of a vertex, and the patch that it replaced.
#[derive(Clone, Copy)]
pub(super) struct Star<'a> {
    pub(super) patches: &'a Patches,
    pub(super) patch: usize,
    pub(super) vertex: u32,
}

impl<'a> Star<'a> {
    pub(super) fn is_ear(self) -> bool {
        self.patches.faces(self.patch).is_empty()
    }

    /// The corners of the coarse mesh that face the edges at which the star has its `num_faces` triangles.
    pub(super) fn polygon(self, num_faces: usize) -> impl Iterator<Item = u32> + 'a {
        let edges = self.patches.edges(self.patch);
        let first = self.patches.first_edge(self.patch);
        (0..num_faces).map(move |i| edges[(first + i) % edges.len()])
    }
}
