//! An order of vertices in which neighbours in space are near each other in memory.

use glam::DVec3;
use rayon::prelude::*;

/// Cells of the grid along each axis, as a power of two.
const CELL_BITS: u32 = 10;

/// Indices of `positions` along a Morton curve through the box `low` .. `high`; ties by index.
///
/// Windows of consecutive vertices then overlap in the cache whatever the order of the file. Values do not
/// depend on it: rows of the adjacency keep the order of the faces, and so does every sum.
pub(super) fn morton_order(positions: &[DVec3], low: DVec3, high: DVec3) -> Vec<u32> {
    let cells_per_unit = f64::from((1 << CELL_BITS) - 1) / (high - low).max_element();
    let mut keys: Vec<u64> = (positions.par_iter().enumerate())
        .map(|(v, &p)| {
            // Casts saturate, and turn the NaN of an empty box into 0.
            let cell = ((p - low) * cells_per_unit).to_array().map(|c| spread(c as u32));
            u64::from(cell[0] | cell[1] << 1 | cell[2] << 2) << 32 | v as u64
        })
        .collect();
    keys.par_sort_unstable();
    keys.into_iter().map(|key| key as u32).collect()
}

/// Moves bit i of a cell to bit 3i.
fn spread(cell: u32) -> u32 {
    let x = cell.min((1 << CELL_BITS) - 1);
    let x = (x | x << 16) & 0x0300_00ff;
    let x = (x | x << 8) & 0x0300_f00f;
    let x = (x | x << 4) & 0x030c_30c3;
    (x | x << 2) & 0x0924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spread_leaves_two_gaps() {
        assert_eq!(spread(0b11_0000_0101), 0b001_001_000_000_000_000_000_001_000_001);
        assert_eq!(spread(u32::MAX), 0x0924_9249);
    }

    #[test]
    fn order_is_a_permutation_even_of_one_point() {
        assert_eq!(morton_order(&[DVec3::ONE; 3], DVec3::ONE, DVec3::ONE), [0, 1, 2]);
        let corners = [DVec3::ONE, DVec3::X, DVec3::ZERO, DVec3::Y];
        assert_eq!(morton_order(&corners, DVec3::ZERO, DVec3::ONE), [2, 1, 3, 0]);
    }
}
