//! Payloads of the chunks before the first pass (`format/SPEC.md`, section 4).

use super::bytes::Reader;
#[cfg(any(feature = "encoder", test))]
use super::bytes::write_varint;
use super::chunk::kind;

/// Largest number of bits per coordinate.
pub(crate) const MAX_PRECISION: u32 = 30;
/// Largest number of passes after the base mesh, and so of levels.
pub(crate) const MAX_PASSES: u32 = 4096;
/// Vertices that one byte of payload may bring or refine: encoders pad, so that a small stream
/// cannot ask for a huge mesh.
pub(crate) const MAX_VERTICES_PER_BYTE: u32 = 64;

/// The grid: cell `c` of the finest precision stands for `origin + c · side / (2^precision − 1)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Grid {
    pub(crate) precision: u32,
    pub(crate) origin: [f64; 3],
    pub(crate) side: f64,
}

const WIDE_FLOATS: u8 = 1;

impl Grid {
    pub(crate) fn read(payload: &[u8]) -> Option<Self> {
        let mut reader = Reader::new(payload);
        let flags = reader.u8()?;
        if flags & !WIDE_FLOATS != 0 {
            return None;
        }
        let precision = u32::from(reader.u8()?);
        let mut number = || if flags & WIDE_FLOATS != 0 { reader.f64() } else { reader.f32().map(f64::from) };
        let origin = [number()?, number()?, number()?];
        let side = number()?;
        let sound = (1..=MAX_PRECISION).contains(&precision)
            && side.is_finite()
            && side >= 0.0
            && origin.iter().all(|o| o.is_finite() && (o + side).is_finite());
        (sound && reader.is_empty()).then_some(Self { precision, origin, side })
    }

    /// Middle of the cells of the full grid that share the bits of `cell`, of which there are `precision`.
    pub(crate) fn position(&self, cell: [i32; 3], precision: u32) -> [f64; 3] {
        let hidden = self.precision - precision;
        let half = (f64::from(1_u32 << hidden) - 1.0) * 0.5;
        let steps = f64::from((1_u32 << self.precision) - 1);
        std::array::from_fn(|axis| {
            let fine = f64::from(cell[axis] << hidden) + half;
            self.origin[axis] + fine / steps * self.side
        })
    }

    /// Half the side of a cell of the full grid.
    pub(crate) fn half_step(&self) -> f64 {
        self.side / f64::from((1_u32 << self.precision) - 1) * 0.5
    }

    /// The cell of the full grid that is closest, halves rounded up.
    #[cfg(feature = "encoder")]
    pub(crate) fn cell(&self, position: [f64; 3]) -> [i32; 3] {
        let steps = f64::from((1_u32 << self.precision) - 1);
        std::array::from_fn(|axis| {
            let offset = position[axis] - self.origin[axis];
            let scaled = offset * steps / self.side;
            // Near the largest double the product overflows where the quotient does not.
            let scaled = if scaled.is_finite() { scaled } else { offset / self.side * steps };
            if self.side > 0.0 { (scaled + 0.5).floor().clamp(0.0, steps) as i32 } else { 0 }
        })
    }

    #[cfg(any(feature = "encoder", test))]
    pub(crate) fn write(&self) -> Vec<u8> {
        let numbers = [self.origin[0], self.origin[1], self.origin[2], self.side];
        let is_narrow = numbers.iter().all(|&x| f64::from(x as f32).to_bits() == x.to_bits());
        let mut payload = vec![if is_narrow { 0 } else { WIDE_FLOATS }, self.precision as u8];
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
    /// The window that a payload without one means.
    const USUAL: Self = Self { descriptor: 0, partition: 0, rings: 4, radius: 3.0, growth: 1.5 };

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
    Base { precision: u32 },
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

/// Why a table of passes is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BadTable(pub(crate) &'static str);

/// Reads the table of passes; the first is always the base mesh. The sums of vertices and of faces
/// stay below 2³⁰.
pub(crate) fn read_passes(payload: &[u8], grid: &Grid) -> Result<Vec<Pass>, BadTable> {
    let short = || BadTable("the table of passes is cut or has a bad number");
    let mut reader = Reader::new(payload);
    let count = reader.varint().ok_or_else(short)?;
    if count > MAX_PASSES {
        return Err(BadTable("too many passes"));
    }
    let base = Pass {
        action: Action::Base { precision: reader.varint().ok_or_else(short)? },
        vertices: reader.varint().ok_or_else(short)?,
        faces: reader.varint().ok_or_else(short)?,
        bytes: reader.varint().ok_or_else(short)?,
    };
    let Action::Base { mut precision } = base.action else { return Err(short()) };
    if !(1..=grid.precision).contains(&precision) {
        return Err(BadTable("the precision of the base mesh is not that of a grid"));
    }
    let mut vertices = base.vertices;
    let mut faces = base.faces;
    let mut passes = vec![base];
    for _ in 0..count {
        let head = reader.varint().ok_or_else(short)?;
        let mut pass = Pass { action: Action::Refine, vertices: 0, faces: 0, bytes: 0 };
        if head == 0 {
            precision += 1;
            if precision > grid.precision {
                return Err(BadTable("the passes refine beyond the grid"));
            }
        } else {
            pass.action = Action::Split;
            pass.vertices = head;
            let on_boundary = reader.varint().ok_or_else(short)?;
            let inside =
                head.checked_sub(on_boundary).ok_or(BadTable("more boundary vertices than vertices"))?;
            pass.faces = head.checked_add(inside).ok_or_else(short)?;
        }
        pass.bytes = reader.varint().ok_or_else(short)?;
        vertices = vertices.checked_add(pass.vertices).ok_or(BadTable("more than 2^32 vertices"))?;
        faces = faces.checked_add(pass.faces).ok_or(BadTable("more than 2^32 faces"))?;
        let touched = if pass.action == Action::Refine { vertices } else { pass.vertices };
        check_density(touched, pass.bytes)?;
        passes.push(pass);
    }
    check_density(base.vertices.max(base.faces), base.bytes)?;
    if !reader.is_empty() {
        return Err(BadTable("bytes follow the table of passes"));
    }
    if base.vertices < 3 || base.faces == 0 || vertices >= u32::MAX / 4 || faces >= u32::MAX / 4 {
        return Err(BadTable("the mesh is empty or too large"));
    }
    Ok(passes)
}

/// Vertices a payload of `bytes` may bring or refine.
pub(crate) fn check_density(vertices: u32, bytes: u32) -> Result<(), BadTable> {
    if u64::from(vertices) > u64::from(MAX_VERTICES_PER_BYTE) * (u64::from(bytes) + 1) {
        return Err(BadTable("a pass has more vertices than its bytes could hold"));
    }
    Ok(())
}

/// Writes the table of passes. `passes[0]` must be the base mesh.
#[cfg(any(feature = "encoder", test))]
pub(crate) fn write_passes(passes: &[Pass]) -> Vec<u8> {
    let mut payload = Vec::new();
    write_varint(&mut payload, passes.len() as u32 - 1);
    for pass in passes {
        match pass.action {
            Action::Base { precision } => {
                write_varint(&mut payload, precision);
                write_varint(&mut payload, pass.vertices);
                write_varint(&mut payload, pass.faces);
            }
            Action::Split => {
                write_varint(&mut payload, pass.vertices);
                write_varint(&mut payload, 2 * pass.vertices - pass.faces);
            }
            Action::Refine => write_varint(&mut payload, 0),
        }
        write_varint(&mut payload, pass.bytes);
    }
    payload
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRID: Grid = Grid { precision: 12, origin: [0.5, -1.0, 0.0], side: 3.0 };

    #[test]
    fn grids_return_in_the_shorter_form_that_is_exact() {
        assert_eq!(GRID.write().len(), 18);
        assert_eq!(Grid::read(&GRID.write()), Some(GRID));
        let fine = Grid { origin: [0.1, 5_500_000.001, 0.0], ..GRID };
        assert_eq!(fine.write().len(), 34);
        assert_eq!(Grid::read(&fine.write()), Some(fine));
        for bad in [
            Grid { precision: 0, ..GRID },
            Grid { precision: 31, ..GRID },
            Grid { side: -1.0, ..GRID },
            Grid { side: f64::INFINITY, ..GRID },
            Grid { origin: [f64::NAN; 3], ..GRID },
            Grid { origin: [f64::MAX; 3], side: f64::MAX, ..GRID },
        ] {
            assert_eq!(Grid::read(&bad.write()), None, "{bad:?}");
        }
    }

    #[test]
    fn tables_return_and_lies_are_refused() {
        let passes = [
            Pass { action: Action::Base { precision: 11 }, vertices: 4, faces: 4, bytes: 20 },
            Pass { action: Action::Split, vertices: 3, faces: 5, bytes: 9 },
            Pass { action: Action::Refine, vertices: 0, faces: 0, bytes: 1 },
            Pass { action: Action::Split, vertices: 70, faces: 140, bytes: 300 },
        ];
        let payload = write_passes(&passes);
        assert_eq!(read_passes(&payload, &GRID).as_deref(), Ok(&passes[..]));
        for cut in 0..payload.len() {
            assert!(read_passes(&payload[..cut], &GRID).is_err());
        }
        let mut huge = passes;
        huge[3].vertices = 300 * 64 + 65;
        huge[3].faces = 2 * huge[3].vertices;
        assert!(read_passes(&write_passes(&huge), &GRID).is_err());
        let mut deep = passes.to_vec();
        deep.push(passes[2]);
        assert!(read_passes(&write_passes(&deep), &GRID).is_err(), "thirteen bits on a grid of twelve");
        for precision in [0, 13, 32, u32::MAX - 1, u32::MAX] {
            let mut wide = passes;
            wide[0].action = Action::Base { precision };
            assert!(read_passes(&write_passes(&wide), &GRID).is_err(), "a base of {precision} bits");
        }
    }
}
