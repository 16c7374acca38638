//! An order of vertices in which neighbours in space are near each other in memory.

use crate::util::morton::morton;
use glam::DVec3;
use rayon::prelude::*;

/// Cells of the grid along each axis, less one: codes have 30 bits.
const LAST_CELL: i32 = (1 << 10) - 1;

/// Indices of `positions` along a Morton curve through the box `low` .. `high`; ties by index.
///
/// Windows of consecutive vertices then overlap in the cache whatever the order of the file. Values do not
/// depend on it: rows of the adjacency keep the order of the faces, and so does every sum.
pub(super) fn morton_order(positions: &[DVec3], low: DVec3, high: DVec3) -> Vec<u32> {
    let cells_per_unit = f64::from(LAST_CELL) / (high - low).max_element();
    let mut keys: Vec<u64> = (positions.par_iter().enumerate())
        .map(|(v, &p)| {
            // Casts saturate, and turn the NaN of an empty box into 0.
            let [x, y, z] = ((p - low) * cells_per_unit).to_array().map(|c| (c as i32).clamp(0, LAST_CELL));
            (morton([z, y, x]) as u64) << 32 | v as u64
        })
        .collect();
    keys.par_sort_unstable();
    keys.into_iter().map(|key| key as u32).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_is_a_permutation_even_of_one_point() {
        assert_eq!(morton_order(&[DVec3::ONE; 3], DVec3::ONE, DVec3::ONE), [0, 1, 2]);
        let corners = [DVec3::ONE, DVec3::X, DVec3::ZERO, DVec3::Y];
        assert_eq!(morton_order(&corners, DVec3::ZERO, DVec3::ONE), [2, 1, 3, 0]);
    }
}
