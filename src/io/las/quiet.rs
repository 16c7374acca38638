//! Panics of a crate that was not written for hostile bytes, as errors.

use std::{
    cell::Cell,
    panic::{self, AssertUnwindSafe},
    sync::Once,
};

thread_local! {
    /// Whether a panic of this thread is expected, so that it is not reported.
    static IS_QUIET: Cell<bool> = const { Cell::new(false) };
}

/// Calls `work`; if it panics, that is an error like others, without a message on standard error.
///
/// # Errors
/// Those of `work`, and its panic.
pub(super) fn without_panic<T>(work: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    silence();
    let was_quiet = IS_QUIET.replace(true);
    let found = panic::catch_unwind(AssertUnwindSafe(work));
    IS_QUIET.set(was_quiet);
    found.unwrap_or_else(|payload| Err(format!("the decoder gave up: {}", message(&*payload))))
}

/// Puts a hook in front of the one that prints panics: the hook is one for all threads, which panic of their own.
fn silence() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let print = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if !IS_QUIET.get() {
                print(info);
            }
        }));
    });
}

fn message(payload: &(dyn std::any::Any + Send)) -> &str {
    let text = payload.downcast_ref::<String>().map(String::as_str);
    text.or(payload.downcast_ref::<&str>().copied()).unwrap_or("it does not say why")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panics_are_errors() {
        assert_eq!(without_panic(|| Ok(3)), Ok(3));
        assert_eq!(without_panic::<()>(|| Err("no".to_owned())), Err("no".to_owned()));
        let number = 7;
        assert_eq!(
            without_panic::<()>(|| panic!("at {number}")),
            Err("the decoder gave up: at 7".to_owned())
        );
        assert!(!IS_QUIET.get());
    }
}
