//! Which numbers all values of a kind are: decimals with a number of digits, or any floats.

use crate::passes::float_values::{Ladder, Scale};

/// Numbers that are looked at first.
const SAMPLES: usize = 2000;
/// One of this many need not be such a number.
const EXCEPTIONS: usize = 200;

/// The scale of `count` numbers, except for a few, that takes the fewest bits where the middle and half the
/// width of the interval `around` each of them are known.
pub(super) fn cheapest_scale(
    is_wide: bool,
    count: usize,
    at: &dyn Fn(usize) -> f64,
    around: &dyn Fn(usize) -> [f64; 2],
) -> Scale {
    let sample: Vec<usize> = (0..count).step_by(count.div_ceil(SAMPLES).max(1)).collect();
    let fits = |ladder: Ladder, numbers: &mut dyn Iterator<Item = usize>, count: usize| {
        numbers.filter(|&i| ladder.key(at(i)).is_none()).take(count / EXCEPTIONS + 1).count() * EXCEPTIONS
            <= count
    };
    let bits = |ladder: Ladder| -> f64 {
        let width = |&i: &usize| {
            let [middle, half] = around(i);
            let [low, high] = ladder.range(middle, half);
            libm::log2((high - low) as f64 + 1.0)
        };
        sample.iter().map(width).sum::<f64>() / sample.len() as f64
    };
    let suits = |scale: &Scale| {
        let ladder = Ladder::new(is_wide, *scale);
        fits(ladder, &mut sample.iter().copied(), sample.len()) && fits(ladder, &mut (0..count), count)
    };
    // The coarsest of each kind takes the fewest bits.
    let decimal = (0..=Scale::MAX_DECIMAL).map(Scale::Decimal).find(suits);
    let binary = (0..=Scale::MAX_BINARY).map(Scale::Binary).find(suits);
    let cost = |scale: &Scale| bits(Ladder::new(is_wide, *scale));
    let found = [decimal, binary, Some(Scale::Float)].into_iter().flatten();
    found.min_by(|a, b| cost(a).total_cmp(&cost(b))).unwrap_or(Scale::Float)
}
