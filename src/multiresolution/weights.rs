//! Weights of a ring that put its mean where the odd vertex lies along the surface.

use glam::DVec3;

/// Weights ≥ 0 with sum 1 for a vertex in a closed `ring`: mean value coordinates (Floater, 2003) of its
/// projection to the ring's plane. Negative ones are cut off; equal ones where the projection fails.
pub(super) fn closed_ring(vertex: DVec3, ring: &[DVec3], weights: &mut Vec<f64>) {
    let count = ring.len();
    let offset = |i: usize| ring[i % count] - vertex;
    let area: DVec3 = (0..count).map(|i| offset(i).cross(offset(i + 1))).sum();
    let normal = area.normalize_or_zero();
    let flat = |i: usize| offset(i) - normal * normal.dot(offset(i));
    // tan(α/2) of the angle at the vertex between one ring vertex and the next.
    let half_tangent = |i: usize| {
        let (p, q) = (flat(i), flat(i + 1));
        p.cross(q).dot(normal) / (p.length() * q.length() + p.dot(q))
    };
    weights.clear();
    weights.extend((0..count).map(|i| {
        let sides = half_tangent((i + count - 1) % count) + half_tangent(i);
        (sides / flat(i).length()).max(0.0)
    }));
    normalise(weights);
}

/// As [`closed_ring`] for a vertex of the boundary: between the ends of its open ring only, so that a
/// boundary is made of boundaries.
pub(super) fn open_ring(vertex: DVec3, ring: &[DVec3], weights: &mut Vec<f64>) {
    weights.clear();
    weights.resize(ring.len(), 0.0);
    let (first, last) = (ring[0], ring[ring.len() - 1]);
    let along = (vertex - first).dot(last - first) / (last - first).length_squared();
    let share = if along.is_finite() { along.clamp(0.0, 1.0) } else { 0.5 };
    weights[0] = 1.0 - share;
    weights[ring.len() - 1] += share;
}

fn normalise(weights: &mut [f64]) {
    let sum: f64 = weights.iter().sum();
    let equal = 1.0 / weights.len() as f64;
    let is_sound = sum.is_finite() && sum > 0.0;
    weights.iter_mut().for_each(|w| *w = if is_sound { *w / sum } else { equal });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mean(ring: &[DVec3], weights: &[f64]) -> DVec3 {
        ring.iter().zip(weights).map(|(&p, &w)| p * w).sum()
    }

    #[test]
    fn the_mean_lies_under_the_vertex() {
        let ring: Vec<DVec3> = [[2.0, 0.0], [1.0, 2.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -2.0]]
            .map(|[x, y]| DVec3::new(x, y, 0.0))
            .to_vec();
        let mut weights = Vec::new();
        for vertex in [DVec3::new(0.3, 0.2, 0.0), DVec3::new(-0.5, 0.1, 0.9), DVec3::new(1.2, -0.4, -0.5)] {
            closed_ring(vertex, &ring, &mut weights);
            assert!(weights.iter().all(|w| *w >= 0.0));
            assert!((mean(&ring, &weights) - vertex.with_z(0.0)).length() < 1e-12);
        }
    }

    #[test]
    fn hopeless_rings_have_equal_weights() {
        let mut weights = Vec::new();
        closed_ring(DVec3::ZERO, &[DVec3::X, DVec3::X * 2.0, DVec3::X * 3.0], &mut weights);
        assert_eq!(weights, [1.0 / 3.0; 3]);
        closed_ring(DVec3::X, &[DVec3::X, DVec3::Y, DVec3::Z], &mut weights);
        assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-15 && weights.iter().all(|w| w.is_finite()));
        open_ring(DVec3::ZERO, &[DVec3::X; 2], &mut weights);
        assert_eq!(weights, [0.5, 0.5]);
    }

    #[test]
    fn a_boundary_is_divided_where_the_vertex_was() {
        let ring = [DVec3::ZERO, DVec3::new(1.0, 5.0, 0.0), DVec3::X * 4.0];
        let mut weights = Vec::new();
        open_ring(DVec3::new(1.0, 0.3, 0.2), &ring, &mut weights);
        assert_eq!(weights, [0.75, 0.0, 0.25]);
    }
}
