//! Adaptive bits with mixed contexts (`format/SPEC.md`, section 6.3): counters predict a bit from
//! one context each, a small online logistic regression weighs them.

use super::range_coder::BitCoder;
use super::specialists::{self, Specialists};
use super::tables::Tables;
use crate::util::simd4::Lanes;
use std::hint::black_box;

/// Inputs of every mixer: contexts, direct inputs and the bias together. Two SIMD vectors.
const LANES: usize = 8;

/// Weight a context starts with.
const INITIAL_WEIGHT: f32 = 0.35;
/// Step of the weights: FAST / (1 + n / DECAY) + SLOW after n bits.
const RATE_FAST: f32 = 0.05;
const RATE_SLOW: f32 = 0.008;
const RATE_DECAY: f32 = 256.0;

/// How bits are mixed: a number of the profile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mixing {
    /// By the weights of one set.
    Plain,
    /// Beside them by a specialist for each value of the first contexts.
    Specialised,
}

/// Probability of a one in one context: 22 bits of probability, 10 bits of age.
#[derive(Clone, Copy)]
pub(crate) struct Counter(u32);

impl Counter {
    const AGE_BITS: u32 = 10;
    const AGE_MASK: u32 = (1 << Self::AGE_BITS) - 1;

    pub(crate) const fn new() -> Self {
        Self::aged(1 << 15, 0)
    }

    /// With the probability `p16` in 1/65536 as if it had learnt it from `age` bits.
    pub(super) const fn aged(p16: u32, age: u32) -> Self {
        Self(p16 << 16 | age)
    }

    /// Probability of a one in 1/4096.
    #[inline]
    fn p12(self) -> usize {
        (self.0 >> 20) as usize
    }

    /// Probability of a one in 1/65536.
    #[inline]
    pub(super) fn p16(self) -> u32 {
        self.0 >> 16
    }

    #[inline]
    fn age(self) -> u32 {
        self.0 & Self::AGE_MASK
    }

    /// Moves towards `bit` by 1/(age + 1.5), the age growing up to `limit`.
    #[inline(always)]
    pub(super) fn update(&mut self, bit: bool, limit: u32) {
        let age = self.age();
        // Upside down for a one, so that both bits go the same way.
        let flip = if bit { u32::MAX >> Self::AGE_BITS } else { 0 };
        let p = (self.0 >> Self::AGE_BITS) ^ flip;
        let p = p - ((u64::from(p) * u64::from(RECIPROCALS[age as usize])) >> 16) as u32;
        self.0 = (p ^ flip) << Self::AGE_BITS | (age + u32::from(age < limit));
    }
}

const fn reciprocals() -> [u32; 1024] {
    let mut table = [0; 1024];
    let mut age = 0;
    while age < 1024 {
        // 65536 / (age + 1.5), rounded down.
        table[age] = (2 * 65_536 / (2 * age + 3)) as u32;
        age += 1;
    }
    table
}

static RECIPROCALS: [u32; 1024] = reciprocals();

/// A binary decision with `C` contexts and up to `LANES − 1 − C` direct inputs.
#[derive(Clone)]
pub(crate) struct MixedBit<const C: usize> {
    /// Counters of all contexts, one run of `sizes[i]` after the other.
    counters: Vec<Counter>,
    starts: [usize; C],
    sizes: [usize; C],
    sets: Vec<WeightSet>,
    limit: u32,
    /// With [`Mixing::Specialised`].
    specialists: Option<Specialists>,
}

/// The weights of all inputs.
#[derive(Clone, Copy)]
pub(super) struct WeightSet {
    weights: [Lanes; 2],
    /// Bits it has seen.
    seen: u32,
}

impl WeightSet {
    fn new(weights: [Lanes; 2]) -> Self {
        Self { weights, seen: 0 }
    }

    /// Log-odds of a one.
    #[inline(always)]
    pub(super) fn log_odds(&self, inputs: &[Lanes; 2]) -> f32 {
        // Through memory: compilers would take all products apart, as only sums of their lanes are wanted.
        let half = black_box(self.weights[0] * inputs[0] + self.weights[1] * inputs[1]);
        (half.0[0] + half.0[2]) + (half.0[1] + half.0[3])
    }

    /// Learns a bit of which these weights said that it is a one with probability `p` in 1/65536, `eagerness` times as
    /// fast as usual.
    #[inline(always)]
    pub(super) fn learn(&mut self, inputs: &[Lanes; 2], p: u32, bit: bool, eagerness: f32) {
        let rate = RATE_SLOW + RATE_FAST / (1.0 + self.seen as f32 * (1.0 / RATE_DECAY));
        self.seen = self.seen.saturating_add(1);
        let target = if bit { 1.0 } else { 0.0 };
        let step = (target - p as f32 * (1.0 / 65_536.0)) * (rate * eagerness);
        self.weights[0] += inputs[0] * step;
        self.weights[1] += inputs[1] * step;
    }
}

impl<const C: usize> MixedBit<C> {
    /// `sizes`: number of values of each context; `sets`: number of weight sets; `direct`: weight
    /// the direct inputs start with; `limit`: largest age of a counter, below 1024.
    pub(crate) fn new(mixing: Mixing, sizes: [usize; C], sets: usize, direct: f32, limit: u32) -> Self {
        let mut starts = [0; C];
        let mut total = 0;
        for (start, size) in starts.iter_mut().zip(sizes) {
            *start = total;
            total += size;
        }
        let initial_weight = match mixing {
            Mixing::Plain => INITIAL_WEIGHT,
            Mixing::Specialised => specialists::INITIAL_WEIGHT,
        };
        let weights = lanes(std::array::from_fn(|i| match i {
            0 => 0.0,
            i if i <= C => initial_weight,
            _ => direct,
        }));
        let first = WeightSet::new(weights);
        let specialists = (mixing == Mixing::Specialised).then(|| {
            let num_slots = sizes.iter().take(specialists::MOST).sum();
            Specialists::new(num_slots, first, limit)
        });
        Self {
            counters: vec![Counter::new(); total],
            starts,
            sizes,
            sets: vec![first; sets],
            limit,
            specialists,
        }
    }

    /// Codes one bit and learns it. `contexts[i] < sizes[i]`; `direct` are log-odds of a one.
    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    pub(crate) fn code<B: BitCoder, const D: usize>(
        &mut self,
        coder: &mut B,
        tables: &Tables,
        contexts: [usize; C],
        direct: [f32; D],
        set: usize,
        bit: bool,
    ) -> bool {
        let mut inputs = [0.0_f32; LANES];
        inputs[0] = 0.3;
        let mut slots = [0; C];
        for i in 0..C {
            debug_assert!(contexts[i] < self.sizes[i], "context {i}: {} of {}", contexts[i], self.sizes[i]);
            slots[i] = self.starts[i] + contexts[i];
            inputs[1 + i] = tables.stretch(self.counters[slots[i]].p12());
        }
        if let Some(specialists) = &self.specialists {
            for i in 0..C {
                inputs[1 + i] *= specialists.say(self.counters[slots[i]].age());
            }
        }
        inputs[1 + C..1 + C + D].copy_from_slice(&direct);
        let inputs = lanes(inputs);

        let set = &mut self.sets[set];
        let log_odds = set.log_odds(&inputs);
        let p1 = tables.squash(log_odds);
        let opinion = self.specialists.as_mut().map(|s| s.judge(tables, &slots, &inputs, log_odds));

        let bit = coder.code(bit, opinion.as_ref().map_or(p1, |opinion| opinion.p));

        set.learn(&inputs, p1, bit, 1.0);
        if let (Some(specialists), Some(opinion)) = (&mut self.specialists, &opinion) {
            specialists.learn(&inputs, opinion, bit);
        }
        for slot in slots {
            self.counters[slot].update(bit, self.limit);
        }
        bit
    }
}

fn lanes([a, b, c, d, e, f, g, h]: [f32; LANES]) -> [Lanes; 2] {
    [Lanes([a, b, c, d]), Lanes([e, f, g, h])]
}

/// Adaptive bits of one context each, for syntax that is too rare to deserve a mixer.
#[derive(Clone)]
pub(crate) struct PlainBits {
    counters: Vec<Counter>,
}

impl PlainBits {
    const LIMIT: u32 = 60;

    pub(crate) fn new(size: usize) -> Self {
        Self { counters: vec![Counter::new(); size] }
    }

    #[inline]
    pub(crate) fn code<B: BitCoder>(&mut self, coder: &mut B, context: usize, bit: bool) -> bool {
        let counter = &mut self.counters[context];
        let bit = coder.code(bit, counter.p16().clamp(64, 65_536 - 64));
        counter.update(bit, Self::LIMIT);
        bit
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::entropy::range_coder::{RangeDecoder, RangeEncoder};

    #[test]
    fn a_context_that_tells_is_learnt() {
        for mixing in [Mixing::Plain, Mixing::Specialised] {
            check(mixing);
        }
    }

    fn check(mixing: Mixing) {
        let bit_of = |i: usize| i * i % 7 < 2;
        let run = |coder: &mut RangeEncoder| {
            let mut model = MixedBit::new(mixing, [7, 3], 1, 0.5, 255);
            for i in 0..20_000 {
                model.code(coder, Tables::get(), [i % 7, i % 3], [0.1], 0, bit_of(i));
            }
        };
        let mut encoder = RangeEncoder::new();
        run(&mut encoder);
        let bytes = encoder.finish();
        assert!(bytes.len() < 400, "{} bytes for 20,000 determined bits", bytes.len());
        let mut decoder = RangeDecoder::new(&bytes);
        let mut model = MixedBit::new(mixing, [7, 3], 1, 0.5, 255);
        for i in 0..20_000 {
            assert_eq!(model.code(&mut decoder, Tables::get(), [i % 7, i % 3], [0.1], 0, false), bit_of(i));
        }
    }
}
