//! One more bit of precision for every vertex (`format/SPEC.md`, section 7.5).

use super::GridMesh;
use crate::bitstream::mixer::MixedBit;
use crate::bitstream::range_coder::BitCoder;
use crate::bitstream::tables::Tables;
use crate::lifting::affine::AffineFilter;
use crate::lifting::neighbourhood::{Neighbourhood, Tip};
use crate::lifting::vec3::from_grid;
use crate::mesh::surface::{NO_CORNER, next, prev};

const NUM_CLASSES: usize = 8;
const OPEN_CLASS: usize = 7;
const OFFSETS: usize = 32;
const SCALES: usize = 16;
/// Rate at which the running error of a class follows.
const ERROR_RATE: f64 = 0.01;
/// Longest ring that is looked at; a vertex with more neighbours is coded without prediction.
const MAX_RING: usize = 64;

/// Adaptive models, kept from pass to pass.
pub(crate) struct RefineModels {
    predictors: Vec<AffineFilter>,
    /// Mean size of the error of the prediction over the ring's length, per class.
    errors: Vec<f64>,
    bit: MixedBit<3>,
}

impl RefineModels {
    pub(crate) fn new() -> Self {
        Self {
            predictors: vec![AffineFilter::new(); NUM_CLASSES],
            errors: vec![0.1; NUM_CLASSES],
            bit: MixedBit::new([OFFSETS * SCALES, OFFSETS * NUM_CLASSES, OFFSETS * 3], 3, 0.6, 400),
        }
    }
}

/// Doubles every coordinate and codes its new last bit, vertex by vertex. `target` holds the
/// refined cells.
pub(crate) fn code<B: BitCoder>(
    coder: &mut B,
    models: &mut RefineModels,
    mesh: &mut GridMesh,
    target: Option<&[[i32; 3]]>,
) {
    let tables = Tables::get();
    let mut corners = Vec::new();
    let mut neighbourhood = Neighbourhood::default();
    for p in mesh.positions.iter_mut().flatten() {
        *p *= 2;
    }
    for v in 0..mesh.positions.len() {
        let class = gather(mesh, v, &mut corners, &mut neighbourhood);
        let outlook = neighbourhood.outlook();
        let predicted = models.predictors[class].predict(&outlook);
        let scale = (models.errors[class] * outlook.length).clamp(0.1, 1e9);
        let scale_level = ((tables.log2(scale) + 3.5) * 2.0).clamp(0.0, (SCALES - 1) as f64) as usize;
        let wanted = target.map_or([0; 3], |t| t[v]);
        let mut size = 0.0;
        for axis in 0..3 {
            let low = mesh.positions[v][axis];
            // The boundary between the two halves, in units where cells have integer centres.
            let offset = predicted[axis] - (f64::from(low) + 0.5);
            let bucket = ((offset * 6.0 + OFFSETS as f64 / 2.0).clamp(0.0, (OFFSETS - 1) as f64)) as usize;
            let above = |x: f64| tables.tail((x - offset) / scale);
            let (lower, middle, upper) = (above(-1.0), above(0.0), above(1.0));
            let p_upper = (middle - upper) / (lower - upper).max(1e-12);
            let bit = models.bit.code(
                coder,
                tables,
                [bucket * SCALES + scale_level, bucket * NUM_CLASSES + class, bucket * 3 + axis],
                &[tables.stretch_real(p_upper.clamp(0.02, 0.98))],
                axis,
                wanted[axis] > low,
            );
            mesh.positions[v][axis] = low + i32::from(bit);
            size += (f64::from(mesh.positions[v][axis]) - predicted[axis]).abs();
        }
        let ratio = (size / 3.0 / outlook.length).min(1.0);
        models.errors[class] += (ratio - models.errors[class]) * ERROR_RATE;
        models.predictors[class].learn(&outlook, from_grid(mesh.positions[v]));
    }
}

/// Fills the neighbourhood of `v`: refined vertices in their cells, the others in the middle of
/// theirs. Returns the class of its predictor.
fn gather(mesh: &GridMesh, v: usize, corners: &mut Vec<u32>, neighbourhood: &mut Neighbourhood) -> usize {
    let surface = &mesh.surface;
    let at = |u: u32| {
        let p = from_grid(mesh.positions[u as usize]);
        if (u as usize) < v { p } else { p.map(|c| c + 0.5) }
    };
    neighbourhood.clear();
    if surface.valence[v] as usize > MAX_RING {
        neighbourhood.ring.push(at(v as u32));
        return OPEN_CLASS;
    }
    let closed = surface.fan(surface.corner_of[v], corners);
    for &corner in corners.iter() {
        neighbourhood.ring.push(at(surface.vertex(next(corner))));
        let across = surface.across(corner);
        neighbourhood.tips.push(if across == NO_CORNER {
            Tip::None
        } else {
            Tip::Fine(at(surface.vertex(across)))
        });
    }
    if !closed && let Some(&last) = corners.last() {
        neighbourhood.ring.push(at(surface.vertex(prev(last))));
    }
    if closed { (surface.valence[v] as usize).clamp(3, 9) - 3 } else { OPEN_CLASS }
}
