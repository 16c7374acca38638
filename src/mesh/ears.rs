//! The rule by which small holes are closed where the size of a stream counts: the corner of least
//! valence is cut off first, of several the one with the shortest cut. Encoders make triangles by
//! it, and both sides ask whether triangles look as if they were made so (`format/SPEC.md`,
//! section 7.2).
//!
//! It drives valences apart: low ones are the next to go, and most groups of faces can be ruled out.

/// Most corners of a hole.
pub(crate) const MAX_CORNERS: usize = 8;
/// Largest valence that the rule tells apart.
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
    fn remove(&mut self, corner: usize) {
        let below = Self::below(corner);
        self.0 = self.0 & below | self.0 >> 8 & !below;
    }

    /// The bytes before `corner`, of at most seven.
    #[inline(always)]
    fn below(corner: usize) -> u64 {
        (1 << (8 * corner)) - 1
    }
}

/// How far two cells are apart, squared: the length of a cut.
#[inline(always)]
pub(crate) fn squared_distance(p: [i32; 3], q: [i32; 3]) -> f32 {
    let [x, y, z] = std::array::from_fn(|i| q[i].wrapping_sub(p[i]) as f32);
    (x * x + y * y) + z * z
}

/// A hole that is closed ear by ear.
pub(crate) struct Hole {
    /// Corners left, counter-clockwise: what they are called, and their valence less any constant.
    names: Bytes,
    valences: Bytes,
    count: usize,
}

/// A corner that may be cut off, with those before and after it.
#[derive(Clone, Copy)]
pub(crate) struct Ear {
    place: usize,
    pub(crate) before: usize,
    pub(crate) corner: usize,
    pub(crate) after: usize,
}

impl Hole {
    /// `count <= MAX_CORNERS`.
    #[inline(always)]
    pub(crate) fn new(valences: Bytes, count: usize) -> Self {
        Self { names: Bytes(0x0706_0504_0302_0100), valences, count }
    }

    /// Corners left.
    #[inline(always)]
    pub(crate) fn len(&self) -> usize {
        self.count
    }

    /// The ear to cut off next, among those that are `allowed`.
    #[inline(always)]
    pub(crate) fn next_ear(
        &self,
        position: impl Fn(usize) -> [i32; 3],
        allowed: impl Fn(Ear) -> bool,
    ) -> Option<Ear> {
        let cut = |ear: Ear| squared_distance(position(ear.before), position(ear.after));
        let mut least = u8::MAX;
        let mut best: Option<Ear> = None;
        // Length of the best one's cut; needed only if there are several of its valence.
        let mut shortest = None;
        for place in 0..self.count {
            let valence = self.valences.get(place);
            if valence > least {
                continue;
            }
            let ear = self.ear(place);
            let mut length = None;
            if let Some(best) = best.filter(|_| valence == least) {
                let other = *shortest.get_or_insert_with(|| cut(best));
                if *length.insert(cut(ear)) >= other {
                    continue;
                }
            }
            if allowed(ear) {
                (least, best, shortest) = (valence, Some(ear), length);
            }
        }
        best
    }

    /// Cuts an ear off: the corners beside it get an edge more.
    #[inline(always)]
    pub(crate) fn cut(&mut self, ear: Ear) {
        let [before, after] = self.beside(ear.place);
        self.valences.add(before, 1);
        self.valences.add(after, 1);
        self.names.remove(ear.place);
        self.valences.remove(ear.place);
        self.count -= 1;
    }

    #[inline(always)]
    fn ear(&self, place: usize) -> Ear {
        let [before, after] = self.beside(place);
        let name = |place: usize| usize::from(self.names.get(place));
        Ear { place, before: name(before), corner: name(place), after: name(after) }
    }

    #[inline(always)]
    fn beside(&self, place: usize) -> [usize; 2] {
        let before = if place == 0 { self.count - 1 } else { place - 1 };
        let after = if place + 1 == self.count { 0 } else { place + 1 };
        [before, after]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ears(valences: &[u8], positions: &[[i32; 3]]) -> Vec<usize> {
        let mut bytes = Bytes::default();
        valences.iter().enumerate().for_each(|(i, &valence)| bytes.add(i, valence));
        let mut hole = Hole::new(bytes, valences.len());
        let mut ears = Vec::new();
        while hole.len() > 3 {
            let ear = hole.next_ear(|i| positions[i], |_| true).unwrap();
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
