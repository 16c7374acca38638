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
    let mut payload = places.write(writer.clone(), &weights, false)?;
    let with_repeated = places.write(writer.clone(), &weights, true)?;
    if with_repeated.len() + with_repeated.len() / WORTH_LOOKING < payload.len() {
        payload = with_repeated;
    }
    let mesh = places.finish(&weights)?;
    Ok((Base { mesh, vertex_source, corner_source }, payload))
}

#[cfg(test)]
mod tests {
    use super::super::pass::BaseInTables;
    use super::*;
    use crate::entropy::context_mixer::Mixing;
    use crate::mesh::Surface;
    use crate::passes::base;

    fn cells(count: usize) -> Vec<[i32; 3]> {
        (0..count as i32).map(|i| [i * 37 % 101, i * i % 97, i * 11 % 89]).collect()
    }

    fn decode(payload: &[u8], counts: (usize, usize), work: u32) -> Result<GridMesh, Malformed> {
        let mut pass = BaseInTables::new(payload, counts.0, counts.1, 7).ok_or(Malformed("no head"))?;
        for _ in 0..100_000 {
            if let Some(mesh) = pass.advance(payload, &mut WorkBudget::units(work))? {
                return Ok(mesh);
            }
        }
        Err(Malformed("without end"))
    }

    /// Writes and reads; returns the payload.
    fn round_trip(triangles: &[[u32; 3]], num_vertices: usize) -> Vec<u8> {
        let surface = Surface::from_triangles(triangles.to_vec(), num_vertices).unwrap();
        let positions = cells(num_vertices);
        let target = BaseTarget { surface: &surface, positions: &positions };
        let (written, payload) = write(&target, 7).unwrap();
        let mut coder = RangeEncoder::new();
        let mixed =
            base::code(&mut coder, num_vertices, triangles.len(), 7, Mixing::Plain, Some(&target)).unwrap();
        for work in [u32::MAX, 3] {
            let read = decode(&payload, (num_vertices, triangles.len()), work).unwrap();
            assert_eq!(read.positions, written.mesh.positions);
            assert_eq!(read.roughness, written.mesh.roughness);
            // The same mesh as in the other profiles.
            assert_eq!(read.positions, mixed.mesh.positions);
            assert_eq!(read.surface.triangles, mixed.mesh.surface.triangles);
            assert_eq!(read.surface.opposite, mixed.mesh.surface.opposite);
            assert_eq!(read.surface.corner_of, mixed.mesh.surface.corner_of);
            assert_eq!(read.surface.valence, mixed.mesh.surface.valence);
        }
        assert_eq!(written.vertex_source, mixed.vertex_source);
        assert_eq!(written.corner_source, mixed.corner_source);
        payload
    }

    fn torus(n: u32, m: u32) -> Vec<[u32; 3]> {
        let at = |i: u32, j: u32| i % n * m + j % m;
        let squares = (0..n).flat_map(|i| (0..m).map(move |j| (i, j)));
        let halves = squares.flat_map(|(i, j)| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        });
        halves.collect()
    }

    #[test]
    fn tetrahedron_strip_soup_and_torus_return() {
        round_trip(&[[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]], 4);
        let strip = |i| if i % 2 == 0 { [i, i + 1, i + 2] } else { [i + 1, i, i + 2] };
        round_trip(&(0..40).map(strip).collect::<Vec<_>>(), 42);
        round_trip(&(0..30).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect::<Vec<_>>(), 90);
        round_trip(&torus(8, 5), 40);
        // A vertex of very many triangles, closed and open.
        let wheel: Vec<[u32; 3]> = (0..100).map(|i| [100, i, (i + 1) % 100]).collect();
        round_trip(&wheel, 101);
        round_trip(&wheel[..99], 101);
    }

    /// A torus with holes, at random: boundaries that meet, splits and handles.
    #[test]
    fn surfaces_with_holes_return() {
        let mut seed = 5_u32;
        let mut random = |n: u32| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 8) % n
        };
        let mut num_tried = 0;
        for _ in 0..300 {
            let mut triangles = torus(12, 9);
            for _ in 0..random(30) {
                triangles.swap_remove(random(triangles.len() as u32) as usize);
            }
            // What is left of each vertex must be one fan; those of two are left out.
            let mut names = vec![u32::MAX; 108];
            let mut count = 0;
            triangles.iter().flatten().for_each(|&v| {
                if names[v as usize] == u32::MAX {
                    names[v as usize] = count;
                    count += 1;
                }
            });
            let named: Vec<[u32; 3]> = triangles.iter().map(|t| t.map(|v| names[v as usize])).collect();
            if Surface::from_triangles(named.clone(), count as usize).is_ok() {
                round_trip(&named, count as usize);
                num_tried += 1;
            }
        }
        assert!(num_tried > 20, "{num_tried}");
    }

    #[test]
    fn damaged_payloads_are_refused_or_surfaces() {
        let payload = round_trip(&torus(12, 9), 108);
        let mut num_read = 0;
        for i in 0..4000_usize {
            let mut damaged = payload.clone();
            let at = i.wrapping_mul(2_654_435_761) % payload.len();
            damaged[at] ^= 1 << (i % 8);
            if i % 5 == 0 {
                damaged.truncate(payload.len() - i % payload.len());
            }
            if let Ok(mesh) = decode(&damaged, (108, 216), u32::MAX) {
                num_read += 1;
                assert!(mesh.positions.iter().flatten().all(|c| (0..128).contains(c)));
                let GridMesh { surface: Surface { triangles, opposite, corner_of, valence }, .. } = mesh;
                let again = Surface::from_triangles(triangles, 108).unwrap();
                assert_eq!((again.opposite, again.corner_of, again.valence), (opposite, corner_of, valence));
            }
        }
        assert!(num_read > 0);
    }
}
