//! Writes a base mesh in tables.

use super::fit::{PredictionFit, SizeFit};
use super::growth::{Grown, Growth};
use super::placing::{Observer, Placing};
use super::symbols::GROUPS;
use super::truth::SurfaceTruth;
use super::weights::{Factors, Weights};
use crate::entropy::ans::coder::SymbolCoder;
use crate::entropy::ans::writer::SymbolWriter;
use crate::entropy::range_coder::RangeEncoder;
use crate::passes::GridMesh;
use crate::passes::Malformed;
use crate::passes::base::BaseTarget;
use crate::passes::base_positions::Base;
use crate::passes::work_budget::WorkBudget;

/// One over the share of the bytes that looking for repeated coordinates must save, as it takes time.
const WORTH_LOOKING: usize = 50;

/// Codes nothing.
struct Nowhere;

impl SymbolCoder for Nowhere {
    fn symbol(&mut self, _: usize, _: usize, symbol: u8) -> u8 {
        symbol
    }

    fn number(&mut self, _: usize, _: usize, number: u32) -> u32 {
        number
    }

    fn raw(&mut self, value: u32, _: u32) -> u32 {
        value
    }
}

/// A grown base mesh and the cells of its vertices.
struct Places {
    grown: Option<Grown>,
    cells: Vec<[i32; 3]>,
    quantization_bits: u32,
}

impl Places {
    /// Places all vertices.
    fn code(
        &mut self,
        coder: &mut impl SymbolCoder,
        weights: &Weights,
        looks_for_repeated: bool,
        observer: &mut impl Observer,
    ) -> Result<(), Malformed> {
        let Some(grown) = self.grown.take() else { return Ok(()) };
        let mut placing =
            Placing::new(grown, self.quantization_bits, Factors::from(weights), looks_for_repeated);
        placing.code_some(coder, Some(&self.cells), observer, &mut WorkBudget::unlimited())?;
        self.grown = Some(placing.into_grown());
        Ok(())
    }

    /// The weights that fit best.
    fn fit(&mut self) -> Result<Weights, Malformed> {
        let mut weights = Weights::DEFAULT;
        let mut predictions = PredictionFit::new();
        self.code(&mut Nowhere, &weights, false, &mut predictions)?;
        predictions.apply(&mut weights);
        let mut sizes = SizeFit::new();
        self.code(&mut Nowhere, &weights, false, &mut sizes)?;
        sizes.apply(&mut weights);
        Ok(weights)
    }

    /// The payload with these weights, after the symbols of the triangles.
    fn write(
        &mut self,
        mut writer: SymbolWriter,
        weights: &Weights,
        looks_for_repeated: bool,
    ) -> Result<Vec<u8>, Malformed> {
        self.code(&mut writer, weights, looks_for_repeated, &mut ())?;
        let mut head = RangeEncoder::new();
        Weights::code(&mut head, Some(weights));
        Ok(writer.finish(head))
    }

    fn finish(mut self, weights: &Weights) -> Result<GridMesh, Malformed> {
        let grown = self.grown.take().unwrap_or_else(|| unreachable!("it is there between two rounds"));
        let mut placing = Placing::new(grown, self.quantization_bits, Factors::from(weights), false);
        placing.code_some(&mut Nowhere, Some(&self.cells), &mut (), &mut WorkBudget::unlimited())?;
        Ok(placing.finish())
    }
}

/// Codes a base mesh with so many bits per coordinate.
///
/// # Errors
/// Never, if the target is a surface whose cells have these bits.
pub(crate) fn write(target: &BaseTarget, quantization_bits: u32) -> Result<(Base, Vec<u8>), Malformed> {
    let (num_vertices, num_faces) = (target.positions.len(), target.surface.triangles.len());
    let mut growth = Growth::new(num_vertices, num_faces);
    let mut truth = SurfaceTruth::new(target.surface);
    let mut writer = SymbolWriter::new(GROUPS);
    growth.code_some(&mut writer, &mut truth, &mut WorkBudget::unlimited())?;
    let SurfaceTruth { vertex_source, corner_source, .. } = truth;
    let cells = vertex_source.iter().map(|&v| target.positions[v as usize]).collect();
    let mut places = Places { grown: Some(growth.finish()?), cells, quantization_bits };
    let weights = places.fit()?;
    if std::env::var("DBG").is_ok() { eprintln!("WEIGHTS {:?} {:?}", weights.predictions, weights.sizes); let mut h = RangeEncoder::new(); Weights::code(&mut h, Some(&weights)); eprintln!("weights {} bytes", h.finish().len()); }
    let mut payload = places.write(writer.clone(), &weights, false)?;
    let with_repeated = places.write(writer.clone(), &weights, true)?;
    if with_repeated.len() + with_repeated.len() / WORTH_LOOKING < payload.len() {
        payload = with_repeated;
    }
    let mesh = places.finish(&weights)?;
    Ok((Base { mesh, vertex_source, corner_source }, payload))
}
