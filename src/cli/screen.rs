//! Standard error, where a bar may stand below what is written.

use indicatif::ProgressBar;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Knows the bar that is there now.
#[derive(Clone, Debug, Default)]
pub struct Screen(Arc<Mutex<Option<ProgressBar>>>);

impl Screen {
    fn bar(&self) -> MutexGuard<'_, Option<ProgressBar>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// From now on this bar is there.
    pub fn show(&self, bar: &ProgressBar) {
        *self.bar() = Some(bar.clone());
    }

    /// No bar is there any more.
    pub fn clear(&self) {
        *self.bar() = None;
    }

    /// Takes the bar away while `write` writes.
    pub fn beside<T>(&self, write: impl FnOnce() -> T) -> T {
        match &*self.bar() {
            Some(bar) => bar.suspend(write),
            None => write(),
        }
    }
}
