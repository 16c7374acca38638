//! Elementary functions that give the same bits everywhere (`format/SPEC.md`, section 6.2).
//!
//! The decoder may not call a library's logarithm: its last bits differ between platforms. These
//! are made of + − × ÷ in a fixed order, tabulated once.

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
const TAIL_LIMIT: f64 = 40.0;
const TAIL_STEPS: f64 = 16.0;
const TAIL_SIZE: usize = 2 * 40 * 16 + 2;
/// Widths and share of the two logistic densities whose sum has this tail.
const NARROW: f64 = 0.8;
const WIDE: f64 = 2.4;
const NARROW_SHARE: f64 = 0.75;
const LOG_STEPS: usize = 256;

pub(crate) struct Tables {
    squash: Box<[u16; SQUASH_SIZE]>,
    stretch: Box<[f32; STRETCH_SIZE]>,
    tail: Box<[f32; TAIL_SIZE]>,
    log2_mantissa: Vec<f64>,
    exp2_fraction: Vec<f64>,
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
        let tail = |i: usize| {
            let z = i as f64 / TAIL_STEPS - TAIL_LIMIT;
            let logistic = |width: f64| 1.0 / (1.0 + exp(z / width));
            (NARROW_SHARE * logistic(NARROW) + (1.0 - NARROW_SHARE) * logistic(WIDE)) as f32
        };
        Self {
            squash: Box::new(std::array::from_fn(squash)),
            stretch: Box::new(std::array::from_fn(stretch)),
            tail: Box::new(std::array::from_fn(tail)),
            log2_mantissa: (0..LOG_STEPS)
                .map(|i| ln(1.0 + (i as f64 + 0.5) / LOG_STEPS as f64) / ln(2.0))
                .collect(),
            exp2_fraction: (0..LOG_STEPS)
                .map(|i| exp((i as f64 + 0.5) / LOG_STEPS as f64 * ln(2.0)))
                .collect(),
        }
    }

    /// Logistic function, as a probability in 1/65536.
    #[inline]
    pub(crate) fn squash(&self, x: f32) -> u32 {
        let i = ((x + SQUASH_LIMIT) * (SQUASH_SIZE as f32 / (2.0 * SQUASH_LIMIT))) as usize;
        u32::from(self.squash[i.min(SQUASH_SIZE - 1)])
    }

    /// ln(p / (1 − p)) of a probability in 1/4096.
    #[inline]
    pub(crate) fn stretch(&self, p: usize) -> f32 {
        self.stretch[p & (STRETCH_SIZE - 1)]
    }

    /// ln(p / (1 − p)) of a probability as a real number; out of range counts as the nearest end.
    #[inline]
    pub(crate) fn stretch_real(&self, p: f64) -> f32 {
        self.stretch[((p * STRETCH_SIZE as f64) as usize).min(STRETCH_SIZE - 1)]
    }

    /// Share of the unit density above `z`: a narrow logistic with a wide one below it, which gives
    /// it the heavy flanks that residuals have.
    #[inline]
    pub(crate) fn tail(&self, z: f64) -> f64 {
        let t = (z.clamp(-TAIL_LIMIT, TAIL_LIMIT) + TAIL_LIMIT) * TAIL_STEPS;
        let i = t as usize;
        let (a, b) = (f64::from(self.tail[i]), f64::from(self.tail[i + 1]));
        a + (b - a) * (t - i as f64)
    }

    /// Base-2 logarithm of a positive, normal number, to about 0.003.
    #[inline]
    pub(crate) fn log2(&self, x: f64) -> f64 {
        let bits = x.to_bits();
        let exponent = (bits >> 52 & 0x7ff) as i64 - 1023;
        exponent as f64 + self.log2_mantissa[(bits >> 44 & 0xff) as usize]
    }

    /// Two to the power `y`, `y` within −60..60, to about 0.2 %.
    #[inline]
    pub(crate) fn exp2(&self, y: f64) -> f64 {
        let t = (y.clamp(-60.0, 60.0) + 64.0) * LOG_STEPS as f64;
        let i = t as usize;
        let power = f64::from_bits(((i / LOG_STEPS) as u64 + 1023 - 64) << 52);
        self.exp2_fraction[i % LOG_STEPS] * power
    }
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
            assert!((tables.tail(x) - 0.75 * logistic(0.8) - 0.25 * logistic(2.4)).abs() < 2e-4);
            assert!((tables.log2(f64::from(i)) - f64::from(i).log2()).abs() < 3e-3);
            assert!((tables.exp2(x) / x.exp2() - 1.0).abs() < 2e-3);
        }
        assert_eq!(tables.squash(-1e9), P_MIN);
        assert_eq!(tables.squash(1e9), P_MAX);
        assert_eq!(tables.squash(f32::NAN), P_MIN);
        assert!(tables.tail(f64::NAN).is_nan());
    }

    /// The bits of the tables are part of the format.
    #[test]
    fn bits_are_pinned() {
        let t = Tables::get();
        let mut hash = crc32fast::Hasher::new();
        t.squash.iter().for_each(|v| hash.update(&v.to_le_bytes()));
        t.stretch.iter().for_each(|v| hash.update(&v.to_bits().to_le_bytes()));
        t.tail.iter().for_each(|v| hash.update(&v.to_bits().to_le_bytes()));
        for table in [&t.log2_mantissa, &t.exp2_fraction] {
            table.iter().for_each(|v| hash.update(&v.to_bits().to_le_bytes()));
        }
        assert_eq!(format!("{:08x}", hash.finalize()), "1bf8a372");
    }
}
