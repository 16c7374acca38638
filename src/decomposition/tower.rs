//! The connectivity of all levels, vertices numbered coarse before fine.

use super::Options;
use super::edit::EditError;
use crate::decoder::{Decoder, PassKind};
use crate::descriptors;
use crate::encoder::quantise::quantise;
use crate::levels::Level;
use crate::limits::Limits;
use crate::mesh::Surface;
use crate::mesh::repair::{Repaired, repair};
use crate::partition::{Geometry, Optimize, remove_level};
use crate::simplify::ShrinkingSurface;
use crate::simplify::canonical::Anchors;
use crate::simplify::memory::ErrorMemory;
use crate::{EncodeError, TriMesh};

/// Bits of the grid on which the sides of faces are compared.
const LEGALITY_BITS: u32 = 30;
/// Without a wish for levels, the base has at most this many vertices if it can.
const SMALL_BASE: usize = 40;
/// Without a wish, a level that removes a smaller share is the last.
const LEAST_SHARE: f64 = 0.02;
/// Most levels, whatever the wish.
const MAX_LEVELS: usize = 128;

/// Triangles of M^0 … M^L. M^k has the vertices below its number.
#[derive(Clone, Debug, Default)]
pub(super) struct Tower {
    levels: Vec<(usize, Vec<[u32; 3]>)>,
}

/// A mesh and its levels.
pub(super) struct MeshTower {
    pub(super) tower: Tower,
    /// The vertex of the mesh for each of the tower.
    pub(super) source: Vec<u32>,
    /// A power of two that brings the mesh near the size 1.
    pub(super) unit: f64,
}

/// A stream down to a level.
pub(super) struct StreamTower {
    pub(super) tower: Tower,
    /// The coarse mesh as a decoder of that level gives it, and the finest mesh.
    pub(super) coarse: TriMesh,
    pub(super) fine: TriMesh,
}

impl Tower {
    pub(super) fn num_levels(&self) -> usize {
        self.levels.len().saturating_sub(1)
    }

    pub(super) fn num_vertices(&self, level: usize) -> usize {
        self.levels[level].0
    }

    pub(super) fn triangles(&self, level: usize) -> &[[u32; 3]] {
        &self.levels[level].1
    }

    /// Takes vertices out of `mesh` level by level.
    pub(super) fn of_mesh(mesh: &TriMesh, options: &Options) -> Result<MeshTower, EncodeError> {
        let Repaired { surface, source, .. } = repair(mesh);
        if surface.triangles.is_empty() {
            return Err(EncodeError::NoTriangles);
        }
        let model = quantise(mesh, &source, LEGALITY_BITS)?;
        let mean_edge = descriptors::mean_edge_length(mesh) * model.unit;
        let geometry = Geometry { grid: &model.cells, positions: &model.positions };
        let num_vertices = surface.corner_of.len();
        let mut memory = ErrorMemory::new(&surface, &model.positions);
        let anchors = Anchors::new(&surface);
        let mut shrinking = ShrinkingSurface::new(surface);
        let mut window = options.window;
        // Finest first, in the numbering of the surface.
        let mut levels = vec![Level::collect(&shrinking)];
        let wants_more = |done: usize, vertices: usize| match options.levels {
            Some(levels) => done < (levels as usize).min(MAX_LEVELS),
            None => done < MAX_LEVELS && vertices > SMALL_BASE,
        };
        while let Some(level) = levels.last_mut().filter(|level| !level.vertices.is_empty()) {
            let before = level.vertices.len();
            if !wants_more(levels.len() - 1, before) {
                break;
            }
            let Some(level) = levels.last_mut() else { break };
            let scores = level.with_mesh(&model.positions, |mesh| {
                descriptors::evaluate(options.descriptor, mesh, &window, mean_edge)
            });
            let record = remove_level(
                options.partition,
                Optimize::default(),
                &mut shrinking,
                geometry,
                &mut memory,
                &anchors,
                &level.vertices,
                &scores,
            );
            if record.len() == 0 {
                break;
            }
            levels.push(Level::collect(&shrinking));
            window.radius *= options.growth;
            if options.levels.is_none() && (record.len() as f64) < LEAST_SHARE * before as f64 {
                break;
            }
        }

        // The coarsest level that a vertex is part of, then its index.
        let mut coarsest = vec![0_u32; num_vertices];
        for (depth, level) in levels.iter().enumerate() {
            level.vertices.iter().for_each(|&v| coarsest[v as usize] = depth as u32);
        }
        let mut order: Vec<u32> = (0..num_vertices as u32).collect();
        order.sort_by_key(|&v| (std::cmp::Reverse(coarsest[v as usize]), v));
        let mut place = vec![0_u32; num_vertices];
        order.iter().zip(0..).for_each(|(&v, i)| place[v as usize] = i);
        let named = levels.iter().rev().map(|level| {
            let name = |i: u32| place[level.vertices[i as usize] as usize];
            (level.vertices.len(), level.triangles.iter().map(|t| t.map(name)).collect())
        });
        Ok(MeshTower {
            tower: Self { levels: named.collect() },
            source: order.iter().map(|&v| source[v as usize]).collect(),
            unit: model.unit,
        })
    }

    /// The levels of a stream from `num_vertices` vertices on.
    ///
    /// # Errors
    /// If the stream is damaged, incomplete or beyond the limits, or no level has as many vertices.
    pub(super) fn of_stream(
        bytes: &[u8],
        num_vertices: usize,
        limits: Limits,
    ) -> Result<StreamTower, EditError> {
        let mut decoder = Decoder::new(limits);
        decoder.feed(bytes)?;
        let mut tower = Self::default();
        let mut coarse = None;
        let mut counts = Vec::new();
        while let Some(update) = decoder.step()? {
            let Some(mesh) = decoder.mesh() else { continue };
            if update.pass.kind != PassKind::Refine {
                counts.push(mesh.num_vertices());
                if mesh.num_vertices() >= num_vertices {
                    tower.levels.push((mesh.num_vertices(), mesh.triangles().to_vec()));
                }
            }
            if mesh.num_vertices() == num_vertices {
                coarse = Some(mesh.to_tri_mesh());
            }
        }
        if !decoder.is_complete() {
            return Err(EditError::Incomplete);
        }
        let fine = decoder.mesh().ok_or(EditError::Incomplete)?.to_tri_mesh();
        let coarse = coarse.ok_or(EditError::Vertices { found: num_vertices, levels: counts })?;
        Ok(StreamTower { tower, coarse, fine })
    }

    /// Rings of the vertices that M^{level+1} has beyond M^level, counter-clockwise; an open one goes
    /// from boundary to boundary. Calls `see` with each vertex in order, its ring, and whether it is closed.
    pub(super) fn rings(&self, level: usize, mut see: impl FnMut(u32, &[u32], bool)) {
        use crate::mesh::surface::{next, prev};
        let (num_fine, triangles) = &self.levels[level + 1];
        let surface = Surface::from_triangles(triangles.clone(), *num_fine);
        debug_assert!(surface.is_ok(), "a level is a surface: {surface:?}");
        let Ok(surface) = surface else { return };
        let (mut corners, mut ring) = (Vec::new(), Vec::new());
        for v in self.levels[level].0..*num_fine {
            let closed = surface.fan(surface.corner_of[v], &mut corners);
            ring.clear();
            ring.extend(corners.iter().map(|&c| surface.vertex(next(c))));
            if !closed && let Some(&last) = corners.last() {
                ring.push(surface.vertex(prev(last)));
            }
            see(v as u32, &ring, closed);
        }
    }
}
