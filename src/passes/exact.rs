//! Coordinates bit for bit (`format/SPEC.md`, section 7.8): which of the numbers that lie in a cell it is.

use super::{EXHAUSTED, Malformed};
use crate::bitstream::header::Grid;
use crate::bitstream::mixer::PlainBits;
use crate::bitstream::range_coder::{BitCoder, PROBABILITY_ONE};
use std::collections::HashMap;

/// Which numbers the coordinates of one axis are.
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

/// The numbers that coordinates of one axis may be, in order: each has a key, and larger ones larger keys.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ladder {
    is_wide: bool,
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
    fn value(self, key: u64) -> f64 {
        match self.steps {
            Some(steps) => self.rounded((key ^ TOP) as i64 as f64 / steps),
            None if self.is_wide => f64::from_bits(unordered(key, 64)),
            None => f64::from(f32::from_bits(unordered(key, 32) as u32)),
        }
    }

    /// The key of a number that is on the ladder.
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

    fn float_key(self, x: f64) -> u64 {
        if self.is_wide { ordered(x.to_bits(), 64) } else { ordered(u64::from((x as f32).to_bits()), 32) }
    }

    /// The least and the largest key that a coordinate within `half` of `middle` may have; some more do no
    /// harm.
    pub(crate) fn range(self, middle: f64, half: f64) -> [u64; 2] {
        let (low, high) = (middle - half, middle + half);
        match self.steps {
            Some(steps) => {
                let whole = |x: f64| (x as i64).clamp(-MAX_WHOLE, MAX_WHOLE);
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
    fn share_above(self, low: u64, middle: u64, high: u64) -> u32 {
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

/// Bytes in front of the coded coordinates: whether the file had doubles, and the scale of each axis.
pub(crate) const LADDER_BYTES: usize = 4;

/// Reads these bytes.
pub(crate) fn read_ladders(payload: &[u8]) -> Option<[Ladder; 3]> {
    let (&[flags, x, y, z], _) = payload.split_first_chunk::<LADDER_BYTES>()?;
    let scales = [Scale::read(x)?, Scale::read(y)?, Scale::read(z)?];
    (flags <= 1).then(|| scales.map(|scale| Ladder::new(flags == 1, scale)))
}

#[cfg(feature = "encoder")]
pub(crate) fn write_ladders(is_wide: bool, scales: [Scale; 3]) -> Vec<u8> {
    let mut bytes = vec![u8::from(is_wide)];
    bytes.extend(scales.map(Scale::code));
    bytes
}

/// Ranges of fewer keys have models for all bits.
const MODELLED: u64 = 32;

/// Adaptive models of one axis.
struct Axis {
    ladder: Ladder,
    /// The key last met in each cell.
    last: HashMap<i32, u64>,
    is_last: PlainBits,
    /// How the last three coordinates were that bit, the newest lowest.
    history: usize,
    is_off: PlainBits,
    small: PlainBits,
}

impl Axis {
    fn new(ladder: Ladder) -> Self {
        Self {
            ladder,
            last: HashMap::new(),
            is_last: PlainBits::new(8),
            history: 0,
            is_off: PlainBits::new(2),
            small: PlainBits::new((MODELLED * MODELLED) as usize),
        }
    }

    /// Codes the coordinate in `cell`, whose numbers have keys from `low` to `high`; `None` if a stream
    /// names no number.
    fn code<B: BitCoder>(
        &mut self,
        coder: &mut B,
        cell: i32,
        [low, high]: [u64; 2],
        target: Option<(Option<u64>, f64)>,
    ) -> Option<f64> {
        let key = target.and_then(|t| t.0);
        if let Some(&last) = self.last.get(&cell) {
            let hit = self.is_last.code(coder, self.history, key == Some(last));
            self.history = (self.history << 1 | usize::from(hit)) & 7;
            if hit {
                return Some(self.ladder.value(last));
            }
        }
        let inside = key.filter(|key| (low..=high).contains(key));
        if self.is_off.code(coder, 0, target.is_some() && inside.is_none()) {
            return self.code_off(coder, target.map_or(0.0, |t| t.1));
        }
        let key = self.code_between(coder, [low, high], inside.unwrap_or(low));
        self.last.insert(cell, key);
        Some(self.ladder.value(key)).filter(|x| x.is_finite())
    }

    fn code_between<B: BitCoder>(&mut self, coder: &mut B, [low, high]: [u64; 2], key: u64) -> u64 {
        let size = high - low;
        let [mut low, mut high] = [low, high];
        let mut node = 1;
        while low < high {
            let middle = low + (high - low) / 2;
            let is_above = key > middle;
            let is_above = if size < MODELLED {
                // At most five halvings.
                let context = size as usize * MODELLED as usize + node;
                self.small.code(coder, context, is_above)
            } else {
                coder.code(is_above, self.ladder.share_above(low, middle, high))
            };
            if is_above {
                low = middle + 1
            } else {
                high = middle
            }
            node = node << 1 | usize::from(is_above);
        }
        low
    }

    /// A number that is not where it should be: −0, or any bits.
    fn code_off<B: BitCoder>(&mut self, coder: &mut B, value: f64) -> Option<f64> {
        let is_negative_zero = value.to_bits() == (-0.0_f64).to_bits();
        if self.is_off.code(coder, 1, is_negative_zero) {
            return Some(-0.0);
        }
        let value = if self.ladder.is_wide {
            let bits = value.to_bits();
            let high = coder.code_raw((bits >> 32) as u32, 32);
            f64::from_bits(u64::from(high) << 32 | u64::from(coder.code_raw(bits as u32, 32)))
        } else {
            f64::from(f32::from_bits(coder.code_raw((value as f32).to_bits(), 32)))
        };
        Some(value).filter(|x| x.is_finite())
    }
}

/// Codes the coordinates of vertices with these cells of the full grid.
pub(crate) fn code<B: BitCoder>(
    coder: &mut B,
    grid: &Grid,
    ladders: [Ladder; 3],
    cells: &[[i32; 3]],
    target: Option<Target>,
) -> Result<Vec<[f64; 3]>, Malformed> {
    let mut axes = ladders.map(Axis::new);
    let half = grid.half_step();
    let mut positions = Vec::with_capacity(cells.len());
    for (i, &cell) in cells.iter().enumerate() {
        let middle = grid.position(cell, grid.precision);
        let mut position = [0.0; 3];
        for (a, axis) in axes.iter_mut().enumerate() {
            let range = axis.ladder.range(middle[a], half);
            let wanted = target.map(|t| t(i)[a]);
            let number = axis.code(coder, cell[a], range, wanted);
            position[a] = number.ok_or(Malformed("a coordinate that is no number"))?;
        }
        if coder.is_exhausted() {
            return Err(Malformed(EXHAUSTED));
        }
        positions.push(position);
    }
    Ok(positions)
}

/// Key, if it is on the ladder, and value of each coordinate of a vertex.
pub(crate) type Target<'a> = &'a dyn Fn(usize) -> [(Option<u64>, f64); 3];
