//! Odd and even: which vertices of a level are removed (Algorithm 1 of the paper), given one score
//! per vertex.

use super::bucket_queue::{ClassQueue, PackingClasses};
use super::canonical::{Anchors, patch_order};
use super::collapse::CollapseTest;
use super::collapse_cost::{CollapseCosts, Evaluator};
use super::level::Level;
use super::quadrics::ErrorMemory;
use super::retriangulate::HoleFiller;
use super::seams::{Demand, may_go};
use super::vertex_selection::{Optimize, Saliency, Thinning, score_keys};
use super::{LevelRecord, Rings, Seams, Star, SurfaceEditor};
use bitvec::vec::BitVec;
use rayon::prelude::*;

/// How a level is split into odd and even vertices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Partition {
    /// The error against the original surface, weighed by the descriptor, decides which vertices
    /// stay, the cost of coding which of the others go first; holes are closed by what lies close to
    /// the surface and is cheap to code ([`Optimize`] weighs the two). The default.
    #[default]
    WeightedError,
    /// Algorithm 1 to the letter: ascending descriptor, half-edge collapse along the shortest legal
    /// edge.
    Algorithm1,
}

impl Partition {
    /// Every partition, in the order of their names in help texts.
    pub const ALL: [Partition; 2] = [Partition::WeightedError, Partition::Algorithm1];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Partition::WeightedError => "weighted-error",
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

/// Removes levels of a surface: what is kept from one level to the next.
pub(crate) struct Remover<'a, 'b> {
    pub(crate) surface: &'a mut SurfaceEditor,
    pub(crate) geometry: Geometry<'a>,
    pub(crate) memory: &'a mut ErrorMemory<'b>,
    pub(crate) anchors: &'a Anchors,
    pub(crate) seams: &'a mut Seams,
}

impl Remover<'_, '_> {
    /// Removes the odd vertices of `level`. `ranked` says in which order, or which of them, go. `max_valence`: the largest
    /// valence of an odd vertex, if not the usual one.
    pub(crate) fn remove(
        &mut self,
        level: &Level,
        ranked: Ranked,
        optimize: Optimize,
        max_valence: Option<u32>,
    ) -> LevelRecord {
        match ranked {
            Ranked::ByScore(scores) => {
                let mut order = by_score(&level.vertices, &scores);
                order.retain(|&v| !self.anchors.is_stitched(v));
                remove_in_order(self.surface, self.geometry, &order, Some(self.memory), self.seams)
            }
            Ranked::BySaliency { saliency, rings } => {
                let mut thinning = Thinning::of_level(optimize, level.vertices.len(), self.surface);
                thinning.max_valence = max_valence.unwrap_or(thinning.max_valence);
                let chosen = self.choose(&level.vertices, (saliency, rings), optimize, thinning);
                self.remove_as_decoded(&level.faces, chosen, thinning.tolerance)
            }
        }
    }

    /// Chooses the odd vertices of a level, none next to another, and forgets the neighbours of its vertices.
    fn choose(
        &mut self,
        vertices: &[u32],
        (saliency, rings): (Saliency, Rings),
        optimize: Optimize,
        thinning: Thinning,
    ) -> Vec<u32> {
        let mut free = saliency.least();
        free.retain(|&place| {
            let is_anchor = self.anchors.contain(vertices[place as usize]);
            rings.valence(place) <= thinning.max_valence as usize && !is_anchor
        });
        leave_seams(optimize, self.surface, self.seams, vertices, &mut free);
        let ((), chosen) = rayon::join(
            || self.surface.forget(vertices, |place| rings.of(place)),
            || closely_packed(&rings, &free),
        );
        chosen.into_iter().map(|place| vertices[place as usize]).collect()
    }

    /// Removes the vertices of `chosen`, none next to another, in the reverse of the order in which a decoder
    /// restores them: the ears of the boundary last. Those that cannot go stay, which costs some bits where
    /// the order then differs.
    fn remove_as_decoded(&mut self, faces: &[u32], mut chosen: Vec<u32>, tolerance: f64) -> LevelRecord {
        let Self { surface, geometry, memory, anchors, seams } = self;
        let Geometry { grid, positions } = *geometry;
        let sees_fans = tolerance < f64::INFINITY && seams.is_empty();
        let evaluator = Evaluator { surface, grid, positions, memory, sees_fans };
        let mut odd: BitVec = BitVec::repeat(false, surface.surface.corner_of.len());
        chosen.iter().for_each(|&v| odd.set(v as usize, true));
        chosen.sort_unstable();
        let (order, outlook) = rayon::join(
            || patch_order(surface, faces, &odd, anchors),
            || CollapseCosts::new(evaluator, &chosen),
        );
        let is_ear = |&corner: &u32| surface.surface.valence[surface.surface.vertex(corner) as usize] == 2;
        let (ears, patches): (Vec<u32>, Vec<u32>) = order.into_iter().rev().partition(is_ear);
        let mut record = LevelRecord::default();
        let mut star = Star::default();
        let mut filler = HoleFiller::default();
        for corner in patches.into_iter().chain(ears) {
            let ahead = outlook.read(surface.surface.vertex(corner), corner, &mut star);
            let demand = demand_that_is_met(seams, surface, *geometry, &star, tolerance, &mut filler);
            let filled = match demand {
                Demand::Stay => continue,
                Demand::None => {
                    filler.fill_as_foreseen(surface, &star, grid, positions, tolerance, ahead.prospect)
                }
                _ => filler.fill(surface, &star, grid, positions, tolerance, demand),
            };
            let Some(ears) = filled else { continue };
            match ahead.heir {
                Some(heir) => memory.hand_on_to(star.vertex, heir),
                None => memory.hand_on(&star),
            }
            let faces = surface.remove(&star, ears);
            record.push(star.vertex, &star.ring, faces);
            seams.remove(&star, ears, &mut record);
        }
        record.shrink_to_fit();
        record
    }
}

/// What a partition goes by.
pub(crate) enum Ranked {
    /// Algorithm 1: the descriptor, of each vertex.
    ByScore(Vec<f64>),
    /// The partition by weighted error.
    BySaliency { saliency: Saliency, rings: Rings },
}

/// Removes the vertices of `order` one after the other, unless a neighbour went before or no collapse is
/// legal, as Algorithm 1 does. `memory` is told.
pub(crate) fn remove_in_order(
    surface: &mut SurfaceEditor,
    geometry: Geometry,
    order: &[u32],
    mut memory: Option<&mut ErrorMemory>,
    seams: &mut Seams,
) -> LevelRecord {
    let mut tagged: BitVec = BitVec::repeat(false, surface.surface.corner_of.len());
    let mut record = LevelRecord::default();
    let mut star = Star::default();
    let mut collapse = CollapseTest::default();
    for &vertex in order {
        if tagged[vertex as usize] {
            continue;
        }
        surface.read_star(vertex, &mut star);
        let Some(ears) = collapse.shortest_legal(surface, &star, geometry.grid, geometry.positions) else {
            continue;
        };
        if let Some(memory) = &mut memory {
            memory.hand_on(&star);
        }
        let faces = surface.remove(&star, ears);
        record.push(vertex, &star.ring, faces);
        seams.remove(&star, ears, &mut record);
        star.ring.iter().for_each(|&v| tagged.set(v as usize, true));
    }
    record.shrink_to_fit();
    record
}

/// What the seams want of the hole of a star, as far as there is a hole that meets it.
fn demand_that_is_met(
    seams: &Seams,
    surface: &SurfaceEditor,
    Geometry { grid, positions }: Geometry,
    star: &Star,
    tolerance: f64,
    filler: &mut HoleFiller,
) -> Demand {
    let mut demand = seams.demand(star);
    if demand != Demand::None {
        let mut is_met = |d| filler.fill(surface, star, grid, positions, tolerance, d).is_some();
        if matches!(demand, Demand::Diagonal(_)) && !is_met(demand) {
            demand = seams.demand_less(star);
        }
        if !seams.hold() && !is_met(demand) {
            demand = Demand::None;
        }
    }
    demand
}

/// Ascending score, ties by index: the order of Algorithm 1.
pub(crate) fn by_score(vertices: &[u32], scores: &[f64]) -> Vec<u32> {
    places_by_score(vertices, scores).into_iter().map(|i| vertices[i as usize]).collect()
}

/// The same as places in `vertices`, which ascend.
fn places_by_score(vertices: &[u32], scores: &[f64]) -> Vec<u32> {
    debug_assert!(vertices.is_sorted());
    let mut keys = score_keys(scores);
    keys.par_sort_unstable();
    keys.into_iter().map(|(_, place)| place).collect()
}

/// Whether so few vertices are left that they may as well be the base, if seams want them. The smallest file is the one
/// whose seams are kept, unless there are only seams from the start.
pub(crate) fn is_coarse(optimize: Optimize, num_vertices: usize, surface: &SurfaceEditor) -> bool {
    let num_finest = surface.surface.corner_of.len();
    let share = if optimize == Optimize::Size { 0.999 } else { 1.0 / 32.0 };
    num_vertices as f64 <= share * num_finest as f64
}

/// Keeps the vertices where seams end or meet, as long as there are others, or the level is coarse: where seams are
/// everywhere they are no reason to stay.
fn leave_seams(
    optimize: Optimize,
    surface: &SurfaceEditor,
    seams: &mut Seams,
    vertices: &[u32],
    free: &mut Vec<u32>,
) {
    /// Share of the vertices that could go otherwise.
    const LEAST_FREE: f64 = 0.125;
    if !seams.hold() {
        return;
    }
    let mut star = Star::default();
    let mut may_go = |&place: &u32| may_go(seams, surface, vertices[place as usize], &mut star);
    let kept: Vec<u32> = free.iter().copied().filter(|place| may_go(place)).collect();
    if is_coarse(optimize, vertices.len(), surface) || kept.len() as f64 >= LEAST_FREE * free.len() as f64 {
        *free = kept;
    } else {
        seams.loosen();
        leave_seams(optimize, surface, seams, vertices, free);
    }
}

/// Chooses vertices of `free` greedily, no two of them neighbours. First goes the one with the least valence, less a
/// share for the neighbours that already touch a chosen vertex; ties by index.
fn closely_packed(rings: &Rings, free: &[u32]) -> Vec<u32> {
    let largest = free.iter().map(|&v| rings.valence(v)).max().unwrap_or(0);
    debug_assert!(largest < usize::from(Packing::CHANGED));
    let classes = PackingClasses::new(largest);
    // For each free vertex, how many of its neighbours are next to a removed vertex.
    let mut states = vec![Packing::STAYS; rings.len()];
    let class = |v: u32, Packing(touched): Packing| classes.of(rings.valence(v), usize::from(touched));
    let mut queue = ClassQueue::new(classes.count, rings.len());
    for &v in free {
        states[v as usize] = Packing::default();
        queue.insert(class(v, Packing::default()), v);
    }
    let mut chosen = Vec::new();
    let (mut fresh, mut changed) = (Vec::new(), Vec::new());
    while let Some(v) = queue.pop() {
        chosen.push(v);
        states[v as usize] = Packing::TOUCHED;
        for &u in rings.of(v) {
            let state = std::mem::replace(&mut states[u as usize], Packing::TOUCHED);
            if state.is_free() {
                queue.remove(class(u, state), u);
            }
            if state != Packing::TOUCHED {
                fresh.push(u);
            }
        }
        for &w in fresh.iter().flat_map(|&u| rings.of(u)) {
            let state = &mut states[w as usize];
            if state.is_free() {
                if state.0 & Packing::CHANGED == 0 {
                    changed.push((w, *state));
                    state.0 |= Packing::CHANGED;
                }
                state.0 += 1;
            }
        }
        fresh.clear();
        for (w, before) in changed.drain(..) {
            let state = &mut states[w as usize];
            state.0 &= !Packing::CHANGED;
            queue.remove(class(w, before), w);
            queue.insert(class(w, *state), w);
        }
    }
    chosen
}

/// What is known about a vertex while others are chosen: if it is free, the number of neighbours that are
/// next to a removed vertex.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
struct Packing(u8);

impl Packing {
    /// It is not free.
    const STAYS: Self = Self(u8::MAX);
    /// It is removed or next to a removed vertex.
    const TOUCHED: Self = Self(u8::MAX - 1);
    /// Added to the number until the queue knows of it. The number is at most the valence of a free vertex, which stays
    /// below this bit: see `Thinning::max_valence`.
    const CHANGED: u8 = 1 << 6;

    fn is_free(self) -> bool {
        self.0 < Self::TOUCHED.0
    }
}
