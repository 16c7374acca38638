//! Distance from a point to a triangle.

use glam::DVec3;

/// Squared distance from `p` to a triangle: to its plane if `p` projects inside, else to the nearest edge.
pub(crate) fn squared_distance(p: DVec3, [a, b, c]: &[DVec3; 3]) -> f64 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let normal = ab.cross(ac);
    let normal_squared = normal.length_squared();
    // The sine of the angle at `a`, squared. A sliver's normal is noise; its edges are as near as it is.
    let is_sliver = normal_squared <= 1e-20 * ab.length_squared() * ac.length_squared();
    if !is_sliver {
        // Barycentric coordinates of the projection, times the squared normal.
        let of_c = ab.cross(ap).dot(normal);
        let of_b = ap.cross(ac).dot(normal);
        if of_b >= 0.0 && of_c >= 0.0 && of_b + of_c <= normal_squared {
            let height = ap.dot(normal);
            return height * height / normal_squared;
        }
    }
    let to_ab = squared_distance_to_segment(ap, ab);
    let to_ac = squared_distance_to_segment(ap, ac);
    let to_bc = squared_distance_to_segment(p - b, c - b);
    to_ab.min(to_ac).min(to_bc)
}

/// Squared distance from `p` to the segment from the origin to `end`, which may be the origin.
fn squared_distance_to_segment(p: DVec3, end: DVec3) -> f64 {
    let along = p.dot(end);
    let length_squared = end.length_squared();
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
