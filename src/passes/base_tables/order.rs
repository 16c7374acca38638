//! Which vertex is placed next: as in [`base_traversal`](crate::passes::base_traversal), the one that most parallelograms say
//! something of.

use std::collections::VecDeque;

/// Parallelograms that make a difference.
pub(super) const MOST: usize = 3;

/// Vertices that had 1, 2, … parallelograms when they came here: most first, then first in, first out.
#[derive(Default)]
pub(super) struct Order {
    waiting: [VecDeque<u32>; MOST],
    /// No vertex before this one waits to be the first of a component.
    first: u32,
}

impl Order {
    /// Takes the next vertex out, the first one of all if no parallelogram ends at any; `None` if all are placed. `state`: the
    /// parallelograms that end at a vertex, `None` if it is placed.
    #[inline(always)]
    pub(super) fn next(&mut self, num_vertices: usize, state: impl Fn(u32) -> Option<usize>) -> Option<u32> {
        for count in (1..=MOST).rev() {
            while let Some(vertex) = self.waiting[count - 1].pop_front() {
                if state(vertex) == Some(count) {
                    return Some(vertex);
                }
            }
        }
        while (self.first as usize) < num_vertices {
            self.first += 1;
            if state(self.first - 1).is_some() {
                return Some(self.first - 1);
            }
        }
        None
    }

    /// Notes that so many parallelograms end at a vertex, 1 to [`MOST`].
    #[inline(always)]
    pub(super) fn push(&mut self, vertex: u32, count: usize) {
        self.waiting[count - 1].push_back(vertex);
    }
}
