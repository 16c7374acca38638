//! From the entries around to the density of each channel, and its coding (`format/SPEC.md`, section 8.4).

use super::around::Around;
use super::entries::Entries;
use super::octahedron::{Octahedron, project};
use crate::entropy::context_mixer::Mixing;
use crate::entropy::mixture::Mixture;
use crate::entropy::range_coder::BitCoder;
use crate::entropy::residual::{Expectation, NUM_KINDS, ResidualModel};
use crate::entropy::tables::{exp2, log2};
use crate::passes::coordinate_prediction::{
    FLOOR, MAX_CENTRE, NUM_CUES, SHARPNESS_FACTOR, ScaleModel, TRUST_LEVELS, TRUST_RATE, log_level,
};
use crate::prediction::plane_fit::PlaneFit;
use crate::prediction::rls::{Filter, sum};
use crate::util::simd4::Lanes;

/// What the channels mean together.
#[derive(Clone, Copy, Debug)]
pub(super) enum Flavour {
    Plain,
    /// The second channel, green, goes first: the others follow it.
    Color,
    /// The first two channels are a map of the surface.
    TexCoord,
    Normal(Octahedron),
}

/// Features: towards the mean by inverse distances, the affine fit, and what is special to the flavour; the
/// errors of the two channels before.
const NUM_FEATURES: usize = 5;
const FIRST_WEIGHTS: [f32; NUM_FEATURES] = [0.3, 0.4, 0.1, 0.0, 0.0];
/// Classes of neighbourhoods with separate filters.
const NUM_CLASSES: usize = 8;
/// Channels with separate models; the last ones share.
const NUM_PLACES: usize = 4;
const FIRST_SCALES: [f32; NUM_CUES] = [-0.4, 0.35, 0.3, 0.1, 0.1, 0.0, 0.05];
const FIRST_TRUST: Lanes = Lanes([0.25; 4]);
const LEAST_TRUST: Lanes = Lanes([0.02; 4]);
/// Logarithm of a residual that nothing is known of.
const UNKNOWN_ROUGHNESS: f32 = 3.0;

/// What is learnt about the numbers of an attribute.
#[derive(Clone)]
pub(super) struct NumberModels {
    flavour: Flavour,
    range: [i32; 2],
    filters: Vec<[Filter<NUM_FEATURES>; NUM_PLACES]>,
    scales: [ScaleModel; NUM_PLACES],
    trust: [[Lanes; TRUST_LEVELS]; NUM_PLACES],
    residuals: ResidualModel,
    /// Texture coordinates: how much more of the surface is mapped mirrored.
    mirrored: f32,
}

/// How entries are looked at: with this octahedron turned inside out, or as they are.
#[derive(Clone, Copy)]
struct View(Option<Octahedron>);

impl View {
    fn channel(self, entry: &[i32], k: usize) -> i32 {
        match self.0 {
            Some(octahedron) => octahedron.flip([entry[0], entry[1]])[k],
            None => entry[k],
        }
    }
}

/// What is known about one channel before it is coded.
#[derive(Clone, Copy, Default)]
struct Outlook {
    mean: f32,
    spread: f32,
    /// The first three features.
    features: [f32; 3],
    /// Middle of the ring's values.
    median: f32,
    /// Of maps: how far the known points lie off the conformal fit.
    misfit: f32,
}

/// Scratch space.
#[derive(Default)]
pub(super) struct Scratch {
    fit: PlaneFit,
    values: Vec<f32>,
    other: Vec<f32>,
    sorted: Vec<f32>,
    outlooks: Vec<Outlook>,
    origin: Vec<i32>,
    channels: Vec<i32>,
}

impl NumberModels {
    pub(super) fn new(flavour: Flavour, range: [i32; 2], mixing: Mixing) -> Self {
        let filters = || std::array::from_fn(|_| Filter::new(FIRST_WEIGHTS));
        Self {
            flavour,
            range,
            filters: (0..NUM_CLASSES).map(|_| filters()).collect(),
            scales: [ScaleModel::new(FIRST_SCALES); NUM_PLACES],
            trust: [[FIRST_TRUST; TRUST_LEVELS]; NUM_PLACES],
            residuals: ResidualModel::new(mixing),
            mirrored: 0.0,
        }
    }

    /// Codes an entry and appends it; `None` if a channel leaves its range. `wanted` is not empty when encoding.
    pub(super) fn code<B: BitCoder>(
        &mut self,
        coder: &mut B,
        entries: &mut Entries,
        around: &Around,
        wanted: &[i32],
        scratch: &mut Scratch,
    ) -> Option<u32> {
        let num_channels = entries.num_channels;
        let view = self.view(entries, around);
        self.look(entries, around, view, scratch);
        let class = class(around);
        let by_ring = match around.ring.len() {
            0 => UNKNOWN_ROUGHNESS,
            n => {
                let mut sum = 0.0;
                around.ring.iter().for_each(|known| sum += entries.roughness(known.entry));
                sum / n as f32
            }
        };
        let mut errors = [0.0_f32; 2];
        let mut total_error = 0.0;
        scratch.channels.clear();
        scratch.channels.resize(num_channels, 0);
        for place in 0..num_channels {
            let channel = self.channel_at(place, num_channels);
            let outlook = scratch.outlooks[channel];
            let origin = scratch.origin[channel];
            let wanted = if wanted.is_empty() { 0 } else { view.channel(wanted, channel) };
            let guess = self.guess(place, class, &outlook, by_ring, errors);
            let expected = guess.expectation(origin, place, class, &outlook, by_ring);
            let value = self.residuals.code(coder, &expected, wanted);
            // What a cut payload does not contain is as predicted.
            let value = if coder.is_guessing() { Some(guess.likeliest(origin, self.range)) } else { value };
            let value = value.filter(|value| (self.range[0]..=self.range[1]).contains(value))?;
            let truth = value.wrapping_sub(origin) as f32;
            self.learn(place, class, &guess, &outlook, errors, truth);
            let error = truth - guess.mixture.centre.0[0];
            total_error += error.abs();
            errors = [error, errors[0]];
            scratch.channels[channel] = value;
        }
        if let View(Some(octahedron)) = view {
            let turned = octahedron.flip([scratch.channels[0], scratch.channels[1]]);
            scratch.channels.copy_from_slice(&turned);
        }
        let roughness = log2(total_error / num_channels as f32 + FLOOR) * 8.0;
        Some(entries.push(&scratch.channels, roughness.clamp(-120.0, 120.0) as i8))
    }

    fn channel_at(&self, place: usize, num_channels: usize) -> usize {
        match (self.flavour, place) {
            (Flavour::Color, 0 | 1) if num_channels >= 3 => 1 - place,
            _ => place,
        }
    }

    /// Directions are looked at with the square turned inside out if the one that is expected, by the ring and
    /// the surface, lies in the lower half.
    fn view(&self, entries: &Entries, around: &Around) -> View {
        let Flavour::Normal(octahedron) = self.flavour else { return View(None) };
        let mut sum = 0.0;
        for known in &around.ring {
            let entry = entries.get(known.entry);
            sum += octahedron.direction([entry[0], entry[1]])[2] as f32;
        }
        let length = around.normal.dot3(around.normal).sqrt();
        if length > 0.0 {
            sum += around.normal.0[2] / length;
        }
        View((sum < 0.0).then_some(octahedron))
    }

    /// Of directions: where that of the surface is, unless it has none.
    fn project(&self, around: &Around, view: View) -> Option<[f32; 2]> {
        let Flavour::Normal(octahedron) = self.flavour else { return None };
        let [x, y, z, _] = around.normal.0;
        let z = if view.0.is_some() { -z } else { z };
        let is_flat = around.normal.dot3(around.normal) > 0.0;
        is_flat.then(|| project([x, y, z], octahedron.radius() as f32))
    }

    /// Fills the outlook of each channel, and the origin that all is counted from.
    fn look(&mut self, entries: &Entries, around: &Around, view: View, scratch: &mut Scratch) {
        let Scratch { fit, values, other, sorted, outlooks, origin, .. } = scratch;
        let num_channels = entries.num_channels;
        origin.clear();
        outlooks.clear();
        outlooks.resize(num_channels, Outlook::default());
        let [low, high] = self.range;
        let Some(first) = around.ring.first() else {
            if let Some(place) = self.project(around, view) {
                origin.extend(place.map(|c| c as i32));
                outlooks.iter_mut().for_each(|outlook| outlook.spread = high as f32 * 0.05);
                return;
            }
            let middle = low + (high - low) / 2;
            let last = |k| entries.last().map_or(middle, |last| view.channel(last, k));
            origin.extend((0..num_channels).map(last));
            let spread = (high - low) as f32 * 0.125;
            outlooks.iter_mut().for_each(|outlook| outlook.spread = spread);
            return;
        };
        origin.extend((0..num_channels).map(|k| view.channel(entries.get(first.entry), k)));
        let all = || around.ring.iter().chain(&around.tips);
        fit.set(all().map(|known| known.way), around.normal);
        let read = |values: &mut Vec<f32>, k: usize| {
            values.clear();
            let value = |entry: u32| view.channel(entries.get(entry), k).wrapping_sub(origin[k]) as f32;
            values.extend(all().map(|known| value(known.entry)));
        };
        let n = around.ring.len();
        let share = 1.0 / n as f32;
        for (k, outlook) in outlooks.iter_mut().enumerate() {
            read(values, k);
            let ring = &values[..n];
            let mut total = 0.0;
            ring.iter().for_each(|v| total += v);
            let mean = total * share;
            let (mut spread, mut near, mut weight) = (0.0, 0.0, 0.0);
            for (value, known) in ring.iter().zip(&around.ring) {
                let d = value - mean;
                spread += d.abs();
                let w = 1.0 / (known.way.dot3(known.way).sqrt() + 0.25);
                near += d * w;
                weight += w;
            }
            sorted.clear();
            sorted.extend_from_slice(ring);
            sorted.sort_unstable_by(f32::total_cmp);
            let median = if n % 2 == 1 { sorted[n / 2] } else { (sorted[n / 2] + sorted[n / 2 - 1]) * 0.5 };
            let affine = fit.affine(values);
            let mut parallelogram = 0.0;
            if !around.triangles.is_empty() {
                let value = |entry: u32| view.channel(entries.get(entry), k).wrapping_sub(origin[k]) as f32;
                for &[a, b, tip] in &around.triangles {
                    parallelogram += ((value(a) + value(b)) - value(tip)) - mean;
                }
                parallelogram *= 1.0 / around.triangles.len() as f32;
            }
            *outlook = Outlook {
                mean,
                spread: spread * share,
                features: [near / weight, affine - mean, parallelogram],
                median,
                misfit: 0.0,
            };
        }
        match self.flavour {
            Flavour::TexCoord if num_channels >= 2 => {
                read(values, 0);
                read(other, 1);
                let [plain, mirrored] = [false, true].map(|m| fit.conformal([values, other], m));
                let is_mirrored = if all().count() > 2 {
                    let is_better = mirrored.explained > plain.explained;
                    self.mirrored += (if is_better { 1.0 } else { -1.0 } - self.mirrored) * 0.02;
                    is_better
                } else {
                    self.mirrored > 0.0
                };
                let found = if is_mirrored { mirrored } else { plain };
                // A map stretches along one channel what lies along the other next to it.
                let spread = (outlooks[0].spread + outlooks[1].spread) * 0.5;
                for (outlook, value) in outlooks.iter_mut().zip(found.values) {
                    outlook.features[2] = value - outlook.mean;
                    outlook.spread = spread;
                    outlook.misfit = found.misfit;
                }
            }
            Flavour::Normal(_) => {
                let place = self.project(around, view).unwrap_or_default();
                for k in 0..2 {
                    outlooks[k].features[2] = (place[k] - origin[k] as f32) - outlooks[k].mean;
                }
            }
            _ => {}
        }
    }

    fn guess(&self, place: usize, class: usize, outlook: &Outlook, by_ring: f32, errors: [f32; 2]) -> Guess {
        let place = place.min(NUM_PLACES - 1);
        let w = self.filters[class][place].weights();
        let Outlook { mean, features: [near, affine, special], spread, median, .. } = *outlook;
        let cross = w[3] * errors[0] + w[4] * errors[1];
        let all = mean + sum(w, [near, affine, special, errors[0], errors[1]]);
        let third = match self.flavour {
            Flavour::Plain | Flavour::Color => median,
            Flavour::TexCoord | Flavour::Normal(_) => mean + special,
        };
        let log = |x: f32| log2(x.abs() + FLOOR);
        let by_spread = log(spread);
        let by_error = log(errors[0]);
        let cues = [
            1.0,
            by_spread,
            by_ring,
            log(affine - near),
            if place > 0 { by_error } else { 0.0 },
            match self.flavour {
                Flavour::TexCoord if place < 2 => log(outlook.misfit),
                _ if place > 1 => log(errors[1]),
                _ => 0.0,
            },
            log(mean + special - all),
        ]
        .map(Lanes::splat);
        let logs = self.scales[place].predict(&cues);
        let centre = Lanes([all, mean + affine + cross, third + cross, mean + near + cross]);
        let trust_level = log_level(by_spread, 1.0, TRUST_LEVELS);
        let mixture = Mixture {
            centre: centre.clamp(-MAX_CENTRE, MAX_CENTRE),
            sharpness: logs.map(|l| exp2(-l)) * SHARPNESS_FACTOR,
            weight: self.trust[place][trust_level],
        };
        Guess { mixture, cues, logs, trust_level, by_spread, by_error, by_fit: log(affine - near) }
    }

    fn learn(
        &mut self,
        place: usize,
        class: usize,
        guess: &Guess,
        outlook: &Outlook,
        errors: [f32; 2],
        truth: f32,
    ) {
        let place = place.min(NUM_PLACES - 1);
        let unit = 1.0 / (outlook.spread + 1.0);
        let [near, affine, special] = outlook.features;
        let features = [near, affine, special, errors[0], errors[1]].map(|f| f * unit);
        self.filters[class][place].learn(features, (truth - outlook.mean) * unit);
        let distance = guess.mixture.centre - Lanes::splat(truth);
        let sizes = (distance.abs() + Lanes::splat(FLOOR)).map(log2);
        self.scales[place].learn(&guess.cues, guess.logs, sizes);
        let scores = guess.mixture.scores(truth);
        let share = scores * (1.0 / scores.sum());
        let trust = &mut self.trust[place][guess.trust_level];
        *trust = (*trust + (share - *trust) * TRUST_RATE).max(LEAST_TRUST);
    }
}

/// The prediction of one channel. Lanes are experts: the filter, the affine fit, the median (of maps and
/// directions what is special to them), the mean by inverse distances.
struct Guess {
    mixture: Mixture,
    cues: [Lanes; NUM_CUES],
    logs: Lanes,
    trust_level: usize,
    by_spread: f32,
    by_error: f32,
    by_fit: f32,
}

impl Guess {
    fn likeliest(&self, origin: i32, [low, high]: [i32; 2]) -> i32 {
        let centre = self.mixture.centre.0[0];
        let nearest = (if centre < 0.0 { centre - 0.5 } else { centre + 0.5 }) as i32;
        origin.saturating_add(nearest).clamp(low, high)
    }

    fn expectation(
        &self,
        origin: i32,
        place: usize,
        class: usize,
        outlook: &Outlook,
        by_ring: f32,
    ) -> Expectation {
        let best = self.mixture.best();
        let by_error = if place > 0 { log_level(self.by_error, 1.0, 8) } else { 0 };
        Expectation {
            origin,
            mixture: self.mixture,
            best,
            log_scale: self.logs.0[best],
            kind: place.min(NUM_KINDS - 1),
            contexts: [
                log_level(by_ring, 2.0, 16) * 16 + log_level(self.by_spread, 1.0, 16),
                (class * 8 + by_error) * 4 + log_level(self.by_fit, 0.5, 4),
            ],
            sign: 2 * class + usize::from(outlook.features[0] < 0.0),
        }
    }
}

/// Closed rings by their size, then open ones.
fn class(around: &Around) -> usize {
    let n = around.ring.len();
    match n {
        _ if around.is_closed => n.clamp(4, 7) - 4,
        0..=2 => 4 + usize::from(!around.tips.is_empty()),
        3 => 6,
        _ => 7,
    }
}
