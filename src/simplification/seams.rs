//! Seams while a surface shrinks: where corners at a vertex, or faces at an edge, have different entries of an attribute.
//!
//! A decoder that restores a vertex gives each triangle of its star what the patch had at the same edge of
//! the hole. That is right without a further bit if a seam that runs through the vertex, in along one spoke
//! and out along another, becomes the diagonal between their ends:
//!
//! ```text
//!      · ───── a            · ───── a
//!    /   \   ‖   \        /      ‖ ‖  \
//!   · ─── v ─── ·   →    ·     ‖  ‖    ·
//!    \   ‖   /   /        \  ‖    ‖   /
//!      u ────── ·           u ────── ·
//! ```
//!
//! Vertices where seams end or meet had better stay. They need not: what is not right is said triangle by triangle.

use super::{LevelRecord, Star, SurfaceEditor};
use crate::mesh::Domain;
use crate::mesh::surface::{next, prev};

/// The ends of a diagonal, as places in the ring.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Diagonal {
    from: usize,
    to: usize,
    degree: usize,
}

impl Diagonal {
    pub(crate) fn new([from, to]: [usize; 2], degree: usize) -> Self {
        Self { from, to, degree }
    }

    pub(crate) fn ends(self) -> [usize; 2] {
        [self.from, self.to]
    }

    /// Steps around the ring from one place to another.
    fn way(self, from: usize, to: usize) -> usize {
        (to + self.degree - from) % self.degree
    }

    /// Whether a triangle over three places lies on one side.
    pub(crate) fn allows(self, places: [usize; 3]) -> bool {
        let span = self.way(self.from, self.to);
        let is_left = |&i: &usize| self.way(self.from, i) <= span;
        let is_right = |&i: &usize| i == self.from || self.way(self.from, i) >= span;
        places.iter().all(is_left) || places.iter().all(is_right)
    }
}

/// What seams want of the hole that a vertex leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Demand {
    /// Nothing.
    None,
    /// A seam goes through: it should go on.
    Diagonal(Diagonal),
    /// Seams end or meet. Nothing has to be said triangle by triangle if no place of this set, all of the ring's
    /// `degree`, is cut off; but the triangles in the middle span what the seams part.
    Uncut { places: u64, degree: usize },
    /// The vertex has to stay.
    Stay,
}

impl Demand {
    /// Whether a triangle over three places, the middle one of which is cut off, may be part of the hole.
    pub(crate) fn allows(self, [before, ear, after]: [usize; 3]) -> bool {
        match self {
            Demand::None => true,
            Demand::Diagonal(diagonal) => diagonal.allows([before, ear, after]),
            Demand::Uncut { places, degree } => {
                [[before, ear, after], [ear, after, before], [after, before, ear]]
                    .into_iter()
                    .all(|[x, y, z]| places >> y & 1 == 0 || (x + 1) % degree != y || (y + 1) % degree != z)
            }
            Demand::Stay => false,
        }
    }
}

/// How firmly seams are kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd)]
enum Grip {
    /// Where they end or meet, vertices stay.
    #[default]
    Firm,
    /// Those may go that leave nothing to say triangle by triangle.
    Loose,
    /// All may.
    None,
}

/// Entries of one attribute, by the slots of a surface.
struct Track {
    domain: Domain,
    /// Per corner, or per face.
    of: Vec<u32>,
}

/// All attributes of corners and faces.
#[derive(Default)]
pub(crate) struct Seams {
    tracks: Vec<Track>,
    grip: Grip,
    left: Vec<u32>,
    right: Vec<u32>,
}

impl Seams {
    /// Follows one more attribute: the entry of each corner or face.
    pub(crate) fn follow(&mut self, domain: Domain, of: Vec<u32>) {
        self.tracks.push(Track { domain, of });
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.tracks.is_empty()
    }

    /// Whether there are vertices that have to stay.
    pub(crate) fn hold(&self) -> bool {
        self.grip < Grip::None && !self.is_empty()
    }

    pub(crate) fn loosen(&mut self) {
        self.grip = if self.grip == Grip::Firm { Grip::Loose } else { Grip::None };
    }

    /// The entry of each corner or face of an attribute.
    pub(crate) fn entries(&self, attribute: usize) -> &[u32] {
        &self.tracks[attribute].of
    }

    /// Places of the ring to which seams run from the vertex of a star; those that count are below 64.
    fn spokes(&self, star: &Star) -> u64 {
        let n = star.corners.len();
        let first = usize::from(!star.is_closed());
        let is_seam = |&i: &usize| {
            let (before, after) = (star.corners[(i + n - 1) % n], star.corners[i]);
            self.tracks.iter().any(|track| {
                let differ = |a: u32, b: u32| track.of[a as usize] != track.of[b as usize];
                match track.domain {
                    Domain::Vertex => false,
                    Domain::Corner => differ(prev(before), next(after)) || differ(before, after),
                    Domain::Triangle => differ(before / 3, after / 3),
                }
            })
        };
        (first..n.min(64)).filter(is_seam).fold(0, |places, i| places | 1 << i)
    }

    /// What the seams at the star of a vertex want most.
    pub(crate) fn demand(&self, star: &Star) -> Demand {
        let places = if self.is_empty() { 0 } else { self.spokes(star) };
        if places == 0 {
            return Demand::None;
        }
        let (from, to) = (places.trailing_zeros() as usize, 63 - places.leading_zeros() as usize);
        let degree = star.degree();
        if places.count_ones() == 2 && star.is_closed() && to - from > 1 && from + degree - to > 1 {
            return Demand::Diagonal(Diagonal::new([from, to], degree));
        }
        self.demand_at(places, degree)
    }

    /// What they are content with if there is no such hole.
    pub(crate) fn demand_less(&self, star: &Star) -> Demand {
        self.demand_at(self.spokes(star), star.degree())
    }

    fn demand_at(&self, places: u64, degree: usize) -> Demand {
        let demand = Demand::Uncut { places, degree };
        // Each hole has two triangles that cut a corner off, which are not next to each other.
        let is_free = |i: usize| places >> i & 1 == 0;
        let can_be = (4..64).contains(&degree)
            && (0..degree).any(|i| is_free(i) && (i + 2..degree).any(|j| is_free(j) && j + 1 < i + degree));
        match self.grip {
            Grip::Firm => Demand::Stay,
            _ if can_be => demand,
            Grip::Loose => Demand::Stay,
            Grip::None => Demand::None,
        }
    }

    /// The vertex of `star` has gone: notes in `record` what its faces had, and gives entries to the triangles of the
    /// hole, which are in the star's first faces. `ears` as in [`SurfaceEditor::remove`].
    pub(crate) fn remove(&mut self, star: &Star, ears: &[usize], record: &mut LevelRecord) {
        if self.is_empty() {
            return;
        }
        let diagonal = match self.demand(star) {
            Demand::Diagonal(diagonal) => Some(diagonal),
            _ => None,
        };
        let triangles = triangles_of(star.degree(), ears);
        for (attribute, track) in self.tracks.iter_mut().enumerate() {
            let of = &mut track.of;
            match track.domain {
                Domain::Vertex => {}
                Domain::Corner => {
                    let at = |c: u32| of[c as usize];
                    let entries = star.corners.iter().flat_map(|&c| [next(c), prev(c), c].map(at));
                    record.push_entries(attribute, entries);
                    // On both sides of each spoke, at its far end.
                    let degree = star.degree();
                    (self.left, self.right) = (vec![0; degree], vec![0; degree]);
                    for (i, &c) in star.corners.iter().enumerate() {
                        self.left[i] = at(next(c));
                        self.right[(i + 1) % degree] = at(prev(c));
                    }
                    if !star.is_closed() {
                        self.right[0] = self.left[0];
                        self.left[degree - 1] = self.right[degree - 1];
                    }
                    for (k, places) in triangles.iter().enumerate() {
                        let first = 3 * (star.corners[k] / 3) as usize;
                        for j in 0..3 {
                            let [x, y, z] = [0, 1, 2].map(|i| places[(j + i) % 3]);
                            let is_left = is_left_of(x, y, z, degree, diagonal);
                            of[first + j] = if is_left { self.left[x] } else { self.right[x] };
                        }
                    }
                }
                Domain::Triangle => {
                    let at = |c: u32| of[c as usize / 3];
                    record.push_entries(attribute, star.corners.iter().map(|&c| at(c)));
                    self.left.clear();
                    self.left.extend(star.corners.iter().map(|&c| at(c)));
                    let last = self.left[self.left.len() - 1];
                    self.left.resize(star.degree(), last);
                    for (k, &places) in triangles.iter().enumerate() {
                        let edge = edge_of(places, star.degree(), diagonal);
                        of[star.corners[k] as usize / 3] = self.left[edge];
                    }
                }
            }
        }
    }
}

/// The triangles that cutting `ears` makes, as places in the ring: before the ear, the ear, after it.
fn triangles_of(degree: usize, ears: &[usize]) -> Vec<[usize; 3]> {
    let mut left: Vec<usize> = (0..degree).collect();
    let mut triangles = Vec::with_capacity(ears.len());
    for &ear in ears {
        let Some(k) = left.iter().position(|&i| i == ear) else { continue };
        let count = left.len();
        triangles.push([left[(k + count - 1) % count], ear, left[(k + 1) % count]]);
        left.remove(k);
    }
    triangles
}

/// Whether the corner at `x` of the triangle x, y, z has the entry to the left of spoke x.
fn is_left_of(x: usize, y: usize, z: usize, degree: usize, diagonal: Option<Diagonal>) -> bool {
    if y == (x + 1) % degree {
        return true;
    }
    if x == (z + 1) % degree {
        return false;
    }
    let Some(diagonal) = diagonal else { return true };
    let other = match diagonal.ends() {
        [from, to] if x == from => to,
        [from, to] if x == to => from,
        _ => return true,
    };
    diagonal.way(x, z) <= diagonal.way(x, other)
}

/// The ring edge whose face a triangle is most like: one of its own, else one on its side of the diagonal.
fn edge_of(places: [usize; 3], degree: usize, diagonal: Option<Diagonal>) -> usize {
    for j in 0..3 {
        if places[(j + 1) % 3] == (places[j] + 1) % degree {
            return places[j];
        }
    }
    let Some(diagonal) = diagonal else { return places[0] };
    let [from, to] = diagonal.ends();
    let span = diagonal.way(from, to);
    let is_left = places.iter().all(|&i| diagonal.way(from, i) <= span);
    let start = if is_left { from } else { to };
    places.into_iter().min_by_key(|&i| diagonal.way(start, i)).unwrap_or(start)
}

/// Whether the seams let the vertex of a star go, and the diagonal they want then.
pub(crate) fn may_go(seams: &Seams, surface: &SurfaceEditor, vertex: u32, star: &mut Star) -> bool {
    surface.read_star(vertex, star);
    seams.demand(star) != Demand::Stay
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Surface;

    #[test]
    fn diagonals_are_not_crossed() {
        let diagonal = Diagonal::new([1, 4], 6);
        for (places, allowed) in
            [([1, 2, 3], true), ([1, 2, 4], true), ([4, 5, 0], true), ([4, 0, 1], true), ([0, 1, 2], false)]
        {
            assert_eq!(diagonal.allows(places), allowed, "{places:?}");
        }
    }

    /// A hexagon whose faces 0 to 2 and 3 to 5 have different entries: the seam runs through the middle.
    #[test]
    fn a_seam_through_a_vertex_becomes_a_diagonal() {
        let triangles: Vec<[u32; 3]> = (0..6).map(|i| [i, (i + 1) % 6, 6]).collect();
        let surface = SurfaceEditor::new(Surface::from_triangles(triangles, 7).unwrap());
        let mut star = Star::default();
        surface.read_star_from(2, &mut star);
        assert_eq!(star.ring, [0, 1, 2, 3, 4, 5]);
        let mut seams = Seams::default();
        let entry = |face: u32| u32::from(face >= 3);
        seams.follow(Domain::Corner, (0..18).map(|c| entry(c / 3)).collect());
        seams.follow(Domain::Triangle, (0..6).map(entry).collect());
        let diagonal = Diagonal::new([0, 3], 6);
        assert_eq!(seams.demand(&star), Demand::Diagonal(diagonal));
        let mut record = LevelRecord::default();
        // Cut off 1, then 2, then 4: the diagonal 0–3 is there.
        seams.remove(&star, &[1, 2, 4, 5], &mut record);
        assert_eq!(record.entries(1), [0, 0, 0, 1, 1, 1]);
        assert_eq!(record.entries(0)[..6], [0; 6]);
        assert_eq!(seams.entries(1)[..4], [0, 0, 1, 1]);
        assert_eq!(seams.entries(0)[..12], [0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1]);
    }

    #[test]
    fn ends_and_meetings_of_seams_stay() {
        let triangles: Vec<[u32; 3]> = (0..6).map(|i| [i, (i + 1) % 6, 6]).collect();
        let surface = SurfaceEditor::new(Surface::from_triangles(triangles, 7).unwrap());
        let mut star = Star::default();
        let mut demand = |faces: [u32; 6], times: usize| {
            let mut seams = Seams::default();
            (0..times).for_each(|_| seams.loosen());
            seams.follow(Domain::Triangle, faces.to_vec());
            surface.read_star(6, &mut star);
            seams.demand(&star)
        };
        assert_eq!(demand([7; 6], 0), Demand::None);
        assert_eq!(demand([0, 0, 1, 1, 2, 2], 0), Demand::Stay);
        assert_eq!(demand([0, 0, 0, 0, 0, 2], 0), Demand::Stay, "the seam would run along the ring");
        assert!(matches!(demand([0, 0, 0, 0, 1, 1], 0), Demand::Diagonal(_)));
        let Demand::Uncut { places, degree } = demand([0, 0, 1, 1, 2, 2], 1) else { panic!("they may go") };
        assert_eq!((places.count_ones(), degree), (3, 6));
        assert_eq!(demand([0, 1, 2, 3, 4, 5], 1), Demand::Stay);
        assert_eq!(demand([0, 1, 2, 3, 4, 5], 2), Demand::None);
    }

    #[test]
    fn places_that_are_not_to_be_cut_are_not() {
        let demand = Demand::Uncut { places: 0b1010, degree: 5 };
        assert!(!demand.allows([0, 1, 2]) && !demand.allows([1, 2, 0]) && !demand.allows([2, 3, 4]));
        assert!(demand.allows([1, 2, 3]) && demand.allows([4, 0, 1]) && demand.allows([1, 3, 4]));
    }
}
