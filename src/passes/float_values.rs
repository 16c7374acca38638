//! Ordered sets of numbers: the floats or decimals that something may be, each with a whole number as its key
//! (`format/SPEC.md`, section 7.8).

use crate::entropy::range_coder::PROBABILITY_ONE;

/// Which numbers all values of one kind are, such as the coordinates of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scale {
    /// Any float.
    Float,
    /// k / 10^digits, rounded, with a whole number k.
    Decimal(u32),
    /// k / 2^digits, rounded.
    Binary(u32),
}

impl Scale {
    /// Largest numbers of digits.
    pub(crate) const MAX_DECIMAL: u32 = 15;
    pub(crate) const MAX_BINARY: u32 = 60;
    const FIRST_BINARY: u32 = 32;

    pub(crate) fn read(code: u8) -> Option<Self> {
        match u32::from(code) {
            0 => Some(Self::Float),
            code @ 1.. if code - 1 <= Self::MAX_DECIMAL => Some(Self::Decimal(code - 1)),
            code @ Self::FIRST_BINARY.. if code - Self::FIRST_BINARY <= Self::MAX_BINARY => {
                Some(Self::Binary(code - Self::FIRST_BINARY))
            }
            _ => None,
        }
    }

    #[cfg(feature = "encoder")]
    pub(crate) fn code(self) -> u8 {
        match self {
            Self::Float => 0,
            Self::Decimal(digits) => 1 + digits as u8,
            Self::Binary(digits) => (Self::FIRST_BINARY + digits) as u8,
        }
    }

    /// Steps to a unit; exact. `None` for floats.
    fn steps(self) -> Option<f64> {
        match self {
            Self::Float => None,
            Self::Decimal(digits) => Some((0..digits).fold(1.0, |x, _| x * 10.0)),
            Self::Binary(digits) => Some((0..digits).fold(1.0, |x, _| x * 2.0)),
        }
    }
}

/// The numbers that values of one kind may be, in order: each has a key, and larger ones larger keys.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ladder {
    pub(super) is_wide: bool,
    /// Steps to a unit, unless all floats are on it.
    steps: Option<f64>,
}

/// Largest k of a decimal or binary number: whole doubles up to here are exact.
const MAX_WHOLE: i64 = 1 << 53;
const TOP: u64 = 1 << 63;

impl Ladder {
    pub(crate) fn new(is_wide: bool, scale: Scale) -> Self {
        Self { is_wide, steps: scale.steps() }
    }

    /// Rounded to what the file had.
    fn rounded(self, x: f64) -> f64 {
        if self.is_wide { x } else { f64::from(x as f32) }
    }

    /// The number of a key.
    pub(super) fn value(self, key: u64) -> f64 {
        match self.steps {
            Some(steps) => self.rounded((key ^ TOP) as i64 as f64 / steps),
            None if self.is_wide => f64::from_bits(unordered(key, 64)),
            None => f64::from(f32::from_bits(unordered(key, 32) as u32)),
        }
    }

    /// The key of a number that is in the ordered set.
    #[cfg(feature = "encoder")]
    pub(crate) fn key(self, x: f64) -> Option<u64> {
        let key = match self.steps {
            Some(steps) => {
                let k = (x * steps).round();
                (k.abs() < MAX_WHOLE as f64).then_some(k as i64 as u64 ^ TOP)
            }
            None => Some(self.float_key(x)),
        };
        key.filter(|&key| self.value(key).to_bits() == x.to_bits())
    }

    /// The key of the number next to `x`.
    pub(super) fn nearest(self, x: f64) -> u64 {
        match self.steps {
            Some(steps) => whole((x * steps + 0.5).floor()) as u64 ^ TOP,
            None => self.float_key(x),
        }
    }

    /// The number whose key is `way` above another one; `None` beyond the end.
    pub(super) fn away(self, key: u64, way: i64) -> Option<f64> {
        let key = key.checked_add_signed(way)?;
        let last = if self.steps.is_some() || self.is_wide { u64::MAX } else { u64::from(u32::MAX) };
        (key <= last).then(|| self.value(key))
    }

    fn float_key(self, x: f64) -> u64 {
        if self.is_wide { ordered(x.to_bits(), 64) } else { ordered(u64::from((x as f32).to_bits()), 32) }
    }

    /// The least and the largest key that a number within `half` of `middle` may have; some more do no
    /// harm.
    pub(crate) fn range(self, middle: f64, half: f64) -> [u64; 2] {
        let (low, high) = (middle - half, middle + half);
        match self.steps {
            Some(steps) => {
                // Towards zero, so that a number between is rounded up or down.
                let down = whole(low * steps);
                let up = whole(high * steps);
                let low = down - i64::from(low < 0.0 && down as f64 > low * steps);
                let high = up + i64::from(high > 0.0 && (up as f64) < high * steps);
                [low as u64 ^ TOP, high.max(low) as u64 ^ TOP]
            }
            None => {
                let last = if self.is_wide { u64::MAX } else { u64::from(u32::MAX) };
                let low = self.float_key(low).saturating_sub(1);
                [low, self.float_key(high).saturating_add(1).clamp(low, last)]
            }
        }
    }

    /// The chance that a key from `low` to `high` is above `middle`: each counts by the way to the next number.
    pub(super) fn share_above(self, low: u64, middle: u64, high: u64) -> u32 {
        let mut share = ((high - middle) as f64) / ((high - low) as f64 + 1.0);
        if self.steps.is_none() && high - low > 16 {
            let [low, middle, high] = [low, middle, high].map(|key| self.value(key));
            let by_width = (high - middle) / (high - low);
            if by_width > 0.0 && by_width < 1.0 {
                share = by_width;
            }
        }
        ((share * f64::from(PROBABILITY_ONE)) as u32).clamp(16, PROBABILITY_ONE - 16)
    }
}

/// Keys ascend with the numbers, −0 before 0.
fn ordered(bits: u64, width: u32) -> u64 {
    let sign = 1 << (width - 1);
    let mask = u64::MAX >> (64 - width);
    if bits & sign != 0 { !bits & mask } else { bits | sign }
}

fn unordered(key: u64, width: u32) -> u64 {
    let sign = 1 << (width - 1);
    let mask = u64::MAX >> (64 - width);
    if key & sign != 0 { key & !sign } else { !key & mask }
}

/// The whole part of a number, towards zero, within what doubles hold exactly.
fn whole(x: f64) -> i64 {
    (x as i64).clamp(-MAX_WHOLE, MAX_WHOLE)
}
