//! Where the vertices of the base mesh lie (`format/SPEC.md`, section 7.1). Each is guessed from those of its neighbours
//! that are placed already, as a vertex of a split is from its ring; the one of which most is known comes next.

use super::Malformed;
use super::base::Base;
use super::base_traversal::BaseTraversal;
use super::coding_context::{CodingContext, Fringe};
use super::coordinate_prediction::VertexPrediction;
use super::coordinates::CoordinateModels;
use super::work_budget::WorkBudget;
use crate::entropy::context_mixer::Mixing;
use crate::entropy::mixture::Mixture;
use crate::entropy::range_coder::BitCoder;
use crate::entropy::residual::{CALLER_CONTEXTS, Expectation, SIGN_CONTEXTS};
use crate::entropy::tables::log2;
use crate::util::simd4::Lanes;

/// Roughness of a vertex that was guessed from no neighbour.
const UNKNOWN_ROUGHNESS: i8 = -16;
/// Smallest scale of a jump, in grid steps.
const LEAST_JUMP: f32 = 0.3;
/// Steps of the mean length of jumps and of edges.
const JUMP_RATE: f32 = 0.2;
const EDGE_RATE: f32 = 0.1;

/// A base mesh whose vertices get their places.
pub(crate) struct Placement<'a> {
    base: Base,
    target: Option<&'a [[i32; 3]]>,
    limit: i64,
    models: CoordinateModels,
    fringe: Fringe,
    /// Mean distance of the first vertices of components from the vertices before them.
    jump: f32,
    /// The cell decoded last.
    last: [i32; 3],
    order: BaseTraversal,
}

impl<'a> Placement<'a> {
    /// Begins with the triangles of `base`; `target` has the cells in the encoder's order.
    pub(super) fn new(
        mut base: Base,
        quantization_bits: u32,
        mixing: Mixing,
        target: Option<&'a [[i32; 3]]>,
    ) -> Self {
        let num_vertices = base.mesh.surface.corner_of.len();
        base.mesh.positions = vec![[0; 3]; num_vertices];
        base.mesh.roughness = vec![[UNKNOWN_ROUGHNESS; 2]; num_vertices];
        let limit = 1_i64 << quantization_bits;
        let length = limit as f32 / 8.0;
        let fringe = Fringe { misses: vec![Lanes::ZERO; num_vertices], edge: length };
        Self {
            base,
            target,
            limit,
            models: CoordinateModels::new(mixing),
            fringe,
            jump: length,
            last: [(limit / 2) as i32; 3],
            order: BaseTraversal::new(num_vertices),
        }
    }

    /// Goes on; true if all vertices have their places.
    pub(crate) fn code_some<B: BitCoder>(
        &mut self,
        coder: &mut B,
        work: &mut WorkBudget,
    ) -> Result<bool, Malformed> {
        let mut surroundings = CodingContext::default();
        let mesh = &mut self.base.mesh;
        while work.is_left() {
            let Some(vertex) = self.order.next() else {
                return Ok(true);
            };
            let v = vertex as usize;
            work.take(mesh.surface.valence[v] as usize);
            let wanted = self.target.map_or([0; 3], |t| t[self.base.vertex_source[v] as usize]);
            let outlook = surroundings.gather_placed(mesh, vertex, &self.order, &self.fringe);
            if let Some(outlook) = outlook {
                let mut vertex = VertexPrediction::with_outlook(&self.models.guesses, &surroundings, outlook);
                let position =
                    self.models.code_vertex(coder, &mut vertex, &surroundings, self.limit, wanted)?;
                mesh.positions[v] = position;
                mesh.roughness[v] = vertex.roughness();
                let place = Lanes::between(surroundings.origin, position);
                self.fringe.misses[v] = place - outlook.mean;
                self.fringe.edge += (outlook.length * 2.0 - self.fringe.edge) * EDGE_RATE;
                self.last = position;
            } else {
                let last = self.last;
                let position = code_jump(coder, &mut self.models, last, self.jump, self.limit, wanted)?;
                let size =
                    |axis: usize| (i64::from(position[axis]) - i64::from(last[axis])).unsigned_abs() as f32;
                let size = (size(0) + size(1)) + size(2);
                self.jump += (size * (1.0 / 3.0) - self.jump) * JUMP_RATE;
                mesh.positions[v] = position;
                self.last = position;
            }
            self.order.place(&mesh.surface, vertex);
        }
        Ok(false)
    }

    pub(crate) fn finish(self) -> Base {
        self.base
    }
}

/// Codes the first vertex of a component, from `last` on.
fn code_jump<B: BitCoder>(
    coder: &mut B,
    models: &mut CoordinateModels,
    last: [i32; 3],
    jump: f32,
    limit: i64,
    wanted: [i32; 3],
) -> Result<[i32; 3], Malformed> {
    let scale = jump.max(LEAST_JUMP);
    let mut position = [0; 3];
    for axis in 0..3 {
        let expected = Expectation {
            origin: last[axis],
            mixture: Mixture::around_zero(scale),
            best: 0,
            log_scale: log2(scale),
            kind: 0,
            contexts: [CALLER_CONTEXTS - 1; 2],
            sign: SIGN_CONTEXTS - 2,
        };
        let value = models.residuals.code(coder, &expected, wanted[axis]);
        let value = value.filter(|&v| (0..limit).contains(&i64::from(v)));
        position[axis] = value.ok_or(Malformed("a base vertex lies outside the grid"))?;
    }
    Ok(position)
}
