//! Adaptive bits with mixed contexts (`format/SPEC.md`, section 6.3): counters predict a bit from
//! one context each, a small online logistic regression weighs them.

use super::counter::Counter;
use super::range_coder::BitCoder;
use super::specialists::{self, Specialists};
use super::tables::Tables;
use super::weights::WeightSet;
use crate::util::simd4::Lanes;

/// Inputs of every mixer: contexts, direct inputs and the bias together. Two SIMD vectors.
const LANES: usize = 8;

/// Weight a context starts with.
const INITIAL_WEIGHT: f32 = 0.35;
/// How bits are mixed: a number of the profile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mixing {
    /// By the weights of one set.
    Plain,
    /// Beside them by a specialist for each value of the first contexts.
    Specialised,
}

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
