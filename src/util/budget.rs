//! Memory for what payloads hold.

/// Memory that is counted before it is allocated. A reader stops at the first `None`; whoever called it asks
/// [`exceeded`](Self::exceeded) whether the limit was the reason.
pub(crate) struct Budget {
    taken: u64,
    allowed: u64,
    needed: Option<u64>,
}

impl Budget {
    /// `held`: bytes that are taken already.
    pub(crate) fn new(held: u64, allowed: u64) -> Self {
        Self { taken: held, allowed, needed: None }
    }

    /// Counts `count` elements of `size` bytes; `None`, for ever, if they are too many.
    pub(crate) fn take(&mut self, count: usize, size: usize) -> Option<()> {
        let needed = self.taken.saturating_add((count as u64).saturating_mul(size as u64));
        if self.needed.is_some() || needed > self.allowed {
            self.needed.get_or_insert(needed);
            return None;
        }
        self.taken = needed;
        Some(())
    }

    /// Bytes taken so far, those from before included.
    pub(crate) fn taken(&self) -> u64 {
        self.taken
    }

    /// What was needed, if that was too much.
    pub(crate) fn exceeded(&self) -> Option<u64> {
        self.needed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_budget_that_is_used_up_stays_so() {
        let mut budget = Budget::new(10, 100);
        assert_eq!(budget.take(9, 10), Some(()));
        assert_eq!((budget.taken(), budget.exceeded()), (100, None));
        assert_eq!(budget.take(1, 10), None);
        assert_eq!(budget.take(0, 1), None);
        assert_eq!(budget.exceeded(), Some(110));
        let mut budget = Budget::new(u64::MAX - 10, u64::MAX - 1);
        assert_eq!(budget.take(usize::MAX, usize::MAX), None);
        assert_eq!(budget.exceeded(), Some(u64::MAX));
    }
}
