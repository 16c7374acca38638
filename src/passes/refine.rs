//! One more bit of precision for every vertex (`format/SPEC.md`, section 7.5).

use super::GridMesh;
use super::coding_context::{CodingContext, NUM_CLASSES};
use super::coordinate_prediction::{NUM_KINDS, PredictionModels, VertexPrediction, log_level};
use super::work_budget::WorkBudget;
use crate::entropy::context_mixer::{MixedBit, Mixing};
use crate::entropy::range_coder::BitCoder;
use crate::entropy::tables::{Tables, index_below};

/// Buckets of the centre's distance from the boundary between the halves of a cell.
const OFFSETS: usize = 32;
const OFFSETS_PER_STEP: f32 = 6.0;
const SCALES: usize = 16;
const LIMIT: u32 = 250;
/// Least mass within a cell: a prediction far away says nothing about its halves.
const LEAST_MASS: f32 = 1e-6;

/// Adaptive models, kept from pass to pass.
#[derive(Clone)]
pub(crate) struct RefineModels {
    guesses: PredictionModels,
    bit: MixedBit<4>,
}

impl RefineModels {
    pub(crate) fn new(mixing: Mixing) -> Self {
        let sizes = [OFFSETS * SCALES, OFFSETS * NUM_CLASSES, OFFSETS * NUM_KINDS, OFFSETS * SCALES];
        Self { guesses: PredictionModels::new(), bit: MixedBit::new(mixing, sizes, NUM_KINDS, 0.4, LIMIT) }
    }
}

/// Doubles every coordinate and codes its new last bit, vertex by vertex. `target` holds the
/// refined cells.
#[cfg(any(feature = "encoder", test))]
pub(crate) fn code<B: BitCoder>(
    coder: &mut B,
    models: &mut RefineModels,
    mesh: &mut GridMesh,
    target: Option<&[[i32; 3]]>,
) {
    mesh.positions.iter_mut().flatten().for_each(|c| *c *= 2);
    code_some(coder, models, mesh, &mut 0, target, &mut WorkBudget::unlimited());
}

/// Goes on with the vertex `next`, where all coordinates are doubled already; true if all are done.
pub(crate) fn code_some<B: BitCoder>(
    coder: &mut B,
    models: &mut RefineModels,
    mesh: &mut GridMesh,
    next: &mut usize,
    target: Option<&[[i32; 3]]>,
    work: &mut WorkBudget,
) -> bool {
    let tables = Tables::get();
    let mut surroundings = CodingContext::default();
    for v in *next..mesh.positions.len() {
        if !work.take(mesh.surface.valence[v] as usize) {
            *next = v;
            return false;
        }
        surroundings.gather_refined(mesh, v);
        let mut vertex = VertexPrediction::new(&models.guesses, &surroundings);
        let class = surroundings.class;
        for kind in 0..NUM_KINDS {
            let guess = vertex.coordinate(&models.guesses, kind);
            let low = mesh.positions[v][guess.axis];
            let middle = low.wrapping_sub(surroundings.origin[guess.axis]) as f32 + 0.5;
            let mixture = guess.mixture.seen_from(middle, false);
            let above_middle = mixture.above(tables, 0.0);
            let lower = mixture.above(tables, -1.0) - above_middle;
            let upper = above_middle - mixture.above(tables, 1.0);
            let bucket = |centre: f32| index_below(centre * OFFSETS_PER_STEP + 0.5 * OFFSETS as f32, OFFSETS);
            let [first, second, third, _] = mixture.centre.0.map(bucket);
            let best = bucket(mixture.centre.0[guess.best]);
            let contexts = [
                best * SCALES + log_level(guess.log_scale + 1.5, 2.0, SCALES),
                first * NUM_CLASSES + class,
                second * NUM_KINDS + kind,
                third * SCALES + log_level(guess.by_spread, 2.0, SCALES),
            ];
            let p_upper = (upper + 0.5 * LEAST_MASS) / (lower + upper + LEAST_MASS);
            let wanted = target.is_some_and(|t| t[v][guess.axis] > low);
            let direct = [tables.stretch_real(p_upper)];
            let bit = models.bit.code(coder, tables, contexts, direct, kind, wanted);
            let value = low + i32::from(bit);
            mesh.positions[v][guess.axis] = value;
            vertex.settle(&mut models.guesses, &guess, kind, value);
        }
    }
    true
}
