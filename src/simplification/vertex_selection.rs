//! Which vertices of a level may go: those of little saliency, the error of the best collapse, between half and twice
//! as much by the rank of the descriptor.

use super::SurfaceEditor;
use rayon::prelude::*;

/// How the partition by weighted error weighs its aims.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Optimize {
    /// The smallest whole file. No vertex is kept for its saliency; and where that is smaller, there are no
    /// levels, unless their number is given.
    Size,
    /// Prefixes nearly as good as with [`Optimize::Prefix`], in a smaller file. The default.
    #[default]
    Balanced,
    /// The best prefixes.
    Prefix,
}

impl Optimize {
    /// Every aim, in the order of their names in help texts.
    pub const ALL: [Optimize; 3] = [Optimize::Size, Optimize::Balanced, Optimize::Prefix];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Optimize::Size => "size",
            Optimize::Balanced => "balanced",
            Optimize::Prefix => "prefix",
        }
    }
}

/// How a level is thinned out.
#[derive(Clone, Copy)]
pub(crate) struct Thinning {
    /// Share of the vertices, the most salient ones, that stay.
    protected: f64,
    /// So many times the median saliency is too much to go as well.
    outlier: Option<f64>,
    /// Largest valence that goes.
    pub(crate) max_valence: u32,
    /// How many times the squared deviation of the best hole a hole that is cheaper to code may have; ∞: cost alone counts.
    pub(crate) tolerance: f64,
}

/// On scans about a fifth of the vertices exceed this multiple of the median. Where creases bound flat parts, almost all of the
/// error is along the creases: more of them stay, and the flat parts are thinned out first.
const OUTLIER: f64 = 3.5;
/// Largest share that stays for that reason.
const MOST_OUTLIERS: f64 = 0.6;

impl Thinning {
    fn new(protected: f64, outlier: Option<f64>, max_valence: u32, tolerance: f64) -> Self {
        Self { protected, outlier, max_valence, tolerance }
    }

    /// For a level of this many vertices.
    pub(crate) fn of_level(optimize: Optimize, num_vertices: usize, surface: &SurfaceEditor) -> Self {
        let num_finest = surface.surface.corner_of.len();
        Self::of(optimize, num_vertices as f64 > FINE_SHARE * num_finest as f64)
    }

    /// Whether saliency counts.
    pub(crate) fn protects(&self) -> bool {
        self.protected > 0.0
    }

    /// How many of the vertices may go. The median is that of the `sample`.
    fn num_free(&self, saliency: &[f64], mut sample: Vec<f64>) -> usize {
        let part = |share: f64| ((1.0 - share) * saliency.len() as f64).ceil() as usize;
        let most = part(self.protected);
        let Some(outlier) = self.outlier else { return most };
        let middle = sample.len() / 2;
        let median = *sample.select_nth_unstable_by(middle, f64::total_cmp).1;
        let usual = saliency.iter().filter(|&&s| s <= outlier * median).count();
        usual.clamp(part(MOST_OUTLIERS).min(most), most)
    }

    /// Most vertices are restored in the finest levels: there the cost of coding counts, before that
    /// the shape.
    fn of(optimize: Optimize, is_fine: bool) -> Self {
        match (optimize, is_fine) {
            (Optimize::Size, _) => Self::new(0.0, None, 6, f64::INFINITY),
            (Optimize::Balanced, true) => Self::new(0.1, None, 6, 8.0),
            (Optimize::Balanced, false) => Self::new(0.2, Some(OUTLIER), 7, 2.0),
            (Optimize::Prefix, _) => Self::new(0.2, Some(OUTLIER), 7, 1.0),
        }
    }
}

/// Levels with more than this share of all vertices are fine.
const FINE_SHARE: f64 = 0.7;

/// Up to this many vertices the descriptor is evaluated everywhere.
const LARGE: usize = 8192;
/// In larger levels at least this many vertices give the ranks of the descriptor.
const SAMPLE: usize = 4096;
/// Ranks and the bound of saliency are known that well from a sample.
const SLACK: f64 = 1.1;
/// The rank of the descriptor multiplies errors by this at most, and divides them by this at most.
const WEIGHT: f64 = 2.0;

/// Saliency of the vertices of a level, and how many of them may go.
pub(crate) struct Saliency {
    /// By place: squared distance times area, weighted by the rank of the descriptor; empty if all may go.
    of: Vec<f64>,
    num_free: usize,
}

impl Saliency {
    /// All may go.
    pub(crate) fn none(num_vertices: usize) -> Self {
        Self { of: Vec::new(), num_free: num_vertices }
    }

    /// Errors alone.
    pub(crate) fn of_errors(thinning: Thinning, errors: Vec<f64>) -> Self {
        let num_free = thinning.num_free(&errors, errors.clone());
        Self { of: errors, num_free }
    }

    /// Errors weighed by the rank of the descriptor. `evaluate` gives its values at some places: on a large level that
    /// is a sample and the vertices about which the weight can decide.
    pub(crate) fn weighed(
        thinning: Thinning,
        mut errors: Vec<f64>,
        mut evaluate: impl FnMut(&[u32]) -> Vec<f64>,
    ) -> Self {
        let num_vertices = errors.len();
        let all = 0..num_vertices as u32;
        if num_vertices <= LARGE {
            let scores = evaluate(&all.collect::<Vec<u32>>());
            for (rank, (_, place)) in sorted_keys(&scores).into_iter().enumerate() {
                errors[place as usize] *= weight(rank as f64 / num_vertices as f64);
            }
            return Self::of_errors(thinning, errors);
        }
        let stride = (num_vertices / SAMPLE) as u32;
        let is_sample = |&place: &u32| spread(place) < u32::MAX / stride;
        let places: Vec<u32> = all.clone().filter(is_sample).collect();
        let scores = evaluate(&places);
        let mut ranking = scores.clone();
        ranking.sort_unstable_by(f64::total_cmp);
        // In the middle of equal ones.
        let weight_of = |score: f64| {
            let ends = [ranking.partition_point(|&s| s < score), ranking.partition_point(|&s| s <= score)];
            weight(0.5 * (ends[0] + ends[1]) as f64 / ranking.len() as f64)
        };
        let mut sample = Vec::with_capacity(places.len());
        for (&place, &score) in places.iter().zip(&scores) {
            let error = &mut errors[place as usize];
            *error *= weight_of(score);
            sample.push(*error);
        }
        let num_free = thinning.num_free(&sample, sample.clone());
        let last = sample.len() - 1;
        let bound = *sample.select_nth_unstable_by(num_free.min(last), f64::total_cmp).1;

        let (low, high) = (bound / (WEIGHT * SLACK), bound * (WEIGHT * SLACK));
        let is_open = |&place: &u32| {
            let error = errors[place as usize];
            error > 0.0 && (low..=high).contains(&error) && !is_sample(&place)
        };
        let places: Vec<u32> = all.filter(is_open).collect();
        let scores = evaluate(&places);
        let weights: Vec<f64> = scores.par_iter().map(|&score| weight_of(score)).collect();
        for (&place, weight) in places.iter().zip(weights) {
            errors[place as usize] *= weight;
        }
        let num_free = thinning.num_free(&errors, sample);
        Self { of: errors, num_free }
    }

    /// The vertices that may go, as places in any order.
    pub(crate) fn least(&self) -> Vec<u32> {
        if self.num_free >= self.of.len() {
            return (0..self.num_free as u32).collect();
        }
        let mut keys = score_keys(&self.of);
        keys.select_nth_unstable(self.num_free);
        keys[..self.num_free].iter().map(|&(_, place)| place).collect()
    }
}

/// `WEIGHT`^(2 rank − 1), from 1 / `WEIGHT` to `WEIGHT`; `rank` is the share of the vertices whose descriptor is less.
fn weight(rank: f64) -> f64 {
    const { assert!(WEIGHT == 2.0) };
    libm::exp2(2.0 * rank - 1.0)
}

/// A number of 32 bits by which places anywhere are told apart evenly.
fn spread(place: u32) -> u32 {
    place.wrapping_mul(0x9e37_79b1)
}

fn sorted_keys(scores: &[f64]) -> Vec<(u64, u32)> {
    let mut keys = score_keys(scores);
    keys.par_sort_unstable();
    keys
}

/// Scores as integers of the same order, each with its place.
pub(crate) fn score_keys(scores: &[f64]) -> Vec<(u64, u32)> {
    let key = |score: f64| {
        // Adding 0 makes −0 equal to 0.
        let bits = (score + 0.0).to_bits();
        if bits >> 63 == 0 { bits | 1 << 63 } else { !bits }
    };
    scores.iter().zip(0..).map(|(&score, place)| (key(score), place)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn creases_stay_where_most_of_the_surface_is_flat() {
        let num_free = |thinning: Thinning, saliency: &[f64]| thinning.num_free(saliency, saliency.to_vec());
        let thinning = Thinning::of(Optimize::Balanced, false);
        let even: Vec<f64> = (0..100).map(|i| 1.0 + f64::from(i) / 100.0).collect();
        assert_eq!(num_free(thinning, &even), 80);
        let mut creased = vec![0.0; 70];
        creased.resize(100, 1.0);
        assert_eq!(num_free(thinning, &creased), 70);
        creased.resize(1000, 1.0);
        assert_eq!(num_free(thinning, &creased), 800);
        let flat = Thinning::of(Optimize::Balanced, true);
        assert_eq!(num_free(flat, &[0.0; 10]), 9);
        assert_eq!(num_free(Thinning::of(Optimize::Prefix, true), &[0.0]), 1);
    }

    /// Hardly any vertex is decided otherwise than by all values, and few are asked for.
    #[test]
    fn a_sample_of_the_descriptor_decides_nearly_as_all_of_it() {
        let num_vertices = 40_000_u32;
        let random = |i: u32, salt: u32| f64::from(spread(i ^ salt) >> 8) / f64::from(1 << 24);
        let errors: Vec<f64> = (0..num_vertices).map(|i| (12.0 * random(i * i, 7)).exp2()).collect();
        let score = |place: u32| random(place.wrapping_mul(place), 12_345);
        for is_fine in [true, false] {
            let thinning = Thinning::of(Optimize::Balanced, is_fine);
            let mut num_asked = 0;
            let saliency = Saliency::weighed(thinning, errors.clone(), |places| {
                num_asked += places.len();
                places.iter().map(|&place| score(place)).collect()
            });
            let mut is_free = vec![false; errors.len()];
            saliency.least().into_iter().for_each(|place| is_free[place as usize] = true);
            let mut exact = errors.clone();
            for (rank, (_, place)) in
                sorted_keys(&(0..num_vertices).map(score).collect::<Vec<f64>>()).into_iter().enumerate()
            {
                exact[place as usize] *= weight(rank as f64 / f64::from(num_vertices));
            }
            let exact = Saliency::of_errors(thinning, exact);
            let missed = exact.least().into_iter().filter(|&place| !is_free[place as usize]).count();
            assert!(missed < errors.len() / 50, "{missed} vertices");
            assert!(num_asked < errors.len() / 2, "{num_asked} values");
        }
    }
}
