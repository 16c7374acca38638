//! The connectivity of all levels, vertices numbered coarse before fine.

use super::edit_error::EditError;
use super::options::Options;
use crate::decoder::{Decoder, PassKind};
use crate::descriptors;
use crate::encoder::quantize::{LEGALITY_BITS, quantize};
use crate::error::EncodeError;
use crate::limits::Limits;
use crate::mesh::repair::{Repaired, repair};
use crate::mesh::{Attributes, Surface, TriMesh};
use crate::simplification::hierarchy::{Descent, Settings};
use crate::simplification::level::Level;
use crate::simplification::partition::Geometry;
use bitvec::vec::BitVec;

/// Triangles of M^0 … M^L. M^k has the vertices below its number.
#[derive(Clone, Debug, Default)]
pub(super) struct Hierarchy {
    levels: Vec<(usize, Vec<[u32; 3]>)>,
}

/// A mesh and its levels.
pub(super) struct MeshHierarchy {
    pub(super) hierarchy: Hierarchy,
    /// The vertex of the mesh for each of the hierarchy.
    pub(super) source: Vec<u32>,
    /// A power of two that brings the mesh near the size 1.
    pub(super) unit: f64,
}

/// A stream down to a level.
pub(super) struct StreamHierarchy {
    pub(super) hierarchy: Hierarchy,
    /// The coarse mesh as a decoder of that level gives it, and the finest mesh.
    /// Both cut where they are not manifold.
    pub(super) coarse: TriMesh,
    pub(super) fine: TriMesh,
    /// For each vertex of the finest mesh the one that it is when joined; those of the coarse mesh come first.
    pub(super) joined: Vec<u32>,
    /// The mesh that was encoded, and its attributes.
    pub(super) whole: (TriMesh, Attributes),
}

impl Hierarchy {
    pub(super) fn num_levels(&self) -> usize {
        self.levels.len().saturating_sub(1)
    }

    pub(super) fn num_vertices(&self, level: usize) -> usize {
        self.levels[level].0
    }

    pub(super) fn triangles(&self, level: usize) -> &[[u32; 3]] {
        &self.levels[level].1
    }

    /// Takes vertices out of `mesh` level by level, and tells `progress` which share is out.
    pub(super) fn of_mesh(
        mesh: &TriMesh,
        options: &Options,
        progress: &dyn Fn(f64),
    ) -> Result<MeshHierarchy, EncodeError> {
        let Repaired { surface, source, .. } = repair(mesh);
        if surface.triangles.is_empty() {
            return Err(EncodeError::NoTriangles);
        }
        let model = quantize(mesh, &source, LEGALITY_BITS)?;
        let mean_edge = descriptors::mean_edge_length(mesh) * model.unit;
        let geometry = Geometry { grid: &model.cells, positions: &model.positions };
        let num_vertices = surface.corner_of.len();
        let Options { descriptor, window, growth, levels, partition, .. } = *options;
        let settings = Settings::new(descriptor, window, growth, levels, partition);
        let none: BitVec = BitVec::repeat(false, num_vertices);
        let mut descent = Descent::new(surface, geometry, settings, none).with_mean_edge(mean_edge);
        // Finest first, in the numbering of the surface.
        let mut levels: Vec<Level> = Vec::new();
        while let Some((finer, _)) = descent.next() {
            levels.push(finer);
            progress(1.0 - descent.level().vertices.len() as f64 / num_vertices as f64);
        }
        levels.push(descent.into_level());

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
        Ok(MeshHierarchy {
            hierarchy: Self { levels: named.collect() },
            source: order.iter().map(|&v| source[v as usize]).collect(),
            unit: model.unit,
        })
    }

    /// The levels of a stream from `num_vertices` joined vertices on.
    ///
    /// # Errors
    /// If the stream is damaged, incomplete or beyond the limits, or no level has as many vertices.
    pub(super) fn of_stream(
        bytes: &[u8],
        num_vertices: usize,
        limits: Limits,
        progress: &dyn Fn(f64),
    ) -> Result<StreamHierarchy, EditError> {
        let mut decoder = Decoder::new(limits);
        decoder.feed(bytes)?;
        let mut hierarchy = Self::default();
        let mut coarse: Vec<TriMesh> = Vec::new();
        let mut counts = Vec::new();
        while let Some(update) = decoder.step()? {
            progress(update.pass.end as f64 / bytes.len() as f64);
            let Some(mesh) = decoder.mesh() else { continue };
            if update.pass.kind != PassKind::Refine {
                counts.push(mesh.num_vertices());
                if mesh.num_vertices() >= num_vertices {
                    hierarchy.levels.push((mesh.num_vertices(), mesh.triangles().to_vec()));
                }
            }
            // Only in the end it is known how many vertices are the same.
            let may_be_it = mesh.num_vertices() >= num_vertices && mesh.num_vertices() <= 8 * num_vertices;
            if may_be_it {
                coarse.pop_if(|last| last.num_vertices() == mesh.num_vertices());
                coarse.push(mesh.to_manifold_mesh());
            }
        }
        if !decoder.is_complete() {
            return Err(EditError::Incomplete);
        }
        let mesh = decoder.mesh().ok_or(EditError::Incomplete)?;
        let (fine, (joined, _)) = (mesh.to_manifold_mesh(), mesh.stitched_vertices());
        // Stitched vertices are numbered in the order of their first copies.
        let num_joined = |count: usize| joined[..count].iter().max().map_or(0, |&last| last as usize + 1);
        let is_it = |count: usize| num_joined(count) == num_vertices;
        hierarchy.levels.retain(|&(count, _)| num_joined(count) >= num_vertices);
        let coarse = coarse.into_iter().find(|coarse| is_it(coarse.num_vertices()));
        let levels = || counts.iter().map(|&count| num_joined(count)).collect();
        let coarse = coarse.ok_or_else(|| EditError::Vertices { found: num_vertices, levels: levels() })?;
        let whole = decoder.to_tri_mesh_with_attributes().ok_or(EditError::Incomplete)?;
        Ok(StreamHierarchy { hierarchy, coarse, fine, joined, whole })
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
