//! Down the levels: M^L → M^0.

use super::grid_error::relative;
use super::options::{Attempt, EncodeOptions, Progress};
use crate::bitstream::grid::Grid;
use crate::descriptors::{self, Features};
use crate::mesh::{Surface, TriMesh};
use crate::simplification::hierarchy::{Descent, Settings};
use crate::simplification::partition::Geometry;
use crate::simplification::{LevelRecord, Seams};
use bitvec::vec::BitVec;

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
    /// Mean squared distance of the full surface from each level, in squares of the largest step, in that order.
    pub(super) errors: Vec<f64>,
    pub(super) num_vertices: usize,
    pub(super) num_faces: usize,
    /// What is left of the full surface, and the entries of attributes there.
    pub(super) slots: Surface,
    pub(super) seams: Seams,
}

/// What goes down with a surface.
pub(super) struct Companions {
    /// The vertices that always stay.
    pub(super) stitched: BitVec,
    pub(super) seams: Seams,
    /// Attributes that the descriptor sees.
    pub(super) features: Option<Features>,
}

/// The vertices of a surface on the grid.
#[derive(Clone, Copy)]
pub(super) struct Placed<'a> {
    pub(super) cells: &'a [[i32; 3]],
    pub(super) grid: &'a Grid,
}

impl Placed<'_> {
    /// The shape of the surface: places in units of which the grid has about one along its longest side. Near 1, so that
    /// squares neither overflow nor vanish.
    fn positions(&self) -> Vec<[f64; 3]> {
        let shares = relative(self.grid.step(self.grid.quantization_bits));
        let place =
            |cell: &[i32; 3]| std::array::from_fn(|a| f64::from(cell[a]) * shares[a] / self.steps_per_unit());
        self.cells.iter().map(place).collect()
    }

    /// Of the largest steps.
    fn steps_per_unit(&self) -> f64 {
        f64::from(1_u32 << self.grid.quantization_bits)
    }
}

/// Goes down from `surface`, whose vertices have the places `placed`. Nothing else is looked at, so that a
/// decoded mesh gives the same levels.
pub(super) fn analyse(
    surface: Surface,
    placed: Placed,
    companions: Companions,
    options: &EncodeOptions,
    attempt: Attempt,
    progress: &(dyn Fn(Progress) + Sync),
) -> Hierarchy {
    let (num_vertices, num_faces) = (surface.corner_of.len(), surface.triangles.len());
    let (cells, positions) = (placed.cells, placed.positions());
    let mesh = TriMesh::from_valid_parts(positions.clone(), surface.triangles.clone());
    let geometry = Geometry { grid: cells, positions: &positions };
    let Companions { stitched, seams, features } = companions;
    let settings = settings(options, attempt);
    let (mean_edge, descent) = rayon::join(
        move || descriptors::mean_edge_length(&mesh),
        || Descent::new(surface, geometry, settings, stitched),
    );
    let mut descent = descent.with_mean_edge(mean_edge).with_seams(seams).with_features(features);
    let squared_step = placed.steps_per_unit().powi(2);
    let mut records = Vec::new();
    let mut mean_edges = vec![descent.level().mean_edge(cells)];
    let mut errors = vec![0.0];
    progress(Progress { stage: "levels", fraction: 0.0 });
    while let Some((_, record)) = descent.next() {
        records.push(record);
        mean_edges.push(descent.level().mean_edge(cells));
        errors.push(descent.mean_error() * squared_step);
        let fraction = 1.0 - descent.level().vertices.len() as f64 / num_vertices as f64;
        progress(Progress { stage: "levels", fraction: fraction * ANALYSIS_SHARE });
    }
    let (level, slots, seams) = descent.into_base();
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
        slots,
        seams,
    }
}

fn settings(options: &EncodeOptions, attempt: Attempt) -> Settings {
    let EncodeOptions { descriptor, window, growth, partition, optimize, .. } = *options;
    let Attempt { levels, max_valence } = attempt;
    let is_hasty = options.effort < EncodeOptions::LOW_EFFORT;
    let usual = Settings::new(descriptor, window, growth, levels, partition);
    Settings { optimize, is_hasty, in_order: true, max_valence, ..usual }
}
