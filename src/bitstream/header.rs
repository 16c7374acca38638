//! Payloads of the chunks before the first pass (`format/SPEC.md`, section 4).

use super::chunk::kind;
use crate::util::bytes::Reader;
#[cfg(any(feature = "encoder", test))]
use crate::util::bytes::write_varint;

/// Largest number of bits per coordinate.
pub(crate) const MAX_QUANTIZATION_BITS: u32 = 30;
/// Largest number of passes after the base mesh, and so of levels.
pub(crate) const MAX_PASSES: u32 = 4096;
/// Vertices that one byte of payload may bring or refine: encoders pad, so that a small stream
/// cannot ask for a huge mesh.
pub(crate) const MAX_VERTICES_PER_BYTE: u32 = 64;

/// The grid: cell `c` of the finest precision stands for `origin + c · side / (2^precision − 1)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Grid {
    pub(crate) quantization_bits: u32,
    pub(crate) origin: [f64; 3],
    pub(crate) side: f64,
}

impl Grid {
    /// Middle of the cells of the full grid that share the bits of `cell`, of which there are `precision`.
    pub(crate) fn position(&self, cell: [i32; 3], quantization_bits: u32) -> [f64; 3] {
        let hidden = self.quantization_bits - quantization_bits;
        let half = (f64::from(1_u32 << hidden) - 1.0) * 0.5;
        let steps = f64::from((1_u32 << self.quantization_bits) - 1);
        std::array::from_fn(|axis| {
            let fine = f64::from(cell[axis] << hidden) + half;
            self.origin[axis] + fine / steps * self.side
        })
    }

    /// Side of the cells of `precision` bits.
    pub(crate) fn step(&self, quantization_bits: u32) -> f64 {
        self.side / f64::from((1_u32 << self.quantization_bits) - 1)
            * f64::from(1_u32 << (self.quantization_bits - quantization_bits))
    }

    /// Half the side of a cell of the full grid.
    pub(crate) fn half_step(&self) -> f64 {
        self.step(self.quantization_bits) * 0.5
    }

    /// The cell of the full grid that is closest, halves rounded up.
    #[cfg(feature = "encoder")]
    pub(crate) fn cell(&self, position: [f64; 3]) -> [i32; 3] {
        let steps = f64::from((1_u32 << self.quantization_bits) - 1);
        std::array::from_fn(|axis| {
            let offset = position[axis] - self.origin[axis];
            let scaled = offset * steps / self.side;
            // Near the largest double the product overflows where the quotient does not.
            let scaled = if scaled.is_finite() { scaled } else { offset / self.side * steps };
            if self.side > 0.0 { (scaled + 0.5).floor().clamp(0.0, steps) as i32 } else { 0 }
        })
    }
}

/// What the header says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Header {
    pub(crate) grid: Grid,
    /// The levels were made as [`Provenance::USUAL`] says.
    pub(crate) is_usual: bool,
    /// Number of the profile, up to [`MAX_PROFILE`].
    pub(crate) profile: u8,
}

const WIDE_FLOATS: u8 = 1;
const USUAL_PROVENANCE: u8 = 2;
const PROFILE_SHIFT: u32 = 2;
const MAX_PROFILE: u8 = 3;

impl Header {
    pub(crate) fn read(payload: &[u8]) -> Option<Self> {
        let mut reader = Reader::new(payload);
        let flags = reader.u8()?;
        if flags >> PROFILE_SHIFT > MAX_PROFILE {
            return None;
        }
        let quantization_bits = u32::from(reader.u8()?);
        let mut number = || if flags & WIDE_FLOATS != 0 { reader.f64() } else { reader.f32().map(f64::from) };
        let origin = [number()?, number()?, number()?];
        let side = number()?;
        let sound = (1..=MAX_QUANTIZATION_BITS).contains(&quantization_bits)
            && side.is_finite()
            && side >= 0.0
            && origin.iter().all(|o| o.is_finite() && (o + side).is_finite());
        let grid = Grid { quantization_bits, origin, side };
        let (is_usual, profile) = (flags & USUAL_PROVENANCE != 0, flags >> PROFILE_SHIFT);
        (sound && reader.is_empty()).then_some(Self { grid, is_usual, profile })
    }

    #[cfg(any(feature = "encoder", test))]
    pub(crate) fn write(&self) -> Vec<u8> {
        let Grid { quantization_bits, origin, side } = self.grid;
        let numbers = [origin[0], origin[1], origin[2], side];
        let is_narrow = numbers.iter().all(|&x| f64::from(x as f32).to_bits() == x.to_bits());
        let width = if is_narrow { 0 } else { WIDE_FLOATS };
        let usual = if self.is_usual { USUAL_PROVENANCE } else { 0 };
        let flags = width | usual | self.profile << PROFILE_SHIFT;
        let mut payload = vec![flags, quantization_bits as u8];
        for x in numbers {
            if is_narrow {
                payload.extend_from_slice(&(x as f32).to_le_bytes());
            } else {
                payload.extend_from_slice(&x.to_le_bytes());
            }
        }
        payload
    }
}

/// How the levels were made: for people, not for decoding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Provenance {
    pub(crate) descriptor: u8,
    pub(crate) partition: u8,
    pub(crate) rings: u32,
    pub(crate) radius: f64,
    pub(crate) growth: f64,
}

impl Provenance {
    /// harris3d and the balanced partition; its window is the one that a payload without one means.
    pub(crate) const USUAL: Self = Self { descriptor: 4, partition: 0, rings: 4, radius: 3.0, growth: 1.5 };

    pub(crate) fn read(payload: &[u8]) -> Option<Self> {
        let mut reader = Reader::new(payload);
        let (descriptor, partition) = (reader.u8()?, reader.u8()?);
        if reader.is_empty() {
            return Some(Self { descriptor, partition, ..Self::USUAL });
        }
        let (rings, radius, growth) = (reader.varint()?, reader.f32()?, reader.f32()?);
        Some(Self { descriptor, partition, rings, radius: radius.into(), growth: growth.into() })
    }

    #[cfg(any(feature = "encoder", test))]
    pub(crate) fn write(&self) -> Vec<u8> {
        let mut payload = vec![self.descriptor, self.partition];
        if *self == (Self { descriptor: self.descriptor, partition: self.partition, ..Self::USUAL }) {
            return payload;
        }
        write_varint(&mut payload, self.rings);
        payload.extend_from_slice(&(self.radius as f32).to_le_bytes());
        payload.extend_from_slice(&(self.growth as f32).to_le_bytes());
        payload
    }
}

/// What one pass does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Action {
    Base { quantization_bits: u32 },
    Split,
    Refine,
}

impl Action {
    /// The kind of its chunk.
    pub(crate) fn kind(self) -> u8 {
        match self {
            Action::Base { .. } => kind::BASE,
            Action::Split => kind::SPLIT,
            Action::Refine => kind::REFINE,
        }
    }
}

/// One row of the table of passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Pass {
    pub(crate) action: Action,
    /// Vertices and faces the pass adds.
    pub(crate) vertices: u32,
    pub(crate) faces: u32,
    /// Bytes of its payload.
    pub(crate) bytes: u32,
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRID: Grid = Grid { quantization_bits: 12, origin: [0.5, -1.0, 0.0], side: 3.0 };

    #[test]
    fn grids_return_in_the_shorter_form_that_is_exact() {
        let header = |grid| Header { grid, is_usual: false, profile: 0 };
        assert_eq!(header(GRID).write().len(), 18);
        for (is_usual, profile) in [(false, 0), (true, 0), (false, 1), (true, MAX_PROFILE)] {
            let header = Header { is_usual, profile, ..header(GRID) };
            assert_eq!(Header::read(&header.write()), Some(header));
        }
        let fine = header(Grid { origin: [0.1, 5_500_000.001, 0.0], ..GRID });
        assert_eq!(fine.write().len(), 34);
        assert_eq!(Header::read(&fine.write()), Some(fine));
        for bad in [
            Grid { quantization_bits: 0, ..GRID },
            Grid { quantization_bits: 31, ..GRID },
            Grid { side: -1.0, ..GRID },
            Grid { side: f64::INFINITY, ..GRID },
            Grid { origin: [f64::NAN; 3], ..GRID },
            Grid { origin: [f64::MAX; 3], side: f64::MAX, ..GRID },
        ] {
            assert_eq!(Header::read(&header(bad).write()), None, "{bad:?}");
        }
        let mut strange = header(GRID).write();
        strange[0] = 0x80;
        assert_eq!(Header::read(&strange), None, "a flag of later versions");
    }
}
