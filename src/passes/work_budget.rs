//! How much of a pass is done before the caller has its turn again.
//!
//! Counted, not timed: there is no clock on every platform, and a count is the same on all.

/// Units of work: an edge or a triangle looked at, each a fraction of a microsecond.
pub(crate) struct WorkBudget {
    limit: i64,
    /// Below zero if the last thing done was more than was left.
    left: i64,
}

/// Elements of an array that is gone through at one go, per unit.
pub(crate) const SWEPT_PER_UNIT: usize = 64;

impl WorkBudget {
    pub(crate) fn units(units: u32) -> Self {
        Self { limit: i64::from(units), left: i64::from(units) }
    }

    /// What is left of it, but no more than `units`.
    pub(crate) fn at_most(&self, units: u64) -> Self {
        let units = i64::try_from(units).unwrap_or(i64::MAX).min(self.left);
        Self { limit: units, left: units }
    }

    /// Takes the units of what has been done.
    pub(crate) fn spend(&mut self, units: u64) {
        self.left -= i64::try_from(units).unwrap_or(i64::MAX);
    }

    /// More than any pass needs.
    pub(crate) fn unlimited() -> Self {
        Self { limit: i64::MAX, left: i64::MAX }
    }

    #[inline]
    pub(crate) fn is_left(&self) -> bool {
        self.left > 0
    }

    /// Takes the units of what is done next; false, and nothing is taken, if none are left.
    #[inline]
    pub(crate) fn take(&mut self, units: usize) -> bool {
        let is_left = self.is_left();
        if is_left {
            self.left -= units as i64;
        }
        is_left
    }

    /// Takes the units of going through `elements` at one go.
    pub(crate) fn sweep(&mut self, elements: usize) {
        self.left -= (elements / SWEPT_PER_UNIT) as i64;
    }

    /// Units taken so far.
    pub(crate) fn done(&self) -> u64 {
        (self.limit - self.left) as u64
    }
}
