//! Triangles of the base mesh M⁰ (`format/SPEC.md`, section 7.1), grown over their edges: around one vertex
//! of the boundary until it is enclosed, then around the next one. The positions follow in
//! [`base_positions`](super::base_positions).

use super::base_positions::{Base, Placement};
use super::work_budget::WorkBudget;
use super::{GridMesh, Malformed};
use crate::entropy::context_mixer::{MixedBit, Mixing, PlainBits};
use crate::entropy::range_coder::BitCoder;
use crate::entropy::tables::Tables;
use crate::mesh::Surface;
use crate::mesh::surface::{NO_CORNER, next, prev};
use std::collections::{HashMap, VecDeque};

/// Steps around a vertex in search of the neighbouring boundary edge.
const MAX_SWING: usize = 32;
/// Vertices along the boundary, on either side of the gate, that are asked for one by one.
const MAX_STEPS: usize = 8;
/// Numbers of triangles at a vertex that contexts tell apart.
const DEGREES: usize = 10;
/// The same where there may be no vertex.
const DEGREES_OR_NONE: usize = DEGREES + 1;
const LIMIT: u32 = 250;

/// What the encoder wants written: a surface and the cell of each vertex.
pub(crate) struct BaseTarget<'a> {
    pub(crate) surface: &'a Surface,
    pub(crate) positions: &'a [[i32; 3]],
}

/// Codes a base mesh of `num_vertices` and `num_faces` with `precision` bits per coordinate.
///
/// Memory stays below a constant times the two counts, which the caller has checked.
#[cfg(any(feature = "encoder", test))]
pub(crate) fn code<B: BitCoder>(
    coder: &mut B,
    num_vertices: usize,
    num_faces: usize,
    quantization_bits: u32,
    mixing: Mixing,
    target: Option<&BaseTarget>,
) -> Result<Base, Malformed> {
    let mut grower = Grower::new(num_vertices, num_faces, quantization_bits, mixing, target);
    grower.code_some(coder, &mut WorkBudget::unlimited())?;
    let mut placement = grower.finish()?;
    placement.code_some(coder, &mut WorkBudget::unlimited())?;
    Ok(placement.finish())
}

/// Adaptive models of the syntax.
struct BaseModels {
    is_new_in_seed: PlainBits,
    has_face: MixedBit<2>,
    /// Whether the tip is new; if not, whether it is the neighbour of the pivot, or that of the gate's other end.
    tip: [MixedBit<6>; 3],
    far: PlainBits,
}

impl BaseModels {
    fn new(mixing: Mixing) -> Self {
        const D: usize = DEGREES;
        const E: usize = DEGREES_OR_NONE;
        let tip = || {
            let sizes = [D * D, D * D * E, D * D * E, D * E * D, E * E, NUM_TIPS * E * E * 4];
            MixedBit::new(mixing, sizes, D, 0.0, LIMIT)
        };
        Self {
            is_new_in_seed: PlainBits::new(1),
            has_face: MixedBit::new(mixing, [8, D * D * 4], 1, 0.0, LIMIT),
            tip: [tip(), tip(), tip()],
            far: PlainBits::new(2 * MAX_STEPS),
        }
    }
}

/// What the vertex beyond a gate was.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Tip {
    New = 0,
    /// The vertex before the pivot along the boundary: the pivot is enclosed now.
    BesidePivot = 1,
    /// The one after the gate's other end.
    BesideEnd = 2,
    Far = 3,
}

const NUM_TIPS: usize = 4;

/// What is known at a vertex so far.
#[derive(Clone, Copy, Default)]
struct Around {
    faces: u8,
    /// True if one of its edges lies on the boundary of the mesh.
    is_at_boundary: bool,
}

impl Around {
    fn degree(self) -> usize {
        usize::from(self.faces).clamp(1, DEGREES) - 1
    }
}

/// A base mesh that grows.
pub(crate) struct Grower<'a> {
    target: Option<&'a BaseTarget<'a>>,
    num_vertices: usize,
    num_faces: usize,
    quantization_bits: u32,
    mixing: Mixing,
    triangles: Vec<[u32; 3]>,
    opposite: Vec<u32>,
    around: Vec<Around>,
    /// Corners that face a directed edge with no triangle beyond it yet.
    open: HashMap<(u32, u32), u32>,
    /// Those of them that are to be looked at, the current one's first. The pivot is the vertex after a gate.
    gates: VecDeque<u32>,
    models: BaseModels,
    last_tip: Tip,
    vertex_source: Vec<u32>,
    /// Vertex of each target vertex, where it has one.
    vertex_of_target: Vec<u32>,
    corner_source: Vec<u32>,
    next_target_face: u32,
    target_face_done: Vec<bool>,
}

impl<'a> Grower<'a> {
    pub(crate) fn new(
        num_vertices: usize,
        num_faces: usize,
        quantization_bits: u32,
        mixing: Mixing,
        target: Option<&'a BaseTarget<'a>>,
    ) -> Self {
        let target_vertices = target.map_or(0, |t| t.positions.len());
        let target_faces = target.map_or(0, |t| t.surface.triangles.len());
        Self {
            target,
            num_vertices,
            num_faces,
            quantization_bits,
            mixing,
            triangles: Vec::with_capacity(num_faces),
            opposite: Vec::with_capacity(3 * num_faces),
            around: Vec::with_capacity(num_vertices),
            open: HashMap::new(),
            gates: VecDeque::new(),
            models: BaseModels::new(mixing),
            last_tip: Tip::New,
            vertex_source: Vec::new(),
            vertex_of_target: vec![u32::MAX; target_vertices],
            corner_source: Vec::new(),
            next_target_face: 0,
            target_face_done: vec![false; target_faces],
        }
    }

    /// Goes on; true if all triangles are there.
    pub(crate) fn code_some<B: BitCoder>(
        &mut self,
        coder: &mut B,
        work: &mut WorkBudget,
    ) -> Result<bool, Malformed> {
        while self.triangles.len() < self.num_faces {
            if !work.take(1) {
                return Ok(false);
            }
            match self.gates.pop_front() {
                None => self.seed(coder)?,
                Some(gate) if self.opposite[gate as usize] == NO_CORNER => self.grow(coder, gate)?,
                Some(_) => {}
            }
        }
        Ok(true)
    }

    /// Links the triangles, once all are there.
    pub(crate) fn finish(self) -> Result<Placement<'a>, Malformed> {
        if self.around.len() != self.num_vertices {
            return Err(Malformed("the base mesh has fewer vertices than announced"));
        }
        let Self {
            target,
            num_vertices,
            quantization_bits,
            mixing,
            triangles,
            vertex_source,
            corner_source,
            ..
        } = self;
        let surface = Surface::from_triangles(triangles, num_vertices)
            .map_err(|_| Malformed("the base mesh is not a surface"))?;
        let base = Base { mesh: GridMesh { surface, ..GridMesh::default() }, vertex_source, corner_source };
        Ok(Placement::new(base, quantization_bits, mixing, target.map(|t| t.positions)))
    }

    /// Starts a component: the first target triangle that is not coded yet.
    fn seed<B: BitCoder>(&mut self, coder: &mut B) -> Result<(), Malformed> {
        while self.target_face_done.get(self.next_target_face as usize) == Some(&true) {
            self.next_target_face += 1;
        }
        let source = 3 * self.next_target_face;
        let mut triangle = [0; 3];
        for (i, vertex) in triangle.iter_mut().enumerate() {
            let wanted = self.target.map(|t| t.surface.vertex(source + i as u32));
            let known = wanted.map_or(u32::MAX, |w| self.vertex_of_target[w as usize]);
            *vertex = if self.models.is_new_in_seed.code(coder, 0, known == u32::MAX) {
                self.add_vertex(wanted)?
            } else {
                self.code_known(coder, known)?
            };
        }
        let gates = self.place(triangle, source)?;
        self.gates.extend(gates.into_iter().flatten());
        Ok(())
    }

    /// Codes what is beyond the edge that `gate` faces.
    fn grow<B: BitCoder>(&mut self, coder: &mut B, gate: u32) -> Result<(), Malformed> {
        let beyond = self.target.map_or(NO_CORNER, |t| {
            let source = self.corner_source[(gate / 3) as usize];
            t.surface.across(rotate(source, gate % 3))
        });
        let (pivot, end, tip) = (self.vertex(next(gate)), self.vertex(prev(gate)), self.vertex(gate));
        let [at_pivot, at_end, at_tip] = [pivot, end, tip].map(|v| self.around[v as usize]);
        let pair = at_pivot.degree() * DEGREES + at_end.degree();
        let bounds = usize::from(at_pivot.is_at_boundary) * 2 + usize::from(at_end.is_at_boundary);
        let contexts = [bounds * 2 + usize::from(at_tip.is_at_boundary), pair * 4 + bounds];
        let has_face = &mut self.models.has_face;
        if !has_face.code(coder, Tables::get(), contexts, [], 0, beyond != NO_CORNER) {
            [pivot, end].iter().for_each(|&v| self.around[v as usize].is_at_boundary = true);
            return Ok(());
        }
        let wanted = (beyond != NO_CORNER).then(|| self.target.map(|t| t.surface.vertex(beyond))).flatten();

        let sides = SIDES.map(|turn| self.along_boundary(gate, turn));
        let beside = [0, 1].map(|i| self.far_end(sides[i], SIDES[i]));
        let degree = |v: Option<u32>| v.map_or(DEGREES, |v| self.around[v as usize].degree());
        let [left, right] = beside.map(degree);
        let both = left * DEGREES_OR_NONE + right;
        let contexts = [
            pair,
            pair * DEGREES_OR_NONE + left,
            pair * DEGREES_OR_NONE + right,
            (at_pivot.degree() * DEGREES_OR_NONE + left) * DEGREES + at_tip.degree(),
            both,
            (self.last_tip as usize * DEGREES_OR_NONE * DEGREES_OR_NONE + both) * 4 + bounds,
        ];
        let (tip, found) = self.code_tip(coder, contexts, at_pivot.degree(), wanted, sides, beside)?;
        self.last_tip = found;
        // The triangle beyond starts at its tip, so that it faces the gate with its first corner.
        let [_, at_pivot, at_end] = self.place([tip, end, pivot], beyond)?;
        // Around the pivot as long as that goes, then around the vertex that encloses it.
        self.gates.extend(at_end.filter(|_| at_pivot.is_some()));
        if let Some(gate) = at_pivot.or(at_end) {
            self.gates.push_front(gate);
        }
        Ok(())
    }

    /// Codes the vertex beyond a gate. `sides`: corners that face the boundary edges before and after it;
    /// `beside`: their far ends.
    fn code_tip<B: BitCoder>(
        &mut self,
        coder: &mut B,
        contexts: [usize; 6],
        set: usize,
        wanted: Option<u32>,
        mut sides: [Option<u32>; 2],
        beside: [Option<u32>; 2],
    ) -> Result<(u32, Tip), Malformed> {
        let tables = Tables::get();
        let known = wanted.map_or(u32::MAX, |w| self.vertex_of_target[w as usize]);
        let [is_new, is_left, is_right] = &mut self.models.tip;
        if is_new.code(coder, tables, contexts, [], set, known == u32::MAX) {
            return Ok((self.add_vertex(wanted)?, Tip::New));
        }
        for (bit, vertex, tip) in
            [(is_left, beside[0], Tip::BesidePivot), (is_right, beside[1], Tip::BesideEnd)]
        {
            if let Some(vertex) = vertex
                && bit.code(coder, tables, contexts, [], set, vertex == known)
            {
                return Ok((vertex, tip));
            }
        }
        for step in 0..MAX_STEPS {
            for (side, turn) in SIDES.into_iter().enumerate() {
                sides[side] = sides[side].and_then(|corner| self.along_boundary(corner, turn));
                if let Some(vertex) = self.far_end(sides[side], turn)
                    && self.models.far.code(coder, 2 * step + side, vertex == known)
                {
                    return Ok((vertex, Tip::Far));
                }
            }
        }
        Ok((self.code_known(coder, known)?, Tip::Far))
    }

    fn vertex(&self, corner: u32) -> u32 {
        self.triangles[(corner / 3) as usize][(corner % 3) as usize]
    }

    /// The corner that faces the boundary edge next to the one that `corner` faces: around the vertex after it if `turn`
    /// is [`prev`], around the one before it if `turn` is [`next`].
    fn along_boundary(&self, corner: u32, turn: fn(u32) -> u32) -> Option<u32> {
        let mut corner = turn(corner);
        for _ in 0..MAX_SWING {
            match self.opposite[corner as usize] {
                NO_CORNER => return Some(corner),
                across => corner = turn(across),
            }
        }
        None
    }

    /// The end of the boundary edge faced by `corner` that lies further along the boundary.
    fn far_end(&self, corner: Option<u32>, turn: fn(u32) -> u32) -> Option<u32> {
        corner.map(|corner| self.vertex(turn(turn(corner))))
    }

    /// Codes the name of a vertex that exists already.
    fn code_known<B: BitCoder>(&mut self, coder: &mut B, known: u32) -> Result<u32, Malformed> {
        let count = self.around.len() as u32;
        let bits = 32 - count.leading_zeros();
        let vertex = coder.code_raw(known, bits);
        if vertex >= count {
            return Err(Malformed("the base mesh names a vertex before it exists"));
        }
        Ok(vertex)
    }

    fn add_vertex(&mut self, wanted: Option<u32>) -> Result<u32, Malformed> {
        let vertex = self.around.len();
        if vertex == self.num_vertices {
            return Err(Malformed("the base mesh has more vertices than announced"));
        }
        self.around.push(Around::default());
        if let Some(w) = wanted {
            self.vertex_of_target[w as usize] = vertex as u32;
            self.vertex_source.push(w);
        }
        Ok(vertex as u32)
    }

    /// Adds a triangle and links it to the open edges it closes. Returns its corners, those of closed edges left out.
    fn place(&mut self, triangle: [u32; 3], source: u32) -> Result<[Option<u32>; 3], Malformed> {
        let first = 3 * self.triangles.len() as u32;
        self.triangles.push(triangle);
        if self.target.is_some() {
            self.corner_source.push(source);
            self.target_face_done[(source / 3) as usize] = true;
        }
        for v in triangle {
            let faces = &mut self.around[v as usize].faces;
            *faces = faces.saturating_add(1);
        }
        let mut open = [None; 3];
        for i in 0..3 {
            let (from, to) = (triangle[(i + 1) % 3], triangle[(i + 2) % 3]);
            if from == to {
                return Err(Malformed("a base triangle names a vertex twice"));
            }
            let corner = first + i as u32;
            match self.open.remove(&(to, from)) {
                Some(twin) => {
                    self.opposite.push(twin);
                    self.opposite[twin as usize] = corner;
                }
                None => {
                    self.opposite.push(NO_CORNER);
                    open[i] = Some(corner);
                    if self.open.insert((from, to), corner).is_some() {
                        return Err(Malformed("two base triangles run along the same edge"));
                    }
                }
            }
        }
        Ok(open)
    }
}

/// Ways along the boundary: from the pivot, and from the gate's other end.
const SIDES: [fn(u32) -> u32; 2] = [prev, next];

/// The corner `steps` after `corner` in its triangle.
fn rotate(corner: u32, steps: u32) -> u32 {
    (0..steps).fold(corner, |c, _| next(c))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::entropy::range_coder::{RangeDecoder, RangeEncoder};

    fn round_trip(triangles: &[[u32; 3]], num_vertices: usize) -> usize {
        let surface = Surface::from_triangles(triangles.to_vec(), num_vertices).unwrap();
        let positions: Vec<[i32; 3]> =
            (0..num_vertices as i32).map(|i| [i * 37 % 101, i * i % 97, i * 11 % 89]).collect();
        let target = BaseTarget { surface: &surface, positions: &positions };
        let mut encoder = RangeEncoder::new();
        let written =
            code(&mut encoder, num_vertices, triangles.len(), 7, Mixing::Plain, Some(&target)).unwrap();
        let bytes = encoder.finish();
        let read =
            code(&mut RangeDecoder::new(&bytes), num_vertices, triangles.len(), 7, Mixing::Plain, None)
                .unwrap();

        assert_eq!(read.mesh.positions, written.mesh.positions);
        assert_eq!(read.mesh.surface.triangles, written.mesh.surface.triangles);
        for (f, t) in read.mesh.surface.triangles.iter().enumerate() {
            let corner = written.corner_source[f];
            let source = [corner, next(corner), prev(corner)].map(|c| surface.vertex(c));
            assert_eq!(t.map(|v| written.vertex_source[v as usize]), source);
            assert_eq!(t.map(|v| read.mesh.positions[v as usize]), source.map(|v| positions[v as usize]));
        }
        bytes.len()
    }

    #[test]
    fn tetrahedron_strip_and_soup_return() {
        assert!(round_trip(&[[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]], 4) < 20);
        let strip: Vec<[u32; 3]> =
            (0..40).map(|i| if i % 2 == 0 { [i, i + 1, i + 2] } else { [i + 1, i, i + 2] }).collect();
        round_trip(&strip, 42);
        let soup: Vec<[u32; 3]> = (0..30).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        round_trip(&soup, 90);
    }

    #[test]
    fn a_torus_closes_on_itself() {
        let (n, m) = (8, 5);
        let at = |i: u32, j: u32| i % n * m + j % m;
        let triangles: Vec<[u32; 3]> = (0..n)
            .flat_map(|i| (0..m).map(move |j| (i, j)))
            .flat_map(|(i, j)| {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                [[a, b, c], [a, c, d]]
            })
            .collect();
        round_trip(&triangles, (n * m) as usize);
    }

    #[test]
    fn random_payloads_are_refused_or_surfaces() {
        let mut seed = 7_u32;
        for _ in 0..2000 {
            let bytes: Vec<u8> = (0..12)
                .map(|_| {
                    seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    (seed >> 24) as u8
                })
                .collect();
            if let Ok(base) = code(&mut RangeDecoder::new(&bytes), 9, 12, 5, Mixing::Plain, None) {
                assert!(base.mesh.positions.iter().flatten().all(|c| (0..32).contains(c)));
            }
        }
    }
}
