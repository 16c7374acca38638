//! Wavelet coefficients: where each odd vertex lies, relative to its prediction
//! (`format/SPEC.md`, section 7.4).

use super::coding_context::CodingContext;
use super::coordinate_prediction::{NUM_KINDS, PredictionModels, VertexPrediction, log_level};
use super::patch::Patches;
use super::work_budget::WorkBudget;
use super::{EXHAUSTED, GridMesh, Malformed};
use crate::entropy::context_mixer::Mixing;
use crate::entropy::range_coder::BitCoder;
use crate::entropy::residual::{Expectation, ResidualModel};

/// Adaptive models, kept from level to level.
#[derive(Clone)]
pub(crate) struct CoordinateModels {
    pub(super) guesses: PredictionModels,
    pub(super) residuals: ResidualModel,
}

impl CoordinateModels {
    pub(crate) fn new(mixing: Mixing) -> Self {
        Self { guesses: PredictionModels::new(), residuals: ResidualModel::new(mixing) }
    }

    /// Codes the three coordinates of a vertex, each between 0 and `limit`.
    #[inline(always)]
    pub(super) fn code_vertex<B: BitCoder>(
        &mut self,
        coder: &mut B,
        vertex: &mut VertexPrediction,
        surroundings: &CodingContext,
        limit: i64,
        wanted: [i32; 3],
    ) -> Result<[i32; 3], Malformed> {
        let class = surroundings.class;
        let mut position = [0; 3];
        for kind in 0..NUM_KINDS {
            let guess = vertex.coordinate(&self.guesses, kind);
            let expected = Expectation {
                origin: surroundings.origin[guess.axis],
                mixture: guess.mixture,
                best: guess.best,
                log_scale: guess.log_scale,
                kind,
                contexts: [
                    log_level(guess.by_tips, 2.0, 16) * 16 + log_level(guess.by_ring, 1.0, 16),
                    (class * 8 + log_level(guess.by_known, 1.0, 8)) * 4 + log_level(guess.by_spread, 0.5, 4),
                ],
                sign: 2 * class + usize::from(guess.leans_down),
            };
            let value = self.residuals.code(coder, &expected, wanted[guess.axis]);
            if coder.is_guessing() {
                break;
            }
            let value = value.filter(|&v| (0..limit).contains(&i64::from(v)));
            let value = value.ok_or(Malformed("a vertex lies outside the grid"))?;
            vertex.settle(&mut self.guesses, &guess, kind, value);
            position[guess.axis] = value;
        }
        Ok(position)
    }
}

/// Codes the cells of the vertices that `patches` brought back, in their order. `mesh.surface` is
/// refined already, `mesh.positions` gets one entry per patch.
#[cfg(any(feature = "encoder", test))]
pub(crate) fn code<B: BitCoder>(
    coder: &mut B,
    models: &mut CoordinateModels,
    mesh: &mut GridMesh,
    patches: &Patches,
    quantization_bits: u32,
    target: Option<&[[i32; 3]]>,
) -> Result<(), Malformed> {
    code_some(coder, models, mesh, patches, quantization_bits, target, &mut WorkBudget::unlimited()).map(drop)
}

/// Goes on from the first vertex that has no position; true if all have one, or a cut payload has told what
/// it can.
pub(crate) fn code_some<B: BitCoder>(
    coder: &mut B,
    models: &mut CoordinateModels,
    mesh: &mut GridMesh,
    patches: &Patches,
    quantization_bits: u32,
    target: Option<&[[i32; 3]]>,
    work: &mut WorkBudget,
) -> Result<bool, Malformed> {
    let mut surroundings = CodingContext::default();
    let limit = 1_i64 << quantization_bits;
    let first_odd = mesh.surface.corner_of.len() - patches.len();
    for patch in mesh.positions.len() - first_odd..patches.len() {
        if !work.take(patches.edges(patch).len()) {
            return Ok(false);
        }
        if coder.is_exhausted() {
            return Err(Malformed(EXHAUSTED));
        }
        surroundings.gather_odd(mesh, patches, patch);
        let mut vertex = VertexPrediction::new(&models.guesses, &surroundings);
        let wanted = target.map_or([0; 3], |t| t[patch]);
        let position = models.code_vertex(coder, &mut vertex, &surroundings, limit, wanted)?;
        if coder.is_guessing() {
            return Ok(true);
        }
        mesh.positions.push(position);
        mesh.roughness.push(vertex.roughness());
    }
    Ok(true)
}
