//! What is not part of a surface: vertices without triangles, triangles that name a vertex twice
//! (`format/SPEC.md`, section 7.7).

use super::{EXHAUSTED, Malformed};
use crate::bitstream::header::MAX_VERTICES_PER_BYTE;
use crate::entropy::numbers::Numbers;
use crate::entropy::range_coder::BitCoder;

/// Vertices after those of the surface, and triangles after its own.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Loose {
    /// Cells at full precision.
    pub(crate) cells: Vec<[i32; 3]>,
    /// Indices of vertices of the mesh: the stitched ones, then the isolated ones.
    pub(crate) faces: Vec<[u32; 3]>,
}

impl Loose {
    /// Vertices and faces.
    pub(crate) fn len(&self) -> u64 {
        (self.cells.len() + self.faces.len()) as u64
    }
}

/// Codes how many isolated vertices and degenerate faces there are. A payload of `bytes` may add
/// [`MAX_VERTICES_PER_BYTE`] of both for each byte and one more.
pub(crate) fn code_counts<B: BitCoder>(
    coder: &mut B,
    bytes: usize,
    target: Option<&Loose>,
) -> Result<[u64; 2], Malformed> {
    let most = u64::from(MAX_VERTICES_PER_BYTE) * (bytes as u64 + 1);
    let mut counts = Numbers::new(2);
    let (num_cells, num_faces) = target.map_or((0, 0), |t| (t.cells.len() as u64, t.faces.len() as u64));
    let num_cells = counts.code(coder, 0, num_cells);
    let num_faces = counts.code(coder, 1, num_faces);
    if target.is_none() && num_cells + num_faces > most {
        return Err(Malformed("more loose vertices and faces than the bytes could hold"));
    }
    Ok([num_cells, num_faces])
}

/// Codes the isolated vertices and degenerate faces of a mesh with `num_joined` stitched vertices.
pub(crate) fn code<B: BitCoder>(
    coder: &mut B,
    quantization_bits: u32,
    num_joined: usize,
    [num_cells, num_faces]: [u64; 2],
    target: Option<&Loose>,
) -> Result<Loose, Malformed> {
    if num_joined as u64 + num_cells >= u64::from(u32::MAX / 4) || num_faces >= u64::from(u32::MAX / 4) {
        return Err(Malformed("too many loose vertices and faces"));
    }
    let mut loose = Loose::default();
    let mut ways = Numbers::new(3);
    let mut last = [0_i32; 3];
    for i in 0..num_cells as usize {
        let wanted = target.map_or(last, |t| t.cells[i]);
        for axis in 0..3 {
            let way = i64::from(wanted[axis]) - i64::from(last[axis]);
            let cell = i64::from(last[axis]) + ways.code_signed(coder, axis, way);
            if !(0..1 << quantization_bits).contains(&cell) {
                return Err(Malformed("a loose vertex off the grid"));
            }
            last[axis] = cell as i32;
        }
        if coder.is_exhausted() {
            return Err(Malformed(EXHAUSTED));
        }
        loose.cells.push(last);
    }

    let num_vertices = num_joined as i64 + num_cells as i64;
    let mut ways = Numbers::new(3);
    let mut first = 0;
    for i in 0..num_faces as usize {
        let wanted = target.map_or([first; 3], |t| t.faces[i].map(i64::from));
        first += ways.code_signed(coder, 0, wanted[0] - first);
        let second = first + ways.code_signed(coder, 1, wanted[1] - first);
        let third = second + ways.code_signed(coder, 2, wanted[2] - second);
        let face = [first, second, third];
        if !face.iter().all(|v| (0..num_vertices).contains(v)) {
            return Err(Malformed("a loose face names no vertex"));
        }
        if coder.is_exhausted() {
            return Err(Malformed(EXHAUSTED));
        }
        loose.faces.push(face.map(|v| v as u32));
    }
    Ok(loose)
}
