//! Triangles of a base mesh in tables: grown as in [`base`](crate::passes::base), around one vertex of the boundary until it
//! is enclosed, then around the next one.

use super::front::{Front, NewGates};
use super::symbols::{BEYOND, MAX_STEPS, STEPS, TIPS, TipContext};
use crate::entropy::ans::coder::SymbolCoder;
use crate::passes::Malformed;
use crate::passes::work_budget::WorkBudget;
use std::collections::VecDeque;

/// What is beyond a gate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Tip {
    New = 0,
    BesidePivot = 1,
    BesideEnd = 2,
    /// A vertex further along the boundary, or along another one.
    Far = 3,
    Nothing = 4,
}

const TIP_BY_SYMBOL: [Tip; 5] = [Tip::New, Tip::BesidePivot, Tip::BesideEnd, Tip::Far, Tip::Nothing];

/// What an encoder knows of the triangles to come; decoders know nothing.
pub(super) trait Truth {
    /// A triangle on its own comes next.
    fn seed(&mut self) {}
    /// What is beyond a gate.
    fn beyond(&mut self, _front: &Front, _gate: u32) -> Tip {
        Tip::Nothing
    }
    /// The corner that faces the edge after the tip, if that is [`Tip::Far`].
    fn far(&mut self, _front: &Front) -> u32 {
        0
    }
}

impl Truth for () {}

/// What is known at a vertex so far.
#[derive(Clone, Copy, Default)]
struct Around {
    faces: u32,
    corner: u32,
    /// True if one of its edges lies on the boundary of the mesh.
    is_at_boundary: bool,
}

/// A base mesh that grows.
pub(super) struct Growth {
    num_vertices: usize,
    num_faces: usize,
    pub(super) front: Front,
    around: Vec<Around>,
    /// Corners that face edges to be looked at: first the next one around the pivot.
    next: Option<u32>,
    later: VecDeque<u32>,
    last: Tip,
}

/// Triangles whose edges are linked.
pub(super) struct Grown {
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) opposite: Vec<u32>,
    /// One corner at each vertex, and the number of its triangles.
    pub(super) corner_of: Vec<u32>,
    pub(super) faces_at: Vec<u32>,
}

impl Growth {
    pub(super) fn new(num_vertices: usize, num_faces: usize) -> Self {
        Self {
            num_vertices,
            num_faces,
            front: Front::new(num_faces),
            around: Vec::with_capacity(num_vertices),
            next: None,
            later: VecDeque::new(),
            last: Tip::New,
        }
    }

    /// Goes on; true if all triangles are there.
    pub(super) fn code_some(
        &mut self,
        coder: &mut impl SymbolCoder,
        truth: &mut impl Truth,
        work: &mut WorkBudget,
    ) -> Result<bool, Malformed> {
        while self.front.triangles.len() < self.num_faces {
            if !work.take(1) {
                return Ok(false);
            }
            match self.next.take().or_else(|| self.later.pop_front()) {
                None => self.seed(truth)?,
                Some(gate) if self.front.is_open(gate) => self.grow(coder, truth, gate)?,
                Some(_) => {}
            }
        }
        Ok(true)
    }

    pub(super) fn finish(self) -> Result<Grown, Malformed> {
        if self.around.len() != self.num_vertices {
            return Err(Malformed("the base mesh has fewer vertices than announced"));
        }
        let (triangles, opposite) = self.front.finish();
        let corner_of = self.around.iter().map(|a| a.corner).collect();
        let faces_at = self.around.iter().map(|a| a.faces).collect();
        Ok(Grown { triangles, opposite, corner_of, faces_at })
    }

    /// Starts a component.
    fn seed(&mut self, truth: &mut impl Truth) -> Result<(), Malformed> {
        truth.seed();
        let triangle = [self.add_vertex()?, self.add_vertex()?, self.add_vertex()?];
        let corners = self.front.seed(triangle);
        self.note_triangle();
        self.later.extend(corners);
        Ok(())
    }

    /// Codes what is beyond a gate.
    fn grow(
        &mut self,
        coder: &mut impl SymbolCoder,
        truth: &mut impl Truth,
        gate: u32,
    ) -> Result<(), Malformed> {
        let front = &self.front;
        let wanted = truth.beyond(front, gate);
        let [before, after] = [front.before(gate), front.after(gate)];
        let ends = [front.start(gate), front.start(after), front.start(before), front.end(after)];
        let [pivot, end, x, y] = ends.map(|v| self.around[v as usize]);
        let context = TipContext {
            pivot: pivot.faces as usize - 1,
            end: end.faces as usize - 1,
            before: x.faces as usize - 1,
            after: y.faces as usize - 1,
            last: self.last as usize,
            bounds: 2 * usize::from(pivot.is_at_boundary) + usize::from(end.is_at_boundary),
        };
        let tip = TIP_BY_SYMBOL[usize::from(coder.symbol(TIPS, context.index(), wanted as u8)).min(4)];
        let front = &mut self.front;
        let [at_pivot, at_end]: NewGates = match tip {
            Tip::Nothing => {
                front.set_border(gate);
                ends[..2].iter().for_each(|&v| self.around[v as usize].is_at_boundary = true);
                return Ok(());
            }
            Tip::New => {
                let vertex = self.add_vertex()?;
                self.front.add_new(gate, vertex)?
            }
            Tip::BesidePivot => front.add_beside_pivot(gate)?,
            Tip::BesideEnd => front.add_beside_end(gate)?,
            Tip::Far => {
                let at = code_far(coder, truth, front, gate)?;
                front.add_far(gate, at)?
            }
        };
        self.last = tip;
        self.note_triangle();
        // Around the pivot as long as that goes, then around the vertex that encloses it.
        self.next = at_pivot.or(at_end);
        self.later.extend(at_end.filter(|_| at_pivot.is_some()));
        Ok(())
    }

    fn add_vertex(&mut self) -> Result<u32, Malformed> {
        let vertex = self.around.len();
        if vertex == self.num_vertices {
            return Err(Malformed("the base mesh has more vertices than announced"));
        }
        self.around.push(Around::default());
        Ok(vertex as u32)
    }

    /// Counts the last triangle at its vertices.
    fn note_triangle(&mut self) {
        let count = self.front.triangles.len() as u32;
        let Some(triangle) = self.front.triangles.last() else { return };
        for (corner, &vertex) in (3 * (count - 1)..).zip(triangle) {
            let around = &mut self.around[vertex as usize];
            around.faces += 1;
            around.corner = corner;
        }
    }
}

/// Codes the corner that faces the edge after a tip far along the boundary: its distance, or its name.
fn code_far(
    coder: &mut impl SymbolCoder,
    truth: &mut impl Truth,
    front: &Front,
    gate: u32,
) -> Result<u32, Malformed> {
    let wanted = truth.far(front);
    let (mut behind, mut ahead) = (front.before(gate), front.after(front.after(gate)));
    let mut near = [0; 2 * MAX_STEPS];
    for pair in near.chunks_exact_mut(2) {
        (behind, ahead) = (front.before(behind), front.after(ahead));
        pair.copy_from_slice(&[behind, ahead]);
    }
    let steps = near.iter().position(|&corner| corner == wanted).map_or(BEYOND, |i| i as u8);
    let steps = coder.symbol(STEPS, 0, steps);
    if let Some(&corner) = near.get(usize::from(steps)) {
        return Ok(corner);
    }
    let count = 3 * front.triangles.len() as u32;
    let corner = coder.raw(wanted, u32::BITS - count.leading_zeros());
    if !front.is_in_loop(corner) {
        return Err(Malformed("the base mesh names an edge that is not open"));
    }
    Ok(corner)
}
