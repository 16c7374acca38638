//! Which triangles close the hole of a removed vertex: those that lie closest to what was there, or
//! those that are cheaper to code if they are not much worse.
//!
//! Departs from section 6 of the paper, which collapses along the shortest legal edge: measured by the
//! distance of prefixes from the surface, that is up to 8 dB worse.

use super::collapse::is_legal;
use super::deviation::Deviation;
use super::triangulate::EarClipper;
use super::{ShrinkingSurface, Star};

/// Scratch space of the choice.
#[derive(Default)]
pub(crate) struct HoleFiller {
    clipper: EarClipper,
    deviation: Deviation,
    ears: Vec<usize>,
}

impl HoleFiller {
    /// The ears to cut, or `None` if no triangulation is legal. The one that is cheap to code
    /// ([`EarClipper`]) wins if its squared deviation is at most `tolerance` times that of the best
    /// half-edge collapse. `grid` decides legality, `positions` distances.
    pub(crate) fn fill(
        &mut self,
        surface: &ShrinkingSurface,
        star: &Star,
        grid: &[[i32; 3]],
        positions: &[[f64; 3]],
        tolerance: f64,
    ) -> Option<&[usize]> {
        let degree = star.degree();
        if degree < 3 {
            let is_ear = degree == 2 && !star.is_closed() && is_legal(surface, star, 0, grid);
            self.ears.clear();
            return is_ear.then_some(&self.ears);
        }
        let clipped = self.clipper.clip(surface, star, grid);
        if tolerance == f64::INFINITY && clipped.is_some() {
            return clipped;
        }
        self.deviation.set(star, positions);
        let mut best = (f64::INFINITY, None);
        for target in (0..degree).filter(|&i| star.is_closed() || i == 0 || i == degree - 1) {
            let deviation = self.deviation.of(fan(target, degree), best.0);
            if deviation < best.0 && is_legal(surface, star, target, grid) {
                best = (deviation, Some(target));
            }
        }
        let bound = best.0 * tolerance;
        match (clipped, best.1) {
            (Some(ears), None) => Some(ears),
            (Some(ears), _) if self.deviation.of(ears.iter().copied(), bound) <= bound => Some(ears),
            (_, Some(target)) => {
                self.ears.clear();
                self.ears.extend(fan(target, degree));
                Some(&self.ears)
            }
            (None, None) => None,
        }
    }
}

/// The ears whose cutting leaves the fan around a ring vertex.
fn fan(target: usize, degree: usize) -> impl Iterator<Item = usize> {
    (1..degree - 1).map(move |i| (target + i) % degree)
}
