//! A pass as bytes.

use crate::bitstream::compensation::Compensation;
use crate::bitstream::header::Pass;

/// Row and payload of a pass, and the glue behind it.
pub(super) struct WrittenPass {
    pub(super) row: Pass,
    pub(super) payload: Vec<u8>,
    pub(super) glue: Option<Vec<u8>>,
    pub(super) compensation: Compensation,
}

impl WrittenPass {
    /// Makes the payload longer; returns by how much.
    pub(super) fn append_zeros(&mut self, count: u64) -> u64 {
        self.payload.resize(self.payload.len() + count as usize, 0);
        self.row.bytes = self.payload.len() as u32;
        count
    }
}
