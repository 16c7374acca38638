//! Ctrl-C while the library works.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

/// How often Python may look for signals.
const INTERVAL: Duration = Duration::from_millis(100);

/// Whether the result is still wanted.
pub struct GoOn(Arc<AtomicBool>);

/// What unwinds the stack of work that nobody waits for.
struct Stopped;

impl GoOn {
    /// Returns if the work is to go on. Otherwise it ends here, as by a panic, but without a message.
    pub fn check(&self) {
        if !self.0.load(Ordering::Relaxed) {
            resume_unwind(Box::new(Stopped));
        }
    }
}

/// Does `work` in a separate thread while this one runs Python's signal handlers. If one raises, as that of
/// Ctrl-C does, the work is given up: its thread ends when it next calls [`GoOn::check`].
///
/// # Errors
/// What the handler raises.
pub fn interruptible<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(GoOn) -> T + Send + 'static,
) -> PyResult<T> {
    let is_wanted = Arc::new(AtomicBool::new(true));
    let go_on = GoOn(Arc::clone(&is_wanted));
    let (sender, mut receiver) = channel();
    // Nobody may be left to receive.
    let worker = thread::Builder::new().spawn(move || sender.send(work(go_on)).unwrap_or(()));
    let worker = worker.map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
    loop {
        let answer;
        (receiver, answer) = py.detach(move || {
            let answer = receiver.recv_timeout(INTERVAL);
            (receiver, answer)
        });
        match answer {
            Ok(found) => return Ok(found),
            Err(RecvTimeoutError::Timeout) => {}
            // A panic is a mistake in the library: it goes on as one.
            Err(RecvTimeoutError::Disconnected) => match worker.join() {
                Err(panic) => resume_unwind(panic),
                Ok(()) => return Err(PyRuntimeError::new_err("the work ended without a result")),
            },
        }
        if let Err(raised) = py.check_signals() {
            is_wanted.store(false, Ordering::Relaxed);
            return Err(raised);
        }
    }
}
