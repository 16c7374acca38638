//! How much of a pass is done before the caller has its turn again.
//!
//! Counted, not timed: there is no clock on every platform, and a count is the same on all.

/// Units of work: an edge or a triangle looked at, each a fraction of a microsecond.
pub(crate) struct Work {
    left: i64,
}

/// Elements of an array that is gone through at one go, per unit.
pub(crate) const SWEPT_PER_UNIT: usize = 64;

impl Work {
    /// More than any pass needs.
    pub(crate) fn unlimited() -> Self {
        Self { left: i64::MAX }
    }

    /// Takes the units of what is done next; false, and nothing is taken, if none are left.
    #[inline]
    pub(crate) fn take(&mut self, units: usize) -> bool {
        let is_left = self.left > 0;
        if is_left {
            self.left -= units as i64;
        }
        is_left
    }
}
