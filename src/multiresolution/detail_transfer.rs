//! Details of a stream put back on a coarse mesh that somebody has changed.

use super::decomposition::Decomposition;
use super::edit_error::EditError;
use super::hierarchy::{Hierarchy, StreamHierarchy};
use super::lift::vertex_normals;
use super::options::Prediction;
use crate::encoder::quantize::unit_near;
use crate::limits::Limits;
use crate::mesh::{Attributes, TriMesh, has_three_vertices};
use glam::DVec3;

/// What of the time decoding the stream takes; the rest are details.
const SHARE_OF_DECODING: f64 = 0.7;

/// A level of a stream that may be changed, and the details above it.
#[derive(Clone, Debug)]
pub struct DetailTransfer {
    level: usize,
    /// The level, cut where it is not manifold.
    cut: TriMesh,
    /// The same joined, and the joined vertex of each vertex of the finest mesh.
    coarse: TriMesh,
    joined: Vec<u32>,
    /// From the coarse mesh as decoded to the positions its vertices have in the finest mesh, in the
    /// frames of the vertices.
    refinements: Vec<DVec3>,
    decomposition: Decomposition,
    attributes: Option<Attributes>,
}

impl DetailTransfer {
    /// Reads `bytes`, a complete stream, down to the level with `num_vertices` vertices.
    ///
    /// # Errors
    /// If the stream is damaged, incomplete or beyond `limits`, or no level has as many vertices.
    pub fn new(bytes: &[u8], num_vertices: usize, limits: Limits) -> Result<Self, EditError> {
        Self::new_with_progress(bytes, num_vertices, limits, &|_| ())
    }

    /// As [`DetailTransfer::new`], calling `progress` with the share of the work done, 0 to 1.
    ///
    /// # Errors
    /// As [`DetailTransfer::new`].
    pub fn new_with_progress(
        bytes: &[u8],
        num_vertices: usize,
        limits: Limits,
        progress: &dyn Fn(f64),
    ) -> Result<Self, EditError> {
        let of_stream = |done: f64| progress(done * SHARE_OF_DECODING);
        let StreamHierarchy { hierarchy, coarse: cut, fine, joined, whole: (whole, attributes) } =
            Hierarchy::of_stream(bytes, num_vertices, limits, &of_stream)?;
        let of_details = |done: f64| progress(SHARE_OF_DECODING + done * (1.0 - SHARE_OF_DECODING));
        let finest_level =
            crate::decoder::StreamInfo::read(bytes)?.map_or(0, |info| info.finest_level() as usize);
        let level = finest_level - hierarchy.num_levels();
        let is_same_mesh = join(&fine, &joined).triangles() == whole.triangles();
        let attributes = (attributes.list.is_empty() || is_same_mesh).then_some(attributes);
        let (low, high) = fine.bounding_box().ok_or(EditError::Incomplete)?;
        let unit = unit_near((0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max));
        let (positions, places) = (points(&fine, unit), points(&cut, unit));
        let frames = Frames::new(&cut, &places);
        let offsets = positions.iter().zip(places).map(|(&fine, coarse)| fine - coarse);
        let refinements = offsets.enumerate().map(|(v, d)| frames.to_local(v, d)).collect();
        let prediction = Prediction::default();
        let mut decomposition =
            Decomposition::of_hierarchy(hierarchy, positions, prediction, false, &of_details);
        decomposition.source = (0..fine.num_vertices() as u32).collect();
        decomposition.input = fine;
        decomposition.unit = unit;
        let coarse = join(&cut, &joined);
        Ok(Self { level, cut, coarse, joined, refinements, decomposition, attributes })
    }

    /// The level that may be changed.
    pub fn level(&self) -> usize {
        self.level
    }

    /// The attributes of the stream, which hold for the mesh of [`DetailTransfer::apply`] as well. `None` if the stream has
    /// isolated vertices, degenerate triangles or an order of its own, which that mesh has not.
    pub fn attributes(&self) -> Option<&Attributes> {
        self.attributes.as_ref()
    }

    /// The mesh to change: what a decoder of that level gives.
    pub fn coarse(&self) -> &TriMesh {
        &self.coarse
    }

    /// Puts the details back on `changed`, the coarse mesh with vertices moved: each detail keeps its
    /// components along and across the surface. The faces may have another order.
    ///
    /// # Errors
    /// If `changed` has other vertices or faces than the level.
    pub fn apply(mut self, changed: &TriMesh) -> Result<TriMesh, EditError> {
        self.check(changed)?;
        let positions = changed.positions();
        let cut = self.joined[..self.cut.num_vertices()].iter().map(|&v| positions[v as usize]).collect();
        let changed = TriMesh::from_valid_parts(cut, self.cut.triangles().to_vec());
        let places = points(&changed, self.decomposition.unit);
        let frames = Frames::new(&self.cut, &places);
        let refined = places.iter().enumerate().map(|(v, &p)| p + frames.to_model(v, self.refinements[v]));
        self.decomposition.base = refined.collect();
        Ok(join(&self.decomposition.reconstruct(), &self.joined))
    }

    fn check(&self, changed: &TriMesh) -> Result<(), EditError> {
        if changed.num_vertices() != self.coarse.num_vertices() {
            let levels = vec![self.coarse.num_vertices()];
            return Err(EditError::Vertices { found: changed.num_vertices(), levels });
        }
        let (ours, theirs) = (sorted(&self.coarse), sorted(changed));
        let differing = ours.iter().filter(|t| theirs.binary_search(t).is_err()).count();
        if differing > 0 || ours.len() != theirs.len() {
            let (expected, found) = (ours.len(), theirs.len());
            return Err(EditError::Faces { level: self.level, expected, found, differing });
        }
        Ok(())
    }
}

fn points(mesh: &TriMesh, unit: f64) -> Vec<DVec3> {
    mesh.positions().iter().map(|&p| DVec3::from_array(p) * unit).collect()
}

/// The mesh with its vertices stitched, as a decoder does: numbered in the order of their first copies.
fn join(mesh: &TriMesh, joined: &[u32]) -> TriMesh {
    let mut positions: Vec<[f64; 3]> = Vec::new();
    for (&place, &position) in joined.iter().zip(mesh.positions()) {
        if place as usize == positions.len() {
            positions.push(position);
        }
    }
    let triangles = mesh.triangles().iter().map(|t| t.map(|v| joined[v as usize]));
    TriMesh::from_valid_parts(positions, triangles.filter(has_three_vertices).collect())
}

/// Faces with the smallest corner first, in order.
fn sorted(mesh: &TriMesh) -> Vec<[u32; 3]> {
    let turned = |&[a, b, c]: &[u32; 3]| [a, b, c].min([b, c, a]).min([c, a, b]);
    let mut triangles: Vec<[u32; 3]> = mesh.triangles().iter().map(turned).collect();
    triangles.sort_unstable();
    triangles
}

/// A frame at each vertex: z along the normal, x towards a neighbour.
struct Frames {
    axes: Vec<[DVec3; 3]>,
}

impl Frames {
    /// Neighbours are those of `mesh`, positions may be others.
    fn new(mesh: &TriMesh, positions: &[DVec3]) -> Self {
        let mut neighbours = vec![u32::MAX; positions.len()];
        for &[a, b, c] in mesh.triangles() {
            for (v, u) in [(a, b), (b, c), (c, a)] {
                neighbours[v as usize] = u.min(neighbours[v as usize]);
            }
        }
        let normals = vertex_normals(mesh.triangles(), positions);
        let axes = normals.iter().enumerate().map(|(v, &z)| {
            let edge = positions.get(neighbours[v] as usize).map_or(DVec3::ZERO, |&u| u - positions[v]);
            match (edge - z * z.dot(edge)).try_normalize() {
                Some(x) if z != DVec3::ZERO => [x, z.cross(x), z],
                _ => [DVec3::X, DVec3::Y, DVec3::Z],
            }
        });
        Self { axes: axes.collect() }
    }

    fn to_local(&self, v: usize, d: DVec3) -> DVec3 {
        DVec3::from_array(self.axes[v].map(|axis| axis.dot(d)))
    }

    fn to_model(&self, v: usize, d: DVec3) -> DVec3 {
        let [x, y, z] = self.axes[v];
        x * d.x + y * d.y + z * d.z
    }
}
