//! Triangulation of a hole so that valences drift apart: the corner of lowest valence is cut off
//! first, which makes some ring vertices high and leaves the others low, to be the next to go.
//!
//! Departs from the half-edge collapse of section 6, which allows any valid triangulation. Cheaper
//! to code: a decoder that knows the rule finds most patches plausible or not.

use super::collapse::is_tetrahedral;
use super::geometry::{area_vector, is_same_side};
use super::shrinking::{ShrinkingSurface, Star};

/// Scratch space of the rule.
#[derive(Default)]
pub(crate) struct EarClipper {
    left: Vec<usize>,
    valence: Vec<i64>,
    ears: Vec<usize>,
}

impl EarClipper {
    /// The ears to cut, or `None` if no order keeps every triangle on its side and every new edge
    /// new. `grid` decides the sides.
    pub(crate) fn clip(
        &mut self,
        surface: &ShrinkingSurface,
        star: &Star,
        grid: &[[i32; 3]],
    ) -> Option<&[usize]> {
        let degree = star.degree();
        if degree < 3 || star.is_closed() && degree == 3 && is_tetrahedral(surface, star) {
            return None;
        }
        let cell = |i: usize| grid[star.ring[i] as usize];
        let side = self.side(star, grid);
        self.left.clear();
        self.left.extend(0..degree);
        self.valence.clear();
        self.valence.extend(star.ring.iter().map(|&v| i64::from(surface.surface.valence[v as usize])));
        self.ears.clear();
        while self.left.len() > 2 {
            let count = self.left.len();
            let corner = |k: usize| {
                let (p, n) = (self.left[(k + count - 1) % count], self.left[(k + 1) % count]);
                (p, self.left[k], n)
            };
            let allowed = |k: usize| {
                let (p, c, n) = corner(k);
                let area = area_vector(cell(p), cell(c), cell(n));
                let keeps_side = side == [0; 3] || is_same_side(side, area);
                let closes = !star.is_closed() && (p, n) == (degree - 1, 0);
                keeps_side && (count == 3 || closes || !surface.has_edge(star.ring[p], star.ring[n]))
            };
            // The new boundary edge of an open star must be new as well.
            let ear = (0..count).filter(|&k| allowed(k)).min_by_key(|&k| {
                let (p, c, n) = corner(k);
                (self.valence[c], -(self.valence[p] + self.valence[n]), c)
            })?;
            let (p, c, n) = corner(ear);
            self.valence[c] -= 1;
            if count > 3 {
                self.valence[p] += 1;
                self.valence[n] += 1;
            }
            self.ears.push(c);
            self.left.remove(ear);
        }
        if !star.is_closed() && surface.has_edge(star.ring[0], star.ring[degree - 1]) {
            return None;
        }
        Some(&self.ears)
    }

    /// Sum of the area vectors of the star's faces; zero where all are degenerate.
    fn side(&self, star: &Star, grid: &[[i32; 3]]) -> [i64; 3] {
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
}
