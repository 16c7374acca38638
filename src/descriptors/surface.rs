//! A mesh made ready for the descriptors: adjacency, scaled positions, vertex normals.

use glam::DVec3;

use super::adjacency::{Adjacency, is_proper};
use super::scale::{exponent, times_power_of_two};
use crate::mesh::TriMesh;

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

/// The input of every descriptor.
pub(super) struct Surface<'a> {
    triangles: &'a [[u32; 3]],
    pub(super) adjacency: Adjacency,
    pub(super) vertices: Vec<Vertex>,
    /// 1 / l̄ in the units of the scaled positions.
    pub(super) unit: f64,
}

impl<'a> Surface<'a> {
    /// `None` if l̄ vanishes beside the coordinates, or there are no edges.
    pub(super) fn new(mesh: &'a TriMesh, mean_edge: f64) -> Option<Self> {
        let adjacency = Adjacency::new(mesh);
        let largest = largest_exponent(mesh, &adjacency)?;
        // l̄ goes to [1, 2), less if coordinates would overflow. Differences may still become infinite
        // when they are divided by l̄; the test of the radius discards those.
        let shift = (-exponent(mean_edge)).min(1000 - largest);
        let unit = times_power_of_two(mean_edge, shift).recip();
        if !unit.is_finite() {
            return None;
        }
        let mut surface = Self { triangles: mesh.triangles(), adjacency, vertices: Vec::new(), unit };
        surface.vertices = (mesh.positions().iter())
            .map(|p| Vertex { position: scaled(p, shift), normal: DVec3::ZERO })
            .collect();
        surface.set_normals();
        Some(surface)
    }

    pub(super) fn num_vertices(&self) -> usize {
        self.vertices.len()
    }

    /// Proper faces with the cross product of their edges, which is zero for a zero area.
    pub(super) fn faces(&self) -> impl Iterator<Item = (&'a [u32; 3], DVec3)> {
        self.triangles.iter().filter(|t| is_proper(t)).map(|t| {
            let [a, b, c] = t.map(|v| self.vertices[v as usize].position);
            (t, (b - a).cross(c - a))
        })
    }

    /// n̂: normalised sum of the cross products of the faces at a vertex (ours: area weighting).
    fn set_normals(&mut self) {
        let mut sums = vec![VectorSum::default(); self.num_vertices()];
        for (t, cross) in self.faces() {
            for &v in t {
                sums[v as usize].add(cross);
            }
        }
        for (vertex, sum) in self.vertices.iter_mut().zip(&sums) {
            vertex.normal = sum.direction();
        }
    }
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
    let adjacency = Adjacency::new(mesh);
    let Some(largest) = largest_exponent(mesh, &adjacency) else {
        return 0.0;
    };
    // Squares then overflow nowhere, and vanish only beside coordinates 2^1000 times larger.
    let shift = 500 - largest;
    let positions: Vec<DVec3> = mesh.positions().iter().map(|p| scaled(p, shift)).collect();
    let (mut sum, mut count) = (0.0, 0u64);
    for v in 0..adjacency.num_vertices() {
        for &u in adjacency.of(v).iter().filter(|&&u| u as usize > v) {
            sum += positions[v].distance(positions[u as usize]);
            count += 1;
        }
    }
    times_power_of_two(sum / count as f64, -shift).min(f64::MAX)
}

/// Exponent of the largest coordinate among the vertices with an edge, `None` without edges.
fn largest_exponent(mesh: &TriMesh, adjacency: &Adjacency) -> Option<i32> {
    (mesh.positions().iter().enumerate())
        .filter(|&(v, _)| !adjacency.of(v).is_empty())
        .map(|(_, p)| p.iter().fold(0.0, |largest: f64, c| largest.max(c.abs())))
        .reduce(f64::max)
        .map(exponent)
}

fn scaled(position: &[f64; 3], shift: i32) -> DVec3 {
    DVec3::from_array(position.map(|c| times_power_of_two(c, shift)))
}
