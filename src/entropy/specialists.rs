//! What the profile *max* adds to mixed bits (`format/SPEC.md`, section 6.3): each value of the first contexts
//! has its own weights, and corrects the resulting probability.

use super::counter::Counter;
use super::range_coder::PROBABILITY_ONE;
use super::tables::Tables;
use super::weights::WeightSet;
use crate::util::simd4::Lanes;

/// Contexts of a bit whose values have specialists.
pub(super) const MOST: usize = 3;

/// A counter of age a counts (a + 1) / (a + CAUTION).
const CAUTION: f32 = 4.0;
/// Weight a context starts with.
pub(super) const INITIAL_WEIGHT: f32 = 0.25;
/// Share of the weights of one value, relative to those of the set.
const SHARE: f32 = 0.3;
/// They learn this many times as fast.
const EAGERNESS: f32 = 2.0;

/// Steps between the log-odds that are corrected one by one, and their width.
const STEPS: usize = 16;
const WIDTH: f32 = 0.75;
/// Just below the last of them.
const LAST_PLACE: f32 = 15.99;
/// What a correction counts as seen from the start, and at most.
const FIRST_AGE: u32 = 12;
const OLDEST_AGE: u32 = 250;

/// No bit has been coded with this value of a context.
const NONE: u32 = u32::MAX;

/// Specialists for the values of the first contexts of a bit.
#[derive(Clone)]
pub(super) struct Specialists {
    /// Index of the specialist of each value, made when it is first used.
    of_slot: Vec<u32>,
    list: Vec<Specialist>,
    first: Specialist,
    /// What a counter of each age counts.
    say: Vec<f32>,
}

#[derive(Clone, Copy)]
#[repr(align(128))]
struct Specialist {
    own: WeightSet,
    /// Chance of a one where the mixer says the log-odds (i − STEPS / 2) · WIDTH.
    corrections: [Counter; STEPS + 1],
}

/// What the specialists of up to [`MOST`] contexts say about a bit.
pub(super) struct Opinion {
    n: usize,
    specialists: [usize; MOST],
    /// Probability of a one by the weights of each.
    by_own: [u32; MOST],
    /// The correction that learns.
    nearest: usize,
    /// Probability of a one in 1/65536.
    pub(super) p: u32,
}

impl Specialists {
    /// For `num_slots` values; `own` are the weights they start with, `oldest_counter` is the largest age of a counter.
    #[inline(never)]
    pub(super) fn new(num_slots: usize, own: WeightSet, oldest_counter: u32) -> Self {
        let tables = Tables::get();
        let corrections = std::array::from_fn(|i| {
            let log_odds = (i as f32 - (STEPS / 2) as f32) * WIDTH;
            Counter::aged(tables.squash(log_odds), FIRST_AGE)
        });
        let first = Specialist { own, corrections };
        let say = (0..=oldest_counter).map(|age| (age as f32 + 1.0) / (age as f32 + CAUTION)).collect();
        Self { of_slot: vec![NONE; num_slots], list: Vec::new(), first, say }
    }

    /// What a counter of this age counts: little as long as it is young.
    #[inline]
    pub(super) fn say(&self, age: u32) -> f32 {
        self.say[age as usize]
    }

    /// Their prediction where the weights of a set say `by_set`; `slots` are those of all contexts.
    #[inline(never)]
    pub(super) fn judge(
        &mut self,
        tables: &Tables,
        slots: &[usize],
        inputs: &[Lanes; 2],
        by_set: f32,
    ) -> Opinion {
        let n = slots.len().min(MOST);
        let (mut specialists, mut by_own) = ([0; MOST], [0; MOST]);
        for (specialist, &slot) in specialists[..n].iter_mut().zip(slots) {
            let entry = &mut self.of_slot[slot];
            if *entry == NONE {
                *entry = self.list.len() as u32;
                self.list.push(self.first);
            }
            *specialist = *entry as usize;
        }
        let mut sum = 0.0;
        for (p, &i) in by_own.iter_mut().zip(&specialists[..n]) {
            let log_odds = self.list[i].own.log_odds(inputs);
            *p = tables.squash(log_odds);
            sum += log_odds;
        }
        let together = (by_set + sum * SHARE) / (1.0 + n as f32 * SHARE);
        let place = (together * (1.0 / WIDTH) + (STEPS / 2) as f32).clamp(0.0, LAST_PLACE);
        let below = place as usize;
        let above_share = place - below as f32;
        let mut sum = 0.0;
        for &i in &specialists[..n] {
            let corrections = &self.list[i].corrections;
            let [low, high] = [corrections[below], corrections[below + 1]].map(|c| c.p16() as f32);
            sum += low + (high - low) * above_share;
        }
        let p = ((sum / n as f32) as u32).clamp(24, PROBABILITY_ONE - 24);
        Opinion { n, specialists, by_own, nearest: below + usize::from(above_share > 0.5), p }
    }

    #[inline(never)]
    pub(super) fn learn(&mut self, inputs: &[Lanes; 2], opinion: &Opinion, bit: bool) {
        for (&i, p) in opinion.specialists[..opinion.n].iter().zip(opinion.by_own) {
            let specialist = &mut self.list[i];
            specialist.own.learn(inputs, p, bit, EAGERNESS);
            specialist.corrections[opinion.nearest].update(bit, OLDEST_AGE);
        }
    }
}
