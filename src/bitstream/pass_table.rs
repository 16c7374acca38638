//! The table of passes (`format/SPEC.md`, section 4.3): every number as its distance from what the
//! passes before it let expect.

use super::grid::Grid;
use super::header::{Action, MAX_PASSES, MAX_VERTICES_PER_BYTE, Pass};
use crate::entropy::bits::BitReader;
#[cfg(any(feature = "encoder", test))]
use crate::entropy::bits::BitWriter;

/// Why a table of passes is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BadTable(pub(crate) &'static str);

/// Bits of small numbers that are never larger by much.
const COUNT_BITS: u32 = 4;
const QUANTIZATION_FIELD_BITS: u32 = 2;
/// Vertices of a usual base mesh.
const USUAL_BASE: u32 = 36;

/// A share of whole numbers, learnt from the last pass of its kind.
#[derive(Clone, Copy)]
struct Share {
    part: u32,
    whole: u32,
}

impl Share {
    fn of(self, whole: u32) -> u32 {
        let part = u64::from(whole) * u64::from(self.part) / u64::from(self.whole.max(1));
        u32::try_from(part).unwrap_or(u32::MAX)
    }
}

/// What the next row is expected to say.
struct Outlook {
    /// Vertices there are.
    vertices: u32,
    /// Vertices of a split per vertex there is.
    odd: Share,
    /// Boundary vertices per vertex of a split.
    boundary: Share,
    /// Bytes per vertex of a split, and of a refinement.
    split_bytes: Share,
    refine_bytes: Share,
}

impl Outlook {
    fn after_base(vertices: u32) -> Self {
        Self {
            vertices,
            odd: Share { part: 3, whole: 8 },
            boundary: Share { part: 0, whole: 1 },
            split_bytes: Share { part: 3, whole: 1 },
            refine_bytes: Share { part: 1, whole: 2 },
        }
    }

    /// Takes note of a row; `None` if there are 2³² vertices or more.
    fn learn(&mut self, row: &Pass) -> Option<()> {
        if row.action == Action::Refine {
            self.refine_bytes = Share { part: row.bytes, whole: self.vertices };
            return Some(());
        }
        self.odd = Share { part: row.vertices, whole: self.vertices };
        self.boundary = Share { part: on_boundary(row), whole: row.vertices };
        self.split_bytes = Share { part: row.bytes, whole: row.vertices };
        self.vertices = self.vertices.checked_add(row.vertices)?;
        Some(())
    }
}

/// Vertices of a split that lie on the boundary.
fn on_boundary(row: &Pass) -> u32 {
    2 * row.vertices - row.triangles
}

fn expected_triangles(base_vertices: u32) -> u32 {
    base_vertices.saturating_mul(2).saturating_sub(4)
}

/// Reads the table of passes; the first is always the base mesh. The sums of vertices and of triangles
/// stay below 2³⁰.
pub(crate) fn read_passes(payload: &[u8], grid: &Grid) -> Result<Vec<Pass>, BadTable> {
    let mut reader = BitReader::new(payload);
    let count = reader.number(COUNT_BITS).ok_or(SHORT)?;
    if count > MAX_PASSES {
        return Err(BadTable("too many passes"));
    }
    let base = read_base(&mut reader).ok_or(SHORT)?;
    let Action::Base { mut quantization_bits } = base.action else { return Err(SHORT) };
    if !(1..=grid.quantization_bits).contains(&quantization_bits) {
        return Err(BadTable("the precision of the base mesh is not that of a grid"));
    }
    if base.vertices < 3 || base.triangles == 0 {
        return Err(BadTable("the base mesh is empty"));
    }
    check_density(base.vertices.max(base.triangles), base.bytes)?;
    let mut outlook = Outlook::after_base(base.vertices);
    let mut triangles = base.triangles;
    let mut passes = vec![base];
    for _ in 0..count {
        let pass = if reader.bit().ok_or(SHORT)? {
            quantization_bits += 1;
            read_refinement(&mut reader, &outlook).ok_or(SHORT)?
        } else {
            read_split(&mut reader, &outlook)?
        };
        if quantization_bits > grid.quantization_bits {
            return Err(BadTable("the passes refine beyond the grid"));
        }
        outlook.learn(&pass).ok_or(TOO_LARGE)?;
        triangles = triangles.checked_add(pass.triangles).ok_or(TOO_LARGE)?;
        let touched = if pass.action == Action::Refine { outlook.vertices } else { pass.vertices };
        check_density(touched, pass.bytes)?;
        passes.push(pass);
    }
    if !reader.is_at_end() {
        return Err(BadTable("something follows the table of passes"));
    }
    if outlook.vertices >= u32::MAX / 4 || triangles >= u32::MAX / 4 {
        return Err(TOO_LARGE);
    }
    Ok(passes)
}

const SHORT: BadTable = BadTable("the table of passes is cut or has a bad number");
const TOO_LARGE: BadTable = BadTable("the mesh is too large");

fn read_base(reader: &mut BitReader) -> Option<Pass> {
    let quantization_bits = reader.number(QUANTIZATION_FIELD_BITS)?;
    let vertices = reader.near(USUAL_BASE)?;
    let triangles = reader.near(expected_triangles(vertices))?;
    let bytes = reader.near(vertices.saturating_mul(2))?;
    Some(Pass { action: Action::Base { quantization_bits }, vertices, triangles, bytes })
}

fn read_split(reader: &mut BitReader, outlook: &Outlook) -> Result<Pass, BadTable> {
    let vertices = reader.near(outlook.odd.of(outlook.vertices)).ok_or(SHORT)?;
    if vertices == 0 {
        return Err(BadTable("a split without vertices"));
    }
    let on_boundary = reader.near(outlook.boundary.of(vertices)).ok_or(SHORT)?;
    let inside = vertices.checked_sub(on_boundary).ok_or(BadTable("more boundary vertices than vertices"))?;
    let triangles = vertices.checked_add(inside).ok_or(TOO_LARGE)?;
    let bytes = reader.near(outlook.split_bytes.of(vertices)).ok_or(SHORT)?;
    Ok(Pass { action: Action::Split, vertices, triangles, bytes })
}

fn read_refinement(reader: &mut BitReader, outlook: &Outlook) -> Option<Pass> {
    let bytes = reader.near(outlook.refine_bytes.of(outlook.vertices))?;
    Some(Pass { action: Action::Refine, vertices: 0, triangles: 0, bytes })
}

/// Vertices that a payload of `bytes` may add or refine.
pub(crate) fn check_density(vertices: u32, bytes: u32) -> Result<(), BadTable> {
    if u64::from(vertices) > u64::from(MAX_VERTICES_PER_BYTE) * (u64::from(bytes) + 1) {
        return Err(BadTable("a pass has more vertices than its bytes could hold"));
    }
    Ok(())
}

/// Writes the table of passes. `passes[0]` must be the base mesh, and the only one.
#[cfg(any(feature = "encoder", test))]
pub(crate) fn write_passes(passes: &[Pass]) -> Vec<u8> {
    let mut writer = BitWriter::default();
    writer.number(passes.len() as u32 - 1, COUNT_BITS);
    let mut outlook = Outlook::after_base(passes[0].vertices);
    for pass in passes {
        match pass.action {
            Action::Base { quantization_bits } => {
                writer.number(quantization_bits, QUANTIZATION_FIELD_BITS);
                writer.near(pass.vertices, USUAL_BASE);
                writer.near(pass.triangles, expected_triangles(pass.vertices));
                writer.near(pass.bytes, pass.vertices.saturating_mul(2));
                continue;
            }
            Action::Split => {
                writer.bit(false);
                writer.near(pass.vertices, outlook.odd.of(outlook.vertices));
                writer.near(on_boundary(pass), outlook.boundary.of(pass.vertices));
                writer.near(pass.bytes, outlook.split_bytes.of(pass.vertices));
            }
            Action::Refine => {
                writer.bit(true);
                writer.near(pass.bytes, outlook.refine_bytes.of(outlook.vertices));
            }
        }
        // Beyond 2³² vertices a reader stops, whatever follows.
        if outlook.learn(pass).is_none() {
            break;
        }
    }
    writer.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid() -> Grid {
        Grid::cube(12, [0.5, -1.0, 0.0], 3.0)
    }

    #[test]
    fn tables_return_and_lies_are_refused() {
        let passes = [
            Pass { action: Action::Base { quantization_bits: 11 }, vertices: 4, triangles: 4, bytes: 20 },
            Pass { action: Action::Split, vertices: 3, triangles: 5, bytes: 9 },
            Pass { action: Action::Refine, vertices: 0, triangles: 0, bytes: 1 },
            Pass { action: Action::Split, vertices: 70, triangles: 140, bytes: 300 },
        ];
        let payload = write_passes(&passes);
        assert_eq!(read_passes(&payload, &grid()).as_deref(), Ok(&passes[..]));
        for cut in 0..payload.len() {
            assert!(read_passes(&payload[..cut], &grid()).is_err());
        }
        let mut huge = passes;
        huge[3].vertices = 300 * 64 + 65;
        huge[3].triangles = 2 * huge[3].vertices;
        assert!(read_passes(&write_passes(&huge), &grid()).is_err());
        let mut deep = passes.to_vec();
        deep.push(passes[2]);
        assert!(read_passes(&write_passes(&deep), &grid()).is_err(), "thirteen bits on a grid of twelve");
        for quantization_bits in [0, 13, 32, u32::MAX - 1, u32::MAX] {
            let mut wide = passes;
            wide[0].action = Action::Base { quantization_bits };
            assert!(
                read_passes(&write_passes(&wide), &grid()).is_err(),
                "a base of {quantization_bits} bits"
            );
        }
    }
}
