//! Distance from a point to a triangle.

use glam::DVec3;

/// Squared distance from `p` to a triangle: to its plane if `p` projects inside, else to the nearest edge.
#[cfg(any(feature = "metrics", test))]
pub(crate) fn squared_distance(p: DVec3, triangle: &[DVec3; 3]) -> f64 {
    Triangle::new(triangle).nearer(p, f64::INFINITY)
}

/// Barycentric coordinates of the point of a triangle that is closest to `p` (Ericson, Real-Time Collision Detection,
/// 5.1.5).
#[cfg(any(feature = "encoder", feature = "metrics"))]
pub(crate) fn closest_shares(p: DVec3, &[a, b, c]: &[DVec3; 3]) -> [f64; 3] {
    let (ab, ac) = (b - a, c - a);
    let [pa, pb, pc] = [a, b, c].map(|corner| p - corner);
    let (d1, d2) = (ab.dot(pa), ac.dot(pa));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let (d3, d4) = (ab.dot(pb), ac.dot(pb));
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let v = share_of(d1, -d3);
        return [1.0 - v, v, 0.0];
    }
    let (d5, d6) = (ab.dot(pc), ac.dot(pc));
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let w = share_of(d2, -d6);
        return [1.0 - w, 0.0, w];
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let w = share_of(d4 - d3, d5 - d6);
        return [0.0, 1.0 - w, w];
    }
    let sum = va + vb + vc;
    if sum > 0.0 { [va / sum, vb / sum, vc / sum] } else { [1.0, 0.0, 0.0] }
}

/// The point of a triangle that is closest to `p`.
#[cfg(feature = "metrics")]
pub(crate) fn nearest_point(p: DVec3, triangle: &[DVec3; 3]) -> DVec3 {
    let shares = closest_shares(p, triangle);
    (0..3).map(|i| shares[i] * triangle[i]).sum()
}

/// x / (x + y), 0 where an edge has no length.
#[cfg(any(feature = "encoder", feature = "metrics"))]
fn share_of(x: f64, y: f64) -> f64 {
    if x + y > 0.0 { x / (x + y) } else { 0.0 }
}

/// A triangle to which many distances are asked.
pub(crate) struct Triangle {
    a: DVec3,
    b: DVec3,
    ab: DVec3,
    ac: DVec3,
    bc: DVec3,
    squared_lengths: [f64; 3],
    normal: DVec3,
    normal_squared: f64,
    is_sliver: bool,
}

impl Triangle {
    #[inline]
    pub(crate) fn new(&[a, b, c]: &[DVec3; 3]) -> Self {
        let (ab, ac, bc) = (b - a, c - a, c - b);
        let squared_lengths = [ab, ac, bc].map(DVec3::length_squared);
        let normal = ab.cross(ac);
        let normal_squared = normal.length_squared();
        // The sine of the angle at `a`, squared. A sliver's normal is noise; its edges are as near as it is.
        let is_sliver = normal_squared <= 1e-20 * squared_lengths[0] * squared_lengths[1];
        Self { a, b, ab, ac, bc, squared_lengths, normal, normal_squared, is_sliver }
    }

    /// Squared distance from `p`, or `squared` if that is less.
    #[inline]
    pub(crate) fn nearer(&self, p: DVec3, squared: f64) -> f64 {
        let &Self { a, b, ab, ac, bc, squared_lengths, normal, normal_squared, is_sliver } = self;
        let ap = p - a;
        if !is_sliver {
            // No point is nearer than the plane.
            let height = ap.dot(normal);
            if height * height >= squared * normal_squared {
                return squared;
            }
            // Barycentric coordinates of the projection, times the squared normal.
            let of_c = ab.cross(ap).dot(normal);
            let of_b = ap.cross(ac).dot(normal);
            if of_b >= 0.0 && of_c >= 0.0 && of_b + of_c <= normal_squared {
                return squared.min(height * height / normal_squared);
            }
        }
        let to_ab = squared_distance_to_segment(ap, ab, squared_lengths[0]);
        let to_ac = squared_distance_to_segment(ap, ac, squared_lengths[1]);
        let to_bc = squared_distance_to_segment(p - b, bc, squared_lengths[2]);
        squared.min(to_ab.min(to_ac).min(to_bc))
    }
}

/// Squared distance from `p` to the segment from the origin to `end`, which may be the origin.
#[inline]
fn squared_distance_to_segment(p: DVec3, end: DVec3, length_squared: f64) -> f64 {
    let along = p.dot(end);
    if along <= 0.0 || length_squared == 0.0 {
        p.length_squared()
    } else if along >= length_squared {
        (p - end).length_squared()
    } else {
        (p - end * (along / length_squared)).length_squared()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_to_a_triangle_by_region() {
        let triangle = [DVec3::ZERO, 2.0 * DVec3::X, 2.0 * DVec3::Y];
        for (point, expected) in [
            ([0.5, 0.5, 3.0], 9.0),   // the face
            ([0.5, 0.5, 0.0], 0.0),   // on it
            ([-1.0, -1.0, 1.0], 3.0), // corner a
            ([4.0, -1.0, 0.0], 5.0),  // corner b
            ([1.0, -2.0, 0.0], 4.0),  // edge ab
            ([-2.0, 1.0, 1.0], 5.0),  // edge ac
            ([2.0, 2.0, 0.0], 2.0),   // edge bc
            ([-1.0, 3.0, 0.0], 2.0),  // corner c
        ] {
            let squared = squared_distance(DVec3::from(point), &triangle);
            assert!((squared - expected).abs() < 1e-12, "{point:?}: {squared} is not {expected}");
            #[cfg(feature = "encoder")]
            {
                let shares = closest_shares(DVec3::from(point), &triangle);
                let closest: DVec3 = triangle.iter().zip(shares).map(|(&corner, share)| corner * share).sum();
                assert!((closest.distance_squared(DVec3::from(point)) - expected).abs() < 1e-12, "{point:?}");
                assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn degenerate_triangles_are_segments_and_points() {
        let (o, x) = (DVec3::ZERO, DVec3::X);
        let above = DVec3::new(0.25, 0.0, 2.0);
        assert_eq!(squared_distance(above, &[o, x, o]), 4.0);
        assert_eq!(squared_distance(above, &[o, 0.5 * x, x]), 4.0);
        assert_eq!(squared_distance(above, &[x, o, 0.1 * x]), 4.0);
        assert_eq!(squared_distance(above, &[x; 3]), 4.5625);
    }
}
