//! Triangulation of a hole by the rule of [`ears`](crate::mesh::ears), which makes connectivity cheap.
//!
//! Departs from the half-edge collapse of section 6, which allows any valid triangulation.

use super::collapse::is_tetrahedral;
use super::geometry::{area_vector, is_same_side};
use super::seams::Demand;
use super::surface_editor::{Star, SurfaceEditor};
use crate::mesh::ears::{Bytes, Ear, Hole, IN_ORDER, MAX_CORNERS, MAX_VALENCE};
use crate::util::simd4::Cell;

/// Scratch space of the rule.
#[derive(Default)]
pub(crate) struct EarClipper {
    ears: Vec<usize>,
}

impl EarClipper {
    /// Those of the last hole.
    pub(crate) fn ears(&self) -> &[usize] {
        &self.ears
    }

    /// The ears to cut, or `None` if the hole has too many corners or the rule does not keep every
    /// triangle on its side, every new edge new and the `demand` met. `grid` decides the sides.
    pub(crate) fn clip(
        &mut self,
        surface: &SurfaceEditor,
        star: &Star,
        grid: &[[i32; 3]],
        demand: Demand,
    ) -> Option<&[usize]> {
        let degree = star.degree();
        let has_edge = |i: usize, j: usize| surface.has_edge(star.ring[i], star.ring[j]);
        if !(3..=MAX_CORNERS).contains(&degree)
            || star.is_closed() && degree == 3 && is_tetrahedral(surface, star)
            || !star.is_closed() && has_edge(0, degree - 1)
        {
            return None;
        }
        let cell = |i: usize| grid[star.ring[i] as usize];
        let side = side(star, grid);
        let allowed = |ear: Ear, count: usize| {
            let (p, c, n) = (ear.before, ear.corner, ear.after);
            let keeps_side = side == [0; 3] || is_same_side(side, area_vector(cell(p), cell(c), cell(n)));
            // The edge that closes an open star has been tested.
            let closes = !star.is_closed() && (p, n) == (degree - 1, 0);
            keeps_side && demand.allows([p, c, n]) && (count == 3 || closes || !has_edge(p, n))
        };
        let mut hole = Hole::new(IN_ORDER, valences(surface, star), degree);
        self.ears.clear();
        while hole.len() > 2 {
            let count = hole.len();
            let length = |i: usize, j: usize| Cell::new(cell(i)).squared_distance(Cell::new(cell(j)));
            let ear = hole.next_ear(length, |ear| allowed(ear, count))?;
            self.ears.push(ear.corner);
            hole.cut(ear);
        }
        Some(&self.ears)
    }
}

/// Valences of the corners of the hole. The ends of an open star get the edge that closes it.
fn valences(surface: &SurfaceEditor, star: &Star) -> Bytes {
    let mut valences = Bytes::default();
    for (i, &v) in star.ring.iter().enumerate() {
        let is_end = !star.is_closed() && (i == 0 || i + 1 == star.degree());
        valences.add(i, surface.surface.valence[v as usize].min(MAX_VALENCE) as u8 + u8::from(is_end));
    }
    valences
}

/// Sum of the area vectors of the star's faces; zero where all are degenerate.
fn side(star: &Star, grid: &[[i32; 3]]) -> [i64; 3] {
    let at = |v: u32| grid[v as usize];
    let mut sum = [0_i64; 3];
    for i in 0..star.corners.len() {
        let (a, b) = (star.ring[i], star.ring[(i + 1) % star.degree()]);
        let area = area_vector(at(star.vertex), at(a), at(b));
        for (s, x) in sum.iter_mut().zip(area) {
            *s = s.saturating_add(x);
        }
    }
    sum
}
