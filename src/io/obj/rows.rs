//! Rows of elements in their order.

use crate::mesh::NO_ENTRY;

/// What is not set has none.
#[derive(Default)]
pub(super) struct Rows(pub Vec<u32>);

impl Rows {
    /// Elements are set in order, each at most once. Those from `element` on are forgotten.
    pub fn set(&mut self, element: usize, row: u32) {
        self.0.resize(element, NO_ENTRY);
        self.0.push(row);
    }

    pub fn get(&self, element: usize) -> u32 {
        self.0.get(element).copied().unwrap_or(NO_ENTRY)
    }
}
