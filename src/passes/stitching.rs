//! Which vertices of the surface are one vertex of the mesh (`format/SPEC.md`, section 7.6). Where a mesh
//! is not manifold, an encoder cuts it into sheets; the stitching joins them again.

use super::{EXHAUSTED, GridMesh, Malformed};
use crate::entropy::context_mixer::PlainBits;
use crate::entropy::numbers::Numbers;
use crate::entropy::range_coder::BitCoder;
use crate::mesh::surface::{NO_CORNER, next, prev};

/// Candidates that have a separate context.
const MAX_COUNTED: usize = 3;

/// Adaptive models of the stitching.
pub(crate) struct StitchingModels {
    is_stitched: PlainBits,
    pick: Numbers,
}

impl Default for StitchingModels {
    fn default() -> Self {
        // Candidates, whether the vertex lies on the boundary, and what is known of its neighbours.
        Self { is_stitched: PlainBits::new(MAX_COUNTED * 2 * 3), pick: Numbers::new(1) }
    }
}

/// Codes the stitching of the vertices of `mesh` from `roots.len()` on. `roots[v]` is the first vertex of the
/// mesh that is the same as v: v itself unless it is stitched to another. `target`: a number for each vertex,
/// equal for those that are the same.
///
/// Takes memory in proportion to the vertices.
pub(crate) fn code<B: BitCoder>(
    coder: &mut B,
    models: &mut StitchingModels,
    mesh: &GridMesh,
    roots: &mut Vec<u32>,
    target: Option<&[u32]>,
) -> Result<(), Malformed> {
    let count = mesh.positions.len();
    let cells = Cells::new(&mesh.positions);
    // Roots in each cell, in the places of its vertices.
    let mut list = vec![0_u32; count];
    let mut num_roots = vec![0_u32; count];
    for v in 0..count {
        let first = cells.first[v] as usize;
        let known = num_roots[first] as usize;
        let mut root = if v < roots.len() { roots[v] } else { v as u32 };
        if v >= roots.len() {
            let candidates = &list[first..first + known];
            if let Some(picked) = pick(coder, models, mesh, v as u32, candidates, roots, target) {
                root = picked;
            }
            roots.push(root);
        }
        if root == v as u32 {
            list[first + known] = root;
            num_roots[first] += 1;
        }
        if coder.is_exhausted() {
            return Err(Malformed(EXHAUSTED));
        }
    }
    Ok(())
}

fn pick<B: BitCoder>(
    coder: &mut B,
    models: &mut StitchingModels,
    mesh: &GridMesh,
    v: u32,
    candidates: &[u32],
    roots: &[u32],
    target: Option<&[u32]>,
) -> Option<u32> {
    if candidates.is_empty() {
        return None;
    }
    let wanted = target.and_then(|t| candidates.iter().rposition(|&c| t[c as usize] == t[v as usize]));
    let context = (candidates.len().min(MAX_COUNTED) - 1) * 6 + around(mesh, v, roots);
    if !models.is_stitched.code(coder, context, wanted.is_some()) {
        return None;
    }
    let last = candidates.len() - 1;
    if last == 0 {
        return candidates.first().copied();
    }
    let back = models.pick.code(coder, 0, wanted.map_or(0, |w| last - w) as u64);
    Some(candidates[last.saturating_sub(back as usize)])
}

/// Whether the vertex lies on the boundary, and whether the root of a neighbour is known (1), or a neighbour
/// is stitched to another vertex (2).
fn around(mesh: &GridMesh, v: u32, roots: &[u32]) -> usize {
    let surface = &mesh.surface;
    let start = surface.corner_of[v as usize];
    let mut known = 0;
    let mut see = |u: u32| {
        if let Some(&root) = roots.get(u as usize) {
            known = known.max(if root == u { 1 } else { 2 });
        }
    };
    let mut corner = start;
    let mut is_open = true;
    loop {
        see(surface.vertex(next(corner)));
        see(surface.vertex(prev(corner)));
        corner = surface.swing_left(corner);
        if corner == start {
            is_open = false;
            break;
        }
        if corner == NO_CORNER {
            break;
        }
    }
    if is_open {
        corner = surface.swing_right(start);
        while corner != NO_CORNER {
            see(surface.vertex(next(corner)));
            see(surface.vertex(prev(corner)));
            corner = surface.swing_right(corner);
        }
    }
    usize::from(is_open) * 3 + known
}

/// Vertices by their cells.
struct Cells {
    /// For each vertex the place of the first one of its cell, when sorted by cell.
    first: Vec<u32>,
}

impl Cells {
    fn new(positions: &[[i32; 3]]) -> Self {
        let mut order: Vec<u32> = (0..positions.len() as u32).collect();
        order.sort_unstable_by_key(|&v| positions[v as usize]);
        let mut first = vec![0_u32; positions.len()];
        let mut start = 0;
        for (i, &v) in order.iter().enumerate() {
            if positions[order[start] as usize] != positions[v as usize] {
                start = i;
            }
            first[v as usize] = start as u32;
        }
        Self { first }
    }
}
