//! The polygon of a patch that grows, and whether an encoder that follows the rule of
//! [`ears`](crate::mesh::ears) would have closed it by the patch's own triangles
//! (`format/SPEC.md`, section 7.2).

use crate::mesh::ears::{Bytes, Hole, IN_ORDER, MAX_CORNERS};
use crate::util::simd4::Cell;

/// The first triangle of a patch, counter-clockwise from the gate on.
pub(super) struct Triangle {
    pub(super) cells: [Cell; 3],
    /// Edges at each corner, those of the triangle too.
    pub(super) valences: [u8; 3],
}

impl Triangle {
    /// Whether it would fit together with the one over the edge that starts at corner `edge`.
    ///
    /// As [`Polygon::fit_grown`] of the four corners: the ears are the tip and the corner that faces the edge.
    #[inline(always)]
    pub(super) fn fit_grown(&self, edge: usize, tip: Cell, tip_valence: u8) -> Fit {
        let (start, end, apex) = (edge, (edge + 1) % 3, (edge + 2) % 3);
        // Without the edges inside: an ear has one triangle, the others have two.
        let valence = |corner: usize, triangles: i32| i32::from(self.valences[corner]) - triangles;
        let [a, b, c, d] = [valence(apex, 1), valence(start, 2), i32::from(tip_valence) - 1, valence(end, 2)];
        let (of_ears, of_others) = (a.min(c), b.min(d));
        if of_ears != of_others {
            return if of_ears < of_others { Fit::Is } else { Fit::Not };
        }
        let cut = self.cells[start].squared_distance(self.cells[end]);
        let other = self.cells[apex].squared_distance(tip);
        // The first of least valence from the gate on, the tip coming after the edge's start.
        let first_is_ear = || {
            let mut from_gate = [(b, false); 4];
            from_gate[apex + usize::from(apex > start)] = (a, true);
            from_gate[start + 1] = (c, true);
            from_gate[end + usize::from(end > start)] = (d, false);
            from_gate.iter().find(|corner| corner.0 == of_ears).is_some_and(|corner| corner.1)
        };
        if cut < other || cut == other && first_is_ear() { Fit::Is } else { Fit::Not }
    }
}

/// The polygon of a patch.
#[derive(Default)]
pub(super) struct Polygon {
    /// Positions of the corners, in the order in which they came.
    cells: [Cell; MAX_CORNERS],
    outline: Outline,
}

/// Counter-clockwise from the gate on.
#[derive(Clone, Copy, Default)]
struct Outline {
    /// When each corner came.
    names: Bytes,
    /// Edges at each corner, those inside the patch too, and [`SPARE`] more.
    valences: Bytes,
    /// Triangles of the patch at each corner.
    triangles: Bytes,
    /// Number of corners; 0 if there are too many to follow.
    len: usize,
    /// The corner at which the edge starts that is looked at.
    cursor: usize,
}

/// Keeps valences above the numbers of triangles, whatever a stream says.
const SPARE: u8 = 8;

impl Polygon {
    /// Begins with a triangle; its edges before corner `cursor` stay.
    #[inline(always)]
    pub(super) fn begin(&mut self, triangle: &Triangle, cursor: usize) {
        self.cells[..3].copy_from_slice(&triangle.cells);
        let mut valences = Bytes::default();
        for (i, valence) in triangle.valences.into_iter().enumerate() {
            valences.add(i, valence + SPARE);
        }
        self.outline = Outline { names: IN_ORDER, valences, triangles: Bytes::ones(3), len: 3, cursor };
    }

    /// The edge that is looked at stays.
    #[inline(always)]
    pub(super) fn pass(&mut self) {
        self.outline.cursor += 1;
    }

    /// Takes in the triangle over the edge that is looked at.
    #[inline(always)]
    pub(super) fn grow(&mut self, tip: Cell, valence: u8) {
        let grown = self.outline.grown(valence);
        self.cells[self.outline.len % MAX_CORNERS] = tip;
        self.outline = grown;
    }

    /// Whether the rule would make just the triangles that it would have then.
    #[inline(always)]
    pub(super) fn fit_grown(&mut self, tip: Cell, valence: u8) -> Fit {
        let grown = self.outline.grown(valence);
        self.cells[self.outline.len % MAX_CORNERS] = tip;
        self.fit(&grown)
    }

    #[inline(always)]
    fn fit(&self, outline: &Outline) -> Fit {
        let &Outline { names, valences, triangles: mut left, len, .. } = outline;
        if len == 0 {
            return Fit::Unknown;
        }
        let mut hole = Hole::new(names, valences.minus(left), len);
        while hole.len() > 4 {
            let (least, ears) = (hole.of_least_valence(), left.corners_with(1));
            let ear = if least.has_some_of(ears) {
                hole.shortest(least, |i, j| self.squared_distance(i, j), |_| true)
            } else {
                None
            };
            let Some(ear) = ear.filter(|ear| left.get(ear.place) == 1) else { return Fit::Not };
            let [before, after] = hole.beside(ear.place);
            left = left.minus(Bytes::at(before)).minus(Bytes::at(after));
            left.remove(ear.place);
            hole.cut(ear);
        }
        self.fit_of_quad(&hole, left)
    }

    /// The same for two triangles, which is asked most: their ears are two opposite corners.
    #[inline(always)]
    fn fit_of_quad(&self, hole: &Hole, left: Bytes) -> Fit {
        let ear = usize::from(left.get(0) != 1);
        let [(a, of_a), (b, of_b), (c, of_c), (d, of_d)] = [0, 1, 2, 3].map(|i| hole.corner((ear + i) & 3));
        let (of_ears, of_others) = (of_a.min(of_c), of_b.min(of_d));
        if of_ears != of_others {
            return if of_ears < of_others { Fit::Is } else { Fit::Not };
        }
        let (cut, other) = (self.squared_distance(b, d), self.squared_distance(a, c));
        let first_is_ear = || (0..4).find(|&i| hole.corner(i).1 == of_ears).is_some_and(|i| i & 1 == ear);
        if cut < other || cut == other && first_is_ear() { Fit::Is } else { Fit::Not }
    }

    /// Between two corners by when they came.
    #[inline(always)]
    fn squared_distance(&self, i: usize, j: usize) -> f32 {
        self.cells[i % MAX_CORNERS].squared_distance(self.cells[j % MAX_CORNERS])
    }
}

impl Outline {
    /// With the triangle over the edge that is looked at.
    #[inline(always)]
    fn grown(&self, valence: u8) -> Self {
        let &Self { mut names, mut valences, mut triangles, len, cursor } = self;
        if len == 0 || len == MAX_CORNERS {
            return Self::default();
        }
        let at = cursor + 1;
        names.insert(at);
        names.add(at, len as u8);
        valences.insert(at);
        valences.add(at, valence + SPARE);
        triangles.insert(at);
        triangles.add(cursor, 1);
        triangles.add(at, 1);
        triangles.add(if at == len { 0 } else { at + 1 }, 1);
        Self { names, valences, triangles, len: len + 1, cursor }
    }
}

/// Whether triangles look as if they were made by the rule.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Fit {
    Not = 0,
    Is = 1,
    Unknown = 2,
}

/// Number of [`Fit`]s.
pub(super) const FITS: usize = 3;

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles fit if the ear that the rule cuts off is one of theirs.
    #[test]
    fn quads_fit_as_the_rule_says() {
        let mut seed = 1_u32;
        let mut random = |below: u32| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 16) % below
        };
        let mut fits = 0;
        for _ in 0..2000 {
            let cells: [Cell; 4] =
                std::array::from_fn(|_| Cell::new(std::array::from_fn(|_| random(3) as i32)));
            let valences: [u8; 4] = std::array::from_fn(|_| 4 + random(3) as u8);
            let [a, b, c, tip] = cells;
            let start = Triangle { cells: [a, b, c], valences: [valences[0], valences[1], valences[2]] };
            let edge = random(3) as usize;
            let mut quad = Polygon::default();
            quad.begin(&start, edge);
            let fit = quad.fit_grown(tip, valences[3]);

            let Outline { names, valences: all, triangles, .. } = quad.outline.grown(valences[3]);
            let hole = Hole::new(names, all.minus(triangles), 4);
            let ear = hole.next_ear(|i, j| quad.squared_distance(i, j), |_| true).expect("there are four");
            let is_own = triangles.get(ear.place) == 1;
            assert_eq!(fit == Fit::Is, is_own);
            assert_eq!(start.fit_grown(edge, tip, valences[3]) == Fit::Is, is_own);
            fits += u32::from(is_own);
        }
        assert!((200..1800).contains(&fits), "{fits}");
    }
}
