//! Average plane distance (eq. 34 of the paper).

use crate::descriptors::symmetric::Sym3;
use crate::simplification::LevelRecord;
use glam::DVec3;

/// A plane is undetermined if the second eigenvalue is at most this part of the largest.
const COLLINEAR: f64 = 1e-12;

/// Mean over the vertices of `record` of the distance to the total-least-squares plane of the one-ring,
/// in the units of `positions`; 0 without vertices.
pub(super) fn average_plane_distance(record: &LevelRecord, positions: &[[f64; 3]]) -> f64 {
    let mut ring = Vec::new();
    let mut sum = 0.0;
    for removed in record.iter() {
        let at = |v: u32| DVec3::from_array(positions[v as usize]);
        let vertex = at(removed.vertex);
        ring.clear();
        ring.extend(removed.ring.iter().map(|&v| at(v) - vertex));
        sum += distance_to_plane(&ring);
    }
    sum / record.len().max(1) as f64
}

/// Distance of the origin from the plane through the centroid of `ring` across the eigenvector of the
/// smallest eigenvalue; 0 if fewer than three points or points on a line leave the plane open.
fn distance_to_plane(ring: &[DVec3]) -> f64 {
    if ring.len() < 3 {
        return 0.0;
    }
    let centroid = ring.iter().sum::<DVec3>() / ring.len() as f64;
    let mut covariance = Sym3::default();
    ring.iter().for_each(|&p| covariance.add_outer(p - centroid, 1.0));
    let eigen = covariance.eigen();
    if eigen.values[1] <= COLLINEAR * eigen.values[2] {
        return 0.0;
    }
    eigen.vectors[0].dot(centroid).abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_of_a_tip_is_its_height() {
        let tip = DVec3::new(3.0, -2.0, 0.7);
        let ring = [DVec3::X, DVec3::Y, -DVec3::X, -DVec3::Y].map(|p| p - tip);
        assert!((distance_to_plane(&ring) - 0.7).abs() < 1e-15);
        assert_eq!(distance_to_plane(&ring[..2]), 0.0);
    }

    #[test]
    fn a_line_has_no_plane() {
        let ring: Vec<DVec3> = (0..5).map(|i| DVec3::new(f64::from(i), 1.0, 2.0)).collect();
        assert_eq!(distance_to_plane(&ring), 0.0);
    }
}
