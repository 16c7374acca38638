//! Four `f32` side by side: the coordinates of a point, or the experts of a mixture. Compilers turn
//! them into one register; every operation is one IEEE 754 operation per lane, so that the bits are
//! the same with and without one (`format/SPEC.md`, section 2).

use std::ops::{Add, AddAssign, Mul, Sub};

/// Lanes 0 to 2 are the axes of a point; the last one is arithmetic without a meaning.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(16))]
pub(crate) struct Lanes(pub(crate) [f32; 4]);

impl Lanes {
    pub(crate) const ZERO: Self = Self([0.0; 4]);

    #[inline(always)]
    pub(crate) const fn splat(x: f32) -> Self {
        Self([x; 4])
    }

    /// The way from `origin` to `cell`.
    #[inline(always)]
    pub(crate) fn between(origin: [i32; 3], cell: [i32; 3]) -> Self {
        let d: [i32; 3] = std::array::from_fn(|i| cell[i].wrapping_sub(origin[i]));
        Self([d[0] as f32, d[1] as f32, d[2] as f32, 0.0])
    }

    #[inline(always)]
    pub(crate) fn map(self, f: impl Fn(f32) -> f32) -> Self {
        Self(self.0.map(f))
    }

    #[inline(always)]
    pub(crate) fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|i| f(self.0[i], other.0[i])))
    }

    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        self.map(f32::abs)
    }

    /// The smaller of each pair; `self` if equal.
    #[inline(always)]
    pub(crate) fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if b < a { b } else { a })
    }

    /// The larger of each pair; `other` if equal.
    #[inline(always)]
    pub(crate) fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if b < a { a } else { b })
    }

    #[inline(always)]
    pub(crate) fn clamp(self, low: f32, high: f32) -> Self {
        Self::splat(low).max(self).min(Self::splat(high))
    }

    /// Scalar product of the first three lanes.
    #[inline(always)]
    pub(crate) fn dot3(self, other: Self) -> f32 {
        let Self([x, y, z, _]) = self * other;
        (x + y) + z
    }

    /// Sum of all four lanes.
    #[inline(always)]
    pub(crate) fn sum(self) -> f32 {
        let [a, b, c, d] = self.0;
        (a + b) + (c + d)
    }

    /// Cross product of the first three lanes.
    #[inline(always)]
    pub(crate) fn cross(self, other: Self) -> Self {
        let ([a0, a1, a2, a3], [b0, b1, b2, b3]) = (self.0, other.0);
        Self([a1, a2, a0, a3]) * Self([b2, b0, b1, b3]) - Self([a2, a0, a1, a3]) * Self([b1, b2, b0, b3])
    }
}

/// A grid cell, as wide as [`Lanes`] are.
#[derive(Clone, Copy, Default)]
#[repr(align(16))]
pub(crate) struct Cell([i32; 4]);

impl Cell {
    #[inline(always)]
    pub(crate) fn new([x, y, z]: [i32; 3]) -> Self {
        Self([x, y, z, 0])
    }

    /// The way to `other`.
    #[inline(always)]
    pub(crate) fn to(self, other: Self) -> Lanes {
        Lanes(std::array::from_fn(|i| other.0[i].wrapping_sub(self.0[i]) as f32))
    }

    /// How far `other` is, squared.
    #[inline(always)]
    pub(crate) fn squared_distance(self, other: Self) -> f32 {
        let way = self.to(other);
        way.dot3(way)
    }
}

impl Add for Lanes {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl AddAssign for Lanes {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Sub for Lanes {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl Mul for Lanes {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

impl Mul<f32> for Lanes {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: f32) -> Self {
        self * Self::splat(s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_those_of_vectors() {
        let (a, b) = (Lanes([1.0, 2.0, 3.0, 9.0]), Lanes([-4.0, 5.0, 0.5, 7.0]));
        assert_eq!(a.dot3(b), 7.5);
        assert_eq!(a.cross(b).0[..3], [-14.0, -12.5, 13.0]);
        assert_eq!(Lanes::between([1, 2, 3], [0, 4, -3]), Lanes([-1.0, 2.0, -6.0, 0.0]));
        assert_eq!((a.min(b).0[1], a.max(b).0[1], a.clamp(1.5, 2.5).0), (2.0, 5.0, [1.5, 2.0, 2.5, 2.5]));
        assert_eq!(a.sum(), 15.0);
    }
}
