//! A queue of vertices that has few different priorities: a set of bits for each, in which the first one is found
//! through summaries of 64 words each.

/// Priorities of vertices by valence and the number of neighbours that are next to a removed vertex.
pub(crate) struct PackingClasses {
    /// Where those of each valence begin, by number of neighbours.
    first: Vec<u32>,
    class: Vec<u32>,
    pub(crate) count: usize,
}

impl PackingClasses {
    /// For valences up to `largest`. First comes the least valence less some of the share of the neighbours.
    pub(crate) fn new(largest: usize) -> Self {
        /// What a ring counts, all of whose vertices are next to others, in units of valence.
        const WEIGHT: f64 = 0.7;
        let mut first = Vec::with_capacity(largest + 1);
        let mut keys = Vec::new();
        for degree in 0..=largest {
            first.push(keys.len() as u32);
            let key = |touched: usize| degree as f64 - WEIGHT * touched as f64 / degree.max(1) as f64;
            keys.extend((0..=degree).map(|touched| (1000.0 * key(touched)) as u64));
        }
        let mut sorted = keys.clone();
        sorted.sort_unstable();
        sorted.dedup();
        let class = keys.iter().map(|&key| sorted.partition_point(|&k| k < key) as u32).collect();
        Self { first, class, count: sorted.len() }
    }

    #[inline]
    pub(crate) fn of(&self, degree: usize, touched: usize) -> usize {
        self.class[self.first[degree] as usize + touched.min(degree)] as usize
    }
}

/// Vertices by class, then index.
pub(crate) struct ClassQueue {
    classes: Vec<BitTree>,
    /// No class before this one has a vertex.
    lowest: usize,
}

impl ClassQueue {
    pub(crate) fn new(num_classes: usize, num_vertices: usize) -> Self {
        Self { classes: vec![BitTree::new(num_vertices); num_classes], lowest: num_classes }
    }

    pub(crate) fn insert(&mut self, class: usize, vertex: u32) {
        self.classes[class].insert(vertex as usize);
        self.lowest = self.lowest.min(class);
    }

    pub(crate) fn remove(&mut self, class: usize, vertex: u32) {
        self.classes[class].remove(vertex as usize);
    }

    /// Takes the first vertex out.
    pub(crate) fn pop(&mut self) -> Option<u32> {
        while let Some(class) = self.classes.get_mut(self.lowest) {
            if let Some(vertex) = class.first() {
                class.remove(vertex);
                return Some(vertex as u32);
            }
            self.lowest += 1;
        }
        None
    }
}

/// A set of small numbers.
#[derive(Clone)]
struct BitTree {
    /// The bits, then which words of the level before are not zero, up to a single word.
    levels: Vec<Vec<u64>>,
}

impl BitTree {
    fn new(len: usize) -> Self {
        let mut levels = Vec::new();
        let mut len = len;
        loop {
            len = len.div_ceil(64).max(1);
            levels.push(vec![0; len]);
            if len == 1 {
                return Self { levels };
            }
        }
    }

    #[inline]
    fn insert(&mut self, mut i: usize) {
        for level in &mut self.levels {
            let word = &mut level[i / 64];
            let was_empty = *word == 0;
            *word |= 1 << (i % 64);
            if !was_empty {
                break;
            }
            i /= 64;
        }
    }

    #[inline]
    fn remove(&mut self, mut i: usize) {
        for level in &mut self.levels {
            let word = &mut level[i / 64];
            *word &= !(1 << (i % 64));
            if *word != 0 {
                break;
            }
            i /= 64;
        }
    }

    fn first(&self) -> Option<usize> {
        let mut at = 0;
        for level in self.levels.iter().rev() {
            let word = level[at];
            if word == 0 {
                return None;
            }
            at = 64 * at + word.trailing_zeros() as usize;
        }
        Some(at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_of_the_lowest_class_comes_first() {
        let mut queue = ClassQueue::new(3, 300_000);
        for (class, vertex) in [(2, 7), (1, 299_999), (1, 70_000), (2, 5), (1, 64)] {
            queue.insert(class, vertex);
        }
        queue.remove(1, 64);
        assert_eq!(queue.pop(), Some(70_000));
        queue.insert(0, 9);
        let rest: Vec<u32> = std::iter::from_fn(|| queue.pop()).collect();
        assert_eq!(rest, [9, 299_999, 5, 7]);
    }

    #[test]
    fn low_valences_and_close_packing_come_first() {
        let classes = PackingClasses::new(7);
        assert!(classes.of(4, 4) < classes.of(4, 1) && classes.of(4, 0) < classes.of(5, 5));
        assert!(classes.of(7, 0) < classes.count);
    }
}
