//! Exact vectors on the grid.

/// Difference `p − q` of two cells.
#[inline]
fn difference(p: [i32; 3], q: [i32; 3]) -> [i64; 3] {
    std::array::from_fn(|i| i64::from(p[i]) - i64::from(q[i]))
}

/// Cross product (b − a) × (c − a): twice the area vector of a triangle. Exact up to 31 bits.
#[inline]
pub(crate) fn area_vector(a: [i32; 3], b: [i32; 3], c: [i32; 3]) -> [i64; 3] {
    let (u, v) = (difference(b, a), difference(c, a));
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

/// Sign of the dot product of two area vectors, exactly.
#[inline]
pub(crate) fn is_same_side(m: [i64; 3], n: [i64; 3]) -> bool {
    let estimate = m[0] as f64 * n[0] as f64 + m[1] as f64 * n[1] as f64 + m[2] as f64 * n[2] as f64;
    let size = (m[0] as f64 * n[0] as f64).abs()
        + (m[1] as f64 * n[1] as f64).abs()
        + (m[2] as f64 * n[2] as f64).abs();
    if estimate.abs() > size * 1e-14 {
        return estimate > 0.0;
    }
    let exact: i128 = (0..3).map(|i| i128::from(m[i]) * i128::from(n[i])).sum();
    exact > 0
}
