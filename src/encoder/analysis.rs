//! Down the levels: M^L → M^0.

use super::options::{EncodeOptions, MAX_LEVELS, Progress};
use super::quantise::Model;
use crate::TriMesh;
use crate::descriptors;
use crate::levels::Level;
use crate::mesh::Surface;
use crate::partition::{Geometry, remove_level};
use crate::simplify::canonical::Anchors;
use crate::simplify::memory::ErrorMemory;
use crate::simplify::{LevelRecord, ShrinkingSurface};

/// Without a wish for levels, the base has at most this many vertices if it can.
const SMALL_BASE: usize = 40;
/// Without a wish, a level that would remove a smaller share is not worth a pass.
const LEAST_SHARE: f64 = 0.02;
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
    progress: &(dyn Fn(Progress) + Sync),
) -> Hierarchy {
    let (num_vertices, num_faces) = (surface.corner_of.len(), surface.triangles.len());
    let mean_edge = descriptors::mean_edge_length(mesh) * model.unit;
    let geometry = Geometry { grid: &model.cells, positions: &model.positions };
    let anchors = Anchors::new(&surface);
    let mut shrinking = ShrinkingSurface::new(surface);
    let mut window = options.window;
    let mut records = Vec::new();
    let mut level = Level::collect(&shrinking);
    let mut memory = ErrorMemory::new(&shrinking.surface, &model.positions);
    let mut mean_edges = vec![level.mean_edge(&model.cells)];
    let mut errors = vec![0.0];

    while wants_level(options, records.len(), shrinking.num_vertices()) {
        let fraction = 1.0 - shrinking.num_vertices() as f64 / num_vertices as f64;
        progress(Progress { stage: "levels", fraction: fraction * ANALYSIS_SHARE });
        let scores = level.with_mesh(&model.positions, |mesh| {
            descriptors::evaluate(options.descriptor, mesh, &window, mean_edge)
        });
        let before = shrinking.num_vertices();
        let record = remove_level(
            options.partition,
            options.optimize,
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
        let is_small = (record.len() as f64) < LEAST_SHARE * before as f64;
        records.push(record);
        level = Level::collect(&shrinking);
        mean_edges.push(level.mean_edge(&model.cells));
        errors.push(memory.mean_error(&level.vertices) * model.steps_per_unit().powi(2));
        window.radius *= options.growth;
        if is_small && options.levels.is_none() {
            break;
        }
    }
    mean_edges.reverse();
    errors.reverse();
    lead_with_anchors(&mut level, &shrinking, &anchors);
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

/// Puts the triangles at the anchors first, the anchor as their first edge, so that a decoder numbers
/// its ends before all other vertices of its component.
fn lead_with_anchors(level: &mut Level, shrinking: &ShrinkingSurface, anchors: &Anchors) {
    let mut place_of_slot: Vec<u32> = vec![u32::MAX; shrinking.surface.triangles.len()];
    level.faces.iter().enumerate().for_each(|(i, &slot)| place_of_slot[slot as usize] = i as u32);
    for (i, corner) in anchors.corners(&shrinking.surface).enumerate() {
        // The corner faces the anchor, so the triangle is to start after it.
        let slot = corner / 3;
        let place = place_of_slot[slot as usize] as usize;
        level.triangles[place].rotate_left(((corner + 1) % 3) as usize);
        level.triangles.swap(i, place);
        level.faces.swap(i, place);
        place_of_slot[level.faces[place] as usize] = place as u32;
        place_of_slot[slot as usize] = i as u32;
    }
}

fn wants_level(options: &EncodeOptions, done: usize, num_vertices: usize) -> bool {
    match options.levels {
        Some(levels) => done < levels as usize,
        None => done < MAX_LEVELS as usize && num_vertices > SMALL_BASE,
    }
}
