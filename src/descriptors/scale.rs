//! Exact powers of two, to keep squares of coordinates inside the range of `f64`.

/// The e of |x| = m·2^e with 1 ≤ m < 2; −1075 for 0.
pub(super) fn exponent(x: f64) -> i32 {
    let bits = x.abs().to_bits();
    match bits >> 52 {
        0 => 63 - bits.leading_zeros() as i32 - 1074,
        biased => biased as i32 - 1023,
    }
}

/// x·2^k, exact unless the result overflows or is subnormal. Needs |k| ≤ 2044.
pub(super) fn times_power_of_two(x: f64, k: i32) -> f64 {
    let half = k / 2;
    x * power_of_two(half) * power_of_two(k - half)
}

fn power_of_two(k: i32) -> f64 {
    debug_assert!((-1022..=1023).contains(&k));
    f64::from_bits(((k + 1023) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponents_of_normal_subnormal_and_zero() {
        assert_eq!(exponent(1.0), 0);
        assert_eq!(exponent(-3.9), 1);
        assert_eq!(exponent(f64::MAX), 1023);
        assert_eq!(exponent(f64::MIN_POSITIVE), -1022);
        assert_eq!(exponent(f64::from_bits(1)), -1074);
        assert_eq!(exponent(0.0), -1075);
    }

    #[test]
    fn powers_compose() {
        assert_eq!(times_power_of_two(1.5, 1023), f64::MAX.min(1.5 * 2f64.powi(1023)));
        assert_eq!(times_power_of_two(f64::from_bits(1), 1074), 1.0);
        assert_eq!(times_power_of_two(1.0, -1074), f64::from_bits(1));
        assert_eq!(times_power_of_two(2f64.powi(1023), -2000), 2f64.powi(-977));
    }
}
