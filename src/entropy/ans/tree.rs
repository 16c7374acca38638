//! Which table a context has (`format/SPEC.md`, section 6.7): a tree that halves the box of all contexts, attribute by
//! attribute.

use super::super::context_mixer::PlainBits;
use super::super::range_coder::BitCoder;

/// Depths that the question for a leaf tells apart.
const DEPTHS: usize = 8;

/// A node, in preorder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Node {
    Leaf,
    /// Contexts whose attribute is below the threshold are on the first side. Decoders make none.
    #[cfg_attr(not(feature = "encoder"), allow(dead_code))]
    Split {
        attribute: usize,
        threshold: usize,
    },
}

/// What a tree says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Leaves {
    /// Leaf of each context, the last attribute counting fastest.
    pub(super) of_context: Vec<u8>,
    pub(super) count: usize,
    /// Whether it looks at each attribute.
    pub(super) looks_at: Vec<bool>,
}

/// Codes a tree over contexts whose attributes have these numbers of values, with `most` leaves at most; `None` if what is read
/// is no such tree.
pub(super) fn code<B: BitCoder>(
    coder: &mut B,
    sizes: &[usize],
    most: usize,
    tree: Option<&[Node]>,
) -> Option<Leaves> {
    let mut looks_at = vec![false; sizes.len()];
    let mut is_leaf = PlainBits::new(DEPTHS);
    let mut leaves = vec![0; sizes.iter().product()];
    let (mut num_leaves, mut next) = (0, 0);
    let mut waiting = vec![(sizes.iter().map(|&size| (0, size)).collect::<Vec<_>>(), 0)];
    while let Some((ranges, depth)) = waiting.pop() {
        let wanted = tree.map_or(Node::Leaf, |tree| tree[next]);
        next += 1;
        if is_leaf.code(coder, depth.min(DEPTHS - 1), wanted == Node::Leaf) {
            if num_leaves == most {
                return None;
            }
            fill(&mut leaves, sizes, &ranges, num_leaves as u8);
            num_leaves += 1;
            continue;
        }
        let wanted =
            if let Node::Split { attribute, threshold } = wanted { (attribute, threshold) } else { (0, 1) };
        let attribute = below(coder, sizes.len(), wanted.0)?;
        looks_at[attribute] = true;
        let (low, high) = ranges[attribute];
        // No side is empty.
        let threshold = low
            + 1
            + below(coder, (high - low).checked_sub(1).filter(|&n| n > 0)?, wanted.1.wrapping_sub(low + 1))?;
        for range in [(threshold, high), (low, threshold)] {
            let mut side = ranges.clone();
            side[attribute] = range;
            waiting.push((side, depth + 1));
        }
        if waiting.len() + num_leaves > most {
            return None;
        }
    }
    Some(Leaves { of_context: leaves, count: num_leaves, looks_at })
}

/// Codes a number below `count`.
fn below<B: BitCoder>(coder: &mut B, count: usize, value: usize) -> Option<usize> {
    let bits = usize::BITS - (count - 1).leading_zeros();
    let value = coder.code_raw(value as u32, bits) as usize;
    (value < count).then_some(value)
}

/// Gives a box of contexts its leaf.
fn fill(leaves: &mut [u8], sizes: &[usize], ranges: &[(usize, usize)], leaf: u8) {
    let (Some((_, sizes)), Some((&(low, high), ranges))) = (sizes.split_first(), ranges.split_first()) else {
        return;
    };
    let inner: usize = sizes.iter().product();
    // What has all values of the other attributes lies side by side.
    if sizes.iter().zip(ranges).all(|(&size, &range)| range == (0, size)) {
        leaves[low * inner..high * inner].fill(leaf);
        return;
    }
    let parts = leaves[low * inner..high * inner].chunks_exact_mut(inner);
    parts.for_each(|part| fill(part, sizes, ranges, leaf));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::entropy::range_coder::{RangeDecoder, RangeEncoder};

    #[test]
    fn a_tree_returns() {
        let split = |attribute, threshold| Node::Split { attribute, threshold };
        let tree = [split(1, 2), split(0, 3), Node::Leaf, Node::Leaf, split(1, 3), Node::Leaf, Node::Leaf];
        let mut encoder = RangeEncoder::new();
        let written = code(&mut encoder, &[5, 4], 4, Some(&tree)).unwrap();
        let bytes = encoder.finish();
        assert_eq!(code(&mut RangeDecoder::new(&bytes), &[5, 4], 4, None), Some(written.clone()));
        assert_eq!(code(&mut RangeDecoder::new(&bytes), &[5, 4], 3, None), None, "too many leaves");
        let leaf = |a: usize, b: usize| written.of_context[a * 4 + b];
        assert_eq!([leaf(0, 0), leaf(2, 1), leaf(3, 1), leaf(0, 2), leaf(4, 3)], [0, 0, 1, 2, 3]);
    }

    #[test]
    fn any_bytes_end() {
        for seed in 0..300_u32 {
            let bytes: Vec<u8> =
                (0..40).map(|i| (seed.wrapping_mul(2_654_435_761) >> (i % 24)) as u8).collect();
            if let Some(leaves) = code(&mut RangeDecoder::new(&bytes), &[3, 7, 2], 9, None) {
                assert!(
                    leaves.of_context.iter().all(|&leaf| usize::from(leaf) < leaves.count)
                        && leaves.count <= 9
                );
            }
        }
    }
}
