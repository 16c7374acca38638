//! The known positions around a vertex that is coded now (`format/SPEC.md`, section 8.1).

use super::GridMesh;
use super::base_traversal::BaseTraversal;
use super::patch::Patches;
use crate::mesh::surface::{NO_CORNER, next, prev};
use crate::prediction::ring_context::{Neighbourhood, Outlook, PartOfRing};
use crate::util::simd4::Lanes;

/// Classes of vertices that have filters each: by valence from 3 to 8 and more, and open rings.
pub(crate) const NUM_CLASSES: usize = 7;
const OPEN_CLASS: usize = 6;
/// Longest ring that a refinement looks at; the rest of a larger one is left out.
const MAX_REFINED_RING: usize = 32;

/// The neighbourhood of one vertex, and how large its neighbours' residuals were.
#[derive(Default)]
pub(crate) struct CodingContext {
    pub(crate) neighbourhood: Neighbourhood,
    /// Cell of the first neighbour; points are relative to it.
    pub(crate) origin: [i32; 3],
    /// Which of the [`NUM_CLASSES`] classes the vertex is in.
    pub(crate) class: usize,
    corners: Vec<u32>,
    /// Base-2 logarithms of residual over edge length: mean of the ring along and across the
    /// surface; mean of the outer vertices of this level (when refining, of the vertex itself), too.
    pub(crate) roughness: Lanes,
}

/// The vertex across a ring edge.
enum Tip {
    /// The edge lies on the boundary.
    None,
    /// The true third vertex of the triangle outside.
    Fine(u32),
    /// That vertex is not known yet; this is the one that stood there in the coarse mesh.
    Coarse(u32),
}

/// What is known about a base mesh while its vertices are placed.
pub(crate) struct Fringe {
    /// For each placed vertex its displacement from the mean of its outlook.
    pub(crate) misses: Vec<Lanes>,
    /// Mean length of edges.
    pub(crate) edge: f32,
}

impl CodingContext {
    /// Looks around the vertex that `patch` brought back, the next one without a position.
    pub(crate) fn gather_odd(&mut self, mesh: &GridMesh, patches: &Patches, patch: usize) {
        let vertex = mesh.positions.len();
        let first_odd = vertex - patch;
        let coarse_tips = patches.coarse_tips(patch);
        let mut edge = patches.first_edge(patch);
        let mut tips = RoughnessMean::default();
        let ring = self.gather(
            mesh,
            vertex,
            usize::MAX,
            |_| 0.0,
            |tip| {
                let coarse =
                    coarse_tips[if edge < coarse_tips.len() { edge } else { edge - coarse_tips.len() }];
                edge += 1;
                if tip == NO_CORNER {
                    Tip::None
                } else if (tip as usize) < vertex {
                    if tip as usize >= first_odd {
                        tips.add(mesh, tip);
                    }
                    Tip::Fine(tip)
                } else if coarse == NO_CORNER {
                    Tip::None
                } else {
                    Tip::Coarse(coarse)
                }
            },
        );
        let tips = tips.mean().unwrap_or(ring);
        self.roughness = Lanes([ring[0], ring[1], tips[0], tips[1]]);
    }

    /// Looks around a vertex of a base mesh that has no position, at those that have one. `None` if it has no neighbour
    /// among them.
    pub(super) fn gather_placed(
        &mut self,
        mesh: &GridMesh,
        vertex: u32,
        order: &BaseTraversal,
        fringe: &Fringe,
    ) -> Option<Outlook> {
        let surface = &mesh.surface;
        let is_placed = |v: u32| order.is_placed(v);
        let is_whole = surface.fan(surface.corner_of[vertex as usize], &mut self.corners);
        let around = &mut self.neighbourhood;
        around.clear();
        around.is_closed = false;
        let mut part = PartOfRing { edge: fringe.edge, ..PartOfRing::default() };
        let (mut ring, mut tips) = (RoughnessMean::default(), RoughnessMean::default());
        let last = self.corners.last().filter(|_| !is_whole).map(|&c| surface.vertex(prev(c)));
        let all = self.corners.iter().map(|&c| surface.vertex(next(c))).chain(last);
        let mut placed = all.filter(|&v| is_placed(v)).peekable();
        self.origin = mesh.positions[*placed.peek()? as usize];
        let point = |v: u32| Lanes::between(self.origin, mesh.positions[v as usize]);
        for v in placed {
            around.ring.push(point(v));
            part.misses += fringe.misses[v as usize];
            ring.add(mesh, v);
        }
        let mut oldest = u32::MAX;
        for &corner in &self.corners {
            let (a, b, across) =
                (surface.vertex(next(corner)), surface.vertex(prev(corner)), surface.across(corner));
            if across == NO_CORNER || !(is_placed(a) && is_placed(b) && is_placed(surface.vertex(across))) {
                continue;
            }
            let tip = surface.vertex(across);
            let [pa, pb, pt] = [a, b, tip].map(point);
            let parallelogram = (pa + pb) - pt;
            around.parallelograms.push(parallelogram);
            part.normal += (pa - pb).cross(pt - pb);
            tips.add(mesh, tip);
            if a.max(b) < oldest {
                oldest = a.max(b);
                part.oldest = parallelogram;
            }
        }
        self.class = match (around.parallelograms.len(), around.ring.len()) {
            (0, 1) => NUM_CLASSES - 1,
            (count, _) => count.min(NUM_CLASSES - 2),
        };
        let ring = ring.mean().unwrap_or_default();
        let tips = tips.mean().unwrap_or(ring);
        self.roughness = Lanes([ring[0], ring[1], tips[0], tips[1]]);
        Some(around.outlook_of_part(&part))
    }

    /// Looks around `vertex` while vertices before it are refined already and the others are not:
    /// those count as lying in the middle of their two cells.
    pub(crate) fn gather_refined(&mut self, mesh: &GridMesh, vertex: usize) {
        let middle = |v: u32| if (v as usize) < vertex { 0.0 } else { 0.5 };
        let ring = self.gather(mesh, vertex, MAX_REFINED_RING, middle, |tip| {
            if tip == NO_CORNER { Tip::None } else { Tip::Fine(tip) }
        });
        let own = mesh.roughness[vertex].map(|r| f32::from(r) / 8.0);
        self.roughness = Lanes([ring[0], ring[1], own[0], own[1]]);
    }

    /// Collects the points around `vertex`, `shift` added to each of a vertex's coordinates, and
    /// returns the roughness of the ring. `tip_of` is asked ring edge by ring edge, with the vertex
    /// outside or `NO_CORNER`.
    #[inline(always)]
    fn gather(
        &mut self,
        mesh: &GridMesh,
        vertex: usize,
        most: usize,
        shift: impl Fn(u32) -> f32,
        mut tip_of: impl FnMut(u32) -> Tip,
    ) -> [f32; 2] {
        let surface = &mesh.surface;
        let mut closed = surface.fan(surface.corner_of[vertex], &mut self.corners);
        if self.corners.len() > most {
            self.corners.truncate(most);
            closed = false;
        }
        let around = &mut self.neighbourhood;
        around.clear();
        around.is_closed = closed;
        let mut roughness = RoughnessMean::default();
        let origin = match self.corners.first() {
            Some(&c) => mesh.positions[surface.vertex(next(c)) as usize],
            None => [0; 3],
        };
        self.origin = origin;
        let point = |v: u32| Lanes::between(origin, mesh.positions[v as usize]) + Lanes::splat(shift(v));
        for &corner in &self.corners {
            let v = surface.vertex(next(corner));
            around.ring.push(point(v));
            roughness.add(mesh, v);
        }
        if !closed && let Some(&last) = self.corners.last() {
            let v = surface.vertex(prev(last));
            around.ring.push(point(v));
            roughness.add(mesh, v);
        }
        for (i, &corner) in self.corners.iter().enumerate() {
            let across = surface.across(corner);
            let outside = if across == NO_CORNER { NO_CORNER } else { surface.vertex(across) };
            let over = |tip: u32| {
                let after = around.ring.get(i + 1).unwrap_or(&around.ring[0]);
                (around.ring[i] + *after) - point(tip)
            };
            match tip_of(outside) {
                Tip::None => {}
                Tip::Fine(tip) => {
                    let parallelogram = over(tip);
                    around.parallelograms.push(parallelogram);
                }
                Tip::Coarse(tip) => around.coarse = (around.coarse.0 + over(tip), around.coarse.1 + 1),
            }
        }
        self.class = if closed { around.ring.len().clamp(3, 8) - 3 } else { OPEN_CLASS };
        roughness.mean().unwrap_or_default()
    }
}

#[derive(Default)]
struct RoughnessMean {
    sum: [i32; 2],
    count: i32,
}

impl RoughnessMean {
    fn add(&mut self, mesh: &GridMesh, vertex: u32) {
        let [along, across] = mesh.roughness[vertex as usize];
        self.sum[0] += i32::from(along);
        self.sum[1] += i32::from(across);
        self.count += 1;
    }

    fn mean(&self) -> Option<[f32; 2]> {
        (self.count > 0).then(|| self.sum.map(|s| s as f32 / (8 * self.count) as f32))
    }
}
