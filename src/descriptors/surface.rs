//! A mesh made ready for the descriptors: adjacency, scaled positions, vertex normals.

use glam::DVec3;
use rayon::prelude::*;

use super::adjacency::Adjacency;
use super::locality::morton_order;
use super::readings::NormalWeights;
use super::scale::{exponent, times_power_of_two};
use crate::mesh::{TriMesh, has_three_vertices};

/// A sum of vectors counts as zero when it is at most this part of the sum of their lengths.
const VANISHING: f64 = 1e-12;

/// What a window needs to know of a vertex.
#[derive(Clone, Copy, Default)]
pub(super) struct Vertex {
    /// Position times a power of two. Differences become units of l̄ by [`Surface::unit`].
    pub(super) position: DVec3,
    /// Unit normal n̂, or zero.
    pub(super) normal: DVec3,
}

/// The tables of surfaces with at least this many vertices are made one after the other: both at once take
/// too much memory.
const MANY_VERTICES: usize = 1 << 20;

/// The input of every descriptor. Vertices are renumbered so that neighbours are near in memory.
pub(super) struct Surface {
    /// The proper faces.
    triangles: Vec<[u32; 3]>,
    pub(super) adjacency: Adjacency,
    pub(super) vertices: Vec<Vertex>,
    /// Vertices of the mesh, in the order of `vertices`.
    mesh_vertices: Vec<u32>,
    /// 1 / l̄ in the units of the scaled positions.
    pub(super) unit: f64,
    /// The vertices that are to be evaluated, if not all.
    selected: Option<Vec<u32>>,
}

impl Surface {
    /// `None` if l̄ vanishes compared with the coordinates, or there are no edges.
    ///
    /// Vertices keep their order if they are `in_order`: those near each other in memory are so in space.
    pub(super) fn new(
        mesh: &TriMesh,
        mean_edge: f64,
        normals: NormalWeights,
        in_order: bool,
    ) -> Option<Self> {
        let mut triangles = proper_triangles(mesh);
        let (low, high) = bounding_box(mesh, &triangles)?;
        // l̄ goes to [1, 2), less if coordinates would overflow. Differences may still become infinite
        // when they are divided by l̄; the test of the radius discards those.
        let largest = exponent(low.abs().max(high.abs()).max_element());
        let shift = (-exponent(mean_edge)).min(1000 - largest);
        let unit = times_power_of_two(mean_edge, shift).recip();
        if !unit.is_finite() {
            return None;
        }

        let positions = scaled_positions(mesh, shift);
        let mesh_vertices = if in_order {
            (0..positions.len() as u32).collect()
        } else {
            let order = morton_order(&positions, scaled(low, shift), scaled(high, shift));
            let mut places = vec![0; order.len()];
            order.iter().zip(0..).for_each(|(&v, place)| places[v as usize] = place);
            triangles.par_iter_mut().for_each(|t| *t = t.map(|v| places[v as usize]));
            order
        };
        let mut vertices: Vec<Vertex> = (mesh_vertices.par_iter())
            .map(|&v| Vertex { position: positions[v as usize], normal: DVec3::ZERO })
            .collect();
        // What follows takes the most memory.
        drop(positions);
        let adjacent = || Adjacency::new(mesh_vertices.len(), &triangles);
        let adjacency = if vertices.len() < MANY_VERTICES {
            rayon::join(adjacent, || set_normals(&mut vertices, &triangles, normals)).0
        } else {
            set_normals(&mut vertices, &triangles, normals);
            adjacent()
        };
        Some(Self { triangles, adjacency, vertices, mesh_vertices, unit, selected: None })
    }

    pub(super) fn num_vertices(&self) -> usize {
        self.vertices.len()
    }

    /// The vertex of the mesh.
    pub(super) fn mesh_vertex(&self, vertex: u32) -> usize {
        self.mesh_vertices[vertex as usize] as usize
    }

    /// Evaluates only these vertices of the mesh from now on.
    pub(super) fn select(&mut self, places: &[u32]) {
        let mut vertex_of = vec![0; self.mesh_vertices.len()];
        self.mesh_vertices.iter().zip(0..).for_each(|(&place, v)| vertex_of[place as usize] = v);
        self.selected = Some(places.iter().map(|&place| vertex_of[place as usize]).collect());
    }

    pub(super) fn select_all(&mut self) {
        self.selected = None;
    }

    /// Number of vertices that are to be evaluated.
    pub(super) fn num_selected(&self) -> usize {
        self.selected.as_ref().map_or(self.num_vertices(), Vec::len)
    }

    /// One of them.
    pub(super) fn selected(&self, i: usize) -> usize {
        self.selected.as_ref().map_or(i, |selected| selected[i] as usize)
    }

    /// Puts one value per vertex back into the order of the mesh.
    pub(super) fn in_mesh_order(&self, values: &[f64]) -> Vec<f64> {
        let mut ordered = vec![0.0; values.len()];
        for (&v, &value) in self.mesh_vertices.iter().zip(values) {
            ordered[v as usize] = value;
        }
        ordered
    }

    /// Faces with the cross product of their edges, which is zero for a zero area.
    pub(super) fn faces(&self) -> impl Iterator<Item = (&[u32; 3], DVec3)> {
        self.triangles.iter().map(|t| (t, cross_product(&self.vertices, t)))
    }
}

fn cross_product(vertices: &[Vertex], triangle: &[u32; 3]) -> DVec3 {
    let [a, b, c] = triangle.map(|v| vertices[v as usize].position);
    (b - a).cross(c - a)
}

/// n̂: normalised sum of the cross products of the faces at a vertex (ours: area weighting by default).
fn set_normals(vertices: &mut [Vertex], triangles: &[[u32; 3]], weights: NormalWeights) {
    let mut sums = vec![VectorSum::default(); vertices.len()];
    for t in triangles {
        let cross = cross_product(vertices, t);
        for (i, &v) in t.iter().enumerate() {
            let term = match weights {
                NormalWeights::Area => cross,
                NormalWeights::Angle => cross.normalize_or_zero() * angle(vertices, t, i),
                NormalWeights::Uniform => cross.normalize_or_zero(),
            };
            sums[v as usize].add(term);
        }
    }
    for (vertex, sum) in vertices.iter_mut().zip(&sums) {
        vertex.normal = sum.direction();
    }
}

/// Angle of a triangle at its corner `i`, radians.
fn angle(vertices: &[Vertex], triangle: &[u32; 3], i: usize) -> f64 {
    let [a, b, c] = [0, 1, 2].map(|k| vertices[triangle[(i + k) % 3] as usize].position);
    (b - a).angle_between(c - a)
}

/// Sum of vectors that knows whether its terms cancelled.
#[derive(Clone, Copy, Default)]
pub(super) struct VectorSum {
    sum: DVec3,
    length_of_terms: f64,
}

impl VectorSum {
    #[inline]
    pub(super) fn add(&mut self, term: DVec3) {
        self.sum += term;
        self.length_of_terms += term.length();
    }

    /// The sum made a unit vector, or zero if the terms cancelled.
    pub(super) fn direction(&self) -> DVec3 {
        let length = self.sum.length();
        if length > VANISHING * self.length_of_terms && length.is_finite() {
            self.sum / length
        } else {
            DVec3::ZERO
        }
    }
}

/// See [`super::mean_edge_length`].
pub(super) fn mean_edge_length(mesh: &TriMesh) -> f64 {
    let triangles = proper_triangles(mesh);
    let Some((low, high)) = bounding_box(mesh, &triangles) else {
        return 0.0;
    };
    // Squares then overflow nowhere, and vanish only against coordinates 2^1000 times larger.
    let shift = 500 - exponent(low.abs().max(high.abs()).max_element());
    let positions = scaled_positions(mesh, shift);
    let adjacency = Adjacency::new(positions.len(), &triangles);
    let (mut sum, mut count) = (0.0, 0u64);
    for (v, &position) in positions.iter().enumerate() {
        for &u in adjacency.of(v).iter().flatten().filter(|&&u| u as usize > v) {
            sum += position.distance(positions[u as usize]);
            count += 1;
        }
    }
    times_power_of_two(sum / count as f64, -shift).min(f64::MAX)
}

/// The faces that name three different vertices.
fn proper_triangles(mesh: &TriMesh) -> Vec<[u32; 3]> {
    // Nearly all are: a vector that grows would take twice the room.
    let mut proper = Vec::with_capacity(mesh.num_triangles());
    proper.extend(mesh.triangles().iter().copied().filter(has_three_vertices));
    proper
}

/// Box around the corners of `triangles`, model units; `None` without triangles.
fn bounding_box(mesh: &TriMesh, triangles: &[[u32; 3]]) -> Option<(DVec3, DVec3)> {
    let mut corners = triangles.iter().flatten().map(|&v| DVec3::from_array(mesh.positions()[v as usize]));
    let first = corners.next()?;
    Some(corners.fold((first, first), |(low, high), p| (low.min(p), high.max(p))))
}

fn scaled_positions(mesh: &TriMesh, shift: i32) -> Vec<DVec3> {
    mesh.positions().par_iter().map(|&p| scaled(DVec3::from_array(p), shift)).collect()
}

fn scaled(p: DVec3, shift: i32) -> DVec3 {
    DVec3::from_array(p.to_array().map(|c| times_power_of_two(c, shift)))
}
