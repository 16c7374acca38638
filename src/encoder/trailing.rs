//! What follows the last pass: everything of the mesh that the surface on the grid does not tell.

use super::options::EncodeOptions;
use super::order::Ordered;
use super::{expect_sound, padded};
use crate::TriMesh;
use crate::bitstream::chunk::kind;
use crate::bitstream::header::{Grid, MAX_VERTICES_PER_BYTE};
use crate::bitstream::range_coder::RangeEncoder;
use crate::decoder::assemble::Extras;
use crate::mesh::has_three_vertices;
use crate::morton::morton;
use crate::passes::GridMesh;
use crate::passes::exact::{self, Ladder, Scale};
use crate::passes::loose::{self, Loose};
use crate::passes::order::{self, Order};
use bitvec::vec::BitVec;

/// Glued vertices are never removed unless they are a larger share of all: the base would be too large.
const MOST_GLUED: f64 = 0.25;

/// The vertices of the surface that are never removed, so that their glue is there from the start and no level
/// has a crack. `source`: ascending, the vertex of the mesh for each.
pub(super) fn kept(source: &[u32]) -> BitVec {
    let is_glued = |i: usize| {
        (i > 0 && source[i - 1] == source[i]) || source.get(i + 1).is_some_and(|&next| next == source[i])
    };
    let glued: BitVec = (0..source.len()).map(is_glued).collect();
    if glued.count_ones() as f64 > MOST_GLUED * source.len() as f64 {
        return BitVec::repeat(false, source.len());
    }
    glued
}

/// The vertices that no usable triangle has and that are to be kept.
pub(super) fn loose_vertices(mesh: &TriMesh, options: &EncodeOptions) -> Vec<u32> {
    let mut is_used: BitVec = BitVec::repeat(false, mesh.num_vertices());
    let mut is_named: BitVec = BitVec::repeat(options.keep_isolated, mesh.num_vertices());
    for triangle in mesh.triangles() {
        let set = if has_three_vertices(triangle) { &mut is_used } else { &mut is_named };
        if has_three_vertices(triangle) || options.keep_degenerate {
            triangle.iter().for_each(|&v| set.set(v as usize, true));
        }
    }
    (0..mesh.num_vertices() as u32).filter(|&v| is_named[v as usize] && !is_used[v as usize]).collect()
}

/// Puts loose vertices in the order of their cells, ties by their coordinates.
pub(super) fn sort_loose(loose: &mut [u32], mesh: &TriMesh, grid: &Grid) {
    let at = |v: u32| mesh.positions()[v as usize];
    loose.sort_by_cached_key(|&v| (morton(grid.cell(at(v))), at(v).map(f64::to_bits), v));
}

/// A mesh, and how its surface was made of it.
#[derive(Clone, Copy)]
pub(super) struct Exact<'a> {
    pub(super) mesh: &'a TriMesh,
    pub(super) grid: &'a Grid,
    pub(super) ordered: &'a Ordered,
    /// Vertex of `ordered` for each vertex of the cut surface.
    pub(super) source: &'a [u32],
    /// Vertices of the mesh that follow those of the surface.
    pub(super) loose: &'a [u32],
    pub(super) options: &'a EncodeOptions,
}

/// The surface as a decoder has it.
pub(super) struct Written<'a> {
    pub(super) mesh: &'a GridMesh,
    /// Vertex of the cut surface for each vertex.
    pub(super) vertex_source: &'a [u32],
    /// Triangle of the cut surface, and so of the ordered mesh, for each triangle.
    pub(super) face_source: &'a [u32],
}

impl Exact<'_> {
    /// Kinds and payloads of the chunks. `roots`: the glue of the surface.
    pub(super) fn trailing(&self, surface: &Written, roots: Vec<u32>) -> Vec<(u8, Vec<u8>)> {
        let mut extras = Extras { roots, ..Extras::default() };
        let joined = extras.joined(surface.vertex_source.len());
        // Vertex of the mesh for each vertex of the joined one.
        let on_surface = joined.first.iter().map(|&v| {
            let cut = surface.vertex_source[v as usize];
            self.ordered.vertex_source[self.source[cut as usize] as usize]
        });
        let vertices: Vec<u32> = on_surface.chain(self.loose.iter().copied()).collect();
        let mut chunks = Vec::new();

        let (loose, loose_faces) = self.loose(&vertices);
        let num_joined = joined.first.len();
        if !loose.cells.is_empty() || !loose.faces.is_empty() {
            chunks.push((kind::LOOSE, self.write_loose(&loose, num_joined)));
            extras.loose = Some(loose);
        }
        if self.options.lossless {
            chunks.push((kind::EXACT, self.write_positions(&vertices)));
        }
        if self.options.keep_order {
            let faces = extras.triangles(&joined, &surface.mesh.surface.triangles);
            let on_surface = surface.face_source.iter().map(|&f| self.ordered.corner_source[f as usize] / 3);
            let face_source: Vec<u32> = on_surface.chain(loose_faces).collect();
            debug_assert_eq!(faces.len(), face_source.len());
            chunks.push((kind::ORDER, self.write_order(&vertices, &faces, &face_source)));
        }
        chunks
    }

    /// What is loose, and the triangle of the mesh for each loose face.
    fn loose(&self, vertices: &[u32]) -> (Loose, Vec<u32>) {
        let cells = self.loose.iter().map(|&v| self.grid.cell(self.mesh.positions()[v as usize])).collect();
        if !self.options.keep_degenerate {
            return (Loose { cells, faces: Vec::new() }, Vec::new());
        }
        let mut place = vec![0_u32; self.mesh.num_vertices()];
        vertices.iter().zip(0..).for_each(|(&v, i)| place[v as usize] = i);
        let triangles = (0..).zip(self.mesh.triangles()).filter(|(_, t)| !has_three_vertices(t));
        let turned = |(face, t): (u32, &[u32; 3])| {
            let [a, b, c] = t.map(|v| place[v as usize]);
            ([a, b, c].min([b, c, a]).min([c, a, b]), face)
        };
        let mut faces: Vec<([u32; 3], u32)> = triangles.map(turned).collect();
        faces.sort_unstable();
        let (faces, source) = faces.into_iter().unzip();
        (Loose { cells, faces }, source)
    }

    fn write_loose(&self, loose: &Loose, num_joined: usize) -> Vec<u8> {
        let mut coder = RangeEncoder::new();
        let counts = expect_sound(loose::code_counts(&mut coder, 0, Some(loose)));
        expect_sound(loose::code(&mut coder, self.grid.precision, num_joined, counts, Some(loose)));
        padded(coder.finish(), counts[0] + counts[1], u64::from(MAX_VERTICES_PER_BYTE))
    }

    fn write_positions(&self, vertices: &[u32]) -> Vec<u8> {
        let at = |i: usize| self.mesh.positions()[vertices[i] as usize];
        let is_wide =
            (0..vertices.len()).any(|i| at(i).iter().any(|&x| f64::from(x as f32).to_bits() != x.to_bits()));
        let scales =
            [0, 1, 2].map(|axis| self.cheapest_scale(is_wide, &|i| at(i)[axis], axis, vertices.len()));
        let ladders = scales.map(|scale| Ladder::new(is_wide, scale));
        let target = |i: usize| [0, 1, 2].map(|axis| (ladders[axis].key(at(i)[axis]), at(i)[axis]));
        let cells: Vec<[i32; 3]> = (0..vertices.len()).map(|i| self.grid.cell(at(i))).collect();
        let mut coder = RangeEncoder::new();
        expect_sound(exact::code(&mut coder, self.grid, ladders, &cells, Some(&target)));
        let mut payload = exact::write_ladders(is_wide, scales);
        payload.extend(coder.finish());
        payload
    }

    /// The numbers that all coordinates of an axis are, but for a few, and that take the fewest bits.
    fn cheapest_scale(&self, is_wide: bool, at: &dyn Fn(usize) -> f64, axis: usize, count: usize) -> Scale {
        /// Coordinates that are looked at first.
        const SAMPLES: usize = 2000;
        /// One of so many may be no such number.
        const EXCEPTIONS: usize = 200;
        let sample: Vec<f64> = (0..count).step_by(count.div_ceil(SAMPLES).max(1)).map(at).collect();
        let fits = |ladder: Ladder, sample: &mut dyn Iterator<Item = f64>, count: usize| {
            sample.filter(|&x| ladder.key(x).is_none()).take(count / EXCEPTIONS + 1).count() * EXCEPTIONS
                <= count
        };
        let bits = |ladder: Ladder| -> f64 {
            let width = |&x: &f64| {
                let mut cell = [0; 3];
                cell[axis] = self.grid.cell([x; 3])[axis];
                let middle = self.grid.position(cell, self.grid.precision)[axis];
                let [low, high] = ladder.range(middle, self.grid.half_step());
                ((high - low) as f64 + 1.0).log2()
            };
            sample.iter().map(width).sum::<f64>() / sample.len() as f64
        };
        let decimal = (0..=Scale::MAX_DECIMAL).map(Scale::Decimal);
        let binary = (0..=Scale::MAX_BINARY).map(Scale::Binary);
        let suits = |scale: &Scale| {
            let ladder = Ladder::new(is_wide, *scale);
            fits(ladder, &mut sample.iter().copied(), sample.len())
                && fits(ladder, &mut (0..count).map(at), count)
        };
        // The coarsest of each kind takes the fewest bits.
        let found = [decimal.clone().find(suits), binary.clone().find(suits), Some(Scale::Float)];
        let cost = |scale: &Scale| bits(Ladder::new(is_wide, *scale));
        found.into_iter().flatten().min_by(|a, b| cost(a).total_cmp(&cost(b))).unwrap_or(Scale::Float)
    }

    fn write_order(&self, vertices: &[u32], faces: &[[u32; 3]], face_source: &[u32]) -> Vec<u8> {
        let mut order = Order { vertices: (0..vertices.len() as u32).collect(), corners: Vec::new() };
        order.vertices.sort_unstable_by_key(|&v| vertices[v as usize]);
        let mut by_file: Vec<u32> = (0..faces.len() as u32).collect();
        by_file.sort_unstable_by_key(|&f| face_source[f as usize]);
        let corner = |&f: &u32| {
            let wanted = self.mesh.triangles()[face_source[f as usize] as usize];
            let face = faces[f as usize].map(|v| vertices[v as usize]);
            let first = (0..3).find(|&i| [0, 1, 2].map(|k| face[(i + k) % 3]) == wanted);
            debug_assert!(first.is_some(), "{face:?} is not {wanted:?}");
            3 * f + first.unwrap_or(0) as u32
        };
        order.corners = by_file.iter().map(corner).collect();
        let mut coder = RangeEncoder::new();
        expect_sound(order::code(&mut coder, vertices.len(), faces, Some(&order)));
        coder.finish()
    }
}
