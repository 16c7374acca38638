//! What follows the last pass: everything about the mesh that the surface on the grid does not contain.

use super::attributes;
use super::canonical_order::Ordered;
use super::number_format::cheapest_scale;
use super::options::EncodeOptions;
use super::payload::{expect_sound, padded};
use super::tie_break::Signatures;
use super::values::ExactValues;
use crate::bitstream::chunk::kind;
use crate::bitstream::header::{Grid, MAX_VERTICES_PER_BYTE};
use crate::decoder::assemble::Extras;
use crate::entropy::range_coder::RangeEncoder;
use crate::mesh::surface::turns;
use crate::mesh::{TriMesh, has_three_vertices};
use crate::passes::attribute::Rows;
use crate::passes::float_values::Ladder;
use crate::passes::isolated_and_degenerate::{self, Loose};
use crate::passes::order::{self, Order};
use crate::passes::values::Elements;
use crate::passes::{GridMesh, exact};
use crate::util::morton::morton;
use bitvec::vec::BitVec;

/// Stitched vertices are never removed unless they are a larger share of all: the base would be too large.
const MOST_GLUED: f64 = 0.25;

/// The vertices of the surface that are never removed, so that they are stitched from the start and no level
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

/// The first corners of the triangles that name a vertex twice and are to be kept.
pub(super) fn loose_corners(mesh: &TriMesh, options: &EncodeOptions) -> Vec<u32> {
    let loose =
        (0..).zip(mesh.triangles()).filter(|(_, t)| options.keep_degenerate && !has_three_vertices(t));
    loose.map(|(face, _): (u32, _)| 3 * face).collect()
}

/// Puts these, and the corners of each, in an order that does not depend on that of the mesh.
pub(super) fn sort_loose_corners(
    corners: &mut [u32],
    mesh: &TriMesh,
    grid: &Grid,
    signatures: Option<&Signatures>,
) {
    let turn = |corner: u32| {
        let vertices = turns(corner).map(|c| mesh.triangles().as_flattened()[c as usize]);
        let cells = vertices.map(|v| grid.cell(mesh.positions()[v as usize]));
        (cells, signatures.map(|s| s.triangle(corner)))
    };
    for corner in corners.iter_mut() {
        *corner = turns(*corner).into_iter().min_by_key(|&turned| turn(turned)).unwrap_or(*corner);
    }
    corners.sort_by_cached_key(|&corner| turn(corner));
}

/// Puts isolated vertices in the order of their cells, ties by their coordinates and attributes.
pub(super) fn sort_loose(loose: &mut [u32], mesh: &TriMesh, grid: &Grid, signatures: Option<&Signatures>) {
    let at = |v: u32| mesh.positions()[v as usize];
    let signature = |v: u32| signatures.map(|s| s.vertices[v as usize]);
    loose.sort_by_cached_key(|&v| (morton(grid.cell(at(v))), at(v).map(f64::to_bits), signature(v), v));
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
    /// First corners of the triangles that are not part of the surface, in order.
    pub(super) loose_corners: &'a [u32],
    pub(super) values: ExactValues<'a>,
    pub(super) options: &'a EncodeOptions,
}

/// The surface as a decoder has it.
pub(super) struct Written<'a> {
    pub(super) mesh: &'a GridMesh,
    /// Vertex of the cut surface for each vertex.
    pub(super) vertex_source: &'a [u32],
    /// Triangle of the cut surface, and so of the ordered mesh, for each triangle.
    pub(super) face_source: &'a [u32],
    /// Of each attribute.
    pub(super) rows: Vec<&'a Rows>,
}

/// The corner of the triangle that `corner` is of where it has the vertex `first`.
fn turned_to(triangle: [u32; 3], corner: u32, first: u32) -> u32 {
    let place = triangle.iter().position(|&v| v == first);
    debug_assert!(place.is_some());
    corner / 3 * 3 + place.unwrap_or(0) as u32
}

impl Exact<'_> {
    /// Kinds and payloads of the chunks. `roots`: the stitching of the surface.
    pub(super) fn trailing(&self, surface: &Written, roots: Vec<u32>) -> Vec<(u8, Vec<u8>)> {
        if self.says_nothing() {
            return Vec::new();
        }
        let mut extras = Extras { roots, ..Extras::default() };
        let joined = extras.joined(surface.vertex_source.len());
        // Vertex of the mesh for each vertex of the joined one.
        let on_surface = joined.first.iter().map(|&v| {
            let cut = surface.vertex_source[v as usize];
            self.ordered.vertex_source[self.source[cut as usize] as usize]
        });
        let vertices: Vec<u32> = on_surface.chain(self.loose.iter().copied()).collect();
        let mut chunks = Vec::new();

        let (loose, loose_corners) = self.loose(&vertices);
        let num_joined = joined.first.len();
        if !loose.cells.is_empty() || !loose.faces.is_empty() {
            chunks.push((kind::LOOSE, self.write_loose(&loose, num_joined)));
            extras.loose = Some(loose);
        }
        if self.options.lossless {
            chunks.push((kind::EXACT, self.write_positions(&vertices)));
        }
        let triangles = &surface.mesh.surface.triangles;
        let on_surface = triangles.iter().zip(surface.face_source).map(|(t, &f)| {
            let corner = self.ordered.corner_source[f as usize];
            let first = vertices[joined.place[t[0] as usize] as usize];
            turned_to(self.mesh.triangles()[(corner / 3) as usize], corner, first)
        });
        let corners: Vec<u32> = on_surface.chain(loose_corners).collect();
        let list = &self.values.quantised.list;
        if !list.is_empty() {
            let elements: Vec<Elements> = list
                .iter()
                .zip(&surface.rows)
                .map(|(one, rows)| extras.elements(&joined, triangles, rows, one.declaration.domain))
                .collect();
            let sources = attributes::Elements { vertices: &vertices, corners: &corners };
            chunks.extend(self.values.payload(&elements, sources).map(|payload| (kind::VALUES, payload)));
        }
        if self.options.keep_order {
            let faces = extras.triangles(&joined, triangles);
            debug_assert_eq!(faces.len(), corners.len());
            chunks.push((kind::ORDER, write_order(&vertices, &faces, &corners)));
        }
        chunks
    }

    /// Whether the surface alone is all that is wanted.
    fn says_nothing(&self) -> bool {
        let has_loose = !self.loose.is_empty() || !self.loose_corners.is_empty();
        let EncodeOptions { lossless, keep_order, .. } = *self.options;
        !(has_loose || lossless || keep_order || !self.values.quantised.list.is_empty())
    }

    /// Isolated vertices and degenerate faces, and the corner of the mesh that is the first of each
    /// degenerate face.
    fn loose(&self, vertices: &[u32]) -> (Loose, Vec<u32>) {
        let cells = self.loose.iter().map(|&v| self.grid.cell(self.mesh.positions()[v as usize])).collect();
        let mut place = vec![0_u32; self.mesh.num_vertices()];
        vertices.iter().zip(0..).for_each(|(&v, i)| place[v as usize] = i);
        let vertex = |corner: u32| self.mesh.triangles().as_flattened()[corner as usize];
        let triangle = |corner: u32| turns(corner).map(|c| place[vertex(c) as usize]);
        let turned = |&corner: &u32| {
            let first = turns(corner).into_iter().min_by_key(|&c| triangle(c)).unwrap_or(corner);
            (triangle(first), first)
        };
        let mut faces: Vec<([u32; 3], u32)> = self.loose_corners.iter().map(turned).collect();
        faces.sort_by_key(|&(t, _)| t);
        let (faces, source) = faces.into_iter().unzip();
        (Loose { cells, faces }, source)
    }

    fn write_loose(&self, loose: &Loose, num_joined: usize) -> Vec<u8> {
        let mut coder = RangeEncoder::new();
        let counts = expect_sound(isolated_and_degenerate::code_counts(&mut coder, 0, Some(loose)));
        expect_sound(isolated_and_degenerate::code(
            &mut coder,
            self.grid.quantization_bits,
            num_joined,
            counts,
            Some(loose),
        ));
        padded(coder.finish(), counts[0] + counts[1], u64::from(MAX_VERTICES_PER_BYTE))
    }

    fn write_positions(&self, vertices: &[u32]) -> Vec<u8> {
        let at = |i: usize| self.mesh.positions()[vertices[i] as usize];
        let is_wide =
            (0..vertices.len()).any(|i| at(i).iter().any(|&x| f64::from(x as f32).to_bits() != x.to_bits()));
        let half = self.grid.half_step();
        let middle = |i: usize| self.grid.position(self.grid.cell(at(i)), self.grid.quantization_bits);
        let scales = [0, 1, 2].map(|axis| {
            let number = |i: usize| at(i)[axis];
            cheapest_scale(is_wide, vertices.len(), &number, &|i| [middle(i)[axis], half])
        });
        let ladders = scales.map(|scale| Ladder::new(is_wide, scale));
        let target = |i: usize| [0, 1, 2].map(|axis| (ladders[axis].key(at(i)[axis]), at(i)[axis]));
        let cells: Vec<[i32; 3]> = (0..vertices.len()).map(|i| self.grid.cell(at(i))).collect();
        let mut coder = RangeEncoder::new();
        expect_sound(exact::code(&mut coder, self.grid, ladders, &cells, Some(&target)));
        let mut payload = exact::write_ladders(is_wide, scales);
        payload.extend(coder.finish());
        payload
    }
}

/// `corners`: the corner of the mesh that is the first of each face.
fn write_order(vertices: &[u32], faces: &[[u32; 3]], corners: &[u32]) -> Vec<u8> {
    let mut order = Order { vertices: (0..vertices.len() as u32).collect(), corners: Vec::new() };
    order.vertices.sort_unstable_by_key(|&v| vertices[v as usize]);
    let mut by_file: Vec<u32> = (0..faces.len() as u32).collect();
    by_file.sort_unstable_by_key(|&f| corners[f as usize] / 3);
    order.corners = by_file.iter().map(|&f| 3 * f + (3 - corners[f as usize] % 3) % 3).collect();
    let mut coder = RangeEncoder::new();
    expect_sound(order::code(&mut coder, vertices.len(), faces, Some(&order)));
    coder.finish()
}
