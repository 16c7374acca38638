//! Vertices with equal cells, distinguished by what is around them.
//!
//! First all vertices are compared by their neighbours for some rounds. What is still equal is distinguished by
//! splitting classes (Paige and Tarjan, *Three partition refinement algorithms*, 1987; McKay, *Practical
//! graph isomorphism*, 1981): a vertex is marked, and only where a class of equal vertices comes apart the
//! neighbours are looked at again. So equal pieces cost as much as they have faces, however many are at one
//! position.

use super::tie_break::mix;
use crate::mesh::CornersAt;

/// Rounds in which all vertices are compared by their neighbours, before a check whether that distinguishes more;
/// a multiple of them at most.
const ROUNDS: usize = 4;
const MOST_ROUNDS: usize = 16 * ROUNDS;
/// Corners and vertices that may be looked at to tell the rest apart, times the corners and vertices there are.
/// More is asked for by meshes that somebody made for it, whose order then depends on the file.
const BUDGET: usize = 64;

/// Vertices in order of their codes, and what distinguishes those with equal codes.
pub(super) struct Ties<'a> {
    triangles: &'a [[u32; 3]],
    codes: Vec<u128>,
    /// One per vertex; equal vertices with equal codes are a class.
    pub(super) hash: Vec<u64>,
    /// Vertices by code, then hash, then index.
    order: Vec<u32>,
}

impl<'a> Ties<'a> {
    /// `codes` ascend.
    pub(super) fn new(codes: Vec<u128>, triangles: &'a [[u32; 3]]) -> Self {
        let hash = codes.iter().map(|&code| mix((code >> 64) as u64 ^ mix(code as u64))).collect();
        let order = (0..codes.len() as u32).collect();
        Self { triangles, codes, hash, order }
    }

    /// The vertices in an order that does not depend on their indices.
    pub(super) fn resolve(self) -> Vec<u32> {
        self.resolve_counting().0
    }

    /// The same, and how much was looked at to tell apart what the rounds did not.
    fn resolve_counting(mut self) -> (Vec<u32>, usize) {
        let mut num_kinds = 0;
        for round in 1..=MOST_ROUNDS {
            let sums = self.sums();
            self.hash.iter_mut().zip(sums).for_each(|(hash, sum)| *hash = mix(*hash ^ mix(sum)));
            if round % ROUNDS == 0 {
                self.sort();
                let before = std::mem::replace(&mut num_kinds, self.num_kinds());
                if num_kinds == self.order.len() || num_kinds == before {
                    break;
                }
            }
        }
        if num_kinds == self.order.len() {
            return (self.order, 0);
        }
        let mut classes = Classes::new(self);
        classes.tell_apart();
        (classes.order, classes.work)
    }

    /// What the corners pass to each vertex.
    fn sums(&self) -> Vec<u64> {
        let mut sums = vec![0_u64; self.hash.len()];
        for &[a, b, c] in self.triangles {
            for [v, n, p] in [[a, b, c], [b, c, a], [c, a, b]] {
                let sum = &mut sums[v as usize];
                *sum = sum.wrapping_add(told(self.hash[n as usize], self.hash[p as usize]));
            }
        }
        sums
    }

    fn look(&self, v: u32) -> (u128, u64) {
        (self.codes[v as usize], self.hash[v as usize])
    }

    /// Vertices that look different, once they are sorted.
    fn num_kinds(&self) -> usize {
        1 + self.order.windows(2).filter(|pair| self.look(pair[0]) != self.look(pair[1])).count()
    }

    fn sort(&mut self) {
        let mut order = std::mem::take(&mut self.order);
        order.sort_unstable_by_key(|&v| (self.look(v), v));
        self.order = order;
    }
}

/// What a corner passes to its vertex: its two other vertices, in their order.
fn told(next: u64, previous: u64) -> u64 {
    mix(next.rotate_left(20).wrapping_add(mix(previous)))
}

/// Classes of equal vertices, in their order: each is a range of `order`, and classes are split in place.
struct Classes<'a> {
    triangles: &'a [[u32; 3]],
    corners: CornersAt,
    hash: Vec<u64>,
    /// What the corners pass to each vertex, with the current hashes.
    sums: Vec<u64>,
    order: Vec<u32>,
    /// For each vertex its place in `order`, and the first place of its class.
    places: Vec<u32>,
    firsts: Vec<u32>,
    /// By the first place of a class: where it ends, and how many of its last vertices are touched.
    ends: Vec<u32>,
    touched: Vec<u32>,
    /// First places of the classes that have touched vertices.
    waiting: Vec<u32>,
    work: usize,
}

impl<'a> Classes<'a> {
    /// Of `ties` that are sorted.
    fn new(ties: Ties<'a>) -> Self {
        let num_vertices = ties.order.len();
        let (mut places, mut firsts) = (vec![0; num_vertices], vec![0; num_vertices]);
        let mut ends = vec![0; num_vertices];
        let mut first = 0;
        for class in ties.order.chunk_by(|&v, &w| ties.look(v) == ties.look(w)) {
            let end = first + class.len() as u32;
            for (&v, place) in class.iter().zip(first..) {
                (places[v as usize], firsts[v as usize]) = (place, first);
            }
            ends[first as usize] = end;
            first = end;
        }
        Self {
            triangles: ties.triangles,
            corners: CornersAt::new(ties.triangles, num_vertices),
            sums: ties.sums(),
            hash: ties.hash,
            order: ties.order,
            places,
            firsts,
            ends,
            touched: vec![0; num_vertices],
            waiting: Vec::new(),
            work: 0,
        }
    }

    /// Marks a vertex of the first class of several, and lets the others know, until there is no such class. Of
    /// vertices that a symmetry of the mesh maps to each other any may be marked.
    fn tell_apart(&mut self) {
        let budget = BUDGET * (self.order.len() + 3 * self.triangles.len());
        (0..self.order.len() as u32).for_each(|v| self.touch(v));
        self.settle(budget);
        let mut first = 0;
        for mark in 0_u64.. {
            // Classes before this one have a single vertex, and keep it.
            while first < self.order.len() && self.ends[first] as usize == first + 1 {
                first += 1;
            }
            if first == self.order.len() || self.work >= budget {
                return;
            }
            let marked = self.order[self.ends[first] as usize - 1];
            self.split_off(first as u32, self.ends[first] - 1);
            self.rename(marked, mix(!self.hash[marked as usize].wrapping_add(mark)));
            self.settle(budget);
        }
    }

    /// Splits classes as long as their touched vertices differ from the others.
    fn settle(&mut self, budget: usize) {
        let mut changed = Vec::new();
        while !self.waiting.is_empty() && self.work < budget {
            // In the order of the classes, which is that of no file. All look before any changes.
            let mut waiting = std::mem::take(&mut self.waiting);
            waiting.sort_unstable();
            waiting.into_iter().for_each(|first| self.split(first, &mut changed));
            changed.drain(..).for_each(|(v, hash)| self.rename(v, hash));
        }
    }

    /// Takes the touched vertices of a class out of it by what they are told, and names those that `changed`.
    fn split(&mut self, first: u32, changed: &mut Vec<(u32, u64)>) {
        let end = self.ends[first as usize];
        let begin = end - std::mem::take(&mut self.touched[first as usize]);
        self.work += (end - begin) as usize;
        let sums = &self.sums;
        let touched = &mut self.order[begin as usize..end as usize];
        touched.sort_unstable_by_key(|&v| sums[v as usize]);
        let starts: Vec<u32> = (begin + 1..end)
            .zip(touched.windows(2))
            .filter(|(_, pair)| sums[pair[0] as usize] != sums[pair[1] as usize])
            .map(|(place, _)| place)
            .collect();
        touched.iter().zip(begin..).for_each(|(&v, place)| self.places[v as usize] = place);
        if begin == first && starts.is_empty() {
            return;
        }
        let named = |&v: &u32| (v, mix(self.hash[v as usize] ^ mix(sums[v as usize])));
        changed.extend(touched.iter().map(named));
        starts.into_iter().rev().for_each(|place| self.split_off(first, place));
        if begin > first {
            self.split_off(first, begin);
        }
    }

    /// Makes the part of a class from `place` on a separate class.
    fn split_off(&mut self, first: u32, place: u32) {
        let end = std::mem::replace(&mut self.ends[first as usize], place);
        self.ends[place as usize] = end;
        for &v in &self.order[place as usize..end as usize] {
            self.firsts[v as usize] = place;
        }
    }

    /// Gives a vertex another hash and passes it to those around it.
    fn rename(&mut self, v: u32, hash: u64) {
        let before = std::mem::replace(&mut self.hash[v as usize], hash);
        for i in 0..self.corners.at(v).len() {
            let corner = self.corners.at(v)[i] as usize;
            let t = self.triangles[corner / 3];
            let (next, previous) = (t[(corner + 1) % 3], t[(corner + 2) % 3]);
            let (of_next, of_previous) = (self.hash[next as usize], self.hash[previous as usize]);
            self.tell(next, told(of_previous, before), told(of_previous, hash));
            self.tell(previous, told(before, of_next), told(hash, of_next));
        }
        self.work += self.corners.at(v).len();
    }

    fn tell(&mut self, v: u32, before: u64, now: u64) {
        let sum = &mut self.sums[v as usize];
        *sum = sum.wrapping_sub(before).wrapping_add(now);
        self.touch(v);
    }

    /// Brings a vertex to the touched ones at the end of its class, unless it is there or alone.
    fn touch(&mut self, v: u32) {
        let first = self.firsts[v as usize];
        let (end, touched) = (self.ends[first as usize], self.touched[first as usize]);
        let from = self.places[v as usize];
        if end - first < 2 || from >= end - touched {
            return;
        }
        let to = end - touched - 1;
        let other = self.order[to as usize];
        self.order.swap(from as usize, to as usize);
        (self.places[v as usize], self.places[other as usize]) = (to, from);
        if touched == 0 {
            self.waiting.push(first);
        }
        self.touched[first as usize] = touched + 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The cost of telling all vertices apart, relative to the number of vertices and corners.
    fn work(codes: Vec<u128>, triangles: &[[u32; 3]]) -> f64 {
        let size = codes.len() + 3 * triangles.len();
        let (mut order, work) = Ties::new(codes, triangles).resolve_counting();
        order.sort_unstable();
        assert!(order.into_iter().eq(0..order_len(triangles)));
        work as f64 / size as f64
    }

    fn order_len(triangles: &[[u32; 3]]) -> u32 {
        1 + triangles.as_flattened().iter().max().copied().unwrap_or(0)
    }

    #[test]
    fn equal_pieces_cost_what_they_have_of_corners() {
        for count in [100_u32, 10_000] {
            let triangles: Vec<[u32; 3]> = (0..count).map(|i| [i, i + count, i + 2 * count]).collect();
            let corners_at_three_places = (0..3 * count).map(|v| u128::from(v / count)).collect();
            let all_at_one = vec![0; 3 * count as usize];
            for codes in [corners_at_three_places, all_at_one] {
                let work = work(codes, &triangles);
                assert!((0.1..4.0).contains(&work), "{count} triangles: {work}");
            }
        }
    }

    #[test]
    fn many_faces_at_an_edge_cost_what_they_have_of_corners() {
        for count in [100_u32, 10_000] {
            let triangles: Vec<[u32; 3]> = (2..count + 2).map(|v| [0, 1, v]).collect();
            let codes = (0..count + 2).map(|v| u128::from(v.saturating_sub(2) / 4)).collect();
            let work = work(codes, &triangles);
            assert!((0.1..4.0).contains(&work), "{count} triangles: {work}");
        }
    }

    #[test]
    fn a_class_may_be_touched_whole_and_again() {
        let mut classes = Classes::new(Ties::new(vec![0; 3], &[[0, 1, 2]]));
        for v in [1, 0, 2, 1, 2, 0] {
            classes.touch(v);
        }
        assert_eq!((classes.touched[0], &classes.waiting[..]), (3, &[0][..]));
        classes.order.sort_unstable();
        assert_eq!(classes.order, [0, 1, 2]);
    }
}
