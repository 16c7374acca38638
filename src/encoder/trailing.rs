//! What follows the last pass: everything about the mesh that the surface on the grid does not contain.

use super::attributes::{self, Quantized};
use super::grid_surface::GridSurface;
use super::number_format::cheapest_scale;
use super::options::{EncodeOptions, Input};
use super::payload::{expect_sound, padded};
use super::values::ExactValues;
use crate::bitstream::chunk::kind;
use crate::bitstream::header::MAX_VERTICES_PER_BYTE;
use crate::decoder::assemble::{Extras, Joined};
use crate::entropy::range_coder::RangeEncoder;
use crate::mesh::surface::turns;
use crate::passes::attribute::Entries;
use crate::passes::float_values::Ladder;
use crate::passes::isolated_and_degenerate::{self, Loose};
use crate::passes::order::{self, Order};
use crate::passes::values::Elements;
use crate::passes::{GridMesh, exact};

/// A mesh, and how its surface was made of it.
#[derive(Clone, Copy)]
pub(super) struct Original<'a> {
    pub(super) input: Input<'a>,
    pub(super) on_grid: &'a GridSurface,
    pub(super) quantized: &'a Quantized,
}

/// The surface as a decoder has it.
pub(super) struct Written<'a> {
    pub(super) mesh: &'a GridMesh,
    /// Vertex of the cut surface for each vertex.
    pub(super) vertex_source: &'a [u32],
    /// Triangle of the cut surface, and so of the ordered mesh, for each triangle.
    pub(super) face_source: &'a [u32],
    /// Of each attribute.
    pub(super) entries: Vec<&'a Entries>,
}

/// The corner of the triangle that `corner` is of where it has the vertex `first`.
fn turned_to(triangle: [u32; 3], corner: u32, first: u32) -> u32 {
    let place = triangle.iter().position(|&v| v == first);
    debug_assert!(place.is_some());
    corner / 3 * 3 + place.unwrap_or(0) as u32
}

impl Original<'_> {
    /// Kinds and payloads of the chunks. `roots`: for each vertex of the cut surface, the first copy of it.
    pub(super) fn trailing(&self, surface: &Written, roots: Vec<u32>) -> Vec<(u8, Vec<u8>)> {
        if self.says_nothing() {
            return Vec::new();
        }
        let options = self.input.options;
        let mut extras = Extras { roots, ..Extras::default() };
        let joined = extras.joined(surface.vertex_source.len());
        let vertices = self.vertices(surface, &joined);
        let mut chunks = Vec::new();
        let (loose, loose_corners) = self.loose(&vertices);
        let num_joined = joined.first.len();
        if !loose.cells.is_empty() || !loose.faces.is_empty() {
            chunks.push((kind::LOOSE, self.write_loose(&loose, num_joined)));
            extras.loose = Some(loose);
        }
        if options.lossless {
            chunks.push((kind::EXACT, self.write_positions(&vertices)));
        }
        let triangles = &surface.mesh.surface.triangles;
        let mut corners = self.corners(surface, &joined, &vertices);
        corners.extend(loose_corners);
        let of_mesh = attributes::Elements { vertices: &vertices, corners: &corners };
        let values = self.write_values(surface, &extras, &joined, of_mesh);
        chunks.extend(values.map(|payload| (kind::VALUES, payload)));
        if options.keep_order {
            let faces = extras.triangles(&joined, triangles);
            debug_assert_eq!(faces.len(), corners.len());
            chunks.push((kind::ORDER, write_order(&vertices, &faces, &corners)));
        }
        chunks
    }

    /// Whether the surface alone is all that is wanted.
    fn says_nothing(&self) -> bool {
        let has_loose = self.on_grid.loose.len() > 0;
        let EncodeOptions { lossless, keep_order, .. } = *self.input.options;
        !(has_loose || lossless || keep_order || !self.quantized.list.is_empty())
    }

    /// Vertex of the mesh for each vertex of the joined surface, then for each one that is loose.
    fn vertices(&self, surface: &Written, joined: &Joined) -> Vec<u32> {
        let GridSurface { ordered, source, loose, .. } = self.on_grid;
        let on_surface = joined.first.iter().map(|&v| {
            let cut = surface.vertex_source[v as usize];
            ordered.vertex_source[source[cut as usize] as usize]
        });
        on_surface.chain(loose.vertices.iter().copied()).collect()
    }

    /// The corner of the mesh that is the first of each triangle of the surface.
    fn corners(&self, surface: &Written, joined: &Joined, vertices: &[u32]) -> Vec<u32> {
        let triangles = surface.mesh.surface.triangles.iter();
        let first_corner = |(t, &f): (&[u32; 3], &u32)| {
            let corner = self.on_grid.ordered.corner_source[f as usize];
            let first = vertices[joined.place[t[0] as usize] as usize];
            turned_to(self.input.mesh.triangles()[(corner / 3) as usize], corner, first)
        };
        triangles.zip(surface.face_source).map(first_corner).collect()
    }

    /// Isolated vertices and degenerate faces, and the corner of the mesh that is the first of each
    /// degenerate face.
    fn loose(&self, vertices: &[u32]) -> (Loose, Vec<u32>) {
        let (GridSurface { grid, loose, .. }, mesh) = (self.on_grid, self.input.mesh);
        let cells = loose.vertices.iter().map(|&v| grid.cell(mesh.positions()[v as usize])).collect();
        let mut place = vec![0_u32; mesh.num_vertices()];
        vertices.iter().zip(0..).for_each(|(&v, i)| place[v as usize] = i);
        let vertex = |corner: u32| mesh.triangles().as_flattened()[corner as usize];
        let triangle = |corner: u32| turns(corner).map(|c| place[vertex(c) as usize]);
        let turned = |&corner: &u32| {
            let first = turns(corner).into_iter().min_by_key(|&c| triangle(c)).unwrap_or(corner);
            (triangle(first), first)
        };
        let mut faces: Vec<([u32; 3], u32)> = loose.corners.iter().map(turned).collect();
        faces.sort_by_key(|&(t, _)| t);
        let (faces, source) = faces.into_iter().unzip();
        (Loose { cells, faces }, source)
    }

    fn write_loose(&self, loose: &Loose, num_joined: usize) -> Vec<u8> {
        let mut coder = RangeEncoder::new();
        let counts = expect_sound(isolated_and_degenerate::code_counts(&mut coder, 0, Some(loose)));
        expect_sound(isolated_and_degenerate::code(
            &mut coder,
            self.on_grid.grid.quantization_bits,
            num_joined,
            counts,
            Some(loose),
        ));
        padded(coder.finish(), counts[0] + counts[1], u64::from(MAX_VERTICES_PER_BYTE))
    }

    /// The exact values of all attributes, if there are any. `of_mesh`: vertices and corners of the mesh.
    fn write_values(
        &self,
        surface: &Written,
        extras: &Extras,
        joined: &Joined,
        of_mesh: attributes::Elements,
    ) -> Option<Vec<u8>> {
        let (list, triangles) = (&self.quantized.list, &surface.mesh.surface.triangles);
        if list.is_empty() {
            return None;
        }
        let domains = list.iter().map(|one| one.declaration.domain);
        let elements =
            domains.zip(&surface.entries).map(|(d, entries)| extras.elements(joined, triangles, entries, d));
        let elements: Vec<Elements> = elements.collect();
        let Input { attributes, options, .. } = self.input;
        let values = ExactValues { attributes, quantized: self.quantized, is_lossless: options.lossless };
        values.payload(&elements, of_mesh)
    }

    fn write_positions(&self, vertices: &[u32]) -> Vec<u8> {
        let grid = &self.on_grid.grid;
        let at = |i: usize| self.input.mesh.positions()[vertices[i] as usize];
        let is_wide =
            (0..vertices.len()).any(|i| at(i).iter().any(|&x| f64::from(x as f32).to_bits() != x.to_bits()));
        let half = grid.half_step();
        let middle = |i: usize| grid.position(grid.cell(at(i)), grid.quantization_bits);
        let scales = [0, 1, 2].map(|axis| {
            let number = |i: usize| at(i)[axis];
            cheapest_scale(is_wide, vertices.len(), &number, &|i| [middle(i)[axis], half[axis]])
        });
        let ladders = scales.map(|scale| Ladder::new(is_wide, scale));
        let target = |i: usize| [0, 1, 2].map(|axis| (ladders[axis].key(at(i)[axis]), at(i)[axis]));
        let cells: Vec<[i32; 3]> = (0..vertices.len()).map(|i| grid.cell(at(i))).collect();
        let mut coder = RangeEncoder::new();
        expect_sound(exact::code(&mut coder, grid, ladders, &cells, Some(&target)));
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
