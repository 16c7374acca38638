//! How many points are measured.

use std::sync::{Mutex, PoisonError};

/// Counts points on any thread, and tells which share of all they are.
pub(super) struct Count<'a> {
    progress: &'a (dyn Fn(f64) + Sync),
    total: usize,
    /// Held while `progress` is told, so that it never hears less than before.
    done: Mutex<usize>,
}

impl<'a> Count<'a> {
    /// `total`: at most so many points will come.
    pub fn new(total: usize, progress: &'a (dyn Fn(f64) + Sync)) -> Self {
        Self { progress, total, done: Mutex::new(0) }
    }

    /// So many more are done.
    pub fn add(&self, points: usize) {
        let mut done = self.done.lock().unwrap_or_else(PoisonError::into_inner);
        *done = done.saturating_add(points).min(self.total);
        (self.progress)(*done as f64 / self.total.max(1) as f64);
    }

    /// All that will come have come.
    pub fn finish(self) {
        self.add(self.total);
    }
}
