//! The known positions around a vertex that is coded now (`format/SPEC.md`, section 8.1).

use super::GridMesh;
use super::patch::Patches;
use crate::lifting::neighbourhood::{Neighbourhood, Tip};
use crate::lifting::vec3::from_grid;
use crate::mesh::surface::{NO_CORNER, next, prev};

/// Classes of vertices that have filters each: by valence from 3 to 8 and more, and open rings.
pub(crate) const NUM_CLASSES: usize = 7;
const OPEN_CLASS: usize = 6;
/// Longest ring that a refinement looks at; the rest of a larger one is left out.
const MAX_REFINED_RING: usize = 32;

/// The neighbourhood of one vertex, and how large its neighbours' residuals were.
#[derive(Default)]
pub(crate) struct Surroundings {
    pub(crate) neighbourhood: Neighbourhood,
    corners: Vec<u32>,
    /// Mean base-2 logarithm of residual over edge length in the ring: along and across the surface.
    pub(crate) ring_roughness: [f64; 2],
    /// The same over the outer vertices of this level; when refining, of the vertex itself.
    pub(crate) tip_roughness: [f64; 2],
}

impl Surroundings {
    pub(crate) fn class(&self) -> usize {
        if self.neighbourhood.is_closed() {
            self.neighbourhood.ring.len().clamp(3, 8) - 3
        } else {
            OPEN_CLASS
        }
    }

    /// Looks around the vertex that `patch` brought back, the next one without a position.
    pub(crate) fn gather_odd(&mut self, mesh: &GridMesh, patches: &Patches, patch: usize) {
        let vertex = mesh.positions.len();
        let first_odd = vertex - patch;
        let coarse_tips = patches.coarse_tips(patch);
        let first_edge = patches.first_edge(patch);
        let at = |v: u32| from_grid(mesh.positions[v as usize]);
        let mut tips = RoughnessMean::default();
        self.gather(mesh, vertex, usize::MAX, at, |i, tip| {
            if (tip as usize) < vertex {
                if tip as usize >= first_odd {
                    tips.add(mesh, tip);
                }
                return Tip::Fine(at(tip));
            }
            match coarse_tips[(first_edge + i) % coarse_tips.len()] {
                NO_CORNER => Tip::None,
                coarse => Tip::Coarse(at(coarse)),
            }
        });
        self.tip_roughness = tips.mean().unwrap_or(self.ring_roughness);
    }

    /// Looks around `vertex` while vertices before it are refined already and the others are not:
    /// those count as lying in the middle of their two cells.
    pub(crate) fn gather_refined(&mut self, mesh: &GridMesh, vertex: usize) {
        let at = |v: u32| {
            let p = from_grid(mesh.positions[v as usize]);
            if (v as usize) < vertex { p } else { p.map(|c| c + 0.5) }
        };
        self.gather(mesh, vertex, MAX_REFINED_RING, at, |_, tip| Tip::Fine(at(tip)));
        self.tip_roughness = mesh.roughness[vertex].map(|r| f64::from(r) / 8.0);
    }

    fn gather(
        &mut self,
        mesh: &GridMesh,
        vertex: usize,
        most: usize,
        at: impl Fn(u32) -> [f64; 3],
        mut tip_at: impl FnMut(usize, u32) -> Tip,
    ) {
        let surface = &mesh.surface;
        let mut closed = surface.fan(surface.corner_of[vertex], &mut self.corners);
        if self.corners.len() > most {
            self.corners.truncate(most);
            closed = false;
        }
        self.neighbourhood.clear();
        let mut ring = RoughnessMean::default();
        for (i, &corner) in self.corners.iter().enumerate() {
            let v = surface.vertex(next(corner));
            self.neighbourhood.ring.push(at(v));
            ring.add(mesh, v);
            let across = surface.across(corner);
            let tip = if across == NO_CORNER { Tip::None } else { tip_at(i, surface.vertex(across)) };
            self.neighbourhood.tips.push(tip);
        }
        if !closed && let Some(&last) = self.corners.last() {
            let v = surface.vertex(prev(last));
            self.neighbourhood.ring.push(at(v));
            ring.add(mesh, v);
        }
        self.ring_roughness = ring.mean().unwrap_or_default();
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

    fn mean(&self) -> Option<[f64; 2]> {
        (self.count > 0).then(|| self.sum.map(|s| f64::from(s) / (8.0 * f64::from(self.count))))
    }
}
