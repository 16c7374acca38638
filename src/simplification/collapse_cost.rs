//! What can be known of stars before their vertices are removed. None of the vertices is next to another: the
//! removal of one changes nothing here for the others, so that all can be looked at in parallel.

use super::quadrics::ErrorMemory;
use super::retriangulate::{HoleFiller, Prospect};
use super::{Star, SurfaceEditor};
use rayon::prelude::*;

/// A level before anything is removed from it.
#[derive(Clone, Copy)]
pub(crate) struct Evaluator<'a> {
    pub(crate) surface: &'a SurfaceEditor,
    pub(crate) grid: &'a [[i32; 3]],
    pub(crate) positions: &'a [[f64; 3]],
    pub(crate) memory: &'a ErrorMemory<'a>,
    /// Whether the fans that may close a hole are looked at.
    pub(crate) sees_fans: bool,
}

/// Vertices that one thread looks at.
const GROUP: usize = 1 << 8;

/// What is known of the stars of some vertices.
pub(crate) struct CollapseCosts {
    /// Place of each vertex of the surface among the stars.
    places: Vec<u32>,
    groups: Vec<Group>,
}

#[derive(Default)]
struct Group {
    stars: Vec<Ahead>,
    corners: Vec<u32>,
    rings: Vec<u32>,
}

/// What is known of one star.
#[derive(Clone, Copy)]
pub(crate) struct Ahead {
    /// Where its corners and its ring begin in the group.
    corners: u32,
    ring: u32,
    /// The neighbour that remembers the vertex, if there is just one that may.
    pub(crate) heir: Option<u32>,
    /// Of its hole, if wanted.
    pub(crate) prospect: Option<Prospect>,
}

impl CollapseCosts {
    /// Looks at `vertices`.
    pub(crate) fn new(evaluator: Evaluator, vertices: &[u32]) -> Self {
        let mut places = vec![0; evaluator.surface.surface.corner_of.len()];
        vertices.iter().zip(0..).for_each(|(&v, place)| places[v as usize] = place);
        let look = |vertices: &[u32]| Group::new(evaluator, vertices);
        Self { places, groups: vertices.par_chunks(GROUP).map(look).collect() }
    }

    /// The star of a vertex; a closed one starts at `corner`.
    pub(crate) fn read(&self, vertex: u32, corner: u32, star: &mut Star) -> Ahead {
        let place = self.places[vertex as usize] as usize;
        let Group { stars, corners, rings } = &self.groups[place / GROUP];
        let (mut ahead, after) = (stars[place % GROUP], stars.get(place % GROUP + 1));
        let end = after.map_or((corners.len(), rings.len()), |a| (a.corners as usize, a.ring as usize));
        star.vertex = vertex;
        star.corners.clear();
        star.corners.extend_from_slice(&corners[ahead.corners as usize..end.0]);
        star.ring.clear();
        star.ring.extend_from_slice(&rings[ahead.ring as usize..end.1]);
        let shift = star.corners.iter().position(|&c| c == corner).unwrap_or(0);
        if star.is_closed() && shift > 0 {
            star.corners.rotate_left(shift);
            star.ring.rotate_left(shift);
            let degree = star.degree();
            ahead.prospect = ahead.prospect.map(|prospect| prospect.turned(shift, degree));
        }
        ahead
    }
}

impl Group {
    fn new(evaluator: Evaluator, vertices: &[u32]) -> Self {
        let Evaluator { surface, grid, positions, memory, sees_fans } = evaluator;
        let mut group = Self::default();
        group.stars.reserve_exact(vertices.len());
        let mut star = Star::default();
        let mut filler = HoleFiller::default();
        for &vertex in vertices {
            surface.read_star(vertex, &mut star);
            let ((_, first), is_sole) = memory.heir(&star);
            let heir = is_sole.then_some(first);
            let first = star.ring.iter().position(|&v| v == first).unwrap_or(0);
            let prospect = if sees_fans { filler.foresee(&star, grid, positions, first) } else { None };
            let (corners, ring) = (group.corners.len() as u32, group.rings.len() as u32);
            group.stars.push(Ahead { corners, ring, heir, prospect });
            group.corners.extend_from_slice(&star.corners);
            group.rings.extend_from_slice(&star.ring);
        }
        group
    }
}
