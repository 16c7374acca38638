//! Whether this thread computes as the format asks for: to nearest, with subnormal numbers (`format/SPEC.md`, section 2).
//!
//! A host may have set its processor otherwise: game engines and audio threads do, and libraries built with fast
//! arithmetic when they are loaded. Sound streams would look damaged then.

use std::hint::black_box;

/// # Errors
/// What is done otherwise: numbers are rounded another way, or subnormal ones become zero.
pub(crate) fn check() -> Result<(), &'static str> {
    // WebAssembly knows no other way.
    if cfg!(target_family = "wasm") {
        return Ok(());
    }
    departure().map_or(Ok(()), Err)
}

/// What is done otherwise. The numbers are hidden from the compiler, which would compute as it should be.
fn departure() -> Option<&'static str> {
    let rounds = |one: f32, half_step: f32| {
        // Ties to even: down and up, of either sign.
        one + half_step == one && (one + 3.0 * half_step) == one + 4.0 * half_step && -one - half_step == -one
    };
    if !rounds(black_box(1.0), black_box(f32::EPSILON / 2.0)) {
        return Some("numbers are not rounded to nearest");
    }
    let rounds = |one: f64, half_step: f64| one + half_step == one && -one - half_step == -one;
    if !rounds(black_box(1.0), black_box(f64::EPSILON / 2.0)) {
        return Some("numbers are not rounded to nearest");
    }
    // What comes out subnormal, and what goes in so.
    let halved = black_box(f32::MIN_POSITIVE) * black_box(0.5);
    let doubled = black_box(f32::from_bits(1)) * black_box(16_777_216.0);
    if halved == 0.0 || doubled == 0.0 {
        return Some("subnormal numbers are taken for zero");
    }
    None
}

#[cfg(test)]
mod tests {
    #[test]
    fn threads_compute_as_the_format_asks_for_by_default() {
        assert_eq!(super::departure(), None);
        assert_eq!(std::thread::spawn(super::departure).join().ok(), Some(None));
    }
}
