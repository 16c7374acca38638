//! The pass of a base mesh in tables, for decoders.

use super::growth::Growth;
use super::head::Head;
use super::placing::Placing;
use super::symbols::GROUPS;
use super::weights::{Factors, Weights};
use crate::entropy::ans::models;
use crate::entropy::ans::reader::{PausedReader, SymbolReader};
use crate::passes::work_budget::WorkBudget;
use crate::passes::{EXHAUSTED, GridMesh, Malformed};

/// Bytes of memory that models take at most.
pub(crate) const MEMORY_OF_MODELS: u64 = models::memory(GROUPS);

/// A pass that has begun.
pub(crate) struct BaseInTables {
    reader: PausedReader,
    stages: Stages,
}

/// What is done, and what for.
struct Stages {
    weights: Weights,
    looks_for_repeated: bool,
    quantization_bits: u32,
    now: Stage,
}

enum Stage {
    Growing(Growth),
    Placing(Box<Placing>),
    Over,
}

impl BaseInTables {
    /// Begins with a base mesh of so many vertices and triangles. Memory stays below a constant times the two counts, which the
    /// caller has checked. `None` if the payload has no head.
    pub(crate) fn new(
        payload: &[u8],
        num_vertices: usize,
        num_faces: usize,
        quantization_bits: u32,
    ) -> Option<Self> {
        let Head { weights, looks_for_repeated, reader } = Head::read(payload)?;
        let now = Stage::Growing(Growth::new(num_vertices, num_faces));
        Some(Self { reader, stages: Stages { weights, looks_for_repeated, quantization_bits, now } })
    }

    /// Goes on; the mesh, once it is over.
    pub(crate) fn advance(
        &mut self,
        payload: &[u8],
        work: &mut WorkBudget,
    ) -> Result<Option<GridMesh>, Malformed> {
        let coder = &mut self.reader.resume(payload);
        let mesh = self.stages.advance(coder, work);
        // What else is found behind the end of the payload depends on where slices of work end.
        if coder.is_exhausted() { Err(Malformed(EXHAUSTED)) } else { mesh }
    }
}

impl Stages {
    fn advance(
        &mut self,
        coder: &mut SymbolReader,
        work: &mut WorkBudget,
    ) -> Result<Option<GridMesh>, Malformed> {
        while work.is_left() {
            self.now = match std::mem::replace(&mut self.now, Stage::Over) {
                Stage::Growing(mut growth) => {
                    if growth.code_some(coder, &mut (), work)? {
                        let factors = Factors::from(&self.weights);
                        let grown = growth.finish()?;
                        work.sweep(grown.triangles.len());
                        let placing =
                            Placing::new(grown, self.quantization_bits, factors, self.looks_for_repeated);
                        Stage::Placing(Box::new(placing))
                    } else {
                        Stage::Growing(growth)
                    }
                }
                Stage::Placing(mut placing) => {
                    if placing.code_some(coder, None, &mut (), work)? {
                        if !coder.is_at_end() {
                            return Err(Malformed("the symbols of a pass do not end where it does"));
                        }
                        return Ok(Some(placing.finish()));
                    }
                    Stage::Placing(placing)
                }
                Stage::Over => return Ok(None),
            };
        }
        Ok(None)
    }
}
