//! Coordinates bit for bit (`format/SPEC.md`, section 7.8): which of the numbers that lie in a cell it is.

use super::float_values::{Ladder, Scale};
use super::{EXHAUSTED, Malformed};
use crate::bitstream::grid::Grid;
use crate::entropy::context_mixer::PlainBits;
use crate::entropy::numbers::Numbers;
use crate::entropy::range_coder::BitCoder;
use std::collections::HashMap;

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

/// Keys that a number may be off what was expected.
const MOST_AWAY: u64 = 1 << 40;

/// What is to be coded, for encoders: the key, if the number is in the ordered set, and the number.
pub(crate) type Keyed = Option<(Option<u64>, f64)>;

/// Adaptive models of numbers of one kind, such as the coordinates of an axis.
pub(super) struct ExactCoder {
    ladder: Ladder,
    /// The key last met in each cell.
    last: HashMap<i32, u64>,
    is_last: PlainBits,
    /// How the last three numbers were that bit, the newest lowest.
    history: usize,
    is_off: PlainBits,
    small: PlainBits,
}

impl ExactCoder {
    pub(super) fn new(ladder: Ladder) -> Self {
        Self {
            ladder,
            last: HashMap::new(),
            is_last: PlainBits::new(8),
            history: 0,
            is_off: PlainBits::new(2),
            small: PlainBits::new((MODELLED * MODELLED) as usize),
        }
    }

    #[cfg(feature = "encoder")]
    pub(super) fn ladder(&self) -> Ladder {
        self.ladder
    }

    /// Codes the number in `cell`, all of whose numbers are within `half` of `middle`; `None` if a stream names no
    /// number.
    pub(super) fn code<B: BitCoder>(
        &mut self,
        coder: &mut B,
        cell: i32,
        [middle, half]: [f64; 2],
        target: Keyed,
    ) -> Option<f64> {
        let key = target.and_then(|t| t.0);
        if let Some(&last) = self.last.get(&cell) {
            let hit = self.is_last.code(coder, self.history, key == Some(last));
            self.history = (self.history << 1 | usize::from(hit)) & 7;
            if hit {
                return Some(self.ladder.value(last));
            }
        }
        match self.code_in_range(coder, [middle, half], target)? {
            Ok(key) => {
                self.last.insert(cell, key);
                Some(self.ladder.value(key)).filter(|x| x.is_finite())
            }
            Err(off) => Some(off),
        }
    }

    /// Codes a number that should be within `half` of `middle`: its key, or a number that is not.
    fn code_in_range<B: BitCoder>(
        &mut self,
        coder: &mut B,
        [middle, half]: [f64; 2],
        target: Keyed,
    ) -> Option<Result<u64, f64>> {
        let [low, high] = self.ladder.range(middle, half);
        let inside = target.and_then(|t| t.0).filter(|key| (low..=high).contains(key));
        if self.is_off.code(coder, 0, target.is_some() && inside.is_none()) {
            return self.code_off(coder, target.map_or(0.0, |t| t.1)).map(Err);
        }
        Some(Ok(self.code_between(coder, [low, high], inside.unwrap_or(low))))
    }

    /// Codes a number that should be within half of a middle, in no cell.
    pub(super) fn code_around<B: BitCoder>(
        &mut self,
        coder: &mut B,
        around: [f64; 2],
        target: Keyed,
    ) -> Option<f64> {
        let number = self.code_in_range(coder, around, target)?;
        number.map_or_else(Some, |key| Some(self.ladder.value(key))).filter(|x| x.is_finite())
    }

    /// Codes a number that should be nearly `expected`, by how many keys it is off.
    pub(super) fn code_expected<B: BitCoder>(
        &mut self,
        coder: &mut B,
        ways: &mut Numbers,
        expected: f64,
        target: Keyed,
    ) -> Option<f64> {
        let near = self.ladder.nearest(expected);
        let way = target.and_then(|t| t.0).map(|key| key.wrapping_sub(near) as i64);
        let way = way.filter(|way| way.unsigned_abs() < MOST_AWAY);
        if self.is_off.code(coder, 0, target.is_some() && way.is_none()) {
            return self.code_off(coder, target.map_or(0.0, |t| t.1));
        }
        let way = ways.code_signed(coder, 0, way.unwrap_or(0));
        self.ladder.away(near, way).filter(|x| x.is_finite())
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
    let mut axes = ladders.map(ExactCoder::new);
    let half = grid.half_step();
    let mut positions = Vec::with_capacity(cells.len());
    for (i, &cell) in cells.iter().enumerate() {
        let middle = grid.position(cell, grid.quantization_bits);
        let mut position = [0.0; 3];
        for (a, axis) in axes.iter_mut().enumerate() {
            let wanted = target.map(|t| t(i)[a]);
            let number = axis.code(coder, cell[a], [middle[a], half[a]], wanted);
            position[a] = number.ok_or(Malformed("a coordinate that is no number"))?;
        }
        if coder.is_exhausted() {
            return Err(Malformed(EXHAUSTED));
        }
        positions.push(position);
    }
    Ok(positions)
}

/// Key, if it is in the ordered set, and value of each coordinate of a vertex.
pub(crate) type Target<'a> = &'a dyn Fn(usize) -> [(Option<u64>, f64); 3];
