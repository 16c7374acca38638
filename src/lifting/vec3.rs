//! The few vector operations of the decoder, their order of evaluation part of the format.

pub(crate) type Vec3 = [f64; 3];

#[inline]
pub(crate) fn add(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline]
pub(crate) fn sub(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline]
pub(crate) fn scale(a: Vec3, s: f64) -> Vec3 {
    [a[0] * s, a[1] * s, a[2] * s]
}

#[inline]
pub(crate) fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline]
pub(crate) fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline]
pub(crate) fn norm(a: Vec3) -> f64 {
    dot(a, a).sqrt()
}

#[inline]
pub(crate) fn from_grid(p: [i32; 3]) -> Vec3 {
    [f64::from(p[0]), f64::from(p[1]), f64::from(p[2])]
}

/// A direction along which points are compared.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Direction {
    /// One of the coordinates.
    Axis(usize),
    /// Any vector.
    Along(Vec3),
}

impl Direction {
    /// Place of a point along the direction.
    #[inline]
    pub(crate) fn of(self, p: Vec3) -> f64 {
        match self {
            Direction::Axis(axis) => p[axis],
            Direction::Along(d) => dot(p, d),
        }
    }
}
