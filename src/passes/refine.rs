//! One more bit of precision for every vertex (`format/SPEC.md`, section 7.5).

use super::GridMesh;
use super::guess::{GuessModels, NUM_KINDS, VertexGuess};
use super::surroundings::{NUM_CLASSES, Surroundings};
use crate::bitstream::mixer::MixedBit;
use crate::bitstream::mixture::Mixture;
use crate::bitstream::range_coder::BitCoder;
use crate::bitstream::tables::Tables;

/// Buckets of the centre's distance from the boundary between the halves of a cell.
const OFFSETS: usize = 32;
const OFFSETS_PER_STEP: f64 = 6.0;
const SCALES: usize = 16;
const LIMIT: u32 = 250;
/// Least mass within a cell: a prediction that lies far away says nothing of its halves.
const LEAST_MASS: f64 = 1e-9;

/// Adaptive models, kept from pass to pass.
pub(crate) struct RefineModels {
    guesses: GuessModels,
    bit: MixedBit<4>,
}

impl RefineModels {
    pub(crate) fn new() -> Self {
        let sizes = [OFFSETS * SCALES, OFFSETS * NUM_CLASSES, OFFSETS * NUM_KINDS, OFFSETS * SCALES];
        Self { guesses: GuessModels::new(), bit: MixedBit::new(sizes, NUM_KINDS, 0.4, LIMIT) }
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
    let mut surroundings = Surroundings::default();
    mesh.positions.iter_mut().flatten().for_each(|c| *c *= 2);
    for v in 0..mesh.positions.len() {
        surroundings.gather_refined(mesh, v);
        let mut vertex = VertexGuess::new(&surroundings);
        let class = surroundings.class();
        for kind in 0..NUM_KINDS {
            let guess = vertex.coordinate(&models.guesses, kind);
            let low = mesh.positions[v][guess.axis];
            let middle = f64::from(low) + 0.5;
            let mixture = Mixture::new(tables, &guess.experts, middle, false);
            let above_middle = mixture.above(0.0);
            let (lower, upper) = (mixture.above(-1.0) - above_middle, above_middle - mixture.above(1.0));
            let bucket = |centre: f64| {
                ((centre - middle) * OFFSETS_PER_STEP + 0.5 * OFFSETS as f64).clamp(0.0, (OFFSETS - 1) as f64)
                    as usize
            };
            let best = bucket(guess.experts[guess.best].centre);
            let scale = ((guess.log_scale + 3.0) * 2.0).clamp(0.0, (SCALES - 1) as f64) as usize;
            let spread = ((guess.by_spread + 1.5) * 2.0).clamp(0.0, (SCALES - 1) as f64) as usize;
            let contexts = [
                best * SCALES + scale,
                bucket(guess.experts[0].centre) * NUM_CLASSES + class,
                bucket(guess.experts[1].centre) * NUM_KINDS + kind,
                bucket(guess.experts[2].centre) * SCALES + spread,
            ];
            let p_upper = (upper + 0.5 * LEAST_MASS) / (lower + upper + LEAST_MASS);
            let wanted = target.is_some_and(|t| t[v][guess.axis] > low);
            let direct = [tables.stretch_real(p_upper)];
            let bit = models.bit.code(coder, tables, contexts, &direct, kind, wanted);
            let value = low + i32::from(bit);
            mesh.positions[v][guess.axis] = value;
            vertex.settle(&mut models.guesses, &guess, value);
        }
    }
}
