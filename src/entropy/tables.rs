//! Elementary functions that give the same bits everywhere (`format/SPEC.md`, section 6.2).
//!
//! The decoder may not call a library's logarithm: its last bits differ between platforms. These
//! are made of + − × ÷ in a fixed order, tabulated once.

use crate::util::simd4::Lanes;
use std::sync::LazyLock;

/// Entries of the logistic table over [−12, 12).
const SQUASH_SIZE: usize = 4096;
const SQUASH_LIMIT: f32 = 12.0;
/// Entries of the stretch table over (0, 1).
const STRETCH_SIZE: usize = 4096;
/// Smallest and largest probability the mixer may give.
const P_MIN: u32 = 24;
const P_MAX: u32 = 65_536 - P_MIN;
/// The tail table covers [−TAIL_LIMIT, TAIL_LIMIT] with this many steps to a unit.
const TAIL_LIMIT: f32 = 40.0;
const TAIL_STEPS: f32 = 8.0;
const TAIL_MIDDLE: u32 = 40 * 8;
/// Twice the middle and one, up to a power of two.
const TAIL_SIZE: usize = 1024;
/// Widths and share of the two logistic densities whose sum has this tail.
const NARROW: f64 = 0.8;
const WIDE: f64 = 2.4;
const NARROW_SHARE: f64 = 0.75;
/// Adding this to a number within ±2²² leaves the nearest integer in the lowest bits.
const ROUND: f32 = 12_582_912.0;

pub(crate) struct Tables {
    squash: Box<[u16; SQUASH_SIZE]>,
    stretch: Box<[f32; STRETCH_SIZE]>,
    /// Value and slope at each step.
    tail: Box<[[f32; 2]; TAIL_SIZE]>,
}

static TABLES: LazyLock<Tables> = LazyLock::new(Tables::build);

impl Tables {
    pub(crate) fn get() -> &'static Tables {
        &TABLES
    }

    fn build() -> Self {
        let squash = |i: usize| {
            let x = (i as f64 + 0.5) * (2.0 * SQUASH_LIMIT as f64 / SQUASH_SIZE as f64) - SQUASH_LIMIT as f64;
            let p = 65_536.0 / (1.0 + exp(-x));
            (p as u32).clamp(P_MIN, P_MAX) as u16
        };
        let stretch = |i: usize| {
            let p = (i as f64 + 0.5) / STRETCH_SIZE as f64;
            ln(p / (1.0 - p)) as f32
        };
        let tail = |step: f64| {
            let logistic = |width: f64| 1.0 / (1.0 + exp(step / f64::from(TAIL_STEPS) / width));
            NARROW_SHARE * logistic(NARROW) + (1.0 - NARROW_SHARE) * logistic(WIDE)
        };
        let tail = |i: usize| {
            let step = (i as f64).min(f64::from(2 * TAIL_MIDDLE)) - f64::from(TAIL_MIDDLE);
            [tail(step) as f32, (0.5 * (tail(step + 1.0) - tail(step - 1.0))) as f32]
        };
        Self {
            squash: Box::new(std::array::from_fn(squash)),
            stretch: Box::new(std::array::from_fn(stretch)),
            tail: Box::new(std::array::from_fn(tail)),
        }
    }

    /// Logistic function, as a probability in 1/65536.
    #[inline]
    pub(crate) fn squash(&self, x: f32) -> u32 {
        let x = (x + SQUASH_LIMIT) * (SQUASH_SIZE as f32 / (2.0 * SQUASH_LIMIT));
        u32::from(self.squash[index_below(x, SQUASH_SIZE)])
    }

    /// ln(p / (1 − p)) of a probability in 1/4096.
    #[inline]
    pub(crate) fn stretch(&self, p: usize) -> f32 {
        self.stretch[p & (STRETCH_SIZE - 1)]
    }

    /// ln(p / (1 − p)) of a probability as a real number; out of range counts as the nearest end.
    #[inline(always)]
    pub(crate) fn stretch_real(&self, p: f32) -> f32 {
        self.stretch[index_below(p * STRETCH_SIZE as f32, STRETCH_SIZE)]
    }

    /// Share of the unit density above `z`, per lane: a narrow logistic with a wide one below it,
    /// which gives it the heavy flanks that residuals have.
    #[inline(always)]
    pub(crate) fn tail(&self, z: Lanes) -> Lanes {
        let step = z.clamp(-TAIL_LIMIT, TAIL_LIMIT) * TAIL_STEPS;
        let rounded = step + Lanes::splat(ROUND);
        let rest = step - (rounded - Lanes::splat(ROUND));
        let entry = rounded.0.map(|r| {
            let i = r.to_bits().wrapping_sub(ROUND.to_bits()).wrapping_add(TAIL_MIDDLE);
            self.tail[i as usize % TAIL_SIZE]
        });
        Lanes(entry.map(|[value, _]| value)) + Lanes(entry.map(|[_, slope]| slope)) * rest
    }
}

/// The whole part of `x`, or the nearest end of `0..count`; 0 if `x` is not a number. `count` is at most
/// 2^16: processors have what cuts a float to 16 bits, to the sizes of pointers it takes many steps.
#[inline(always)]
pub(crate) fn index_below(x: f32, count: usize) -> usize {
    usize::from(x as u16).min(count - 1)
}

/// The integer nearest to `x`, halves upwards: ⌊x + ½⌋ without the library call that `floor` is
/// where the processor's own is not assumed.
#[inline(always)]
pub(crate) fn round_half_up(x: f32) -> i32 {
    let shifted = x + 0.5;
    let truncated = shifted as i32;
    truncated - i32::from(truncated as f32 > shifted)
}

/// Base-2 logarithm of a positive, normal number, to about 0.0002.
#[inline(always)]
pub(crate) fn log2(x: f32) -> f32 {
    const C: [f32; 3] = [0.438_725_7, -0.239_058_1, 0.082_130_6];
    let bits = x.to_bits();
    let exponent = (bits >> 23) as i32 - 127;
    let t = f32::from_bits(bits & 0x007f_ffff | 0x3f80_0000) - 1.0;
    (exponent as f32 + t) + (t * (1.0 - t)) * (C[0] + t * (C[1] + t * C[2]))
}

/// Two to the power `y`, `y` within −60..60, to about 0.01 %.
#[inline(always)]
pub(crate) fn exp2(y: f32) -> f32 {
    const C: [f32; 4] = [0.999_928_04, 0.693_261, 0.242_611_64, 0.055_171_57];
    let y = y.clamp(-60.0, 60.0);
    let rounded = y + ROUND;
    let f = y - (rounded - ROUND);
    let power = f32::from_bits(rounded.to_bits().wrapping_sub(ROUND.to_bits()).wrapping_add(127) << 23);
    (C[0] + f * (C[1] + f * (C[2] + f * C[3]))) * power
}

/// e^x for |x| ≤ 64: Taylor series of x / 2^10, squared ten times.
fn exp(x: f64) -> f64 {
    let y = x / 1024.0;
    let mut term = 1.0;
    let mut sum = 1.0;
    for k in 1..=12 {
        term = term * y / f64::from(k);
        sum += term;
    }
    for _ in 0..10 {
        sum *= sum;
    }
    sum
}

/// Natural logarithm of a positive number: powers of two taken out, then 2·artanh((m−1)/(m+1)).
fn ln(x: f64) -> f64 {
    const LN_2: f64 = std::f64::consts::LN_2;
    let (mut m, mut exponent) = (x, 0.0);
    while m >= 1.5 {
        m *= 0.5;
        exponent += 1.0;
    }
    while m < 0.75 {
        m *= 2.0;
        exponent -= 1.0;
    }
    let t = (m - 1.0) / (m + 1.0);
    let square = t * t;
    let mut power = t;
    let mut sum = 0.0;
    for k in 0..20 {
        sum += power / f64::from(2 * k + 1);
        power *= square;
    }
    2.0 * sum + exponent * LN_2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agree_with_the_standard_library() {
        let tables = Tables::get();
        for i in 1..2000 {
            let x = f64::from(i) * 0.0117 - 11.7;
            assert!((exp(x) / x.exp() - 1.0).abs() < 1e-12);
            assert!((ln(f64::from(i)) - f64::from(i).ln()).abs() < 1e-13 * 8.0);
            let p = 1.0 / (1.0 + (-x).exp());
            assert!((f64::from(tables.squash(x as f32)) / 65_536.0 - p).abs() < 1.6e-3);
            let logistic = |width: f64| 1.0 / (1.0 + (x / width).exp());
            let wanted = 0.75 * logistic(0.8) + 0.25 * logistic(2.4);
            let [tail, ..] = tables.tail(Lanes::splat(x as f32)).0;
            assert!((f64::from(tail) / wanted - 1.0).abs() < 4e-3, "{x}: {tail} for {wanted}");
            assert!((f64::from(log2(i as f32)) - f64::from(i).log2()).abs() < 2e-4);
            assert!((f64::from(exp2(x as f32)) / x.exp2() - 1.0).abs() < 1e-4);
        }
        assert_eq!(tables.squash(-1e9), P_MIN);
        assert_eq!(tables.squash(1e9), P_MAX);
        assert_eq!(tables.squash(f32::NAN), P_MIN);
    }

    /// The bits of the tables are part of the format.
    #[test]
    fn bits_are_pinned() {
        let t = Tables::get();
        let mut hash = crc32fast::Hasher::new();
        t.squash.iter().for_each(|v| hash.update(&v.to_le_bytes()));
        t.stretch.iter().for_each(|v| hash.update(&v.to_bits().to_le_bytes()));
        let used = &t.tail[..=2 * TAIL_MIDDLE as usize];
        used.iter().flatten().for_each(|v| hash.update(&v.to_bits().to_le_bytes()));
        assert_eq!(format!("{:08x}", hash.finalize()), "a84b1b07");
    }
}
