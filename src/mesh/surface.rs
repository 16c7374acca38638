//! Connectivity that decoder and encoder refine in place: a corner table that never moves an old
//! vertex or triangle.
//!
//! ```text
//!          v = triangles[f][i]            corner c = 3 f + i
//!         / \                             next(c) at n, prev(c) at p
//!        / c \                            opposite(c): the corner facing c across the
//!       n --- p                           edge n → p, NO_CORNER on the boundary
//! ```

/// Absence of a corner: the edge lies on the boundary.
pub const NO_CORNER: u32 = u32::MAX;

/// The corner after `corner`, counter-clockwise in its triangle.
#[inline]
pub fn next(corner: u32) -> u32 {
    if corner % 3 == 2 { corner - 2 } else { corner + 1 }
}

/// The corner before `corner` in its triangle.
#[inline]
pub fn prev(corner: u32) -> u32 {
    if corner.is_multiple_of(3) { corner + 2 } else { corner - 1 }
}

/// The corners of a triangle from this one on.
pub fn turns(corner: u32) -> [u32; 3] {
    [corner, next(corner), prev(corner)]
}

/// An oriented triangle surface, possibly with boundary, of any number of components: every
/// directed edge belongs to at most one triangle.
#[derive(Clone, Debug, Default)]
pub struct Surface {
    /// Vertices of each triangle, counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
    /// For corner 3 f + i the corner across its edge, or [`NO_CORNER`].
    pub opposite: Vec<u32>,
    /// One corner at each vertex.
    pub corner_of: Vec<u32>,
    /// Edges at each vertex.
    pub valence: Vec<u32>,
}

impl Surface {
    /// Vertex at `corner`.
    #[inline]
    pub fn vertex(&self, corner: u32) -> u32 {
        self.triangles.as_flattened()[corner as usize]
    }

    /// Corner across the edge that faces `corner`.
    #[inline]
    pub fn across(&self, corner: u32) -> u32 {
        self.opposite[corner as usize]
    }

    /// The next corner at the same vertex, counter-clockwise, or [`NO_CORNER`] at the boundary.
    #[inline]
    pub fn swing_left(&self, corner: u32) -> u32 {
        // The edge vertex–prev is shared with the triangle to the left.
        let o = self.across(next(corner));
        if o == NO_CORNER { NO_CORNER } else { next(o) }
    }

    /// The next corner at the same vertex, clockwise, or [`NO_CORNER`] at the boundary.
    #[inline]
    pub fn swing_right(&self, corner: u32) -> u32 {
        let o = self.across(prev(corner));
        if o == NO_CORNER { NO_CORNER } else { prev(o) }
    }

    /// Links the edges that face two corners.
    #[cfg(feature = "encoder")]
    #[inline]
    pub fn link(&mut self, a: u32, b: u32) {
        if a != NO_CORNER {
            self.opposite[a as usize] = b;
        }
        if b != NO_CORNER {
            self.opposite[b as usize] = a;
        }
    }

    /// Fills `corners` with the corners at the vertex of `corner` in counter-clockwise order; an
    /// open fan starts at its boundary. Returns whether the fan is closed.
    pub fn fan(&self, corner: u32, corners: &mut Vec<u32>) -> bool {
        corners.clear();
        let mut c = corner;
        loop {
            corners.push(c);
            let left = self.swing_left(c);
            if left == corner {
                return true;
            }
            if left == NO_CORNER {
                break;
            }
            c = left;
        }
        let after = corners.len();
        let mut c = self.swing_right(corner);
        while c != NO_CORNER {
            corners.push(c);
            c = self.swing_right(c);
        }
        corners[after..].reverse();
        corners.rotate_left(after);
        false
    }
}
