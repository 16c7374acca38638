//! Which vertex of the base mesh is placed next (`format/SPEC.md`, section 7.1): the one that most parallelograms say
//! something of.

use crate::mesh::Surface;
use crate::mesh::surface::{NO_CORNER, next, prev};
use std::collections::VecDeque;

/// Parallelograms that make a difference.
const MOST: usize = 3;

/// Queue of vertices: most parallelograms first, then first in, first out.
pub(super) struct BaseTraversal {
    is_placed: Vec<bool>,
    /// Parallelograms over known points that end at each vertex, up to [`MOST`].
    counts: Vec<u8>,
    /// Vertices that had 1, 2, … of them when they came here.
    waiting: [VecDeque<u32>; MOST],
    /// No vertex before this one waits.
    first: u32,
    corners: Vec<u32>,
}

impl BaseTraversal {
    pub(super) fn new(num_vertices: usize) -> Self {
        Self {
            is_placed: vec![false; num_vertices],
            counts: vec![0; num_vertices],
            waiting: Default::default(),
            first: 0,
            corners: Vec::new(),
        }
    }

    pub(super) fn is_placed(&self, vertex: u32) -> bool {
        self.is_placed[vertex as usize]
    }

    /// Takes the next vertex out, the first of all if no parallelogram ends at any; `None` if all are placed.
    pub(super) fn next(&mut self) -> Option<u32> {
        for count in (1..=MOST).rev() {
            while let Some(v) = self.waiting[count - 1].pop_front() {
                if !self.is_placed[v as usize] && usize::from(self.counts[v as usize]) == count {
                    return Some(v);
                }
            }
        }
        let rest = &self.is_placed[self.first as usize..];
        self.first += rest.iter().position(|&is_placed| !is_placed)? as u32;
        Some(self.first)
    }

    /// Counts the parallelograms that `vertex` completes, now that it is placed.
    pub(super) fn place(&mut self, surface: &Surface, vertex: u32) {
        self.is_placed[vertex as usize] = true;
        let mut corners = std::mem::take(&mut self.corners);
        surface.fan(surface.corner_of[vertex as usize], &mut corners);
        // The edges across the vertex, and those at it.
        for corner in corners.iter().flat_map(|&c| [c, next(c)]) {
            let across = surface.across(corner);
            let is_edge_placed =
                self.is_placed(surface.vertex(next(corner))) && self.is_placed(surface.vertex(prev(corner)));
            if across == NO_CORNER || !is_edge_placed {
                continue;
            }
            let tips = [corner, across].map(|c| surface.vertex(c));
            match tips.map(|v| self.is_placed(v)) {
                [true, false] => self.count(tips[1]),
                [false, true] => self.count(tips[0]),
                _ => {}
            }
        }
        self.corners = corners;
    }

    fn count(&mut self, vertex: u32) {
        let count = &mut self.counts[vertex as usize];
        if usize::from(*count) < MOST {
            self.waiting[usize::from(*count)].push_back(vertex);
            *count += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_vertex_has_its_turn_and_the_best_known_comes_first() {
        // A strip of eight triangles, and a triangle on its own.
        let mut triangles: Vec<[u32; 3]> =
            (0..8).map(|i| if i % 2 == 0 { [i, i + 1, i + 2] } else { [i + 1, i, i + 2] }).collect();
        triangles.push([10, 11, 12]);
        let surface = Surface::from_triangles(triangles, 13).unwrap();
        let mut order = BaseTraversal::new(13);
        let mut found = Vec::new();
        while let Some(v) = order.next() {
            order.place(&surface, v);
            found.push(v);
        }
        assert_eq!(found, (0..13).collect::<Vec<u32>>());

        // Around a hexagon's middle: the last corner completes two triangles with parallelograms.
        let fan: Vec<[u32; 3]> = (0..6).map(|i| [6, i, (i + 1) % 6]).collect();
        let surface = Surface::from_triangles(fan, 7).unwrap();
        let mut order = BaseTraversal::new(7);
        for v in [6, 0, 1] {
            order.place(&surface, v);
        }
        assert_eq!(order.next(), Some(2));
        order.place(&surface, 2);
        assert_eq!(order.next(), Some(5));
    }
}
