//! Payloads of the chunks before the first pass (`format/SPEC.md`, section 4).

use super::chunk::kind;
use super::grid::{Grid, Lattice, Spread};
use crate::util::bytes::Reader;
#[cfg(any(feature = "encoder", test))]
use crate::util::bytes::write_varint;

/// Largest number of passes after the base mesh, and so of levels.
pub(crate) const MAX_PASSES: u32 = 4096;
/// Vertices that one byte of payload may add or refine: encoders pad, so that a small stream
/// cannot ask for a huge mesh.
pub(crate) const MAX_VERTICES_PER_BYTE: u32 = 64;

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
const ON_LATTICE: u8 = 16;
const HAS_OFFSET: u8 = 32;
const KNOWN_FLAGS: u8 = 63;

impl Header {
    pub(crate) fn read(payload: &[u8]) -> Option<Self> {
        let mut reader = Reader::new(payload);
        let flags = reader.u8()?;
        if flags & !KNOWN_FLAGS != 0 || flags & (ON_LATTICE | HAS_OFFSET) == HAS_OFFSET {
            return None;
        }
        let quantization_bits = u32::from(reader.u8()?);
        let spread = if flags & ON_LATTICE == 0 {
            let [x, y, z, side] = floats(&mut reader, flags)?;
            Spread::Cube { origin: [x, y, z], side }
        } else {
            let lattice = Lattice { origin: floats(&mut reader, flags)?, step: floats(&mut reader, flags)? };
            Spread::Lattice { lattice, offset: read_offset(&mut reader, flags)? }
        };
        let grid = Grid { quantization_bits, spread };
        let (is_usual, profile) = (flags & USUAL_PROVENANCE != 0, flags >> PROFILE_SHIFT & MAX_PROFILE);
        (grid.is_sound() && reader.is_empty()).then_some(Self { grid, is_usual, profile })
    }

    #[cfg(any(feature = "encoder", test))]
    pub(crate) fn write(&self) -> Vec<u8> {
        let (numbers, offset, mut flags) = match self.grid.spread {
            Spread::Cube { origin: [x, y, z], side } => (vec![x, y, z, side], [0; 3], 0),
            Spread::Lattice { lattice, offset } => {
                ([lattice.origin, lattice.step].concat(), offset, ON_LATTICE)
            }
        };
        let is_narrow = numbers.iter().all(|&x| f64::from(x as f32).to_bits() == x.to_bits());
        flags |= if is_narrow { 0 } else { WIDE_FLOATS };
        flags |= if self.is_usual { USUAL_PROVENANCE } else { 0 };
        flags |= if offset == [0; 3] { 0 } else { HAS_OFFSET };
        flags |= self.profile << PROFILE_SHIFT;
        let mut payload = vec![flags, self.grid.quantization_bits as u8];
        for x in numbers {
            if is_narrow {
                payload.extend_from_slice(&(x as f32).to_le_bytes());
            } else {
                payload.extend_from_slice(&x.to_le_bytes());
            }
        }
        if flags & HAS_OFFSET != 0 {
            payload.extend(offset.iter().flat_map(|k| k.to_le_bytes()));
        }
        payload
    }
}

/// So many floats, of the width that the flags say.
fn floats<const N: usize>(reader: &mut Reader, flags: u8) -> Option<[f64; N]> {
    let mut numbers = [0.0; N];
    for number in &mut numbers {
        *number = if flags & WIDE_FLOATS != 0 { reader.f64()? } else { reader.f32()?.into() };
    }
    Some(numbers)
}

/// The offset of a lattice: without one, zeros, which one may not say in full.
fn read_offset(reader: &mut Reader, flags: u8) -> Option<[i64; 3]> {
    if flags & HAS_OFFSET == 0 {
        return Some([0; 3]);
    }
    let offset = [reader.i64()?, reader.i64()?, reader.i64()?];
    Some(offset).filter(|&offset| offset != [0; 3])
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
    /// harris3d and the partition by weighted error; its window is the one that a payload without one means.
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
    pub(crate) triangles: u32,
    /// Bytes of its payload.
    pub(crate) bytes: u32,
}

#[cfg(test)]
mod tests {
    use super::super::grid::MAX_OFFSET;
    use super::*;

    const ORIGIN: [f64; 3] = [0.5, -1.0, 0.0];

    fn header(grid: Grid) -> Header {
        Header { grid, is_usual: false, profile: 0 }
    }

    fn cube() -> Grid {
        Grid::cube(12, ORIGIN, 3.0)
    }

    fn on_lattice(origin: [f64; 3], step: [f64; 3], offset: [i64; 3]) -> Grid {
        Grid { quantization_bits: 12, spread: Spread::Lattice { lattice: Lattice { origin, step }, offset } }
    }

    #[test]
    fn grids_return_in_the_shorter_form_that_is_exact() {
        assert_eq!(header(cube()).write().len(), 18);
        for (is_usual, profile) in [(false, 0), (true, 0), (false, 1), (true, MAX_PROFILE)] {
            let header = Header { is_usual, profile, ..header(cube()) };
            assert_eq!(Header::read(&header.write()), Some(header));
        }
        let fine = header(Grid::cube(12, [0.1, 5_500_000.001, 0.0], 3.0));
        assert_eq!(fine.write().len(), 34);
        assert_eq!(Header::read(&fine.write()), Some(fine));
        for bad in [
            Grid { quantization_bits: 0, ..cube() },
            Grid { quantization_bits: 31, ..cube() },
            Grid::cube(12, ORIGIN, -1.0),
            Grid::cube(12, ORIGIN, f64::INFINITY),
            Grid::cube(12, [f64::NAN; 3], 3.0),
            Grid::cube(12, [f64::MAX; 3], f64::MAX),
        ] {
            assert_eq!(Header::read(&header(bad).write()), None, "{bad:?}");
        }
        for flag in [0x40, 0x80] {
            let mut strange = header(cube()).write();
            strange[0] = flag;
            assert_eq!(Header::read(&strange), None, "a flag of later versions");
        }
    }

    #[test]
    fn lattices_return_with_their_offsets() {
        let step = [0.5, 0.25, 2.0];
        for (grid, size) in [
            (on_lattice(ORIGIN, step, [0; 3]), 26),
            (on_lattice(ORIGIN, [0.1, 0.25, 2.0], [0; 3]), 50),
            (on_lattice(ORIGIN, step, [0, -1, 0]), 50),
            (on_lattice(ORIGIN, step, [MAX_OFFSET, -MAX_OFFSET, 5]), 50),
        ] {
            let header = Header { is_usual: true, profile: 2, ..header(grid) };
            assert_eq!(header.write().len(), size);
            assert_eq!(Header::read(&header.write()), Some(header));
            assert_eq!(Header::read(&header.write()[..size - 1]), None);
            assert_eq!(Header::read(&[header.write(), vec![0]].concat()), None);
        }
    }

    #[test]
    fn lattices_that_leave_the_numbers_are_refused() {
        let step = [0.5, 0.25, 2.0];
        for bad in [
            Grid { quantization_bits: 31, ..on_lattice(ORIGIN, step, [0; 3]) },
            on_lattice(ORIGIN, [0.5, 0.0, 2.0], [0; 3]),
            on_lattice(ORIGIN, [0.5, -0.25, 2.0], [0; 3]),
            on_lattice(ORIGIN, [0.5, f64::NAN, 2.0], [0; 3]),
            on_lattice(ORIGIN, [0.5, 0.25, f64::INFINITY], [0; 3]),
            on_lattice([0.0, f64::NEG_INFINITY, 0.0], step, [0; 3]),
            on_lattice(ORIGIN, step, [0, 0, MAX_OFFSET + 1]),
            on_lattice(ORIGIN, step, [i64::MIN, 0, 0]),
            on_lattice(ORIGIN, [1e305; 3], [0; 3]),
            on_lattice(ORIGIN, [1e300; 3], [-1 << 40, 0, 0]),
            on_lattice([f64::MAX; 3], [1e300; 3], [0; 3]),
        ] {
            assert_eq!(Header::read(&header(bad).write()), None, "{bad:?}");
        }
        let mut without = header(on_lattice(ORIGIN, step, [1, 0, 0])).write();
        without[26] = 0;
        assert_eq!(Header::read(&without), None, "an offset of zeros in full");
        let mut cubic = header(cube()).write();
        cubic[0] |= HAS_OFFSET;
        assert_eq!(Header::read(&cubic), None, "an offset without a lattice");
    }
}
