//! From a neighbourhood to the density of each coordinate (`format/SPEC.md`, section 8.3): three
//! experts, each with a scale that follows a linear model, weighed by how well they did.

use super::surroundings::{NUM_CLASSES, Surroundings};
use crate::bitstream::mixture::{Expert, NUM_EXPERTS};
pub(crate) use crate::bitstream::residual::NUM_KINDS;
use crate::bitstream::tables::Tables;
use crate::lifting::affine::AffineFilter;
use crate::lifting::consensus::consensus;
use crate::lifting::neighbourhood::Outlook;
use crate::lifting::vec3::{Direction, Vec3};

/// Kind of the coordinate closest to the normal.
pub(crate) const ACROSS: usize = 2;
/// Inputs of the scale models.
const NUM_CUES: usize = 7;
/// Smallest length that counts in a logarithm, in grid steps.
const FLOOR: f64 = 0.35;
/// Typical residual over the exponential of its mean logarithm.
const SCALE_FACTOR: f64 = 0.85;
/// Step of the scale models.
const SCALE_RATE: f64 = 0.02;
/// Step of the experts' weights, and the least weight.
const TRUST_RATE: f64 = 0.02;
const LEAST_TRUST: f64 = 0.02;
const TRUST_LEVELS: usize = 16;
/// Steepest slope of the surface over the two axes coded first that is believed.
const MAX_SLOPE: f64 = 4.0;
/// Bound on centres, far outside any grid.
const MAX_CENTRE: f64 = 1e9;

/// What is learnt about coordinates; kept from pass to pass.
pub(crate) struct GuessModels {
    /// Per class: the filter of the coordinates along the surface and of the one across it.
    filters: Vec<[AffineFilter; 2]>,
    scales: [[ScaleModel; NUM_EXPERTS]; NUM_KINDS],
    trust: [[[f64; NUM_EXPERTS]; TRUST_LEVELS]; NUM_KINDS],
}

impl GuessModels {
    pub(crate) fn new() -> Self {
        Self {
            filters: vec![[AffineFilter::new(), AffineFilter::new()]; NUM_CLASSES],
            scales: [[ScaleModel::new(); NUM_EXPERTS]; NUM_KINDS],
            trust: [[[1.0 / NUM_EXPERTS as f64; NUM_EXPERTS]; TRUST_LEVELS]; NUM_KINDS],
        }
    }
}

/// Linear model of the base-2 logarithm of a residual's size.
#[derive(Clone, Copy)]
struct ScaleModel {
    weights: [f64; NUM_CUES],
}

impl ScaleModel {
    const fn new() -> Self {
        Self { weights: [-0.4, 0.1, 0.2, 0.3, 0.1, 0.0, 0.3] }
    }

    fn predict(&self, cues: &[f64; NUM_CUES]) -> f64 {
        let p: [f64; NUM_CUES] = std::array::from_fn(|i| self.weights[i] * cues[i]);
        (((p[0] + p[1]) + (p[2] + p[3])) + ((p[4] + p[5]) + p[6])).clamp(-4.0, 32.0)
    }

    fn learn(&mut self, cues: &[f64; NUM_CUES], predicted: f64, truth: f64) {
        let error = (truth - predicted).clamp(-3.0, 3.0);
        let s: [f64; NUM_CUES] = std::array::from_fn(|i| cues[i] * cues[i]);
        let energy = 1.0 + (((s[0] + s[1]) + (s[2] + s[3])) + ((s[4] + s[5]) + s[6]));
        let step = error * SCALE_RATE / energy;
        for (weight, cue) in self.weights.iter_mut().zip(cues) {
            *weight += step * cue;
        }
    }
}

/// The guess at one vertex, coordinate after coordinate.
pub(crate) struct VertexGuess<'a> {
    surroundings: &'a Surroundings,
    outlook: Outlook,
    /// Axes in coding order.
    axes: [usize; 3],
    log_length: f64,
    /// Logarithms of the sizes that the neighbours' residuals suggest: ring and tips, each along and
    /// across the surface.
    by_neighbours: [[f64; 2]; 2],
    /// Coordinates known so far, and their distance from the first expert's centre.
    position: Vec3,
    errors: Vec3,
}

/// The guess at one coordinate.
pub(crate) struct CoordinateGuess {
    pub(crate) axis: usize,
    pub(crate) experts: [Expert; NUM_EXPERTS],
    /// The expert with the highest peak, and the logarithm of its scale.
    pub(crate) best: usize,
    pub(crate) log_scale: f64,
    /// Logarithms of lengths that contexts may use: expected size by the residuals of the ring, of
    /// the outer vertices, by the coordinates already known, and disagreement of the guesses.
    pub(crate) by_ring: f64,
    pub(crate) by_tips: f64,
    pub(crate) by_known: f64,
    pub(crate) by_spread: f64,
    /// True if the affine correction points down the axis.
    pub(crate) leans_down: bool,
    kind: usize,
    direction: Direction,
    /// Contribution of the coordinates already known along `direction`.
    known: f64,
    cues: [[f64; NUM_CUES]; NUM_EXPERTS],
    log_scales: [f64; NUM_EXPERTS],
    trust_level: usize,
}

impl<'a> VertexGuess<'a> {
    pub(crate) fn new(surroundings: &'a Surroundings) -> Self {
        let outlook = surroundings.neighbourhood.outlook();
        let tables = Tables::get();
        let size = |roughness: f64| tables.log2(outlook.length * tables.exp2(roughness) + FLOOR);
        Self {
            by_neighbours: [surroundings.ring_roughness.map(size), surroundings.tip_roughness.map(size)],
            surroundings,
            axes: axis_order(outlook.normal),
            log_length: tables.log2(outlook.length),
            outlook,
            position: [0.0; 3],
            errors: [0.0; 3],
        }
    }

    /// Guesses the coordinate of `kind`; those before it have been [settled](Self::settle).
    #[inline(always)]
    pub(crate) fn coordinate(&self, models: &GuessModels, kind: usize) -> CoordinateGuess {
        let tables = Tables::get();
        let axis = self.axes[kind];
        let (direction, known) = self.direction(kind);
        let across = usize::from(kind == ACROSS);
        let filter = &models.filters[self.surroundings.class()][across];
        let affine = filter.predict(&self.outlook, direction);
        let agreed = consensus(&self.surroundings.neighbourhood, direction, affine);

        let [by_ring, by_tips] = self.by_neighbours.map(|by| by[across]);
        let lean = self.outlook.features[0][axis];
        let by_lean = tables.log2(lean.abs() + self.outlook.features[1][axis].abs() + FLOOR);
        let by_known = tables.log2(self.errors[0].abs() + self.errors[1].abs() + FLOOR);
        let by_spread = tables.log2(agreed.spread + FLOOR);
        let by_width = tables.log2(agreed.width + FLOOR);
        let cues = [by_spread, by_spread, by_width].map(|by| {
            [1.0, self.log_length, by_ring, by_tips, by_lean, if kind == 0 { 0.0 } else { by_known }, by]
        });

        let log_scales: [f64; NUM_EXPERTS] =
            std::array::from_fn(|i| models.scales[kind][i].predict(&cues[i]));
        let trust_level = log_level(by_spread, 1.0, TRUST_LEVELS);
        let centres = [affine, agreed.median, agreed.mode];
        let experts: [Expert; NUM_EXPERTS] = std::array::from_fn(|i| Expert {
            centre: (centres[i] - known).clamp(-MAX_CENTRE, MAX_CENTRE),
            scale: tables.exp2(log_scales[i]) * SCALE_FACTOR,
            weight: models.trust[kind][trust_level][i],
        });
        let mut best = 0;
        for i in 1..NUM_EXPERTS {
            if experts[i].weight * experts[best].scale > experts[best].weight * experts[i].scale {
                best = i;
            }
        }
        CoordinateGuess {
            axis,
            experts,
            best,
            log_scale: log_scales[best],
            by_ring,
            by_tips,
            by_known: if kind == 0 { 0.0 } else { by_known },
            by_spread,
            leans_down: lean < 0.0,
            kind,
            direction,
            known,
            cues,
            log_scales,
            trust_level,
        }
    }

    /// Direction along which a coordinate is guessed, and what the known ones contribute to it. The
    /// last coordinate is guessed along the normal, scaled so that the axis itself counts once: a
    /// guess that lies elsewhere on the surface is moved along its tangent plane.
    fn direction(&self, kind: usize) -> (Direction, f64) {
        let axis = self.axes[kind];
        let n = self.outlook.normal;
        if kind != ACROSS || n[axis] == 0.0 {
            return (Direction::Axis(axis), 0.0);
        }
        let mut along = [0.0; 3];
        along[axis] = 1.0;
        let mut known = 0.0;
        for &a in &self.axes[..2] {
            along[a] = (n[a] / n[axis]).clamp(-MAX_SLOPE, MAX_SLOPE);
            known += along[a] * self.position[a];
        }
        (Direction::Along(along), known)
    }

    /// Learns a coordinate.
    #[inline(always)]
    pub(crate) fn settle(&mut self, models: &mut GuessModels, guess: &CoordinateGuess, value: i32) {
        let tables = Tables::get();
        let truth = f64::from(value);
        let kind = guess.kind;
        let filter = &mut models.filters[self.surroundings.class()][usize::from(kind == ACROSS)];
        filter.learn(&self.outlook, guess.direction, truth + guess.known);
        for i in 0..NUM_EXPERTS {
            let size = tables.log2((truth - guess.experts[i].centre).abs() + FLOOR);
            models.scales[kind][i].learn(&guess.cues[i], guess.log_scales[i], size);
        }
        let likelihood = guess.experts.map(|e| e.score(truth));
        let total = (likelihood[0] + likelihood[1]) + likelihood[2];
        let trust = &mut models.trust[kind][guess.trust_level];
        for i in 0..NUM_EXPERTS {
            let share = likelihood[i] / total;
            trust[i] = (trust[i] + (share - trust[i]) * TRUST_RATE).max(LEAST_TRUST);
        }
        self.position[guess.axis] = truth;
        self.errors[kind] = truth - guess.experts[0].centre;
    }

    /// Sizes of the residuals over the ring's length, as kept per vertex: along and across.
    pub(crate) fn roughness(&self) -> [i8; 2] {
        let [a, b, across] = self.errors;
        let along = (a * a + b * b).sqrt();
        [along, across.abs()].map(|error| {
            let log = Tables::get().log2(error + FLOOR) - self.log_length;
            (log * 8.0).clamp(-120.0, 120.0) as i8
        })
    }
}

/// Axes in coding order: the one closest to the normal last, the other two ascending.
fn axis_order(normal: Vec3) -> [usize; 3] {
    let [x, y, z] = normal.map(f64::abs);
    if x > y && x > z {
        [1, 2, 0]
    } else if y > z {
        [0, 2, 1]
    } else {
        [0, 1, 2]
    }
}

/// Buckets of a base-2 logarithm: `per_octave` to the octave, from the floor on.
pub(crate) fn log_level(log: f64, per_octave: f64, count: usize) -> usize {
    ((log + 1.5) * per_octave).clamp(0.0, (count - 1) as f64) as usize
}
