//! The rule by which small holes are closed where the size of a stream counts: the corner of least
//! valence is cut off first, among several the one with the shortest cut. Encoders make triangles by
//! it, and both sides ask whether triangles look as if they were made so (`format/SPEC.md`,
//! section 7.2).
//!
//! It drives valences apart: low ones are the next to go, and most groups of faces can be ruled out.

/// Most corners of a hole.
pub(crate) const MAX_CORNERS: usize = 8;
/// Largest valence that the rule distinguishes.
pub(crate) const MAX_VALENCE: u32 = 200;

/// A byte for each corner.
#[derive(Clone, Copy, Default)]
pub(crate) struct Bytes(u64);

impl Bytes {
    /// One each for the first `count` corners.
    #[inline(always)]
    pub(crate) fn ones(count: usize) -> Self {
        Self(0x0101_0101_0101_0101 & Self::below(count))
    }

    /// One at a corner.
    #[inline(always)]
    pub(crate) fn at(corner: usize) -> Self {
        Self(1 << (8 * corner))
    }

    #[inline(always)]
    pub(crate) fn get(self, corner: usize) -> u8 {
        (self.0 >> (8 * corner)) as u8
    }

    /// Adds to a byte; the sum is below 256.
    #[inline(always)]
    pub(crate) fn add(&mut self, corner: usize, value: u8) {
        self.0 += u64::from(value) << (8 * corner);
    }

    /// Takes each byte off, which is at most as large.
    #[inline(always)]
    pub(crate) fn minus(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }

    /// Makes room for a byte of 0 before `corner`.
    #[inline(always)]
    pub(crate) fn insert(&mut self, corner: usize) {
        let low = self.0 & Self::below(corner);
        self.0 = low | (self.0 ^ low) << 8;
    }

    #[inline(always)]
    pub(crate) fn remove(&mut self, corner: usize) {
        let below = Self::below(corner);
        self.0 = self.0 & below | self.0 >> 8 & !below;
    }

    #[inline(always)]
    fn least(self) -> u8 {
        self.0.to_le_bytes().into_iter().fold(u8::MAX, u8::min)
    }

    /// The corners that have this value.
    #[inline(always)]
    pub(crate) fn corners_with(self, value: u8) -> Corners {
        const LOW: u64 = 0x7f7f_7f7f_7f7f_7f7f;
        let differ = self.0 ^ (u64::from(value) * 0x0101_0101_0101_0101);
        // In a byte that is not 0, either the highest bit is set, or what is added to the rest carries into
        // it.
        Corners(!(((differ & LOW) + LOW) | differ | LOW))
    }

    /// The bytes before `corner`, of at most seven.
    #[inline(always)]
    fn below(corner: usize) -> u64 {
        (1 << (8 * corner)) - 1
    }
}

/// Some of the corners: of each the highest bit of its byte.
#[derive(Clone, Copy)]
pub(crate) struct Corners(u64);

impl Corners {
    #[inline(always)]
    pub(crate) fn has_some_of(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    #[inline(always)]
    fn is_one(self) -> bool {
        self.0.is_power_of_two()
    }
}

impl Iterator for Corners {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        let corner = (self.0 != 0).then_some(self.0.trailing_zeros() as usize / 8);
        self.0 &= self.0.wrapping_sub(1);
        corner
    }
}

/// A hole that is closed ear by ear.
pub(crate) struct Hole {
    /// Corners left, counter-clockwise: what they are called, and their valence less any constant. No valence is as large
    /// as the filler after the last one.
    names: Bytes,
    valences: Bytes,
    count: usize,
}

/// The names of corners that are called by their places.
pub(crate) const IN_ORDER: Bytes = Bytes(0x0706_0504_0302_0100);

/// A corner that may be cut off, with those before and after it.
#[derive(Clone, Copy)]
pub(crate) struct Ear {
    pub(crate) place: usize,
    pub(crate) before: usize,
    #[cfg_attr(not(feature = "encoder"), allow(dead_code))]
    pub(crate) corner: usize,
    pub(crate) after: usize,
}

impl Hole {
    /// `count <= MAX_CORNERS`.
    #[inline(always)]
    pub(crate) fn new(names: Bytes, valences: Bytes, count: usize) -> Self {
        let behind = u64::MAX.unbounded_shl(8 * count as u32);
        Self { names, valences: Bytes(valences.0 | behind), count }
    }

    /// Corners left.
    #[inline(always)]
    pub(crate) fn len(&self) -> usize {
        self.count
    }

    /// The ear to cut off next, among those that are `allowed`. `length` is that of a cut between two corners.
    #[cfg(any(feature = "encoder", test))]
    #[inline(always)]
    pub(crate) fn next_ear(
        &self,
        length: impl Fn(usize, usize) -> f32,
        allowed: impl Fn(Ear) -> bool,
    ) -> Option<Ear> {
        let mut rest = self.valences;
        while rest.least() < u8::MAX {
            let equals = rest.corners_with(rest.least());
            if let Some(ear) = self.shortest(equals, &length, &allowed) {
                return Some(ear);
            }
            equals.for_each(|place| rest.0 |= 0xff << (8 * place));
        }
        None
    }

    /// Places of the corners of least valence.
    #[inline(always)]
    pub(crate) fn of_least_valence(&self) -> Corners {
        self.valences.corners_with(self.valences.least())
    }

    /// The ear with the shortest cut, the first one if equal, at these places.
    #[inline(always)]
    pub(crate) fn shortest(
        &self,
        places: Corners,
        length: impl Fn(usize, usize) -> f32,
        allowed: impl Fn(Ear) -> bool,
    ) -> Option<Ear> {
        let is_one = places.is_one();
        let mut best = None;
        let mut shortest = f32::INFINITY;
        for place in places {
            let ear = self.ear(place);
            let length = if is_one { 0.0 } else { length(ear.before, ear.after) };
            if length < shortest && allowed(ear) {
                (best, shortest) = (Some(ear), length);
            }
        }
        best
    }

    /// What the corner at a place is called, and its valence less the constant.
    #[inline(always)]
    pub(crate) fn corner(&self, place: usize) -> (usize, u8) {
        (usize::from(self.names.get(place)), self.valences.get(place))
    }

    /// Cuts an ear off: the corners next to it get one more edge.
    #[inline(always)]
    pub(crate) fn cut(&mut self, ear: Ear) {
        let [before, after] = self.beside(ear.place);
        self.valences.add(before, 1);
        self.valences.add(after, 1);
        self.names.remove(ear.place);
        self.valences.remove(ear.place);
        self.valences.0 |= 0xff << 56;
        self.count -= 1;
    }

    #[inline(always)]
    fn ear(&self, place: usize) -> Ear {
        let [before, after] = self.beside(place);
        let name = |place: usize| usize::from(self.names.get(place));
        Ear { place, before: name(before), corner: name(place), after: name(after) }
    }

    /// The places before and after one.
    #[inline(always)]
    pub(crate) fn beside(&self, place: usize) -> [usize; 2] {
        let before = if place == 0 { self.count - 1 } else { place - 1 };
        let after = if place + 1 == self.count { 0 } else { place + 1 };
        [before, after]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::util::simd4::Cell;

    fn ears(valences: &[u8], positions: &[[i32; 3]]) -> Vec<usize> {
        let mut bytes = Bytes::default();
        valences.iter().enumerate().for_each(|(i, &valence)| bytes.add(i, valence));
        let mut hole = Hole::new(IN_ORDER, bytes, valences.len());
        let length = |i: usize, j: usize| Cell::new(positions[i]).squared_distance(Cell::new(positions[j]));
        let mut ears = Vec::new();
        while hole.len() > 3 {
            let ear = hole.next_ear(length, |_| true).unwrap();
            ears.push(ear.corner);
            hole.cut(ear);
        }
        ears
    }

    #[test]
    fn valence_counts_before_length_and_length_before_order() {
        let square = [[0, 0, 0], [10, 0, 0], [10, 10, 0], [0, 10, 0]];
        assert_eq!(ears(&[5, 5, 5, 5], &square), [0]);
        assert_eq!(ears(&[5, 4, 5, 5], &square), [1]);
        let kite = [[0, 0, 0], [10, -1, 0], [20, 0, 0], [10, 1, 0]];
        assert_eq!(ears(&[5, 5, 5, 5], &kite), [0]);
        assert_eq!(ears(&[6, 5, 5, 5], &kite), [2]);
    }

    #[test]
    fn a_regular_hexagon_keeps_a_triangle() {
        let hexagon = [[1, -1, 0], [1, 0, -1], [0, 1, -1], [-1, 1, 0], [-1, 0, 1], [0, -1, 1]];
        assert_eq!(ears(&[6; 6], &hexagon), [0, 2, 4]);
    }
}
