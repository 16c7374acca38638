//! Codes along a space-filling curve (Morton 1966).

/// The bits of the three coordinates (each below 2³⁰) in turn, x highest.
pub(crate) fn morton(cell: [i32; 3]) -> u128 {
    let [x, y, z] = cell.map(|c| spread(c as u32));
    x << 2 | y << 1 | z
}

/// Two zeros in front of each of 30 bits.
fn spread(c: u32) -> u128 {
    let half = |bits: u32| {
        let mut x = u64::from(bits);
        x = (x | x << 32) & 0x001f_0000_0000_ffff;
        x = (x | x << 16) & 0x001f_0000_ff00_00ff;
        x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
        x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
        (x | x << 2) & 0x1249_2492_4924_9249
    };
    u128::from(half(c >> 15)) << 45 | u128::from(half(c & 0x7fff))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spread_leaves_two_gaps() {
        assert_eq!(spread(0b11_0000_0101), 0b001_001_000_000_000_000_000_001_000_001);
        assert_eq!(spread(1023), 0x0924_9249);
    }

    #[test]
    fn codes_interleave_all_bits() {
        let slow = |cell: [i32; 3]| {
            (0..30)
                .rev()
                .flat_map(|bit| cell.map(|c| c >> bit & 1))
                .fold(0_u128, |code, b| code << 1 | b as u128)
        };
        for cell in [[0, 0, 0], [1, 2, 4], [0x3fff_ffff; 3], [0x1234_5678, 0x0fed_cba9, 0x2aaa_5555]] {
            assert_eq!(morton(cell), slow(cell), "{cell:?}");
        }
    }
}
