//! Triangles that grow, and the loops of edges around them that may get a triangle on the other side.
//!
//! ```text
//!        x ------ tip ----- y           gate: the corner that faces the edge pivot → end from below
//!         \      /   \     /            before: faces x → pivot, after: faces end → y
//!  before  \    /     \   /  after      new triangle: tip, end, pivot
//!           pivot --- end
//! ```

use crate::mesh::surface::NO_CORNER;
use crate::passes::Malformed;

/// Opposite of a corner that faces an edge of the boundary of the mesh.
const BORDER: u32 = NO_CORNER - 1;

pub(super) struct Front {
    pub(super) triangles: Vec<[u32; 3]>,
    opposite: Vec<u32>,
    /// The edge that each corner faces, as long as it is in a loop.
    edges: Vec<Edge>,
    has_border: bool,
}

/// An edge of a loop. It ends where the one after it starts.
#[derive(Clone, Copy)]
struct Edge {
    /// Corners that face the edges before and after it.
    before: u32,
    after: u32,
    /// The vertex where it starts.
    start: u32,
}

/// The corners of a new triangle that face edges of loops: one from the pivot, one to the gate's end.
pub(super) type NewGates = [Option<u32>; 2];

impl Front {
    pub(super) fn new(num_faces: usize) -> Self {
        Self {
            triangles: Vec::with_capacity(num_faces),
            opposite: Vec::with_capacity(3 * num_faces),
            edges: Vec::with_capacity(3 * num_faces),
            has_border: false,
        }
    }

    /// Where the edge of a loop starts that a corner faces.
    #[inline(always)]
    pub(super) fn start(&self, corner: u32) -> u32 {
        self.edges[corner as usize].start
    }

    #[inline(always)]
    pub(super) fn end(&self, corner: u32) -> u32 {
        self.start(self.after(corner))
    }

    #[inline(always)]
    pub(super) fn before(&self, corner: u32) -> u32 {
        self.edges[corner as usize].before
    }

    #[inline(always)]
    pub(super) fn after(&self, corner: u32) -> u32 {
        self.edges[corner as usize].after
    }

    /// True if what is beyond the edge has not been said.
    #[inline(always)]
    pub(super) fn is_open(&self, corner: u32) -> bool {
        self.opposite[corner as usize] == NO_CORNER
    }

    /// True if the corner faces an edge of a loop.
    pub(super) fn is_in_loop(&self, corner: u32) -> bool {
        self.opposite.get(corner as usize).is_some_and(|&o| o >= BORDER)
    }

    /// Notes that nothing is beyond a gate.
    pub(super) fn set_border(&mut self, gate: u32) {
        self.opposite[gate as usize] = BORDER;
        self.has_border = true;
    }

    /// Adds a triangle on its own; returns its corners.
    pub(super) fn seed(&mut self, triangle: [u32; 3]) -> [u32; 3] {
        let [a, b, c] = self.add(triangle);
        let [at_a, at_b, at_c] = triangle;
        // The edge that a corner faces starts at the next one.
        let edge = |before, after, start| Edge { before, after, start };
        self.edges.extend_from_slice(&[edge(c, b, at_b), edge(a, c, at_c), edge(b, a, at_a)]);
        [a, b, c]
    }

    /// Adds the triangle to a vertex on no loop beyond `gate`.
    pub(super) fn add_new(&mut self, gate: u32, tip: u32) -> Result<NewGates, Malformed> {
        let [s, e] = [self.before(gate), self.after(gate)];
        let [_, p, q] = self.attach(gate, tip)?;
        self.link(s, p);
        self.link(p, q);
        self.link(q, e);
        Ok([Some(p), Some(q)])
    }

    /// Adds the triangle to the vertex before the pivot, which is enclosed then.
    pub(super) fn add_beside_pivot(&mut self, gate: u32) -> Result<NewGates, Malformed> {
        let [s, e] = [self.before(gate), self.after(gate)];
        let outer = self.before(s);
        let is_last = outer == e;
        if !self.is_open(s) || s == e || (is_last && !self.is_open(e)) {
            return Err(NOT_OPEN);
        }
        let [_, p, q] = self.attach(gate, self.start(s))?;
        self.glue(p, s);
        if is_last {
            self.glue(q, e);
            return Ok([None, None]);
        }
        self.link(outer, q);
        self.link(q, e);
        Ok([None, Some(q)])
    }

    /// Adds the triangle to the vertex after the gate's end.
    pub(super) fn add_beside_end(&mut self, gate: u32) -> Result<NewGates, Malformed> {
        let [s, e] = [self.before(gate), self.after(gate)];
        let outer = self.after(e);
        if !self.is_open(e) || s == e || outer == s {
            return Err(NOT_OPEN);
        }
        let [_, p, q] = self.attach(gate, self.end(e))?;
        self.glue(q, e);
        self.link(s, p);
        self.link(p, outer);
        Ok([Some(p), None])
    }

    /// Adds the triangle to the vertex where the edge of a loop starts that `at` faces: loops are split or joined.
    pub(super) fn add_far(&mut self, gate: u32, at: u32) -> Result<NewGates, Malformed> {
        let [s, e] = [self.before(gate), self.after(gate)];
        let outer = self.before(at);
        let [_, p, q] = self.attach(gate, self.start(at))?;
        self.link(s, p);
        self.link(p, at);
        self.link(outer, q);
        self.link(q, e);
        Ok([Some(p), Some(q)])
    }

    /// Triangles and opposite corners.
    pub(super) fn finish(self) -> (Vec<[u32; 3]>, Vec<u32>) {
        let Self { triangles, mut opposite, has_border, .. } = self;
        if has_border {
            opposite.iter_mut().filter(|o| **o == BORDER).for_each(|o| *o = NO_CORNER);
        }
        (triangles, opposite)
    }

    fn add(&mut self, triangle: [u32; 3]) -> [u32; 3] {
        let first = 3 * self.triangles.len() as u32;
        self.triangles.push(triangle);
        self.opposite.extend_from_slice(&[NO_CORNER; 3]);
        [first, first + 1, first + 2]
    }

    /// Adds the triangle beyond a gate, and glues it to that.
    fn attach(&mut self, gate: u32, tip: u32) -> Result<[u32; 3], Malformed> {
        let (pivot, end) = (self.start(gate), self.end(gate));
        if tip == pivot || tip == end {
            return Err(TWICE);
        }
        let corners = self.add([tip, end, pivot]);
        let edge = |start| Edge { before: NO_CORNER, after: NO_CORNER, start };
        self.edges.extend_from_slice(&[edge(end), edge(pivot), edge(tip)]);
        self.glue(corners[0], gate);
        Ok(corners)
    }

    #[inline(always)]
    fn glue(&mut self, a: u32, b: u32) {
        self.opposite[a as usize] = b;
        self.opposite[b as usize] = a;
    }

    #[inline(always)]
    fn link(&mut self, before: u32, after: u32) {
        self.edges[before as usize].after = after;
        self.edges[after as usize].before = before;
    }
}

const NOT_OPEN: Malformed = Malformed("the base mesh names an edge that is not open");
const TWICE: Malformed = Malformed("a base triangle names a vertex twice");
