//! Predictions of the coordinates of a vertex from what is around it, and of how far off they are.

use super::arithmetic::{FLOOR, log_size, rough_log2};
use super::surroundings::Surroundings;
use super::symbols::{CLASSES, COUNTS, FRACTIONS, LEVELS, REPEATS, ResidualContext};
use super::weights::{Factors, NUM_CUES, NUM_FEATURES};
use crate::entropy::tables::{index_below, round_half_up};
use crate::passes::coordinate_prediction::{ACROSS, MAX_CENTRE, axis_order, slopes};
use crate::prediction::robust_estimate::Guesses;
use crate::util::simd4::Lanes;

/// Length that stands in for a collapsed ring, in grid steps.
const MIN_LENGTH: f32 = 0.25;
/// Levels of expected sizes: where they begin, as a logarithm, and how many there are to an octave.
const FIRST_LEVEL: f32 = -1.6;
const LEVELS_PER_OCTAVE: f32 = 5.0;
/// Steps either way in which a repeated coordinate makes a context.
const NEAR: i32 = 4;

/// What the surroundings say of a vertex. Lanes are axes.
pub(super) struct Outlook {
    pub(super) class: usize,
    pub(super) mean: Lanes,
    pub(super) features: [Lanes; NUM_FEATURES],
    pub(super) length: f32,
    /// Axes in coding order, and what the first two count in the coordinate across.
    pub(super) axes: [usize; 3],
    pub(super) slopes: Lanes,
    along: Lanes,
    across: Lanes,
    log_length: f32,
    /// Logarithms of sizes that the ring and the tips suggest, along and across.
    by_ring: [f32; 2],
    by_tips: [f32; 2],
    spread: Lanes,
    num_parallelograms: f32,
    /// Places so far, and how far off they were.
    pub(super) place: Lanes,
    pub(super) errors: [f32; 3],
}

/// What is expected of one coordinate.
pub(super) struct Expected {
    pub(super) axis: usize,
    centre: f32,
    pub(super) nearest: i32,
    /// True if the centre is below the nearest integer: residuals are counted the other way.
    pub(super) is_mirrored: bool,
    pub(super) cues: [f32; NUM_CUES],
}

impl Outlook {
    /// `None` if no neighbour has its place. `edge`: length that an edge usually has.
    #[inline(always)]
    pub(super) fn new(around: &Surroundings, factors: &Factors, edge: f32) -> Option<Self> {
        let count = around.ring.len();
        if count == 0 {
            return None;
        }
        let share = 1.0 / count as f32;
        let mut ring_mean = Lanes::ZERO;
        around.ring.iter().for_each(|&p| ring_mean += p);
        let ring_mean = ring_mean * share;
        let mut extent = Lanes::ZERO;
        around.ring.iter().for_each(|&p| extent += (p - ring_mean).abs());
        let [x, y, z, _] = extent.0;
        let length = if count > 1 { ((x + y) + z) * share } else { edge * 0.5 };
        let length = length.max(MIN_LENGTH);

        let parallelograms = &around.parallelograms[..];
        let (mut mean, mut spread, mut normal) = (ring_mean, Lanes::ZERO, Lanes::ZERO);
        let mut features = [around.misses * share, Lanes::ZERO, Lanes::ZERO];
        if !parallelograms.is_empty() {
            let mut sum = Lanes::ZERO;
            for p in parallelograms {
                sum += p.end;
                normal += (p.a - p.b).cross(p.tip - p.b);
            }
            mean = sum * (1.0 / parallelograms.len() as f32);
            let (median, range) = median(around);
            spread = range;
            features[1] = (ring_mean - mean) * 0.5;
            features[2] = median - mean;
        }
        if normal.dot3(normal) == 0.0 {
            normal = polygon(&around.ring, ring_mean);
        }
        let class = match (parallelograms.len(), count) {
            (0, 1) => CLASSES - 1,
            (count, _) => count.min(CLASSES - 2),
        };
        let axes = axis_order(normal);
        let [along, across] = factors.predictions[class];
        let corrected = |weights: [f32; NUM_FEATURES]| {
            let [a, b, c]: [Lanes; NUM_FEATURES] = std::array::from_fn(|i| features[i] * weights[i]);
            mean + ((a + b) + c)
        };
        let log_length = rough_log2(length);
        let by =
            |sum: [i32; 2], count: usize| sum.map(|sum| sum as f32 * (0.125 / count as f32) + log_length);
        let by_ring = by(around.ring_roughness, count);
        let is_any = !parallelograms.is_empty();
        let by_tips = if is_any { by(around.tip_roughness, parallelograms.len()) } else { by_ring };
        Some(Self {
            class,
            mean,
            features,
            length,
            axes,
            slopes: slopes(normal, axes),
            along: corrected(along),
            across: corrected(across),
            log_length,
            by_ring,
            by_tips,
            spread,
            num_parallelograms: parallelograms.len().min(3) as f32,
            place: Lanes::ZERO,
            errors: [0.0; 3],
        })
    }

    /// What is expected of the coordinate of `kind`; those before it have been settled.
    #[inline(always)]
    pub(super) fn expect(&self, kind: usize) -> Expected {
        let axis = self.axes[kind];
        let side = usize::from(kind == ACROSS);
        // A prediction elsewhere on the surface is moved along its tangent plane.
        let centre = match kind {
            ACROSS => self.across.0[axis] - self.slopes.dot3(self.place - self.across),
            _ => self.along.0[axis],
        };
        let centre = centre.clamp(-MAX_CENTRE, MAX_CENTRE);
        let nearest = round_half_up(centre);
        let by_known = match kind {
            0 => 0.0,
            _ => rough_log2(self.errors[0].abs() + self.errors[1].abs() + FLOOR),
        };
        let cues = [
            1.0,
            self.log_length,
            self.by_ring[side],
            self.by_tips[side],
            log_size(self.spread.0[axis]),
            by_known,
            self.num_parallelograms,
            log_size(self.features[0].0[axis]),
        ];
        Expected { axis, centre, nearest, is_mirrored: centre < nearest as f32, cues }
    }

    /// Notes a coordinate, seen from the origin.
    #[inline(always)]
    pub(super) fn settle(&mut self, expected: &Expected, kind: usize, place: i32) {
        let place = place as f32;
        self.place.0[expected.axis] = place;
        self.errors[kind] = place - expected.centre;
    }

    /// Sizes of the errors over the ring's length, along and across, in eighths of an octave.
    #[inline(always)]
    pub(super) fn roughness(&self) -> [i8; 2] {
        let [a, b, across] = self.errors;
        [a.abs() + b.abs(), across]
            .map(|error| ((log_size(error) - self.log_length) * 8.0).clamp(-120.0, 120.0) as i8)
    }
}

impl Expected {
    /// The context of the residual. `around`, if the neighbours' coordinates are looked at.
    #[inline(always)]
    pub(super) fn context(
        &self,
        kind: usize,
        class: usize,
        sizes: &[f32; NUM_CUES],
        around: Option<&Surroundings>,
    ) -> ResidualContext {
        let p: [f32; NUM_CUES] = std::array::from_fn(|i| sizes[i] * self.cues[i]);
        let log = ((p[0] + p[1]) + (p[2] + p[3])) + ((p[4] + p[5]) + (p[6] + p[7]));
        let fraction = (self.centre - self.nearest as f32).abs();
        let (repeated, count) = around.map_or((0, 0), |around| self.repeated(around));
        ResidualContext {
            kind,
            level: index_below((log - FIRST_LEVEL) * LEVELS_PER_OCTAVE, LEVELS),
            fraction: index_below(fraction * (2 * FRACTIONS) as f32, FRACTIONS),
            class,
            repeated,
            count,
        }
    }

    /// Where the neighbours' coordinate is that is closest to the centre, and how many more have it from there on: what is
    /// drawn along an axis, or lies in a plane across it, repeats coordinates to the bit.
    #[inline(always)]
    fn repeated(&self, around: &Surroundings) -> (usize, usize) {
        let (mut repeated, mut least, mut count) = (0.0, f32::INFINITY, 0);
        for p in &around.ring {
            let coordinate = p.0[self.axis];
            let distance = (coordinate - self.centre).abs();
            if distance < least {
                (repeated, least, count) = (coordinate, distance, 0);
            } else if coordinate == repeated {
                count += 1;
            }
        }
        let steps = (repeated as i32).saturating_sub(self.nearest);
        let steps = if self.is_mirrored { steps.wrapping_neg() } else { steps };
        let place = if (-NEAR..=NEAR).contains(&steps) { (steps + NEAR) as usize } else { REPEATS - 1 };
        (place, count.min(COUNTS - 1))
    }
}

/// The median of the parallelograms, coordinate by coordinate, and how far they are apart.
#[inline(always)]
fn median(around: &Surroundings) -> (Lanes, Lanes) {
    match around.parallelograms[..] {
        [] => (Lanes::ZERO, Lanes::ZERO),
        [p] => (p.end, Lanes::ZERO),
        [p, q] => ((p.end + q.end) * 0.5, (p.end - q.end).abs()),
        [p, q, r] => {
            let (low, high) = (p.end.min(q.end), p.end.max(q.end));
            (low.max(high.min(r.end)), high.max(r.end) - low.min(r.end))
        }
        _ => {
            let mut guesses = Guesses::new();
            around.parallelograms.iter().for_each(|p| guesses.insert(p.end));
            let consensus = guesses.consensus();
            (consensus.median, consensus.spread)
        }
    }
}

/// Twice the area vector of the ring.
fn polygon(ring: &[Lanes], mean: Lanes) -> Lanes {
    let mut sum = Lanes::ZERO;
    let mut before = ring[ring.len() - 1] - mean;
    for &p in ring {
        sum += before.cross(p - mean);
        before = p - mean;
    }
    sum
}
