//! What can be known of stars before their vertices are removed. None of the vertices is next to another: the
//! removal of one changes nothing here for the others, so that all can be looked at in parallel.

use super::hole::{HoleFiller, Prospect};
use super::memory::ErrorMemory;
use super::{ShrinkingSurface, Star};

/// The stars of some vertices.
#[derive(Default)]
pub(crate) struct Outlook {
    ends: Vec<StarEnd>,
    corners: Vec<u32>,
    rings: Vec<u32>,
}

struct StarEnd {
    vertex: u32,
    heir: u32,
    corners: u32,
    ring: u32,
    prospect: Option<Prospect>,
}

/// One of them.
pub(crate) struct Ahead<'a> {
    vertex: u32,
    corners: &'a [u32],
    ring: &'a [u32],
    /// The neighbour that remembers the vertex.
    pub(crate) heir: u32,
    /// Of its hole, if wanted.
    pub(crate) prospect: Option<Prospect>,
}

impl Outlook {
    /// Looks at the vertices at `corners`, at the fans that may close their holes only if `see_fans`.
    pub(crate) fn new(
        surface: &ShrinkingSurface,
        grid: &[[i32; 3]],
        positions: &[[f64; 3]],
        memory: &ErrorMemory,
        corners: &[u32],
        see_fans: bool,
    ) -> Self {
        let mut outlook = Self::default();
        outlook.ends.reserve_exact(corners.len());
        let mut star = Star::default();
        let mut filler = HoleFiller::default();
        for &corner in corners {
            surface.read_star_from(corner, &mut star);
            let (_, heir) = memory.least_error(&star);
            let first = star.ring.iter().position(|&v| v == heir).unwrap_or(0);
            let prospect = if see_fans { filler.foresee(&star, grid, positions, first) } else { None };
            outlook.corners.extend_from_slice(&star.corners);
            outlook.rings.extend_from_slice(&star.ring);
            let (corners, ring) = (outlook.corners.len() as u32, outlook.rings.len() as u32);
            outlook.ends.push(StarEnd { vertex: star.vertex, heir, corners, ring, prospect });
        }
        outlook
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = Ahead<'_>> {
        let (mut corners, mut ring) = (0, 0);
        self.ends.iter().map(move |end| {
            let from = (corners as usize, ring as usize);
            (corners, ring) = (end.corners, end.ring);
            Ahead {
                vertex: end.vertex,
                corners: &self.corners[from.0..corners as usize],
                ring: &self.rings[from.1..ring as usize],
                heir: end.heir,
                prospect: end.prospect,
            }
        })
    }
}

impl Ahead<'_> {
    /// Its star.
    pub(crate) fn star(&self, star: &mut Star) {
        star.vertex = self.vertex;
        star.corners.clear();
        star.corners.extend_from_slice(self.corners);
        star.ring.clear();
        star.ring.extend_from_slice(self.ring);
    }
}
