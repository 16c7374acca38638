//! A logarithm that costs nothing and is the same everywhere.

/// Smallest length that counts in a logarithm, in grid steps.
pub(super) const FLOOR: f32 = 0.35;

/// Base-2 logarithm of a positive, normal number, linear between powers of two.
#[inline(always)]
pub(super) fn rough_log2(x: f32) -> f32 {
    (x.to_bits() as i32 - 1.0_f32.to_bits() as i32) as f32 * (1.0 / (1 << 23) as f32)
}

/// The same of a length of any sign, which may be 0.
#[inline(always)]
pub(super) fn log_size(x: f32) -> f32 {
    rough_log2(x.abs() + FLOOR)
}
