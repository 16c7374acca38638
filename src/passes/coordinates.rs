//! Wavelet coefficients: where each odd vertex lies, relative to its prediction
//! (`format/SPEC.md`, section 7.4).

use super::patch::Patches;
use super::{GridMesh, Malformed};
use crate::bitstream::range_coder::BitCoder;
use crate::bitstream::residual::{Expectation, NUM_KINDS, ResidualModel};
use crate::bitstream::tables::Tables;
use crate::lifting::affine::AffineFilter;
use crate::lifting::neighbourhood::{Neighbourhood, Outlook, Tip};
use crate::lifting::vec3::{Vec3, from_grid};
use crate::mesh::surface::{NO_CORNER, next, prev};

/// Classes of vertices that have a predictor each: by valence from 3 to 8 and more, and open rings.
const NUM_CLASSES: usize = 7;
const OPEN_CLASS: usize = 6;
/// Inputs of the scale model.
const NUM_CUES: usize = 6;
/// Smallest length that counts in a logarithm, in grid steps.
const FLOOR: f64 = 0.35;
/// Step of the scale model.
const SCALE_RATE: f64 = 0.02;
/// Typical residual over the exponential of the mean logarithm.
const SCALE_FACTOR: f64 = 1.2;
/// Longest step along the normal that a tangential residual may cause, in ring lengths.
const MAX_SLOPE_STEP: f64 = 4.0;

/// Adaptive models, kept from level to level.
pub(crate) struct CoordinateModels {
    predictors: Vec<AffineFilter>,
    scales: Vec<ScaleModel>,
    residuals: ResidualModel,
}

impl CoordinateModels {
    pub(crate) fn new() -> Self {
        Self {
            predictors: vec![AffineFilter::new(); NUM_CLASSES],
            scales: vec![ScaleModel::new(); NUM_KINDS],
            residuals: ResidualModel::new(),
        }
    }
}

/// Linear model of the logarithm of a residual's size.
#[derive(Clone)]
struct ScaleModel {
    weights: [f64; NUM_CUES],
}

impl ScaleModel {
    fn new() -> Self {
        Self { weights: [-0.4, 0.2, 0.3, 0.4, 0.1, 0.0] }
    }

    fn predict(&self, cues: &[f64; NUM_CUES]) -> f64 {
        let w = &self.weights;
        let sum = (w[0] * cues[0] + w[1] * cues[1]) + (w[2] * cues[2] + w[3] * cues[3]);
        (sum + (w[4] * cues[4] + w[5] * cues[5])).clamp(-4.0, 32.0)
    }

    fn learn(&mut self, cues: &[f64; NUM_CUES], predicted: f64, truth: f64) {
        let error = (truth - predicted).clamp(-3.0, 3.0);
        let energy = cues.iter().fold(1.0, |sum, c| sum + c * c);
        let step = error * SCALE_RATE / energy;
        for (weight, cue) in self.weights.iter_mut().zip(cues) {
            *weight += step * cue;
        }
    }
}

/// Codes the cells of the vertices that `patches` brought back, in their order. `mesh.surface` is
/// refined already, `mesh.positions` gets one entry per patch.
pub(crate) fn code<B: BitCoder>(
    coder: &mut B,
    models: &mut CoordinateModels,
    mesh: &mut GridMesh,
    patches: &Patches,
    precision: u32,
    target: Option<&[[i32; 3]]>,
) -> Result<(), Malformed> {
    let mut context = Surroundings::default();
    let limit = 1_i64 << precision;
    for patch in 0..patches.len() {
        context.gather(mesh, patches, patch);
        let outlook = context.neighbourhood.outlook();
        let class = context.class();
        let predicted = models.predictors[class].predict(&outlook);
        let wanted = target.map_or([0; 3], |t| t[patch]);
        let coded = code_vertex(coder, models, &context, &outlook, predicted, wanted)
            .filter(|p| p.iter().all(|&c| (0..limit).contains(&i64::from(c))))
            .ok_or(Malformed("a vertex lies outside the grid"))?;
        models.predictors[class].learn(&outlook, from_grid(coded.position));
        mesh.positions.push(coded.position);
        mesh.roughness.push(coded.roughness);
    }
    Ok(())
}

struct Coded {
    position: [i32; 3],
    roughness: [i8; 2],
}

impl Coded {
    fn iter(&self) -> std::slice::Iter<'_, i32> {
        self.position.iter()
    }
}

fn code_vertex<B: BitCoder>(
    coder: &mut B,
    models: &mut CoordinateModels,
    context: &Surroundings,
    outlook: &Outlook,
    mut predicted: Vec3,
    wanted: [i32; 3],
) -> Option<Coded> {
    let tables = Tables::get();
    let axes = axis_order(outlook.normal);
    let mut position = [0; 3];
    let mut errors = [0.0_f64; 3];
    let log_length = tables.log2(outlook.length);
    for (kind, &axis) in axes.iter().enumerate() {
        if kind == 2 {
            predicted[axis] += slope_step(outlook, axes, errors);
        }
        let spread = outlook.features[0][axis].abs() + outlook.features[1][axis].abs();
        let known_errors = errors[0].abs() + errors[1].abs();
        let surface = usize::from(kind == 2);
        let cues = [
            1.0,
            log_length,
            tables.log2(outlook.length * tables.exp2(context.ring_roughness[surface]) + FLOOR),
            tables.log2(outlook.length * tables.exp2(context.tip_roughness[surface]) + FLOOR),
            tables.log2(spread + FLOOR),
            if kind == 0 { 0.0 } else { tables.log2(known_errors + FLOOR) },
        ];
        let log_size = models.scales[kind].predict(&cues);
        let expected = Expectation {
            centre: predicted[axis].clamp(-1e9, 1e9),
            scale: tables.exp2(log_size) * SCALE_FACTOR,
            log_scale: log_size,
            kind,
            contexts: [
                level(cues[3], 2.0, 16) * 16 + level(cues[2], 1.0, 16),
                (context.class() * 8 + level(cues[5], 1.0, 8)) * 4 + level(cues[4], 0.5, 4),
            ],
            sign: 2 * context.class() + usize::from(outlook.features[0][axis] < 0.0),
        };
        position[axis] = models.residuals.code(coder, tables, &expected, wanted[axis])?;
        errors[kind] = f64::from(position[axis]) - predicted[axis];
        models.scales[kind].learn(&cues, log_size, tables.log2(errors[kind].abs() + FLOOR));
    }
    let along = (errors[0] * errors[0] + errors[1] * errors[1]).sqrt();
    let ratio = |error: f64| {
        let log = tables.log2(error + FLOOR) - log_length;
        (log * 8.0).clamp(-120.0, 120.0) as i8
    };
    Some(Coded { position, roughness: [ratio(along), ratio(errors[2].abs())] })
}

/// Buckets of a base-2 logarithm: `per_octave` to the octave, from the floor on.
fn level(log: f64, per_octave: f64, count: usize) -> usize {
    ((log + 1.5) * per_octave).clamp(0.0, (count - 1) as f64) as usize
}

/// Axes in coding order: the one closest to the normal last, the other two ascending.
fn axis_order(normal: Vec3) -> [usize; 3] {
    let [x, y, z] = normal.map(f64::abs);
    if x > y && x > z {
        [1, 2, 0]
    } else if y > z {
        [0, 2, 1]
    } else {
        [0, 1, 2]
    }
}

/// How far the tangent plane rises along the last axis for the tangential errors already known.
fn slope_step(outlook: &Outlook, axes: [usize; 3], errors: Vec3) -> f64 {
    let n = outlook.normal;
    if n[axes[2]] == 0.0 {
        return 0.0;
    }
    let rise = -(n[axes[0]] * errors[0] + n[axes[1]] * errors[1]) / n[axes[2]];
    let most = MAX_SLOPE_STEP * outlook.length;
    rise.clamp(-most, most)
}

/// The neighbourhood of one odd vertex, and what its neighbours' residuals were.
#[derive(Default)]
struct Surroundings {
    neighbourhood: Neighbourhood,
    corners: Vec<u32>,
    /// Mean logarithm of residual over edge length, along and across the surface.
    ring_roughness: [f64; 2],
    /// The same over the outer vertices of this level.
    tip_roughness: [f64; 2],
}

impl Surroundings {
    fn class(&self) -> usize {
        if self.neighbourhood.is_closed() {
            self.neighbourhood.ring.len().clamp(3, 8) - 3
        } else {
            OPEN_CLASS
        }
    }

    fn gather(&mut self, mesh: &GridMesh, patches: &Patches, patch: usize) {
        let surface = &mesh.surface;
        let vertex = mesh.positions.len();
        let closed = surface.fan(surface.corner_of[vertex], &mut self.corners);
        let at = |v: u32| from_grid(mesh.positions[v as usize]);
        let coarse_tips = patches.coarse_tips(patch);
        let first_edge = patches.first_edge(patch);

        self.neighbourhood.clear();
        let mut ring_sum = [0_i32; 2];
        let mut tip_sum = [0_i32; 2];
        let mut num_tips = 0;
        let meet = |sum: &mut [i32; 2], v: u32| {
            let r = mesh.roughness[v as usize];
            sum[0] += i32::from(r[0]);
            sum[1] += i32::from(r[1]);
        };
        for (i, &corner) in self.corners.iter().enumerate() {
            let v = surface.vertex(next(corner));
            self.neighbourhood.ring.push(at(v));
            meet(&mut ring_sum, v);
            let across = surface.across(corner);
            let coarse = coarse_tips[(first_edge + i) % coarse_tips.len()];
            self.neighbourhood.tips.push(if across == NO_CORNER {
                Tip::None
            } else {
                let tip = surface.vertex(across);
                if (tip as usize) < vertex {
                    if tip as usize >= vertex - patch {
                        meet(&mut tip_sum, tip);
                        num_tips += 1;
                    }
                    Tip::Fine(at(tip))
                } else if coarse != NO_CORNER {
                    Tip::Coarse(at(coarse))
                } else {
                    Tip::None
                }
            });
        }
        if !closed && let Some(&last) = self.corners.last() {
            let v = surface.vertex(prev(last));
            self.neighbourhood.ring.push(at(v));
            meet(&mut ring_sum, v);
        }
        let mean = |sum: [i32; 2], count: usize| sum.map(|s| f64::from(s) / (8.0 * count as f64));
        self.ring_roughness = mean(ring_sum, self.neighbourhood.ring.len());
        self.tip_roughness = if num_tips > 0 { mean(tip_sum, num_tips) } else { self.ring_roughness };
    }
}
