//! From a neighbourhood to the density of each coordinate (`format/SPEC.md`, section 8.3): experts,
//! each with a scale that follows a linear model, weighed by how well they did.

use super::coding_context::{CodingContext, NUM_CLASSES};
use crate::entropy::mixture::Mixture;
pub(crate) use crate::entropy::residual::NUM_KINDS;
use crate::entropy::tables::{exp2, index_below, log2};
use crate::prediction::ring_context::{NUM_FEATURES, Outlook};
use crate::prediction::rls_affine::AffineFilter;
use crate::prediction::robust_estimate::{Consensus, Guesses, MAX_GUESSES};
use crate::util::simd4::Lanes;

/// Kind of the coordinate closest to the normal.
pub(crate) const ACROSS: usize = 2;
/// Inputs of the scale models.
pub(super) const NUM_CUES: usize = 7;
/// Smallest length that counts in a logarithm, in grid steps.
pub(super) const FLOOR: f32 = 0.35;
/// Typical residual over the exponential of its mean logarithm, and its inverse.
const SCALE_FACTOR: f32 = 0.85;
pub(super) const SHARPNESS_FACTOR: f32 = 1.0 / SCALE_FACTOR;
/// Weights the scale models start with.
const FIRST_SCALES: [f32; NUM_CUES] = [-0.4, 0.1, 0.2, 0.3, 0.1, 0.0, 0.3];
/// Step of the scale models.
const SCALE_RATE: f32 = 0.02;
/// Step of the experts' weights, where they start and the least they get. The fourth expert has weights of his own.
pub(super) const TRUST_RATE: f32 = 0.02;
const FIRST_TRUST: Lanes = Lanes([1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0, 0.0]);
const LEAST_TRUST: Lanes = Lanes([0.02, 0.02, 0.02, 0.0]);
pub(super) const TRUST_LEVELS: usize = 16;
/// Steepest slope of the surface over the two axes coded first that is believed.
const MAX_SLOPE: f32 = 4.0;
/// The expert that predicts a neighbour's coordinate to repeat, and the logarithm of its scale.
const REPEATED: usize = 3;
const REPEATED_LOG_SCALE: f32 = -1.25;
/// Weight beyond which residuals are counted from it.
const REPEATED_LEADS: f32 = 0.2;
/// Its weights: where they start, and the number of coordinates that counts for; the least step and the least
/// weight. The largest number of neighbours with the coordinate that is distinguished.
const FIRST_REPEATED: Repeated = Repeated { weight: 0.2, count: 5.0 };
const REPEATED_RATE: f32 = 0.01;
const LEAST_REPEATED: f32 = 0.02;
const REPEATED_COUNTS: usize = 4;
/// Bound on centres, far outside any grid.
pub(super) const MAX_CENTRE: f32 = 1e9;

/// What is learnt about coordinates; kept from pass to pass.
#[derive(Clone)]
pub(crate) struct PredictionModels {
    /// Per class: the filter of the coordinates along the surface and of the one across it.
    filters: Vec<[AffineFilter; 2]>,
    scales: [ScaleModel; NUM_KINDS],
    trust: [[Lanes; TRUST_LEVELS]; NUM_KINDS],
    /// By how many neighbours have the coordinate, and how far it is from the median.
    repeated: [[[Repeated; TRUST_LEVELS]; REPEATED_COUNTS]; NUM_KINDS],
}

/// How often coordinates repeat: a mean, and the number of samples.
#[derive(Clone, Copy)]
struct Repeated {
    weight: f32,
    count: f32,
}

impl Repeated {
    #[inline(always)]
    fn learn(&mut self, share: f32) {
        self.count += 1.0;
        let rate = (1.0 / self.count).max(REPEATED_RATE);
        self.weight = (self.weight + (share - self.weight) * rate).max(LEAST_REPEATED);
    }
}

impl PredictionModels {
    pub(crate) fn new() -> Self {
        Self {
            filters: vec![[AffineFilter::new(), AffineFilter::new()]; NUM_CLASSES],
            scales: [ScaleModel::new(FIRST_SCALES); NUM_KINDS],
            trust: [[FIRST_TRUST; TRUST_LEVELS]; NUM_KINDS],
            repeated: [[[FIRST_REPEATED; TRUST_LEVELS]; REPEATED_COUNTS]; NUM_KINDS],
        }
    }
}

/// Linear models of the base-2 logarithms of the experts' residuals.
#[derive(Clone, Copy)]
pub(super) struct ScaleModel {
    /// Lane `i` of each cue's weight is for expert `i`.
    weights: [Lanes; NUM_CUES],
}

impl ScaleModel {
    pub(super) const fn new(weights: [f32; NUM_CUES]) -> Self {
        let mut lanes = [Lanes::ZERO; NUM_CUES];
        let mut i = 0;
        while i < NUM_CUES {
            lanes[i] = Lanes::splat(weights[i]);
            i += 1;
        }
        Self { weights: lanes }
    }

    #[inline(always)]
    pub(super) fn predict(&self, cues: &[Lanes; NUM_CUES]) -> Lanes {
        let p: [Lanes; NUM_CUES] = std::array::from_fn(|i| self.weights[i] * cues[i]);
        (((p[0] + p[1]) + (p[2] + p[3])) + ((p[4] + p[5]) + p[6])).clamp(-4.0, 32.0)
    }

    #[inline(always)]
    pub(super) fn learn(&mut self, cues: &[Lanes; NUM_CUES], predicted: Lanes, truth: Lanes) {
        let error = (truth - predicted).clamp(-3.0, 3.0);
        let s: [Lanes; NUM_CUES] = std::array::from_fn(|i| cues[i] * cues[i]);
        let energy = Lanes::splat(1.0) + (((s[0] + s[1]) + (s[2] + s[3])) + ((s[4] + s[5]) + s[6]));
        let step = (error * SCALE_RATE).zip(energy, |s, e| s / e);
        for (weight, &cue) in self.weights.iter_mut().zip(cues) {
            *weight += step * cue;
        }
    }
}

/// The prediction of one vertex, coordinate by coordinate. Lanes are axes.
pub(crate) struct VertexPrediction<'a> {
    surroundings: &'a CodingContext,
    /// Axes in coding order.
    axes: [usize; 3],
    /// Slopes of the surface over the axes coded first; 0 for the last one.
    slopes: Lanes,
    mean: Lanes,
    features: [Lanes; NUM_FEATURES],
    /// Centres of the experts.
    affine: Lanes,
    agreed: Consensus,
    length: f32,
    log_length: f32,
    /// Logarithms of the sizes that the neighbours' residuals suggest: ring along and across the
    /// surface, tips along and across.
    by_neighbours: Lanes,
    by_lean: Lanes,
    by_spread: Lanes,
    by_width: Lanes,
    /// Coordinates known so far, and their distance from the first expert's centre.
    position: Lanes,
    errors: [f32; 3],
}

/// The prediction of one coordinate. Lanes are experts.
pub(crate) struct CoordinatePrediction {
    pub(crate) axis: usize,
    /// Seen from the origin of the surroundings.
    pub(crate) mixture: Mixture,
    /// The expert with the highest peak, and the logarithm of its scale.
    pub(crate) best: usize,
    pub(crate) log_scale: f32,
    /// Logarithms of lengths that contexts may use: expected size by the residuals of the ring, of
    /// the outer vertices, by the coordinates already known, and disagreement of the predictions.
    pub(crate) by_ring: f32,
    pub(crate) by_tips: f32,
    pub(crate) by_known: f32,
    pub(crate) by_spread: f32,
    /// True if the affine correction points down the axis.
    pub(crate) leans_down: bool,
    /// Contribution of the coordinates already known to the centres.
    known: f32,
    cues: [Lanes; NUM_CUES],
    log_scales: Lanes,
    trust_level: usize,
    repeated_class: [usize; 2],
}

impl<'a> VertexPrediction<'a> {
    /// Guesses all three coordinates as far as that is possible before one of them is known.
    #[inline(always)]
    pub(crate) fn new(models: &PredictionModels, surroundings: &'a CodingContext) -> Self {
        Self::with_outlook(models, surroundings, surroundings.neighbourhood.outlook())
    }

    /// The same where the outlook is not that of a whole ring.
    #[inline(always)]
    pub(crate) fn with_outlook(
        models: &PredictionModels,
        surroundings: &'a CodingContext,
        outlook: Outlook,
    ) -> Self {
        let around = &surroundings.neighbourhood;
        let Outlook { mean, features, normal, length } = outlook;
        let axes = axis_order(normal);
        let slopes = slopes(normal, axes);
        let frame = Frame::new(slopes, axes[ACROSS]);
        let mean = frame.of(mean);
        let features = features.map(|f| frame.of(f));

        let [along, across] = &models.filters[surroundings.class];
        let (along, across) = (along.weights(), across.weights());
        let mut affine = mean;
        for i in 0..NUM_FEATURES {
            let mut weight = Lanes::splat(along[i]);
            weight.0[axes[ACROSS]] = across[i];
            affine += weight * features[i];
        }
        let mut guesses = Guesses::new();
        guesses.insert(affine);
        let degree = around.ring.len();
        if around.is_closed && degree.is_multiple_of(2) && degree <= MAX_GUESSES {
            let (first, second) = around.ring.split_at(degree / 2);
            for (&p, &q) in first.iter().zip(second) {
                guesses.insert(frame.of((p + q) * 0.5));
            }
        }
        for &p in around.parallelograms.iter().take(MAX_GUESSES) {
            guesses.insert(frame.of(p));
        }
        let agreed = guesses.consensus();

        let logs = |x: Lanes| (x + Lanes::splat(FLOOR)).map(log2);
        Self {
            surroundings,
            axes,
            slopes,
            mean,
            features,
            affine,
            agreed,
            length,
            log_length: log2(length),
            by_neighbours: logs(surroundings.roughness.map(exp2) * length),
            by_lean: logs(features[0].abs() + features[1].abs()),
            by_spread: logs(agreed.spread),
            by_width: logs(agreed.width),
            position: Lanes::ZERO,
            errors: [0.0; 3],
        }
    }

    /// Guesses the coordinate of `kind`; those before it have been [settled](Self::settle).
    #[inline(always)]
    pub(crate) fn coordinate(&self, models: &PredictionModels, kind: usize) -> CoordinatePrediction {
        let axis = self.axes[kind];
        let known = if kind == ACROSS { self.slopes.dot3(self.position) } else { 0.0 };
        let [ring_along, ring_across, tips_along, tips_across] = self.by_neighbours.0;
        let (by_ring, by_tips) =
            if kind == ACROSS { (ring_across, tips_across) } else { (ring_along, tips_along) };
        let by_known = match kind {
            0 => 0.0,
            _ => log2(self.errors[0].abs() + self.errors[1].abs() + FLOOR),
        };
        let (by_spread, by_width) = (self.by_spread.0[axis], self.by_width.0[axis]);
        let [median, mode] = [self.agreed.median, self.agreed.mode].map(|l| l.0[axis]);
        let (repeated, distance, count) = self.repeated(axis, median - known);
        let repeated_class = [count - 1, log_level(log2(distance + FLOOR), 1.0, TRUST_LEVELS)];
        let cues = [
            Lanes::splat(1.0),
            Lanes::splat(self.log_length),
            Lanes::splat(by_ring),
            Lanes::splat(by_tips),
            Lanes::splat(self.by_lean.0[axis]),
            Lanes::splat(by_known),
            Lanes([by_spread, by_spread, by_width, 0.0]),
        ];
        let mut log_scales = models.scales[kind].predict(&cues);
        log_scales.0[REPEATED] = REPEATED_LOG_SCALE;
        let trust_level = log_level(by_spread, 1.0, TRUST_LEVELS);
        let mut centre = Lanes([self.affine.0[axis], median, mode, 0.0]) - Lanes::splat(known);
        centre.0[REPEATED] = repeated;
        let mut mixture = Mixture {
            centre: centre.clamp(-MAX_CENTRE, MAX_CENTRE),
            sharpness: log_scales.map(|l| exp2(-l)) * SHARPNESS_FACTOR,
            weight: models.trust[kind][trust_level],
        };
        let [by_count, by_distance] = repeated_class;
        let weight = models.repeated[kind][by_count][by_distance].weight;
        let best = if weight > REPEATED_LEADS { REPEATED } else { mixture.best() };
        mixture.weight.0[REPEATED] = weight;
        CoordinatePrediction {
            axis,
            mixture,
            best,
            log_scale: log_scales.0[best],
            by_ring,
            by_tips,
            by_known,
            by_spread,
            leans_down: self.features[0].0[axis] < 0.0,
            known,
            cues,
            log_scales,
            trust_level,
            repeated_class,
        }
    }

    /// The neighbours' coordinate that is closest to `median`, the first one if equal, how far it is from it,
    /// and how many have it from there on, 1 to [`REPEATED_COUNTS`]: what is drawn along an axis, or lies in
    /// a plane across it, repeats coordinates to the bit.
    #[inline(always)]
    fn repeated(&self, axis: usize, median: f32) -> (f32, f32, usize) {
        let (mut repeated, mut least, mut count) = (0.0, MAX_CENTRE, 1);
        for p in &self.surroundings.neighbourhood.ring {
            let distance = (p.0[axis] - median).abs();
            if distance < least {
                (repeated, least, count) = (p.0[axis], distance, 1);
            } else if p.0[axis] == repeated {
                count += 1;
            }
        }
        (repeated, least, count.min(REPEATED_COUNTS))
    }

    /// Learns a coordinate.
    #[inline(always)]
    pub(crate) fn settle(
        &mut self,
        models: &mut PredictionModels,
        guess: &CoordinatePrediction,
        kind: usize,
        value: i32,
    ) {
        let axis = guess.axis;
        let truth = value.wrapping_sub(self.surroundings.origin[axis]) as f32;
        let filter = &mut models.filters[self.surroundings.class][usize::from(kind == ACROSS)];
        let per_length = 1.0 / self.length;
        let offset = (truth + guess.known) - self.mean.0[axis];
        filter.learn(self.features.map(|f| f.0[axis] * per_length), offset * per_length);

        let distance = guess.mixture.centre - Lanes::splat(truth);
        let sizes = (distance.abs() + Lanes::splat(FLOOR)).map(log2);
        models.scales[kind].learn(&guess.cues, guess.log_scales, sizes);

        let scores = guess.mixture.scores(truth);
        let share = scores * (1.0 / scores.sum());
        let [by_count, by_distance] = guess.repeated_class;
        let hit = share.0[REPEATED];
        models.repeated[kind][by_count][by_distance].learn(hit);
        // The others learn as much as it was not him.
        let mut others = share * (1.0 / (1.0 - hit).max(1e-6));
        others.0[REPEATED] = 0.0;
        let trust = &mut models.trust[kind][guess.trust_level];
        *trust = (*trust + (others - *trust) * (TRUST_RATE * (1.0 - hit))).max(LEAST_TRUST);
        self.position.0[axis] = truth;
        self.errors[kind] = distance.0[0];
    }

    /// Sizes of the residuals over the ring's length, as kept per vertex: along and across.
    pub(crate) fn roughness(&self) -> [i8; 2] {
        let [a, b, across] = self.errors;
        let along = (a * a + b * b).sqrt();
        [along, across.abs()].map(|error| {
            let log = log2(error + FLOOR) - self.log_length;
            (log * 8.0).clamp(-120.0, 120.0) as i8
        })
    }
}

/// Axes in coding order: the one closest to the normal last, the other two ascending.
#[inline(always)]
pub(super) fn axis_order(normal: Lanes) -> [usize; 3] {
    let [x, y, z, _] = normal.abs().0;
    if x > y && x > z {
        [1, 2, 0]
    } else if y > z {
        [0, 2, 1]
    } else {
        [0, 1, 2]
    }
}

/// The last coordinate is predicted along the normal, scaled so that its axis counts once: a prediction
/// that lies elsewhere on the surface is moved along its tangent plane. Returns what the other two
/// axes count.
#[inline(always)]
pub(super) fn slopes(normal: Lanes, axes: [usize; 3]) -> Lanes {
    let axis = axes[ACROSS];
    let n = normal.0[axis];
    if n == 0.0 {
        return Lanes::ZERO;
    }
    let mut slopes = (normal * (1.0 / n)).clamp(-MAX_SLOPE, MAX_SLOPE);
    slopes.0[axis] = 0.0;
    slopes
}

/// A shear: the coordinate across the surface becomes the place along the scaled normal.
struct Frame {
    columns: [Lanes; 3],
}

impl Frame {
    #[inline(always)]
    fn new(slopes: Lanes, across: usize) -> Self {
        // Entry by entry, in registers: LLVM 22 for the z10 takes stores to computed lanes apart into stack slots, and merges
        // slots that still hold lanes.
        let entry = |axis: usize, row: usize| match row {
            _ if row == axis => 1.0,
            _ if row == across => slopes.0[axis],
            _ => 0.0,
        };
        let columns = std::array::from_fn(|axis| Lanes(std::array::from_fn(|row| entry(axis, row))));
        Self { columns }
    }

    #[inline(always)]
    fn of(&self, p: Lanes) -> Lanes {
        let [x, y, z] = self.columns;
        (x * p.0[0] + y * p.0[1]) + z * p.0[2]
    }
}

/// Buckets of a base-2 logarithm: `per_octave` to the octave, from the floor on.
#[inline(always)]
pub(crate) fn log_level(log: f32, per_octave: f32, count: usize) -> usize {
    index_below((log + 1.5) * per_octave, count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::hint::black_box;

    /// A compiler once lost the slopes of a frame, where many points were sheared with it.
    #[test]
    fn a_frame_shears_every_point_alike() {
        let points = [[1365.0, 682.5, -2047.5, 0.0], [1.0, 2.0, 3.0, 0.0], [5.0, 7.0, 11.0, 0.0]].map(Lanes);
        for normal in [[4.0, 1.0, 2.0, 0.0], [1.0, 4.0, 2.0, 0.0], [1.0, 2.0, 4.0, 0.0]].map(Lanes) {
            let axes = axis_order(black_box(normal));
            let [first, second, across] = axes;
            let slopes = slopes(normal, axes);
            let frame = Frame::new(slopes, across);
            assert_eq!(
                (slopes.0[across], slopes.0[first], slopes.0[second]),
                (0.0, normal.0[first] / 4.0, normal.0[second] / 4.0)
            );
            for point in black_box(points) {
                let mut sheared = point;
                sheared.0[across] += slopes.dot3(point);
                assert_eq!(frame.of(point), sheared, "across axis {across}");
            }
        }
    }
}
