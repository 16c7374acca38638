//! Odd and even: which vertices of a level are removed (Algorithm 1 of the paper), given one score
//! per vertex.

use crate::simplify::collapse::CollapseTest;
use crate::simplify::triangulate::EarClipper;
use crate::simplify::{LevelRecord, ShrinkingSurface, Star};
use bitvec::vec::BitVec;
use std::collections::VecDeque;

/// How a level is split into odd and even vertices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Partition {
    /// The descriptor decides which vertices stay, the cost of coding which of the others go first,
    /// and holes are triangulated so that they are cheap to code. The default.
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

/// Share of the vertices, the most salient ones, that `Balanced` keeps at every level.
const PROTECTED_SHARE: f64 = 0.05;
/// Classes of saliency among the rest.
const SALIENCY_CLASSES: f64 = 4.0;
/// Valences that a class of saliency is worth.
const CLASS_WEIGHT: f64 = 0.0;
/// Largest valence that `Balanced` removes.
const MAX_VALENCE: u32 = 6;

/// Removes one level of odd vertices. `vertices` are those of the level and `scores` their
/// descriptor values, in the same order.
pub(crate) fn remove_level(
    partition: Partition,
    surface: &mut ShrinkingSurface,
    geometry: Geometry,
    vertices: &[u32],
    scores: &[f64],
) -> LevelRecord {
    let order = removal_order(partition, surface, vertices, scores);
    remove_in_order(partition, surface, geometry, &order)
}

/// The vertices that may be removed, in the order in which that is tried.
pub(crate) fn removal_order(
    partition: Partition,
    surface: &ShrinkingSurface,
    vertices: &[u32],
    scores: &[f64],
) -> Vec<u32> {
    match partition {
        Partition::Algorithm1 => by_score(vertices, scores),
        Partition::Balanced => by_cost(surface, vertices, scores),
    }
}

/// Removes the vertices of `order` one after the other, unless a neighbour went before or no removal
/// is legal.
pub(crate) fn remove_in_order(
    partition: Partition,
    surface: &mut ShrinkingSurface,
    geometry: Geometry,
    order: &[u32],
) -> LevelRecord {
    let mut tagged: BitVec = BitVec::repeat(false, surface.surface.corner_of.len());
    let mut record = LevelRecord::default();
    let mut star = Star::default();
    let mut collapse = CollapseTest::default();
    let mut clipper = EarClipper::default();
    for &vertex in order {
        if tagged[vertex as usize] {
            continue;
        }
        surface.read_star(vertex, &mut star);
        let clipped = match partition {
            Partition::Algorithm1 => None,
            Partition::Balanced => clipper.clip(surface, &star, geometry.grid),
        };
        let ears =
            clipped.or_else(|| collapse.shortest_legal(surface, &star, geometry.grid, geometry.positions));
        let Some(ears) = ears else { continue };
        let faces = surface.remove(&star, ears);
        record.push(vertex, &star.ring, faces);
        star.ring.iter().for_each(|&v| tagged.set(v as usize, true));
    }
    record.shrink_to_fit();
    record
}

/// Ascending score, ties by index.
fn by_score(vertices: &[u32], scores: &[f64]) -> Vec<u32> {
    let mut order: Vec<usize> = (0..vertices.len()).collect();
    // Adding 0 makes −0 equal to 0.
    order.sort_by(|&a, &b| {
        (scores[a] + 0.0).total_cmp(&(scores[b] + 0.0)).then(vertices[a].cmp(&vertices[b]))
    });
    order.into_iter().map(|i| vertices[i]).collect()
}

/// Low valence and low saliency first, ties along a walk over the surface; the most salient
/// vertices and those of high valence are left out.
fn by_cost(surface: &ShrinkingSurface, vertices: &[u32], scores: &[f64]) -> Vec<u32> {
    let ranked = by_score(vertices, scores);
    let walk = breadth_first(surface, vertices);
    let free = ((1.0 - PROTECTED_SHARE) * ranked.len() as f64).ceil();
    let mut keyed: Vec<(u32, u32, u32)> = ranked
        .iter()
        .enumerate()
        .take(free as usize)
        .filter_map(|(rank, &v)| {
            let valence = surface.surface.valence[v as usize];
            let class = (rank as f64 / free * SALIENCY_CLASSES).floor();
            let cost = 4.0 * (f64::from(valence) + CLASS_WEIGHT * class);
            (valence <= MAX_VALENCE).then_some((cost as u32, walk[v as usize], v))
        })
        .collect();
    keyed.sort_unstable();
    keyed.into_iter().map(|(_, _, v)| v).collect()
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
