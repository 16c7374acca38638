//! How much of a known number of things is done.

use std::sync::{Mutex, PoisonError};

/// Counts what is done on any thread, and tells which share of all that is.
pub(crate) struct Count<'a> {
    progress: &'a (dyn Fn(f64) + Sync),
    total: usize,
    /// Held while `progress` is told, so that it never hears less than before.
    done: Mutex<usize>,
}

impl<'a> Count<'a> {
    /// `total`: at most so many things will be done.
    pub(crate) fn new(total: usize, progress: &'a (dyn Fn(f64) + Sync)) -> Self {
        Self { progress, total, done: Mutex::new(0) }
    }

    /// So many more are done.
    pub(crate) fn add(&self, more: usize) {
        let mut done = self.done.lock().unwrap_or_else(PoisonError::into_inner);
        *done = done.saturating_add(more).min(self.total);
        (self.progress)(*done as f64 / self.total.max(1) as f64);
    }

    /// No more will be done.
    pub(crate) fn finish(self) {
        self.add(self.total);
    }
}
