//! A surface from which vertices are taken, one star at a time.

use super::hubs::Hubs;
use crate::mesh::Surface;
use crate::mesh::surface::{NO_CORNER, next, prev};

/// Mark of a triangle slot that holds nothing.
pub(crate) const FREE: [u32; 3] = [u32::MAX; 3];

/// The faces around one vertex.
#[derive(Clone, Debug, Default)]
pub(crate) struct Star {
    pub(crate) vertex: u32,
    /// Corners at the vertex, counter-clockwise.
    pub(crate) corners: Vec<u32>,
    /// Neighbours; as many as corners if closed, else one more.
    pub(crate) ring: Vec<u32>,
}

impl Star {
    pub(crate) fn is_closed(&self) -> bool {
        self.ring.len() == self.corners.len()
    }

    pub(crate) fn degree(&self) -> usize {
        self.ring.len()
    }
}

/// Surface with slots that become free.
pub(crate) struct SurfaceEditor {
    pub(crate) surface: Surface,
    num_vertices: usize,
    num_faces: usize,
    /// For each vertex the bits of all neighbours that it has or had: a vertex not among them is not a
    /// neighbour.
    acquaintances: Vec<u32>,
    hubs: Hubs,
    /// Scratch: neighbours of the polygon corners and the corner across each polygon edge.
    after: Vec<usize>,
    before: Vec<usize>,
    outer: Vec<u32>,
    slots: Vec<u32>,
}

/// One of 32 bits that tell most vertices apart.
#[inline]
fn bit(vertex: u32) -> u32 {
    1 << (vertex.wrapping_mul(0x9e37_79b1) >> 27)
}

impl SurfaceEditor {
    pub(crate) fn new(surface: Surface) -> Self {
        let mut acquaintances = vec![0; surface.corner_of.len()];
        for &[a, b, c] in &surface.triangles {
            acquaintances[a as usize] |= bit(b) | bit(c);
            acquaintances[b as usize] |= bit(c) | bit(a);
            acquaintances[c as usize] |= bit(a) | bit(b);
        }
        Self {
            acquaintances,
            hubs: Hubs::new(&surface),
            num_vertices: surface.corner_of.len(),
            num_faces: surface.triangles.len(),
            surface,
            after: Vec::new(),
            before: Vec::new(),
            outer: Vec::new(),
            slots: Vec::new(),
        }
    }

    /// Forgets the neighbours that were; `ring_of` has the places of those that each vertex has now.
    pub(crate) fn forget<'a>(&mut self, vertices: &[u32], ring_of: impl Fn(u32) -> &'a [u32]) {
        for (&v, place) in vertices.iter().zip(0..) {
            let bits = ring_of(place).iter().map(|&u| bit(vertices[u as usize]));
            self.acquaintances[v as usize] = bits.fold(0, |all, bit| all | bit);
        }
    }

    /// Vertices still there.
    pub(crate) fn num_vertices(&self) -> usize {
        self.num_vertices
    }

    /// Triangles still there.
    pub(crate) fn num_faces(&self) -> usize {
        self.num_faces
    }

    pub(crate) fn contains(&self, vertex: u32) -> bool {
        self.surface.corner_of[vertex as usize] != NO_CORNER
    }

    pub(crate) fn read_star(&self, vertex: u32, star: &mut Star) {
        self.read_star_from(self.surface.corner_of[vertex as usize], star);
    }

    /// The star of the vertex at `corner`; a closed one starts there.
    pub(crate) fn read_star_from(&self, corner: u32, star: &mut Star) {
        star.vertex = self.surface.vertex(corner);
        let surface = &self.surface;
        let closed = surface.fan(corner, &mut star.corners);
        star.ring.clear();
        star.ring.extend(star.corners.iter().map(|&c| surface.vertex(next(c))));
        if !closed && let Some(&last) = star.corners.last() {
            star.ring.push(surface.vertex(prev(last)));
        }
    }

    /// Calls `see` with each neighbour, in any order, and whether it is an end of the ring. Returns whether there
    /// are no ends.
    #[inline]
    pub(crate) fn for_each_neighbour(&self, vertex: u32, mut see: impl FnMut(u32, bool)) -> bool {
        let s = &self.surface;
        let start = s.corner_of[vertex as usize];
        let mut corner = start;
        loop {
            let left = s.swing_left(corner);
            if left == NO_CORNER {
                see(s.vertex(prev(corner)), true);
                break;
            }
            see(s.vertex(prev(corner)), false);
            if left == start {
                return true;
            }
            corner = left;
        }
        let mut corner = start;
        loop {
            let right = s.swing_right(corner);
            see(s.vertex(next(corner)), right == NO_CORNER);
            if right == NO_CORNER {
                return false;
            }
            corner = right;
        }
    }

    /// True if an edge joins the two vertices.
    pub(crate) fn has_edge(&self, a: u32, b: u32) -> bool {
        if self.acquaintances[a as usize] & bit(b) == 0 || self.acquaintances[b as usize] & bit(a) == 0 {
            return false;
        }
        let s = &self.surface;
        if s.valence[a as usize].min(s.valence[b as usize]) > Hubs::MOST {
            return self.hubs.has_edge(a, b);
        }
        let (from, to) = if s.valence[a as usize] <= s.valence[b as usize] { (a, b) } else { (b, a) };
        let start = s.corner_of[from as usize];
        let mut corner = start;
        loop {
            if s.vertex(next(corner)) == to || s.vertex(prev(corner)) == to {
                return true;
            }
            corner = s.swing_left(corner);
            if corner == start {
                return false;
            }
            if corner == NO_CORNER {
                break;
            }
        }
        let mut corner = s.swing_right(start);
        while corner != NO_CORNER {
            if s.vertex(next(corner)) == to || s.vertex(prev(corner)) == to {
                return true;
            }
            corner = s.swing_right(corner);
        }
        false
    }

    /// Takes a vertex to the hubs if it has become one.
    fn see_hub(&mut self, vertex: u32) {
        if self.surface.valence[vertex as usize] > Hubs::MOST && !self.hubs.contains(vertex) {
            let mut neighbours = Vec::new();
            self.for_each_neighbour(vertex, |u, _| neighbours.push(u));
            self.hubs.add(vertex, &neighbours);
        }
    }

    /// Takes the vertex of `star` out and closes the hole by cutting ears: `ears[k]` is the ring
    /// index whose corner the k-th triangle cuts off; `degree − 2` of them. Returns the slots of the
    /// star's faces: the new triangles are in the first ones, in order.
    pub(crate) fn remove(&mut self, star: &Star, ears: &[usize]) -> &[u32] {
        let degree = star.degree();
        debug_assert_eq!(ears.len(), degree - 2);
        let surface = &mut self.surface;
        self.slots.clear();
        self.slots.extend(star.corners.iter().map(|&c| c / 3));
        self.outer.clear();
        self.outer.extend(star.corners.iter().map(|&c| surface.across(c)));
        if !star.is_closed() {
            self.outer.push(NO_CORNER);
        }
        for &slot in &self.slots {
            surface.triangles[slot as usize] = FREE;
            surface.opposite[3 * slot as usize..3 * slot as usize + 3].fill(NO_CORNER);
        }
        let closes_new_edge = !star.is_closed() && degree > 2;
        if closes_new_edge {
            let (first, last) = (star.ring[0], star.ring[degree - 1]);
            self.acquaintances[first as usize] |= bit(last);
            self.acquaintances[last as usize] |= bit(first);
            self.hubs.join(first, last);
        }
        for (i, &v) in star.ring.iter().enumerate() {
            let is_end = i == 0 || i == degree - 1;
            surface.valence[v as usize] -= u32::from(!(closes_new_edge && is_end));
        }

        self.after.clear();
        self.after.extend((0..degree).map(|i| if i + 1 == degree { 0 } else { i + 1 }));
        self.before.clear();
        self.before.extend((0..degree).map(|i| if i == 0 { degree - 1 } else { i - 1 }));
        for (k, &ear) in ears.iter().enumerate() {
            let (p, n) = (self.before[ear], self.after[ear]);
            let base = 3 * self.slots[k];
            surface.triangles[self.slots[k] as usize] = [star.ring[p], star.ring[ear], star.ring[n]];
            for (j, &i) in [p, ear, n].iter().enumerate() {
                surface.corner_of[star.ring[i] as usize] = base + j as u32;
            }
            // Corner 2 (at n) faces the edge p → ear, corner 0 (at p) faces ear → n.
            surface.link(base + 2, self.outer[p]);
            surface.link(base, self.outer[ear]);
            if k + 1 == ears.len() {
                surface.link(base + 1, self.outer[n]);
            } else {
                for (i, j) in [(p, n), (n, p)] {
                    surface.valence[star.ring[i] as usize] += 1;
                    self.acquaintances[star.ring[i] as usize] |= bit(star.ring[j]);
                }
                self.hubs.join(star.ring[p], star.ring[n]);
                self.outer[p] = base + 1;
                self.after[p] = n;
                self.before[n] = p;
            }
        }
        if ears.is_empty() {
            // An ear of the boundary: its edge is the boundary now.
            let o = self.outer[0];
            surface.opposite[o as usize] = NO_CORNER;
            for c in [next(o), prev(o)] {
                let v = surface.vertex(c) as usize;
                surface.corner_of[v] = c;
            }
        }
        surface.corner_of[star.vertex as usize] = NO_CORNER;
        self.num_vertices -= 1;
        self.num_faces -= star.corners.len() - ears.len();
        star.ring.iter().for_each(|&v| self.see_hub(v));
        &self.slots
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rebuilds adjacency from the triangles that are left and compares.
    fn check(shrinking: &SurfaceEditor) {
        let mut name = vec![u32::MAX; shrinking.surface.corner_of.len()];
        let mut count = 0;
        for (v, n) in name.iter_mut().enumerate() {
            if shrinking.contains(v as u32) {
                *n = count;
                count += 1;
            }
        }
        let left: Vec<[u32; 3]> = shrinking
            .surface
            .triangles
            .iter()
            .filter(|&&t| t != FREE)
            .map(|t| t.map(|v| name[v as usize]))
            .collect();
        assert_eq!((left.len(), count as usize), (shrinking.num_faces(), shrinking.num_vertices()));
        for &[a, b, c] in shrinking.surface.triangles.iter().filter(|&&t| t != FREE) {
            assert!(shrinking.has_edge(a, b) && shrinking.has_edge(b, c) && shrinking.has_edge(c, a));
        }
        let rebuilt = Surface::from_triangles(left, count as usize).unwrap();
        for (v, &n) in name.iter().enumerate() {
            if n != u32::MAX {
                assert_eq!(shrinking.surface.valence[v], rebuilt.valence[n as usize], "valence of {v}");
                let (mut a, mut b) = (Star::default(), Star::default());
                shrinking.read_star(v as u32, &mut a);
                SurfaceEditor::new(rebuilt.clone()).read_star(n, &mut b);
                assert_eq!((a.is_closed(), a.degree()), (b.is_closed(), b.degree()));
            }
        }
    }

    #[test]
    fn removal_leaves_a_surface() {
        let n = 6;
        let at = |i: u32, j: u32| i * n + j;
        let triangles: Vec<[u32; 3]> = (0..n - 1)
            .flat_map(|i| (0..n - 1).map(move |j| (i, j)))
            .flat_map(|(i, j)| {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                [[a, b, c], [a, c, d]]
            })
            .collect();
        let surface = Surface::from_triangles(triangles, (n * n) as usize).unwrap();
        let mut shrinking = SurfaceEditor::new(surface);
        let mut star = Star::default();
        // Inside, on an edge, and at a corner of valence two.
        for (vertex, ears) in [(at(2, 2), vec![1, 2, 3, 4]), (at(0, 3), vec![1, 2]), (at(0, 5), vec![])] {
            shrinking.read_star(vertex, &mut star);
            let ears: Vec<usize> = ears.into_iter().take(star.degree() - 2).collect();
            shrinking.remove(&star, &ears);
            check(&shrinking);
            assert!(!shrinking.contains(vertex));
        }
    }

    #[test]
    fn hubs_know_the_edges_between_them() {
        // Two hubs over a rim: they become neighbours when a vertex of the rim goes, by the diagonal between them.
        let n = 2 * Hubs::MOST;
        let rim = |i: u32| 2 + i % n;
        let triangles = (0..n).flat_map(|i| [[0, rim(i), rim(i + 1)], [1, rim(i + 1), rim(i)]]).collect();
        let surface = Surface::from_triangles(triangles, 2 + n as usize).unwrap();
        let mut shrinking = SurfaceEditor::new(surface);
        assert!(!shrinking.has_edge(0, 1));
        let mut star = Star::default();
        shrinking.read_star(5, &mut star);
        let beside_hub = star.ring.iter().position(|&v| v > 1).unwrap();
        shrinking.remove(&star, &[beside_hub, (beside_hub + 2) % 4]);
        assert!(shrinking.has_edge(0, 1) && shrinking.has_edge(1, 0));
        check(&shrinking);
    }

    #[test]
    fn a_vertex_becomes_a_hub() {
        // Two strips of hubs to be: each vertex between them goes into the first of its row.
        let n = Hubs::MOST + 20;
        let rim = |i: u32| 2 + i % n;
        let triangles: Vec<[u32; 3]> =
            (0..n).flat_map(|i| [[0, rim(i), rim(i + 1)], [1, rim(i + 1), rim(i)]]).collect();
        let surface = Surface::from_triangles(triangles, 2 + n as usize).unwrap();
        let mut shrinking = SurfaceEditor::new(surface);
        // Hub 1 goes into vertex 2, which then has all others of the rim as neighbours, and hub 0.
        let mut star = Star::default();
        shrinking.read_star(1, &mut star);
        let target = star.ring.iter().position(|&v| v == 2).unwrap();
        let degree = star.degree();
        let ears: Vec<usize> = (1..degree - 1).map(|i| (target + i) % degree).collect();
        shrinking.remove(&star, &ears);
        assert!(shrinking.surface.valence[2] > Hubs::MOST && shrinking.has_edge(0, 2));
        check(&shrinking);
    }
}
