//! Down the levels: M^L → M^0.

use super::options::{EncodeOptions, Progress};
use super::quantise::Model;
use crate::TriMesh;
use crate::descent::{Descent, Settings};
use crate::descriptors;
use crate::mesh::Surface;
use crate::partition::Geometry;
use crate::simplify::LevelRecord;

/// Share of an encoder's time that goes into the analysis.
pub(super) const ANALYSIS_SHARE: f64 = 0.6;

/// All levels of a surface.
pub(super) struct Hierarchy {
    /// What each level removed, finest first.
    pub(super) records: Vec<LevelRecord>,
    /// The base mesh, renumbered.
    pub(super) base: Surface,
    /// For each vertex and each triangle of the base where it stands in the full surface.
    pub(super) base_vertices: Vec<u32>,
    pub(super) base_faces: Vec<u32>,
    /// Mean edge length in steps of the full grid, base first, then each finer level.
    pub(super) mean_edges: Vec<f64>,
    /// Mean squared distance of the full surface from each level, in squared steps, in that order.
    pub(super) errors: Vec<f64>,
    pub(super) num_vertices: usize,
    pub(super) num_faces: usize,
}

pub(super) fn analyse(
    mesh: &TriMesh,
    surface: Surface,
    model: &Model,
    options: &EncodeOptions,
    max_valence: Option<u32>,
    progress: &(dyn Fn(Progress) + Sync),
) -> Hierarchy {
    let (num_vertices, num_faces) = (surface.corner_of.len(), surface.triangles.len());
    let mean_edge = descriptors::mean_edge_length(mesh) * model.unit;
    let geometry = Geometry { grid: &model.cells, positions: &model.positions };
    let mut descent =
        Descent::new(surface, geometry, mean_edge, Settings { max_valence, ..settings(options) });
    let squared_step = model.steps_per_unit().powi(2);
    let mut records = Vec::new();
    let mut mean_edges = vec![descent.level().mean_edge(&model.cells)];
    let mut errors = vec![0.0];
    progress(Progress { stage: "levels", fraction: 0.0 });
    while let Some((_, record)) = descent.next() {
        records.push(record);
        mean_edges.push(descent.level().mean_edge(&model.cells));
        errors.push(descent.mean_error() * squared_step);
        let fraction = 1.0 - descent.level().vertices.len() as f64 / num_vertices as f64;
        progress(Progress { stage: "levels", fraction: fraction * ANALYSIS_SHARE });
    }
    let level = descent.into_base();
    mean_edges.reverse();
    errors.reverse();
    let base = Surface::from_triangles(level.triangles, level.vertices.len());
    debug_assert!(base.is_ok(), "removal keeps a surface: {base:?}");
    Hierarchy {
        records,
        base: base.unwrap_or_default(),
        base_vertices: level.vertices,
        base_faces: level.faces,
        mean_edges,
        errors,
        num_vertices,
        num_faces,
    }
}

fn settings(options: &EncodeOptions) -> Settings {
    let EncodeOptions { descriptor, window, growth, levels, partition, optimize, .. } = *options;
    let is_hasty = options.effort < EncodeOptions::LOW_EFFORT;
    Settings { descriptor, window, growth, levels, partition, optimize, is_hasty, max_valence: None }
}
