//! How often each symbol of a table comes, in 1/1024 (`format/SPEC.md`, section 6.7).

use super::super::numbers::Numbers;
use super::super::range_coder::BitCoder;

/// Frequencies of a table sum up to two to this power.
pub(crate) const LOG_TOTAL: u32 = 10;
pub(crate) const TOTAL: u32 = 1 << LOG_TOTAL;
/// Contexts of a frequency: digits of the one before.
const CONTEXTS: usize = LOG_TOTAL as usize + 2;

/// A frequency for each symbol up to the last that has one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Frequencies(pub(super) Vec<u16>);

/// Adaptive models of frequencies.
pub(super) struct FrequencyModels {
    size: Numbers,
    frequency: Numbers,
}

impl FrequencyModels {
    pub(super) fn new() -> Self {
        Self { size: Numbers::new(1), frequency: Numbers::new(CONTEXTS) }
    }

    /// Codes a table of an alphabet; `None` if what is read is none. The last frequency follows from the others.
    pub(super) fn code<B: BitCoder>(
        &mut self,
        coder: &mut B,
        alphabet: usize,
        table: Option<&Frequencies>,
    ) -> Option<Frequencies> {
        let size = self.size.code(coder, 0, table.map_or(0, |t| t.0.len() as u64 - 1)) + 1;
        if size > alphabet as u64 {
            return None;
        }
        let (mut frequencies, mut left, mut context) = (Vec::with_capacity(size as usize), TOTAL, 0);
        for symbol in 0..size as usize - 1 {
            let wanted = table.map_or(0, |t| u64::from(t.0[symbol]));
            let frequency = self.frequency.code(coder, context, wanted);
            // The last symbol has a frequency.
            if frequency >= u64::from(left) {
                return None;
            }
            left -= frequency as u32;
            context = (frequency as u32 + 1).ilog2() as usize;
            frequencies.push(frequency as u16);
        }
        frequencies.push(left as u16);
        Some(Frequencies(frequencies))
    }
}

#[cfg(any(feature = "encoder", test))]
impl Frequencies {
    /// Frequencies close to these counts, of which one is not 0: each symbol that comes has one.
    pub(super) fn of(counts: &[u32]) -> Self {
        let size = counts.iter().rposition(|&c| c > 0).map_or(1, |last| last + 1);
        let counts = &counts[..size];
        let sum: u64 = counts.iter().map(|&c| u64::from(c)).sum();
        let share =
            |c: u32| ((u64::from(c) * u64::from(TOTAL) + sum / 2) / sum.max(1)).max(u64::from(c > 0)) as u32;
        let mut frequencies: Vec<u32> = counts.iter().map(|&c| share(c)).collect();
        loop {
            let total: u32 = frequencies.iter().sum();
            if total == TOTAL {
                break;
            }
            let step = if total < TOTAL { 1_i32 } else { -1 };
            // Where one more or less costs least.
            let loss = |i: usize| {
                let (count, f) = (f64::from(counts[i]), f64::from(frequencies[i]));
                // Close to the logarithm of how much longer the symbol gets.
                let more = f64::from(step) / f;
                -count * more / (1.0 + 0.5 * more)
            };
            let may = |i: &usize| if step > 0 { counts[*i] > 0 } else { frequencies[*i] > 1 };
            let best = (0..size).filter(may).min_by(|&a, &b| loss(a).total_cmp(&loss(b)));
            let Some(best) = best else { return Self(vec![TOTAL as u16]) };
            frequencies[best] = frequencies[best].wrapping_add_signed(step);
        }
        Self(frequencies.into_iter().map(|f| f as u16).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::entropy::range_coder::{RangeDecoder, RangeEncoder};

    #[test]
    fn tables_return_and_sum_up() {
        let mut encoder = RangeEncoder::new();
        let mut models = FrequencyModels::new();
        let counts = [&[5_u32][..], &[0, 0, 9], &[1; 700], &[1_000_000, 1, 0, 1], &[3, 3, 3], &[1; 1024]];
        let tables: Vec<Frequencies> = counts.iter().map(|c| Frequencies::of(c)).collect();
        for (table, counts) in tables.iter().zip(counts) {
            assert_eq!(table.0.iter().map(|&f| u32::from(f)).sum::<u32>(), TOTAL);
            assert!(table.0.iter().zip(counts).all(|(&f, &c)| (f > 0) == (c > 0)));
            models.code(&mut encoder, 1024, Some(table)).unwrap();
        }
        let bytes = encoder.finish();
        let mut decoder = RangeDecoder::new(&bytes);
        let mut models = FrequencyModels::new();
        for table in &tables {
            assert_eq!(models.code(&mut decoder, 1024, None).as_ref(), Some(table));
        }
    }

    #[test]
    fn tables_that_are_none_are_refused() {
        // More symbols than there are, or more than all.
        for (frequencies, alphabet) in [(vec![512, 256, 256], 2), (vec![1000, 24, 5], 3), (vec![1024, 0], 2)]
        {
            let mut encoder = RangeEncoder::new();
            FrequencyModels::new().code(&mut encoder, 3, Some(&Frequencies(frequencies)));
            let bytes = encoder.finish();
            assert_eq!(FrequencyModels::new().code(&mut RangeDecoder::new(&bytes), alphabet, None), None);
        }
    }
}
