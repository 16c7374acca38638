//! Entries that are known around an entry that is coded now.

use super::entries::Entries;
use crate::mesh::surface::{NO_CORNER, next, prev};
use crate::mesh::{NO_ENTRY, Surface};
use crate::passes::GridMesh;
use crate::util::simd4::Lanes;

/// A entry and its displacement from the position of the entry that is coded.
#[derive(Clone, Copy, Debug)]
pub(super) struct Known {
    pub(super) entry: u32,
    pub(super) way: Lanes,
}

/// The neighbours of a vertex, a wedge or a face.
#[derive(Default)]
pub(super) struct Around {
    /// Across one edge each, counter-clockwise.
    pub(super) ring: Vec<Known>,
    /// Beyond the edges of the ring, where no seam is between.
    pub(super) tips: Vec<Known>,
    /// Entries of the triangles outside: both ends of the edge, the tip.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Neighbours that have no value.
    pub(super) num_missing: usize,
    /// Area vector of the triangles that the entry belongs to.
    pub(super) normal: Lanes,
    /// Whether these go all the way round the vertex.
    pub(super) is_closed: bool,
}

impl Around {
    fn clear(&mut self) {
        self.ring.clear();
        self.tips.clear();
        self.triangles.clear();
        self.num_missing = 0;
        self.normal = Lanes::ZERO;
        self.is_closed = false;
    }

    /// Forgets all but the face that the entry belongs to.
    pub(super) fn begin_at(&mut self, mesh: &GridMesh, face: u32) {
        self.clear();
        let [a, b, c] = mesh.surface.triangles[face as usize].map(|v| mesh.positions[v as usize]);
        self.normal = Lanes::between(a, b).cross(Lanes::between(a, c));
    }

    /// Adds a neighbour unless it has no value.
    pub(super) fn push(&mut self, entry: u32, way: Lanes) {
        if entry == NO_ENTRY {
            self.num_missing += 1;
        } else {
            self.ring.push(Known { entry, way });
        }
    }

    /// Looks around `vertex` from the wedge of `corners`, which follow each other counter-clockwise; known
    /// is what belongs to vertices before it.
    pub(super) fn gather(
        &mut self,
        mesh: &GridMesh,
        entries: &Entries,
        vertex: u32,
        corners: &[u32],
        closed: bool,
    ) {
        self.clear();
        self.is_closed = closed;
        let surface = &mesh.surface;
        let origin = mesh.positions[vertex as usize];
        let way = |v: u32| Lanes::between(origin, mesh.positions[v as usize]);
        let mut last = (u32::MAX, NO_ENTRY);
        let mut first = last;
        for (i, &corner) in corners.iter().enumerate() {
            let ends = [next(corner), prev(corner)];
            let [a, b] = ends.map(|c| surface.vertex(c));
            self.normal += way(a).cross(way(b));
            for (c, u) in [(ends[0], a), (ends[1], b)] {
                let seen = (u, if u < vertex { entries.at(surface, c) } else { NO_ENTRY });
                let is_first_again = closed && i + 1 == corners.len() && c == ends[1] && seen == first;
                if u < vertex && seen != last && !is_first_again {
                    self.push(seen.1, way(u));
                }
                last = seen;
                if i == 0 && c == ends[0] {
                    first = seen;
                }
            }
            if a < vertex && b < vertex {
                self.look_across(mesh, entries, vertex, corner);
            }
        }
    }

    fn look_across(&mut self, mesh: &GridMesh, entries: &Entries, vertex: u32, corner: u32) {
        let surface: &Surface = &mesh.surface;
        let across = surface.across(corner);
        if across == NO_CORNER || surface.vertex(across) >= vertex {
            return;
        }
        let at = |c: u32| entries.at(surface, c);
        let (a, b, tip) = (at(next(corner)), at(prev(corner)), at(across));
        let is_seam = at(prev(across)) != a || at(next(across)) != b;
        if is_seam || [a, b, tip].contains(&NO_ENTRY) {
            return;
        }
        let [origin, there] = [vertex, surface.vertex(across)].map(|v| mesh.positions[v as usize]);
        self.tips.push(Known { entry: tip, way: Lanes::between(origin, there) });
        self.triangles.push([a, b, tip]);
    }
}
