//! The polygon of a patch that grows, and whether an encoder that follows the rule of
//! [`ears`](crate::mesh::ears) would have closed it by the patch's own triangles
//! (`format/SPEC.md`, section 7.2).

use crate::mesh::ears::{Bytes, Hole, MAX_CORNERS, squared_distance};

/// The first triangle of a patch, counter-clockwise from the gate on.
pub(super) struct Triangle {
    pub(super) vertices: [u32; 3],
    /// Edges at each corner, those of the triangle too.
    pub(super) valences: [u8; 3],
}

impl Triangle {
    /// Whether it would fit together with the one over the edge that starts at corner `edge`.
    ///
    /// As [`Polygon::fit`] of the four corners: the ears are the tip and the corner that faces the edge.
    #[inline]
    pub(super) fn fit_grown(&self, edge: usize, tip: u32, tip_valence: u8, positions: &[[i32; 3]]) -> Fit {
        let (start, end, apex) = (edge, (edge + 1) % 3, (edge + 2) % 3);
        // Without the edges inside: an ear has one triangle, the others have two.
        let valence = |corner: usize, triangles: i32| i32::from(self.valences[corner]) - triangles;
        let [a, b, c, d] = [valence(apex, 1), valence(start, 2), i32::from(tip_valence) - 1, valence(end, 2)];
        let (of_ears, of_others) = (a.min(c), b.min(d));
        if of_ears != of_others {
            return if of_ears < of_others { Fit::Is } else { Fit::Not };
        }
        let position = |corner: usize| positions[self.vertices[corner] as usize];
        let cut = squared_distance(position(start), position(end));
        let other = squared_distance(position(apex), positions[tip as usize]);
        // The first of least valence from the gate on, the tip standing behind the edge's start.
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

/// Counter-clockwise from the gate on.
#[derive(Clone, Copy, Default)]
pub(super) struct Polygon {
    vertices: [u32; MAX_CORNERS],
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
    /// A triangle; its edges before corner `cursor` stay.
    #[inline]
    pub(super) fn of_triangle(triangle: &Triangle, cursor: usize) -> Self {
        let mut polygon = Self { triangles: Bytes::ones(3), len: 3, cursor, ..Self::default() };
        polygon.vertices[..3].copy_from_slice(&triangle.vertices);
        for (i, valence) in triangle.valences.into_iter().enumerate() {
            polygon.valences.add(i, valence + SPARE);
        }
        polygon
    }

    /// The edge that is looked at stays.
    #[inline]
    pub(super) fn pass(&mut self) {
        self.cursor += 1;
    }

    /// The polygon with the triangle over the edge that is looked at.
    #[inline]
    pub(super) fn grown(&self, tip: u32, valence: u8) -> Self {
        let len = self.len;
        if len == 0 || len == MAX_CORNERS {
            return Self::default();
        }
        let cursor = self.cursor;
        let at = cursor + 1;
        let vertices = std::array::from_fn(|i| match i {
            i if i < at => self.vertices[i],
            i if i == at => tip,
            i => self.vertices[i - 1],
        });
        let (mut valences, mut triangles) = (self.valences, self.triangles);
        valences.insert(at);
        valences.add(at, valence + SPARE);
        triangles.insert(at);
        triangles.add(cursor, 1);
        triangles.add(at, 1);
        triangles.add(if at == len { 0 } else { at + 1 }, 1);
        Self { vertices, valences, triangles, len: len + 1, cursor }
    }

    /// Whether the rule makes just these triangles.
    #[inline]
    pub(super) fn fit(&self, positions: &[[i32; 3]]) -> Fit {
        if self.len == 0 {
            return Fit::Unknown;
        }
        if self.len == 4 {
            return self.fit_of_quad(positions);
        }
        let position = |corner: usize| positions[self.vertices[corner] as usize];
        let mut left = self.triangles;
        let mut hole = Hole::new(self.valences.minus(left), self.len);
        while hole.len() > 3 {
            let Some(ear) = hole.next_ear(position, |_| true) else { break };
            if left.get(ear.corner) != 1 {
                return Fit::Not;
            }
            left = left.minus(Bytes::at(ear.before)).minus(Bytes::at(ear.after));
            hole.cut(ear);
        }
        Fit::Is
    }

    /// The same for two triangles, which is asked most: their ears are two opposite corners.
    #[inline]
    fn fit_of_quad(&self, positions: &[[i32; 3]]) -> Fit {
        let ear = usize::from(self.triangles.get(0) != 1);
        let outside = self.valences.minus(self.triangles);
        let [a, b, c, d] = std::array::from_fn(|i| outside.get((ear + i) & 3));
        let (of_ears, of_others) = (a.min(c), b.min(d));
        if of_ears != of_others {
            return if of_ears < of_others { Fit::Is } else { Fit::Not };
        }
        let [pa, pb, pc, pd] = std::array::from_fn(|i| positions[self.vertices[(ear + i) & 3] as usize]);
        let (cut, other) = (squared_distance(pb, pd), squared_distance(pa, pc));
        let first_is_ear = || (0..4).find(|&i| outside.get(i) == of_ears).is_some_and(|i| i & 1 == ear);
        if cut < other || cut == other && first_is_ear() { Fit::Is } else { Fit::Not }
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
            let positions: [[i32; 3]; 4] = std::array::from_fn(|_| std::array::from_fn(|_| random(3) as i32));
            let valences: [u8; 4] = std::array::from_fn(|_| 4 + random(3) as u8);
            let start = Triangle { vertices: [0, 1, 2], valences: [valences[0], valences[1], valences[2]] };
            let edge = random(3) as usize;
            let quad = Polygon::of_triangle(&start, edge).grown(3, valences[3]);

            let position = |corner: usize| positions[quad.vertices[corner] as usize];
            let hole = Hole::new(quad.valences.minus(quad.triangles), 4);
            let ear = hole.next_ear(position, |_| true).expect("there are four");
            let is_own = quad.triangles.get(ear.corner) == 1;
            assert_eq!(quad.fit(&positions) == Fit::Is, is_own);
            assert_eq!(start.fit_grown(edge, 3, valences[3], &positions) == Fit::Is, is_own);
            fits += u32::from(is_own);
        }
        assert!((200..1800).contains(&fits), "{fits}");
    }
}
