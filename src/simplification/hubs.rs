//! Vertices with too many neighbours to look through: the edges between two of them are kept in a table.

use crate::mesh::Surface;
use rustc_hash::FxHashSet;

/// Those that are or were such vertices of a surface that shrinks.
pub(super) struct Hubs {
    vertices: FxHashSet<u32>,
    /// Edges between them, the smaller vertex first. They go with their vertices, after which nobody asks.
    edges: FxHashSet<[u32; 2]>,
}

impl Hubs {
    /// Vertices with more neighbours are hubs.
    pub(super) const MOST: u32 = 64;

    pub(super) fn new(surface: &Surface) -> Self {
        let valences = (0..).zip(&surface.valence);
        let vertices: FxHashSet<u32> =
            valences.filter(|&(_, &valence)| valence > Self::MOST).map(|(v, _)| v).collect();
        let mut hubs = Self { vertices, edges: FxHashSet::default() };
        if !hubs.vertices.is_empty() {
            for &[a, b, c] in &surface.triangles {
                [[a, b], [b, c], [c, a]].into_iter().for_each(|[v, w]| hubs.join(v, w));
            }
        }
        hubs
    }

    pub(super) fn contains(&self, vertex: u32) -> bool {
        self.vertices.contains(&vertex)
    }

    /// Another vertex is a hub now.
    pub(super) fn add(&mut self, vertex: u32, neighbours: &[u32]) {
        self.vertices.insert(vertex);
        neighbours.iter().for_each(|&v| self.join(vertex, v));
    }

    /// There is an edge between two vertices now.
    pub(super) fn join(&mut self, v: u32, w: u32) {
        if !self.vertices.is_empty() && self.contains(v) && self.contains(w) {
            self.edges.insert([v.min(w), v.max(w)]);
        }
    }

    /// Whether there is an edge between two hubs.
    pub(super) fn has_edge(&self, v: u32, w: u32) -> bool {
        self.edges.contains(&[v.min(w), v.max(w)])
    }
}
