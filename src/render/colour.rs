//! Colour maps.

/// Viridis, perceptually even: dark violet at 0, yellow at 1. Values outside are moved to the nearer end.
pub fn sequential(value: f64) -> [u8; 3] {
    let value = if value.is_nan() { 0.0 } else { value.clamp(0.0, 1.0) };
    let colour = colorous::VIRIDIS.eval_continuous(value);
    [colour.r, colour.g, colour.b]
}
