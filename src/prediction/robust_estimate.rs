//! Robust prediction: what most of many simple predictions agree on (`format/SPEC.md`, section 8.2).
//!
//! On a regular stretch of a mesh (a scan's lattice, a CAD face) the middle of two opposite
//! neighbours and each parallelogram name the vertex almost exactly, save the few that reach across
//! an irregularity or a crease. Their mean is spoilt by those, their median and their mode are not.

use crate::util::simd4::Lanes;

/// Predictions that are used; the rest of a large ring is left out.
pub(crate) const MAX_GUESSES: usize = 16;
/// With at least this many predictions the mode is the closest three, else the closest two.
const ENOUGH_FOR_THREE: usize = 5;

/// Agreement of the predictions, coordinate by coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Consensus {
    pub(crate) median: Lanes,
    /// Distance between the quartiles.
    pub(crate) spread: Lanes,
    /// Centre of the closest predictions.
    pub(crate) mode: Lanes,
    /// Distance between the outer ones of them.
    pub(crate) width: Lanes,
}

/// Puts pairs of the first values in order, one after the other, without a loop: all of them stay in
/// registers.
macro_rules! network {
    ($guesses:ident, [$count:literal] $($i:literal $j:literal),*) => {
        let mut v: [Lanes; $count] = std::array::from_fn(|i| $guesses.values[i]);
        $((v[$i], v[$j]) = (v[$i].min(v[$j]), v[$i].max(v[$j]));)*
        $guesses.values[..$count].copy_from_slice(&v);
    };
}

/// A short list of predictions.
pub(crate) struct Guesses {
    values: [Lanes; MAX_GUESSES],
    count: usize,
}

impl Guesses {
    #[inline(always)]
    pub(crate) fn new() -> Self {
        // What is not filled sorts to the end.
        Self { values: [Lanes::splat(f32::INFINITY); MAX_GUESSES], count: 0 }
    }

    /// Adds a prediction if there is room.
    #[inline(always)]
    pub(crate) fn insert(&mut self, value: Lanes) {
        if let Some(place) = self.values.get_mut(self.count) {
            *place = value;
            self.count += 1;
        }
    }

    /// Sorts each coordinate for itself, by a network of comparisons (Batcher's odd–even merge
    /// sort): the same steps for all of them, and no branches. Comparisons with empty places would change nothing.
    #[inline(always)]
    fn sort(&mut self) {
        network!(self, [8] 0 1, 2 3, 0 2, 1 3, 1 2, 4 5, 6 7, 4 6, 5 7, 5 6, 0 4, 2 6, 2 4, 1 5, 3 7, 3 5, 1 2, 3 4, 5 6);
        if self.count > 12 {
            network!(self, [16] 8 9, 10 11, 8 10, 9 11, 9 10, 12 13, 14 15, 12 14, 13 15, 13 14, 8 12, 10 14, 10 12,
                9 13, 11 15, 11 13, 9 10, 11 12, 13 14, 0 8, 4 12, 4 8, 2 10, 6 14, 6 10, 2 4, 6 8, 10 12, 1 9, 5 13,
                5 9, 3 11, 7 15, 7 11, 3 5, 7 9, 11 13, 1 2, 3 4, 5 6, 7 8, 9 10, 11 12, 13 14);
        } else if self.count > 8 {
            network!(self, [12] 8 9, 10 11, 8 10, 9 11, 9 10, 9 10, 0 8, 4 8, 2 10, 6 10, 2 4, 6 8, 1 9, 5 9, 3 11, 7 11, 3 5, 7 9, 1 2, 3 4, 5 6, 7 8, 9 10);
        }
    }

    /// What they agree on. There must be one prediction.
    #[inline]
    pub(crate) fn consensus(&mut self) -> Consensus {
        self.sort();
        let count = self.count.min(MAX_GUESSES);
        let v = &self.values[..count];
        let middle = v.len() / 2;
        let median = if v.len() % 2 == 1 { v[middle] } else { (v[middle] + v[middle - 1]) * 0.5 };
        let quarter = v.len() / 4;
        let spread = v[v.len() - 1 - quarter] - v[quarter];
        if v.len() < ENOUGH_FOR_THREE {
            let last = v.len().min(2) - 1;
            let (mode, width) = closest(v, last, |first, last| (v[first] + v[last]) * 0.5);
            Consensus { median, spread, mode, width }
        } else {
            let (mode, width) = closest(v, 2, |first, _| v[first + 1]);
            Consensus { median, spread, mode, width }
        }
    }
}

/// Centre and width of the first of the narrowest runs from `i` to `i + step`.
#[inline(always)]
fn closest(v: &[Lanes], step: usize, centre: impl Fn(usize, usize) -> Lanes) -> (Lanes, Lanes) {
    let mut best = centre(0, step);
    let mut least = v[step] - v[0];
    for first in 1..v.len() - step {
        let (c, width) = (centre(first, first + step), v[first + step] - v[first]);
        let (kept, narrow) = (best, least);
        best = Lanes(std::array::from_fn(|k| if width.0[k] < narrow.0[k] { c.0[k] } else { kept.0[k] }));
        least = narrow.min(width);
    }
    (best, least)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn collect(values: &[f32]) -> Guesses {
        let mut guesses = Guesses::new();
        // Another order in each coordinate.
        let reversed = values.iter().rev();
        values.iter().zip(reversed).for_each(|(&a, &b)| guesses.insert(Lanes([a, b, -a, 0.0])));
        guesses
    }

    fn agree(values: &[f32]) -> [f32; 4] {
        let c = collect(values).consensus();
        assert_eq!((c.median.0[0], c.mode.0[0]), (c.median.0[1], c.mode.0[1]));
        assert_eq!(c.median.0[0], -c.median.0[2]);
        [c.median, c.spread, c.mode, c.width].map(|l| l.0[0])
    }

    #[test]
    fn outliers_do_not_count() {
        let [median, _, mode, width] = agree(&[5.0, 5.125, -80.0, 4.875, 300.0, 9.0]);
        assert_eq!((median, mode, width), (5.0625, 5.0, 0.25));
    }

    #[test]
    fn networks_sort() {
        let mut seed = 1_u32;
        for count in 1..=MAX_GUESSES {
            for _ in 0..200 {
                let mut random = || {
                    seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    (seed >> 28) as f32
                };
                let values: Vec<f32> = (0..count).map(|_| random()).collect();
                let mut guesses = collect(&values);
                guesses.sort();
                let mut expected = values;
                expected.sort_by(f32::total_cmp);
                for lane in 0..2 {
                    let sorted: Vec<f32> = guesses.values[..count].iter().map(|v| v.0[lane]).collect();
                    assert_eq!(sorted, expected);
                }
            }
        }
    }

    #[test]
    fn few_guesses_are_enough() {
        assert_eq!(agree(&[2.0]), [2.0, 0.0, 2.0, 0.0]);
        assert_eq!(agree(&[2.0, 4.0]), [3.0, 2.0, 3.0, 2.0]);
        let many: Vec<f32> = (0..100).map(|i| i as f32).collect();
        assert!(collect(&many).consensus().median.0[0].is_finite());
    }
}
