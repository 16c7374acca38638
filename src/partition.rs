//! Odd and even: which vertices of a level are removed (Algorithm 1 of the paper), given one score
//! per vertex.

use crate::simplify::canonical::{Anchors, patch_order};
use crate::simplify::collapse::CollapseTest;
use crate::simplify::hole::HoleFiller;
use crate::simplify::memory::ErrorMemory;
use crate::simplify::{LevelRecord, ShrinkingSurface, Star};
use bitvec::vec::BitVec;
use rayon::prelude::*;
use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};

/// How a level is split into odd and even vertices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Partition {
    /// The error against the original surface, weighed by the descriptor, decides which vertices
    /// stay, the cost of coding which of the others go first; holes are closed by what lies close to
    /// the surface and is cheap to code ([`Optimize`] weighs the two). The default.
    #[default]
    Balanced,
    /// Algorithm 1 to the letter: ascending descriptor, half-edge collapse along the shortest legal
    /// edge.
    Algorithm1,
}

impl Partition {
    /// Every partition, in the order of their names in help texts.
    pub const ALL: [Partition; 2] = [Partition::Balanced, Partition::Algorithm1];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Partition::Balanced => "balanced",
            Partition::Algorithm1 => "algorithm1",
        }
    }
}

/// Coordinates that decide removals: both per vertex of the surface.
#[derive(Clone, Copy)]
pub(crate) struct Geometry<'a> {
    /// Cells the decoder will have: legality.
    pub(crate) grid: &'a [[i32; 3]],
    /// Coordinates of the input: lengths.
    pub(crate) positions: &'a [[f64; 3]],
}

/// What the balanced partition gives up for what.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Optimize {
    /// The smallest whole file.
    Size,
    /// Prefixes nearly as good as they get, for a file a little larger. The default.
    #[default]
    Balanced,
    /// The best prefixes.
    Prefix,
}

impl Optimize {
    /// Every aim, in the order of their names in help texts.
    pub const ALL: [Optimize; 3] = [Optimize::Size, Optimize::Balanced, Optimize::Prefix];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Optimize::Size => "size",
            Optimize::Balanced => "balanced",
            Optimize::Prefix => "prefix",
        }
    }
}

/// How a level is thinned out.
#[derive(Clone, Copy)]
struct Thinning {
    /// Share of the vertices, the most salient ones, that stay.
    protected: f64,
    /// Largest valence that goes.
    max_valence: u32,
    /// How much worse (squared distance) a hole may be closed to be cheaper to code.
    tolerance: f64,
}

impl Thinning {
    /// Most vertices come back in the finest levels: there the cost of coding counts, before that
    /// the shape.
    fn of(optimize: Optimize, is_fine: bool) -> Self {
        match (optimize, is_fine) {
            (Optimize::Size, _) => Self { protected: 0.0, max_valence: 6, tolerance: f64::INFINITY },
            (Optimize::Balanced, true) => Self { protected: 0.1, max_valence: 6, tolerance: 8.0 },
            (Optimize::Balanced, false) => Self { protected: 0.2, max_valence: 7, tolerance: 2.0 },
            (Optimize::Prefix, _) => Self { protected: 0.2, max_valence: 7, tolerance: 1.0 },
        }
    }
}

/// Levels with more than this share of all vertices are fine.
const FINE_SHARE: f64 = 0.5;

/// Removes one level of odd vertices. `vertices` are those of the level and `scores` their
/// descriptor values, in the same order.
#[expect(clippy::too_many_arguments, reason = "what a level is, and what is kept from one to the next")]
pub(crate) fn remove_level(
    partition: Partition,
    optimize: Optimize,
    surface: &mut ShrinkingSurface,
    geometry: Geometry,
    memory: &mut ErrorMemory,
    anchors: &Anchors,
    vertices: &[u32],
    scores: &[f64],
) -> LevelRecord {
    let is_fine = vertices.len() as f64 > FINE_SHARE * surface.surface.corner_of.len() as f64;
    let thinning = Thinning::of(optimize, is_fine);
    match partition {
        Partition::Algorithm1 => {
            let order = by_score(vertices, scores);
            remove_in_order(surface, geometry, &order, None, Some(memory))
        }
        Partition::Balanced => {
            let mut order = by_cost(surface, memory, vertices, scores, thinning);
            order.retain(|&v| !anchors.contain(v));
            let order = closely_packed(surface, &order);
            let mut trial = surface.clone();
            let chosen = remove_in_order(&mut trial, geometry, &order, Some(thinning.tolerance), None);
            drop(trial);
            remove_as_decoded(surface, geometry, &chosen, thinning.tolerance, memory, anchors)
        }
    }
}

/// Removes the vertices of `order` one after the other, unless a neighbour went before or no removal
/// is legal: as Algorithm 1 does without a `tolerance`, else with the holes of [`HoleFiller`].
/// `memory` is told.
pub(crate) fn remove_in_order(
    surface: &mut ShrinkingSurface,
    geometry: Geometry,
    order: &[u32],
    tolerance: Option<f64>,
    mut memory: Option<&mut ErrorMemory>,
) -> LevelRecord {
    let mut tagged: BitVec = BitVec::repeat(false, surface.surface.corner_of.len());
    let mut record = LevelRecord::default();
    let mut star = Star::default();
    let mut collapse = CollapseTest::default();
    let mut filler = HoleFiller::default();
    let Geometry { grid, positions } = geometry;
    for &vertex in order {
        if tagged[vertex as usize] {
            continue;
        }
        surface.read_star(vertex, &mut star);
        let ears = match tolerance {
            None => collapse.shortest_legal(surface, &star, grid, positions),
            Some(tolerance) => filler.fill(surface, &star, grid, positions, tolerance),
        };
        let Some(ears) = ears else { continue };
        if let Some(memory) = &mut memory {
            memory.hand_on(&star);
        }
        let faces = surface.remove(&star, ears);
        record.push(vertex, &star.ring, faces);
        star.ring.iter().for_each(|&v| tagged.set(v as usize, true));
    }
    record.shrink_to_fit();
    record
}

/// Removes the vertices that `chosen` took from a copy of the surface, in the reverse of the order in
/// which a decoder brings them back: the ears of the boundary last.
fn remove_as_decoded(
    surface: &mut ShrinkingSurface,
    geometry: Geometry,
    chosen: &LevelRecord,
    tolerance: f64,
    memory: &mut ErrorMemory,
    anchors: &Anchors,
) -> LevelRecord {
    let mut odd: BitVec = BitVec::repeat(false, surface.surface.corner_of.len());
    chosen.iter().for_each(|removed| odd.set(removed.vertex as usize, true));
    let order = patch_order(surface, &odd, anchors);
    let is_ear = |&corner: &u32| surface.surface.valence[surface.surface.vertex(corner) as usize] == 2;
    let (ears, patches): (Vec<u32>, Vec<u32>) = order.into_iter().rev().partition(is_ear);
    let mut record = LevelRecord::default();
    let mut star = Star::default();
    let mut filler = HoleFiller::default();
    for corner in patches.into_iter().chain(ears) {
        surface.read_star_from(corner, &mut star);
        let filled = filler.fill(surface, &star, geometry.grid, geometry.positions, tolerance);
        // What was legal in the other order need not be in this one.
        let Some(ears) = filled else { continue };
        memory.hand_on(&star);
        let faces = surface.remove(&star, ears);
        record.push(star.vertex, &star.ring, faces);
    }
    record.shrink_to_fit();
    record
}

/// Ascending score, ties by index: the order of Algorithm 1.
pub(crate) fn by_score(vertices: &[u32], scores: &[f64]) -> Vec<u32> {
    places_by_score(vertices, scores).into_iter().map(|i| vertices[i as usize]).collect()
}

/// The same as places in `vertices`.
fn places_by_score(vertices: &[u32], scores: &[f64]) -> Vec<u32> {
    let mut order: Vec<u32> = (0..vertices.len() as u32).collect();
    order.sort_by(|&a, &b| {
        let (a, b) = (a as usize, b as usize);
        // Adding 0 makes −0 equal to 0.
        (scores[a] + 0.0).total_cmp(&(scores[b] + 0.0)).then(vertices[a].cmp(&vertices[b]))
    });
    order
}

/// Low valence first, ties along a walk over the surface; the most salient vertices and those of
/// high valence are left out. Saliency is the error of the best collapse, between half and twice as
/// much by the rank of the descriptor.
fn by_cost(
    surface: &ShrinkingSurface,
    memory: &ErrorMemory,
    vertices: &[u32],
    scores: &[f64],
    thinning: Thinning,
) -> Vec<u32> {
    let mut free = vertices.to_vec();
    if thinning.protected > 0.0 {
        let saliency = saliency(surface, memory, vertices, scores);
        free = by_score(vertices, &saliency);
        free.truncate(((1.0 - thinning.protected) * free.len() as f64).ceil() as usize);
    }
    let walk = breadth_first(surface, vertices);
    let valence = |v: u32| surface.surface.valence[v as usize];
    free.retain(|&v| valence(v) <= thinning.max_valence);
    free.sort_unstable_by_key(|&v| (valence(v), walk[v as usize]));
    free
}

/// Those of `order` that go one after the other if each rules out its neighbours, the ones first
/// whose valence less some of the share of their neighbours that are next to a removed vertex
/// already is least, ties as in `order`.
fn closely_packed(surface: &ShrinkingSurface, order: &[u32]) -> Vec<u32> {
    /// What a ring counts, all of whose vertices are next to others, in units of valence.
    const WEIGHT: f64 = 0.7;
    const OUT: u32 = u32::MAX;
    let mut rank = vec![OUT; surface.surface.corner_of.len()];
    order.iter().zip(0..).for_each(|(&v, i)| rank[v as usize] = i);
    let mut touched: BitVec = BitVec::repeat(false, rank.len());
    let key = |star: &Star, touched: &BitVec| {
        let near = star.ring.iter().filter(|&&u| touched[u as usize]).count();
        let key = star.degree() as f64 - WEIGHT * near as f64 / star.degree() as f64;
        Reverse(((1000.0 * key) as i64, rank[star.vertex as usize]))
    };
    let mut star = Star::default();
    let mut queue = BinaryHeap::new();
    for &v in order {
        surface.read_star(v, &mut star);
        queue.push(key(&star, &touched));
    }
    let mut chosen = Vec::new();
    let (mut second, mut third) = (Star::default(), Star::default());
    while let Some(first) = queue.pop() {
        let v = order[first.0.1 as usize];
        surface.read_star(v, &mut star);
        if touched[v as usize] || key(&star, &touched) != first {
            continue;
        }
        chosen.push(v);
        let fresh: Vec<u32> = star.ring.iter().copied().filter(|&u| !touched[u as usize]).collect();
        fresh.iter().chain([&v]).for_each(|&u| touched.set(u as usize, true));
        for u in fresh {
            surface.read_star(u, &mut second);
            for &w in second.ring.iter().filter(|&&w| rank[w as usize] != OUT && !touched[w as usize]) {
                surface.read_star(w, &mut third);
                queue.push(key(&third, &touched));
            }
        }
    }
    chosen
}

/// Error of the best collapse of each vertex, weighed by the rank of its score.
fn saliency(surface: &ShrinkingSurface, memory: &ErrorMemory, vertices: &[u32], scores: &[f64]) -> Vec<f64> {
    const MIN_PARALLEL: usize = 2048;
    let mut weight = vec![0.0_f64; vertices.len()];
    for (rank, place) in places_by_score(vertices, scores).into_iter().enumerate() {
        weight[place as usize] = (2.0 * rank as f64 / vertices.len() as f64 - 1.0).exp2();
    }
    let weighed = |star: &mut Star, (&v, weight): (&u32, f64)| {
        surface.read_star(v, star);
        weight * memory.least_error(star).0
    };
    let pairs = vertices.par_iter().zip(weight).with_min_len(MIN_PARALLEL);
    pairs.map_init(Star::default, weighed).collect()
}

/// Position of each vertex in a breadth-first walk.
fn breadth_first(surface: &ShrinkingSurface, vertices: &[u32]) -> Vec<u32> {
    let mut place = vec![u32::MAX; surface.surface.corner_of.len()];
    let mut queue = VecDeque::new();
    let mut star = Star::default();
    let mut count = 0;
    let mut visit = |v: u32, queue: &mut VecDeque<u32>| {
        if place[v as usize] == u32::MAX {
            place[v as usize] = count;
            count += 1;
            queue.push_back(v);
        }
    };
    for &seed in vertices {
        visit(seed, &mut queue);
        while let Some(v) = queue.pop_front() {
            surface.read_star(v, &mut star);
            star.ring.iter().for_each(|&u| visit(u, &mut queue));
        }
    }
    place
}
