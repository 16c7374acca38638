//! Fits a tree of contexts and its tables to symbols.

use super::frequencies::{Frequencies, TOTAL};
use super::models::{Group, GroupModel};
use super::tree::Node;
use libm::log2;

/// Bits that a table is reckoned to take, and each of its symbols.
const TABLE_BITS: f64 = 6.0;
const SYMBOL_BITS: f64 = 5.5;

/// Symbols of one context: `(symbol, count)`.
struct Cell {
    attributes: Vec<usize>,
    counts: Vec<(u8, u32)>,
}

/// A box of contexts.
struct Region {
    ranges: Vec<(usize, usize)>,
    cells: Vec<usize>,
    counts: Vec<u32>,
    bits: f64,
    best: Option<Halving>,
    children: Option<[usize; 2]>,
}

/// The way to halve a region that saves most bits.
#[derive(Clone, Copy)]
struct Halving {
    attribute: usize,
    threshold: usize,
    saved: f64,
}

/// Fits a group to its symbols with their contexts.
pub(super) fn fit(group: &Group, symbols: &mut [(u32, u8)]) -> GroupModel {
    let cells = cells_of(group, symbols);
    let ranges = group.attributes.iter().map(|&size| (0, size)).collect();
    let mut regions = vec![Region::new(ranges, (0..cells.len()).collect(), &cells, group.alphabet)];
    let mut num_leaves = 1;
    while num_leaves < group.most_tables {
        let leaves = regions.iter().enumerate().filter(|(_, r)| r.children.is_none());
        let best =
            leaves.filter_map(|(i, r)| Some((i, r.best?))).max_by(|a, b| a.1.saved.total_cmp(&b.1.saved));
        let Some((parent, halving)) = best else { break };
        let halves = regions[parent].halve(halving, &cells, group.alphabet);
        regions[parent].children = Some([regions.len(), regions.len() + 1]);
        regions.extend(halves);
        num_leaves += 1;
    }
    let mut model = GroupModel { tree: Vec::new(), tables: Vec::new() };
    let mut waiting = vec![0];
    while let Some(i) = waiting.pop() {
        let region = &regions[i];
        match (region.children, region.best) {
            (Some([first, second]), Some(Halving { attribute, threshold, .. })) => {
                model.tree.push(Node::Split { attribute, threshold });
                waiting.extend([second, first]);
            }
            _ => {
                model.tree.push(Node::Leaf);
                model.tables.push(Frequencies::of(&region.counts));
            }
        }
    }
    model
}

fn cells_of(group: &Group, symbols: &mut [(u32, u8)]) -> Vec<Cell> {
    symbols.sort_unstable();
    let cells = symbols.chunk_by(|a, b| a.0 == b.0).map(|same| {
        let mut context = same[0].0 as usize;
        let mut attributes = vec![0; group.attributes.len()];
        for (value, size) in attributes.iter_mut().zip(group.attributes).rev() {
            *value = context % size;
            context /= size;
        }
        let counts = same.chunk_by(|a, b| a.1 == b.1).map(|run| (run[0].1, run.len() as u32)).collect();
        Cell { attributes, counts }
    });
    cells.collect()
}

impl Region {
    fn new(ranges: Vec<(usize, usize)>, cells: Vec<usize>, all: &[Cell], alphabet: usize) -> Self {
        let mut counts = vec![0; alphabet];
        for &cell in &cells {
            all[cell].counts.iter().for_each(|&(symbol, count)| counts[usize::from(symbol)] += count);
        }
        let bits = bits(&counts);
        let mut region = Self { ranges, cells, counts, bits, best: None, children: None };
        region.best = region.best_halving(all);
        region
    }

    fn best_halving(&self, all: &[Cell]) -> Option<Halving> {
        let mut best: Option<Halving> = None;
        for (attribute, &(low, high)) in self.ranges.iter().enumerate() {
            let alphabet = self.counts.len();
            // Symbols by the value of the attribute.
            let mut by_value = vec![0; (high - low) * alphabet];
            for &cell in &self.cells {
                let first = (all[cell].attributes[attribute] - low) * alphabet;
                all[cell].counts.iter().for_each(|&(symbol, n)| by_value[first + usize::from(symbol)] += n);
            }
            let mut sides = [vec![0; alphabet], self.counts.clone()];
            for (value, counts) in by_value.chunks(alphabet).enumerate().take(high - low - 1) {
                if counts.iter().all(|&n| n == 0) {
                    continue;
                }
                counts.iter().zip(&mut sides[0]).for_each(|(n, sum)| *sum += n);
                counts.iter().zip(&mut sides[1]).for_each(|(n, sum)| *sum -= n);
                if sides[1].iter().all(|&n| n == 0) {
                    break;
                }
                let split = 1.0 + log2((self.ranges.len() * (high - low)) as f64);
                let saved = self.bits - bits(&sides[0]) - bits(&sides[1]) - split;
                if saved > best.map_or(0.0, |best| best.saved) {
                    best = Some(Halving { attribute, threshold: low + value + 1, saved });
                }
            }
        }
        best
    }

    fn halve(&self, halving: Halving, all: &[Cell], alphabet: usize) -> [Self; 2] {
        let Halving { attribute, threshold, .. } = halving;
        let (low, high) = self.ranges[attribute];
        [(low, threshold), (threshold, high)].map(|range| {
            let mut ranges = self.ranges.clone();
            ranges[attribute] = range;
            let is_inside = |cell: &&usize| (range.0..range.1).contains(&all[**cell].attributes[attribute]);
            let cells = self.cells.iter().filter(is_inside).copied().collect();
            Self::new(ranges, cells, all, alphabet)
        })
    }
}

/// Bits of symbols that come so often, with their table.
fn bits(counts: &[u32]) -> f64 {
    let sum: u64 = counts.iter().map(|&c| u64::from(c)).sum();
    let total = sum as f64;
    let least = 1.0 / f64::from(TOTAL);
    let used = counts.iter().filter(|&&c| c > 0);
    let symbols = used.map(|&c| SYMBOL_BITS - f64::from(c) * log2((f64::from(c) / total).max(least)));
    TABLE_BITS + symbols.sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contexts_that_tell_have_tables_of_their_own() {
        const GROUP: Group = Group { alphabet: 4, attributes: &[3, 5], most_tables: 8 };
        // The symbol follows from the second attribute.
        let mut symbols: Vec<(u32, u8)> = (0..6000)
            .map(|i: u32| (i % 15, u8::from(i % 5 >= 2) + 2 * u8::from(i.is_multiple_of(97))))
            .collect();
        let model = fit(&GROUP, &mut symbols);
        assert_eq!(model.tree, [Node::Split { attribute: 1, threshold: 2 }, Node::Leaf, Node::Leaf]);
        assert_eq!(model.tables.len(), 2);
        let alone = fit(&GROUP, &mut []);
        assert_eq!((alone.tree, alone.tables), (vec![Node::Leaf], vec![Frequencies(vec![1024])]));
    }
}
