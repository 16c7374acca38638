//! Work on every element of a slice, on all threads where there are any: the decoder alone has no pool.

/// Elements that one thread sees at least.
#[cfg(feature = "encoder")]
const MIN_LEN: usize = 1 << 12;

/// Sets each element to what `value` makes of its place. `scratch` is what one thread needs for that.
#[cfg(feature = "encoder")]
pub(crate) fn fill<T: Send, S>(
    elements: &mut [T],
    scratch: impl Fn() -> S + Send + Sync,
    value: impl Fn(&mut S, usize) -> T + Send + Sync,
) {
    use rayon::prelude::*;
    let places = elements.par_iter_mut().enumerate().with_min_len(MIN_LEN);
    places.for_each_init(scratch, |scratch, (place, element)| *element = value(scratch, place));
}

/// Sets each element to what `value` makes of its place.
#[cfg(not(feature = "encoder"))]
pub(crate) fn fill<T, S>(elements: &mut [T], scratch: impl Fn() -> S, value: impl Fn(&mut S, usize) -> T) {
    let mut scratch = scratch();
    elements.iter_mut().enumerate().for_each(|(place, element)| *element = value(&mut scratch, place));
}
