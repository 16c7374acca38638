//! Which triangles close the hole of a removed vertex: those that are closest to what was there, or
//! those that are cheaper to code if they are not much worse.
//!
//! Departs from section 6 of the paper, which collapses along the shortest legal edge: measured by the
//! distance of prefixes from the surface, that is up to 8 dB worse.

use super::collapse::{is_legal, keeps_sides, makes_new_edges};
use super::deviation::Deviation;
use super::seams::Demand;
use super::triangulate::EarClipper;
use super::{Star, SurfaceEditor};

/// A vertex stays for now if the best legal hole deviates this many times more (squared) than the best of
/// all: what is illegal this time was what the vertex was judged by.
const UNFIT: f64 = 8.0;
/// Deviations below this share of the star's extent are as good as none: a fiftieth of its spokes.
const SMALL: f64 = 4e-4;

/// What does not depend on which vertices went before, as long as the star's own did not: the fans.
#[derive(Clone, Copy)]
pub(crate) struct Prospect {
    /// The best half-edge collapses that keep every face on its side, as places in the ring, and their deviation.
    targets: Places,
    deviation: f64,
    /// Whether it deviates too much, so that the vertex stays.
    is_unfit: bool,
}

impl Prospect {
    /// The same of a ring of so many vertices that begins `shift` places later.
    pub(super) fn turned(self, shift: usize, degree: usize) -> Self {
        Self { targets: self.targets.turned(shift, degree), ..self }
    }
}

/// Places in a ring of up to 64 vertices.
#[derive(Clone, Copy, Default)]
pub(super) struct Places(u64);

impl Places {
    pub(super) const MOST: usize = 64;

    pub(super) fn insert(&mut self, place: usize) {
        self.0 |= 1 << place;
    }

    /// The same of a ring of so many vertices that begins `shift` places later.
    pub(super) fn turned(self, shift: usize, degree: usize) -> Self {
        let all = u64::MAX >> (Self::MOST - degree);
        Self((self.0 >> shift | self.0 << (degree - shift)) & all)
    }

    pub(super) fn first(self) -> usize {
        self.0.trailing_zeros() as usize
    }
}

/// Scratch space of the choice.
#[derive(Default)]
pub(crate) struct HoleFiller {
    clipper: EarClipper,
    deviation: Deviation,
    ears: Vec<usize>,
}

impl HoleFiller {
    /// The ears to cut, or `None` if no triangulation is legal or none that is fits. The one that is cheap to code
    /// ([`EarClipper`]) wins if its squared deviation is at most `tolerance` times that of the best
    /// half-edge collapse. `grid` decides legality, `positions` distances. Only holes that meet the
    /// `demand` count.
    pub(crate) fn fill(
        &mut self,
        surface: &SurfaceEditor,
        star: &Star,
        grid: &[[i32; 3]],
        positions: &[[f64; 3]],
        tolerance: f64,
        demand: Demand,
    ) -> Option<&[usize]> {
        let degree = star.degree();
        if degree < 3 {
            let is_ear = degree == 2 && !star.is_closed() && is_legal(surface, star, 0, grid);
            self.ears.clear();
            return is_ear.then_some(&self.ears);
        }
        if tolerance == f64::INFINITY && self.clipper.clip(surface, star, grid, demand).is_some() {
            return Some(self.clipper.ears());
        }
        self.deviation.set(star, positions);
        let may_fan = |i: usize| {
            demand == Demand::None || fan(i, degree).all(|ear| demand.allows([i, ear, (ear + 1) % degree]))
        };
        let is_legal = |i: usize| is_legal(surface, star, i, grid);
        let (best, is_unfit) = self.best_fan(star, 0, may_fan, is_legal, |_, _| ());
        if is_unfit {
            return None;
        }
        self.choose(surface, star, grid, tolerance, demand, best)
    }

    /// What [`fill`](Self::fill) with no demand finds of the fans. `first` is the one of which most is expected.
    pub(crate) fn foresee(
        &mut self,
        star: &Star,
        grid: &[[i32; 3]],
        positions: &[[f64; 3]],
        first: usize,
    ) -> Option<Prospect> {
        if !(3..=Places::MOST).contains(&star.degree()) {
            return None;
        }
        self.deviation.set(star, positions);
        let mut targets = Places::default();
        let mut deviation = f64::INFINITY;
        let is_legal = |i: usize| keeps_sides(star, i, grid);
        let (best, is_unfit) = self.best_fan(
            star,
            first,
            |_| true,
            is_legal,
            |i, of_fan| {
                if of_fan < deviation {
                    (targets, deviation) = (Places::default(), of_fan);
                }
                targets.insert(i);
            },
        );
        (best.1.is_some() || is_unfit).then_some(Prospect { targets, deviation, is_unfit })
    }

    /// The same as [`fill`](Self::fill) with no demand, if all that was foreseen comes true.
    pub(crate) fn fill_as_foreseen(
        &mut self,
        surface: &SurfaceEditor,
        star: &Star,
        grid: &[[i32; 3]],
        positions: &[[f64; 3]],
        tolerance: f64,
        prospect: Option<Prospect>,
    ) -> Option<&[usize]> {
        let Some(Prospect { targets, deviation, is_unfit }) = prospect else {
            return self.fill(surface, star, grid, positions, tolerance, Demand::None);
        };
        if is_unfit {
            return None;
        }
        let target = targets.first();
        if !makes_new_edges(surface, star, target) {
            return self.fill(surface, star, grid, positions, tolerance, Demand::None);
        }
        self.deviation.set(star, positions);
        self.choose(surface, star, grid, tolerance, Demand::None, (deviation, Some(target)))
    }

    /// The legal fan that deviates least, the first among equals, and whether that is much more than the
    /// least of all. `see` is called with each legal one that does not deviate more than those before.
    fn best_fan(
        &mut self,
        star: &Star,
        first: usize,
        may_fan: impl Fn(usize) -> bool,
        is_legal: impl Fn(usize) -> bool,
        mut see: impl FnMut(usize, f64),
    ) -> ((f64, Option<usize>), bool) {
        let degree = star.degree();
        let mut best = (f64::INFINITY, None);
        let mut least = f64::INFINITY;
        let is_target = |&i: &usize| (star.is_closed() || i == 0 || i == degree - 1) && may_fan(i);
        let others = (0..degree).filter(|&i| i != first);
        for target in std::iter::once(first).chain(others).filter(is_target) {
            let deviation = self.deviation.of_fan(target, best.0);
            least = least.min(deviation);
            if deviation <= best.0 && is_legal(target) {
                see(target, deviation);
                let is_first = best.1.is_none_or(|best| target < best);
                if deviation < best.0 || is_first {
                    best = (deviation, Some(target));
                }
            }
        }
        (best, best.0 > UNFIT * (least + SMALL * self.deviation.extent()))
    }

    /// The hole that is cheap to code, unless the best fan is much better.
    fn choose(
        &mut self,
        surface: &SurfaceEditor,
        star: &Star,
        grid: &[[i32; 3]],
        tolerance: f64,
        demand: Demand,
        (deviation, target): (f64, Option<usize>),
    ) -> Option<&[usize]> {
        let bound = deviation * tolerance;
        let clipped = self.clipper.clip(surface, star, grid, demand);
        match (clipped, target) {
            (Some(ears), None) => Some(ears),
            (Some(ears), Some(target))
                if is_fan(ears, target, star.degree())
                    || self.deviation.of(ears.iter().copied(), bound) <= bound =>
            {
                Some(ears)
            }
            (_, Some(target)) => {
                self.ears.clear();
                self.ears.extend(fan(target, star.degree()));
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

/// Whether cutting `ears` leaves the fan around `target`: all but the last one cut a diagonal to it.
fn is_fan(ears: &[usize], target: usize, degree: usize) -> bool {
    // The places between the target and the diagonals so far.
    let (mut after, mut before) = (1, degree - 1);
    ears[..ears.len() - 1].iter().all(|&ear| {
        let place = if ear >= target { ear - target } else { ear + degree - target };
        let is_next = place == after;
        let is_last = place == before;
        after += usize::from(is_next);
        before -= usize::from(is_last);
        is_next || is_last
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Surface;
    use crate::simplification::seams::Diagonal;

    #[test]
    fn a_vertex_stays_if_only_a_bad_hole_is_legal() {
        // A roof with vertex 0 on its ridge, which runs from 1 to 3.
        let mut triangles = vec![[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]];
        let grid = [[0, 0, 10], [10, 0, 10], [0, 10, 0], [-10, 0, 10], [0, -10, 0], [0, 30, 10]];
        let positions = grid.map(|p| p.map(f64::from));
        let fill = |triangles: &[[u32; 3]], num_vertices, seam: Option<[u32; 2]>| {
            let surface = Surface::from_triangles(triangles.to_vec(), num_vertices).unwrap();
            let surface = SurfaceEditor::new(surface);
            let mut star = Star::default();
            surface.read_star(0, &mut star);
            let place = |v: u32| star.ring.iter().position(|&u| u == v).unwrap();
            let demand =
                seam.map_or(Demand::None, |ends| Demand::Diagonal(Diagonal::new(ends.map(place), 4)));
            HoleFiller::default().fill(&surface, &star, &grid, &positions, 1.0, demand).map(<[usize]>::len)
        };
        assert_eq!(fill(&triangles, 5, None), Some(2));
        // Now 1 and 3 are neighbours already, so that the ridge cannot be closed.
        triangles.extend([[2, 1, 5], [3, 2, 5], [1, 3, 5]]);
        assert_eq!(fill(&triangles, 6, None), None);
        // Nor if a seam must run along it; across it would do.
        assert_eq!(fill(&triangles, 6, Some([1, 3])), None);
        assert_eq!(fill(&triangles, 6, Some([2, 4])), Some(2));
    }
}
