//! Positions of the vertices of a base mesh in tables. Each is predicted from those neighbours that have their places; the one
//! about which most is known comes next.

use super::growth::Grown;
use super::prediction::{Expected, Outlook};
use super::surroundings::{Surroundings, Vertices};
use super::symbols::{JUMPS, RESIDUALS};
use super::weights::Factors;
use crate::entropy::ans::coder::SymbolCoder;
use crate::mesh::Surface;
use crate::passes::work_budget::WorkBudget;
use crate::passes::{GridMesh, Malformed};
use crate::util::simd4::Lanes;

/// Step of the mean length of edges.
const EDGE_RATE: f32 = 0.1;

/// Who wants to know what was predicted and what came.
pub(super) trait Observer {
    fn see_vertex(&mut self, _outlook: &Outlook, _place: Lanes) {}
    fn see_residual(&mut self, _expected: &Expected, _kind: usize, _residual: i32) {}
}

impl Observer for () {}

/// A base mesh whose vertices get their places.
pub(super) struct Placing {
    grown: Grown,
    valence: Vec<u32>,
    vertices: Vertices,
    around: Surroundings,
    factors: Factors,
    /// Whether contexts look for coordinates that repeat.
    looks_for_repeated: bool,
    limit: i64,
    edge: f32,
    /// The cell decoded last.
    last: [i32; 3],
}

impl Placing {
    pub(super) fn new(
        grown: Grown,
        quantization_bits: u32,
        factors: Factors,
        looks_for_repeated: bool,
    ) -> Self {
        let num_vertices = grown.corner_of.len();
        let limit = 1_i64 << quantization_bits;
        Self {
            valence: vec![0; num_vertices],
            vertices: Vertices::new(num_vertices),
            around: Surroundings::default(),
            factors,
            looks_for_repeated,
            limit,
            edge: limit as f32 / 8.0,
            last: [(limit / 2) as i32; 3],
            grown,
        }
    }

    /// Goes on; true if all vertices have their places. `wanted`: the cell of each vertex, when encoding.
    pub(super) fn code_some(
        &mut self,
        coder: &mut impl SymbolCoder,
        wanted: Option<&[[i32; 3]]>,
        observer: &mut impl Observer,
        work: &mut WorkBudget,
    ) -> Result<bool, Malformed> {
        while work.is_left() {
            let Some(vertex) = self.vertices.next() else {
                return Ok(true);
            };
            let valence = self.around.gather(&self.grown, &mut self.vertices, vertex)?;
            self.valence[vertex as usize] = valence as u32;
            work.take(valence);
            let wanted = wanted.map_or([0; 3], |wanted| wanted[vertex as usize]);
            let outlook = Outlook::new(&self.around, &self.factors, self.edge);
            let (position, miss, roughness) = if let Some(mut outlook) = outlook {
                let position = self.code_near(coder, &mut outlook, wanted, observer)?;
                self.edge += (outlook.length * 2.0 - self.edge) * EDGE_RATE;
                (position, outlook.place - outlook.mean, Some(outlook.roughness()))
            } else {
                (self.code_first(coder, wanted)?, Lanes::ZERO, None)
            };
            self.vertices.place(vertex, &self.around, position, miss, roughness);
            self.last = position;
        }
        Ok(false)
    }

    /// Codes a vertex beside others.
    #[inline(always)]
    fn code_near(
        &self,
        coder: &mut impl SymbolCoder,
        outlook: &mut Outlook,
        wanted: [i32; 3],
        observer: &mut impl Observer,
    ) -> Result<[i32; 3], Malformed> {
        let origin = self.around.origin;
        let mut position = [0; 3];
        for kind in 0..3 {
            let expected = outlook.expect(kind);
            let (axis, is_mirrored) = (expected.axis, expected.is_mirrored);
            let repeated = self.looks_for_repeated.then_some(&self.around);
            let context = expected.context(kind, outlook.class, &self.factors.sizes[kind], repeated).index();
            let base = origin[axis].wrapping_add(expected.nearest);
            // The side of the centre counts as the positive one, and as the nearer.
            let towards = |residual: i32| if is_mirrored { residual } else { residual.wrapping_neg() };
            let residual =
                towards(coder.signed(RESIDUALS, context, towards(wanted[axis].wrapping_sub(base))));
            let cell = i64::from(base) + i64::from(residual);
            if !(0..self.limit).contains(&cell) {
                return Err(OUTSIDE);
            }
            position[axis] = cell as i32;
            observer.see_residual(&expected, kind, residual);
            outlook.settle(&expected, kind, position[axis].wrapping_sub(origin[axis]));
        }
        observer.see_vertex(outlook, outlook.place);
        Ok(position)
    }

    /// Codes the first vertex of a component, from the last cell on.
    fn code_first(&self, coder: &mut impl SymbolCoder, wanted: [i32; 3]) -> Result<[i32; 3], Malformed> {
        let mut position = [0; 3];
        for axis in 0..3 {
            let last = self.last[axis];
            let cell = i64::from(last) + i64::from(coder.signed(JUMPS, 0, wanted[axis].wrapping_sub(last)));
            if !(0..self.limit).contains(&cell) {
                return Err(OUTSIDE);
            }
            position[axis] = cell as i32;
        }
        Ok(position)
    }

    pub(super) fn finish(self) -> GridMesh {
        let Grown { triangles, opposite, corner_of, .. } = self.grown;
        let surface = Surface { triangles, opposite, corner_of, valence: self.valence };
        let (positions, roughness) = self.vertices.into_positions();
        GridMesh { surface, positions, roughness }
    }

    /// The triangles again, to place their vertices anew.
    #[cfg(any(feature = "encoder", test))]
    pub(super) fn into_grown(self) -> Grown {
        self.grown
    }
}

const OUTSIDE: Malformed = Malformed("a base vertex lies outside the grid");
