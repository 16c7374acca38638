//! Robust prediction: what most of many simple guesses agree on (`format/SPEC.md`, section 8.2).
//!
//! On a regular stretch of a mesh (a scan's lattice, a CAD face) the middle of two opposite
//! neighbours and each parallelogram name the vertex almost exactly, save the few that reach across
//! an irregularity or a crease. Their mean is spoilt by those, their median and their mode are not.

use super::neighbourhood::{Neighbourhood, Tip};
use super::vec3::Direction;

/// Guesses that are looked at; the rest of a large ring is left out (its last neighbour stands in
/// for those beyond).
const MAX_GUESSES: usize = 16;
/// With at least this many guesses the mode is the closest three, else the closest two.
const ENOUGH_FOR_THREE: usize = 5;

/// Agreement of the guesses along one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Consensus {
    pub(crate) median: f64,
    /// Distance between the quartiles.
    pub(crate) spread: f64,
    /// Centre of the closest guesses.
    pub(crate) mode: f64,
    /// Distance between the outer ones of them.
    pub(crate) width: f64,
}

/// Gathers the guesses along `direction`: `affine`, the middles of opposite neighbours (closed rings
/// of even size), and the parallelograms over true outer vertices.
pub(crate) fn consensus(neighbourhood: &Neighbourhood, direction: Direction, affine: f64) -> Consensus {
    let mut guesses = Guesses::new();
    let degree = neighbourhood.ring.len();
    let mut ring = [0.0; MAX_GUESSES];
    for (place, &p) in ring.iter_mut().zip(&neighbourhood.ring) {
        *place = direction.of(p);
    }
    guesses.insert(affine);
    if degree <= MAX_GUESSES && neighbourhood.is_closed() && degree.is_multiple_of(2) {
        let (first, second) = ring[..degree].split_at(degree / 2);
        for (p, q) in first.iter().zip(second) {
            guesses.insert(0.5 * (p + q));
        }
    }
    for (i, tip) in neighbourhood.tips.iter().enumerate().take(MAX_GUESSES) {
        if let Tip::Fine(tip) = *tip {
            let after = if i + 1 == degree { 0 } else { i + 1 };
            let (p, q) = (ring[i], ring[after.min(MAX_GUESSES - 1)]);
            guesses.insert(p + q - direction.of(tip));
        }
    }
    guesses.consensus()
}

/// A short list of guesses.
struct Guesses {
    values: [f64; MAX_GUESSES],
    count: usize,
}

impl Guesses {
    fn new() -> Self {
        // What is not filled sorts to the end.
        Self { values: [f64::INFINITY; MAX_GUESSES], count: 0 }
    }

    #[inline]
    fn insert(&mut self, value: f64) {
        if let Some(place) = self.values.get_mut(self.count) {
            *place = value;
            self.count += 1;
        }
    }

    /// Sorts without branches, by a network of comparisons (Batcher's odd–even merge sort): the
    /// order of guesses is as good as random, so that branches would be mispredicted.
    fn sort(&mut self) {
        if self.count <= 8 {
            for (i, j) in NETWORK_8 {
                exchange(&mut self.values, i, j);
            }
        } else {
            for (i, j) in NETWORK_16 {
                exchange(&mut self.values, i, j);
            }
        }
    }

    fn consensus(mut self) -> Consensus {
        self.sort();
        let v = &self.values[..self.count];
        let middle = v.len() / 2;
        let median = if v.len() % 2 == 1 { v[middle] } else { 0.5 * (v[middle] + v[middle - 1]) };
        let quarter = v.len() / 4;
        let (first, mode, last) = if v.len() >= ENOUGH_FOR_THREE {
            closest(v.windows(3).map(|w| (w[0], w[1], w[2])))
        } else if v.len() >= 2 {
            closest(v.windows(2).map(|w| (w[0], 0.5 * (w[0] + w[1]), w[1])))
        } else {
            (v[0], v[0], v[0])
        };
        Consensus { median, spread: v[v.len() - 1 - quarter] - v[quarter], mode, width: last - first }
    }
}

/// The first of the narrowest (first, middle, last).
#[inline]
fn closest(candidates: impl Iterator<Item = (f64, f64, f64)>) -> (f64, f64, f64) {
    let mut best = (0.0, 0.0, f64::INFINITY);
    for candidate in candidates {
        if candidate.2 - candidate.0 < best.2 - best.0 {
            best = candidate;
        }
    }
    best
}

/// The network for eight values is how the one for sixteen begins.
const NETWORK_8: [(usize, usize); 19] = {
    let mut first = [(0, 0); 19];
    let mut k = 0;
    while k < first.len() {
        first[k] = NETWORK_16[k];
        k += 1;
    }
    first
};
const NETWORK_16: [(usize, usize); 63] = [
    (0, 1),
    (2, 3),
    (0, 2),
    (1, 3),
    (1, 2),
    (4, 5),
    (6, 7),
    (4, 6),
    (5, 7),
    (5, 6),
    (0, 4),
    (2, 6),
    (2, 4),
    (1, 5),
    (3, 7),
    (3, 5),
    (1, 2),
    (3, 4),
    (5, 6),
    (8, 9),
    (10, 11),
    (8, 10),
    (9, 11),
    (9, 10),
    (12, 13),
    (14, 15),
    (12, 14),
    (13, 15),
    (13, 14),
    (8, 12),
    (10, 14),
    (10, 12),
    (9, 13),
    (11, 15),
    (11, 13),
    (9, 10),
    (11, 12),
    (13, 14),
    (0, 8),
    (4, 12),
    (4, 8),
    (2, 10),
    (6, 14),
    (6, 10),
    (2, 4),
    (6, 8),
    (10, 12),
    (1, 9),
    (5, 13),
    (5, 9),
    (3, 11),
    (7, 15),
    (7, 11),
    (3, 5),
    (7, 9),
    (11, 13),
    (1, 2),
    (3, 4),
    (5, 6),
    (7, 8),
    (9, 10),
    (11, 12),
    (13, 14),
];

#[inline(always)]
fn exchange(values: &mut [f64; MAX_GUESSES], i: usize, j: usize) {
    let (a, b) = (values[i], values[j]);
    let swap = b < a;
    values[i] = if swap { b } else { a };
    values[j] = if swap { a } else { b };
}

#[cfg(test)]
mod tests {
    use super::*;

    fn agree(values: &[f64]) -> Consensus {
        let mut sorted = Guesses::new();
        values.iter().for_each(|&v| sorted.insert(v));
        sorted.consensus()
    }

    #[test]
    fn outliers_do_not_count() {
        let c = agree(&[5.0, 5.1, -80.0, 4.9, 300.0, 9.0]);
        assert_eq!((c.mode, c.median), (5.0, 5.05));
        assert!((c.width - 0.2).abs() < 1e-12);
    }

    #[test]
    fn networks_sort() {
        let mut seed = 1_u32;
        for count in 1..=MAX_GUESSES {
            for _ in 0..200 {
                let mut guesses = Guesses::new();
                for _ in 0..count {
                    seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    guesses.insert(f64::from(seed >> 28));
                }
                let mut expected = guesses.values[..count].to_vec();
                expected.sort_by(f64::total_cmp);
                guesses.sort();
                assert_eq!(guesses.values[..count], expected);
            }
        }
    }

    #[test]
    fn few_guesses_are_enough() {
        assert_eq!(agree(&[2.0]), Consensus { median: 2.0, spread: 0.0, mode: 2.0, width: 0.0 });
        assert_eq!(agree(&[2.0, 4.0]), Consensus { median: 3.0, spread: 2.0, mode: 3.0, width: 2.0 });
        let many: Vec<f64> = (0..100).map(f64::from).collect();
        assert!(agree(&many).median.is_finite());
    }

    #[test]
    fn opposite_neighbours_and_parallelograms_meet_on_a_lattice() {
        let ring = vec![
            [2.0, 0.0, 0.0],
            [1.0, 2.0, 0.0],
            [-1.0, 2.0, 0.0],
            [-2.0, 0.0, 0.0],
            [-1.0, -2.0, 0.0],
            [1.0, -2.0, 0.0],
        ];
        let mut tips = vec![Tip::Fine([3.0, 2.0, 0.0]); 6];
        tips[1..].fill(Tip::None);
        let c = consensus(&Neighbourhood { ring, tips }, Direction::Axis(0), 0.7);
        assert_eq!((c.mode, c.median, c.width), (0.0, 0.0, 0.0));
    }
}
