//! Signals that end the program: nothing half-written is left behind.

/// Ends the program at SIGINT or SIGTERM, by a thread that waits for one, with the number that shells expect.
///
/// # Errors
/// If there can be no such thread.
#[cfg(unix)]
pub fn watch() -> anyhow::Result<()> {
    use signal_hook::consts::{SIGINT, SIGTERM, SIGXFSZ};
    use std::sync::{Arc, atomic::AtomicBool};
    // Past the largest size of a file (`ulimit -f`) writing fails then, and the error is told.
    signal_hook::flag::register(SIGXFSZ, Arc::new(AtomicBool::new(false)))?;
    let mut signals = signal_hook::iterator::Signals::new([SIGINT, SIGTERM])?;
    let wait = move || {
        if let Some(signal) = signals.forever().next() {
            lwc::io::abandon_writes(|| std::process::exit(128 + signal));
        }
    };
    std::thread::Builder::new().name("signals".into()).spawn(wait)?;
    Ok(())
}

/// Elsewhere the system ends the program.
///
/// # Errors
/// None.
#[cfg(not(unix))]
pub fn watch() -> anyhow::Result<()> {
    Ok(())
}
