//! Patches: what removed vertices leave behind, and their replacement by stars
//! (`format/SPEC.md`, section 7.3).

use super::Malformed;
use crate::mesh::Surface;
use crate::mesh::surface::{NO_CORNER, next, prev};

/// All patches of one level, in coding order. Patch `j` restores vertex `first_vertex + j`.
///
/// A patch is a polygon of `d` corners, triangulated by `d − 2` faces; an ear is the polygon of two
/// corners, without faces, along a boundary edge.
#[derive(Clone, Debug, Default)]
pub(crate) struct Patches {
    /// Per polygon edge, counter-clockwise: the corner inside the patch that faces it. For an ear
    /// the one corner that faces its boundary edge.
    edges: Vec<u32>,
    /// Per polygon edge: the vertex across it in the coarse mesh, or `NO_CORNER`.
    coarse_tips: Vec<u32>,
    /// Per patch: end of its edges.
    edge_ends: Vec<u32>,
    /// Faces of the patches, in the order they were grown.
    faces: Vec<u32>,
    face_ends: Vec<u32>,
    /// Per patch: the polygon edge that lies on the boundary of the refined mesh's hole, as an index
    /// into its edges; [`CLOSED`] for a vertex inside the surface.
    open_edges: Vec<u32>,
    num_ears: usize,
}

/// [`Patches::open_edge`] of a vertex that has triangles all around.
pub(crate) const CLOSED: u32 = u32::MAX;

impl Patches {
    pub(crate) fn len(&self) -> usize {
        self.edge_ends.len()
    }

    pub(crate) fn push_edge(&mut self, surface: &Surface, corner: u32) {
        self.edges.push(corner);
        let o = surface.across(corner);
        self.coarse_tips.push(if o == NO_CORNER { NO_CORNER } else { surface.vertex(o) });
    }

    pub(crate) fn push_face(&mut self, face: u32) {
        self.faces.push(face);
    }

    /// Edges and faces pushed since the last patch.
    pub(crate) fn unfinished(&self) -> (&[u32], &[u32]) {
        (&self.edges[self.edges_start(self.len())..], &self.faces[self.faces_start(self.len())..])
    }

    /// Makes a patch of the edges and faces pushed since the last one.
    pub(crate) fn finish(&mut self, open_edge: u32) {
        if self.faces_start(self.len()) == self.faces.len() {
            self.num_ears += 1;
        }
        self.edge_ends.push(self.edges.len() as u32);
        self.face_ends.push(self.faces.len() as u32);
        self.open_edges.push(open_edge);
    }

    /// Triangles that the vertices add: two each inside the surface, one at the boundary.
    pub(crate) fn num_new_faces(&self) -> usize {
        self.open_edges.iter().map(|&e| if e == CLOSED { 2 } else { 1 }).sum()
    }

    /// The faces of all patches, among the first `num_coarse`, as ascending ranges.
    pub(crate) fn rewritten_faces(&self, num_coarse: usize) -> Vec<std::ops::Range<u32>> {
        let mut is_rewritten = vec![false; num_coarse];
        self.faces.iter().for_each(|&f| is_rewritten[f as usize] = true);
        let mut ranges = Vec::new();
        let mut start = 0;
        for run in is_rewritten.chunk_by(|a, b| a == b) {
            let end = start + run.len() as u32;
            if run[0] {
                ranges.push(start..end);
            }
            start = end;
        }
        ranges
    }

    pub(crate) fn edges(&self, patch: usize) -> &[u32] {
        &self.edges[self.edges_start(patch)..self.edge_ends[patch] as usize]
    }

    pub(crate) fn coarse_tips(&self, patch: usize) -> &[u32] {
        &self.coarse_tips[self.edges_start(patch)..self.edge_ends[patch] as usize]
    }

    pub(crate) fn faces(&self, patch: usize) -> &[u32] {
        &self.faces[self.faces_start(patch)..self.face_ends[patch] as usize]
    }

    /// True if one of the ears, which come before all patches and by ascending corner, hangs on the
    /// edge that `corner` faces.
    pub(crate) fn has_ear(&self, corner: u32) -> bool {
        let ears = self.num_ears;
        self.edges[..ears].binary_search(&corner).is_ok()
    }

    pub(crate) fn open_edge(&self, patch: usize) -> u32 {
        self.open_edges[patch]
    }

    /// The polygon edge that becomes the first ring edge of the star.
    pub(crate) fn first_edge(&self, patch: usize) -> usize {
        if self.open_edge(patch) == CLOSED || self.faces(patch).is_empty() {
            0
        } else {
            self.open_edge(patch) as usize + 1
        }
    }

    fn edges_start(&self, patch: usize) -> usize {
        if patch == 0 { 0 } else { self.edge_ends[patch - 1] as usize }
    }

    fn faces_start(&self, patch: usize) -> usize {
        if patch == 0 { 0 } else { self.face_ends[patch - 1] as usize }
    }
}

/// The triangles around a vertex that was brought back.
#[derive(Default)]
pub(crate) struct Star {
    /// Neighbours, counter-clockwise; an open ring goes from boundary to boundary.
    pub(crate) ring: Vec<u32>,
    /// Triangle `i` is (ring[i], ring[i + 1], the vertex).
    pub(crate) faces: Vec<u32>,
    /// Corners across the ring edges, outside the star.
    pub(crate) outer: Vec<u32>,
}

/// Replaces patch after patch by the star of its vertex.
pub(crate) struct StarBuilder {
    star: Star,
    /// Patch that last met a vertex.
    met: Vec<u32>,
}

impl StarBuilder {
    pub(crate) fn new(num_coarse_vertices: usize) -> Self {
        Self { star: Star::default(), met: vec![u32::MAX; num_coarse_vertices] }
    }

    /// Rewrites the faces of patch `index` and appends those that are missing. Old faces keep their
    /// slots, the vertex is `surface.corner_of.len()`.
    ///
    /// # Errors
    /// If the polygon visits a vertex twice.
    pub(crate) fn restore(
        &mut self,
        surface: &mut Surface,
        patches: &Patches,
        index: usize,
    ) -> Result<&Star, Malformed> {
        self.read_polygon(surface, patches, index)?;
        let star = &mut self.star;
        let closed = patches.open_edge(index) == CLOSED;
        let vertex = surface.corner_of.len() as u32;
        let (faces, degree) = (patches.faces(index), star.ring.len());

        for &f in faces {
            for v in surface.triangles[f as usize] {
                surface.valence[v as usize] -= 1;
            }
        }
        // Edges − (faces − 1) diagonals + the new edge; an open ring loses the edge that closed it.
        let gained = if faces.is_empty() { 1 } else { 2 };
        star.ring.iter().for_each(|&v| surface.valence[v as usize] += gained);
        if !closed && degree > 2 {
            [0, degree - 1].iter().for_each(|&end| surface.valence[star.ring[end] as usize] -= 1);
        }

        star.faces.clear();
        star.faces.extend_from_slice(faces);
        let first_new = surface.triangles.len();
        let num_new = star.outer.len() - faces.len();
        star.faces.extend((first_new..first_new + num_new).map(|f| f as u32));
        surface.triangles.resize(first_new + num_new, [0; 3]);
        surface.opposite.resize(3 * (first_new + num_new), NO_CORNER);

        let (first, last) = (star.faces[0], star.faces[star.faces.len() - 1]);
        let (mut before, beyond_last) =
            if closed { (3 * last, 3 * first + 1) } else { (NO_CORNER, NO_CORNER) };
        for (i, (&f, &outer)) in star.faces.iter().zip(&star.outer).enumerate() {
            let (a, b) = (star.ring[i], *star.ring.get(i + 1).unwrap_or(&star.ring[0]));
            let after = star.faces.get(i + 1).map_or(beyond_last, |after| 3 * after + 1);
            surface.triangles[f as usize] = [a, b, vertex];
            surface.opposite[3 * f as usize..][..3].copy_from_slice(&[after, before, outer]);
            if outer != NO_CORNER {
                surface.opposite[outer as usize] = 3 * f + 2;
            }
            surface.corner_of[a as usize] = 3 * f;
            surface.corner_of[b as usize] = 3 * f + 1;
            before = 3 * f;
        }
        surface.corner_of.push(3 * first + 2);
        surface.valence.push(degree as u32);
        Ok(star)
    }

    /// Collects ring and outer corners before the faces are overwritten.
    fn read_polygon(&mut self, surface: &Surface, patches: &Patches, index: usize) -> Result<(), Malformed> {
        let edges = patches.edges(index);
        let star = &mut self.star;
        star.ring.clear();
        star.outer.clear();
        let open_edge = patches.open_edge(index);
        if patches.faces(index).is_empty() {
            // An ear's triangle lies beyond its boundary edge, so it runs the other way.
            star.ring.extend([surface.vertex(prev(edges[0])), surface.vertex(next(edges[0]))]);
            star.outer.push(edges[0]);
        } else {
            let first_edge = patches.first_edge(index) % edges.len();
            let (end, beginning) = edges.split_at(first_edge);
            for half in [beginning, end] {
                star.ring.extend(half.iter().map(|&corner| surface.vertex(next(corner))));
                star.outer.extend(half.iter().map(|&corner| surface.across(corner)));
            }
            if open_edge != CLOSED {
                star.outer.pop();
            }
        }
        for &v in &star.ring {
            let met = self.met.get_mut(v as usize).ok_or(Malformed("a patch touches a removed vertex"))?;
            if *met == index as u32 {
                return Err(Malformed("a patch meets a vertex twice"));
            }
            *met = index as u32;
        }
        Ok(())
    }
}
