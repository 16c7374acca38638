//! How long the edges at a vertex are.

use super::tri_mesh::{TriMesh, has_three_vertices};

/// The length of a vector, also of one whose squares are 0 or infinite.
pub(crate) fn length(vector: [f64; 3]) -> f64 {
    /// Squares of what is between these are as precise as any.
    const USUAL: std::ops::Range<f64> = 1e-140..1e150;
    let norm = |vector: [f64; 3]| vector.map(|c| c * c).iter().sum::<f64>().sqrt();
    let largest = vector.iter().fold(0.0, |largest, c| c.abs().max(largest));
    if largest == 0.0 || !largest.is_finite() || USUAL.contains(&largest) {
        return norm(vector);
    }
    largest * norm(vector.map(|c| c / largest))
}

/// The mean length of the edges of each vertex, `None` where no triangle of three different vertices has it. An edge of two
/// triangles counts twice.
pub(crate) fn mean_edge_lengths(mesh: &TriMesh) -> Vec<Option<f64>> {
    let at = |vertex: u32| mesh.positions()[vertex as usize];
    let mut sums = vec![(0.0, 0_u32); mesh.num_vertices()];
    for &[a, b, c] in mesh.triangles().iter().filter(|t| has_three_vertices(t)) {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let (p, q) = (at(from), at(to));
            let length = length([0, 1, 2].map(|k| q[k] - p[k]));
            for vertex in [from, to] {
                let (sum, count) = &mut sums[vertex as usize];
                *sum += length;
                *count += 1;
            }
        }
    }
    sums.into_iter().map(|(sum, count)| (count > 0).then(|| sum / f64::from(count))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_count_once_per_triangle() {
        let positions = vec![[0.0; 3], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0], [9.0; 3]];
        let mesh = TriMesh::new(positions, vec![[0, 1, 2], [3, 3, 0]]).unwrap();
        assert_eq!(mean_edge_lengths(&mesh), [Some(3.5), Some(4.0), Some(4.5), None]);
    }

    #[test]
    fn lengths_neither_vanish_nor_overflow() {
        for scale in [1e-300, 1e-200, 1.0, 1e200, 1e300] {
            assert!((length([3.0 * scale, 4.0 * scale, 0.0]) / (5.0 * scale) - 1.0).abs() < 1e-15, "{scale}");
        }
        assert_eq!(length([0.0; 3]), 0.0);
    }
}
