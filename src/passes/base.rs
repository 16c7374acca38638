//! The base mesh M⁰ (`format/SPEC.md`, section 7.1): triangles grown over their edges, each new
//! vertex predicted by the parallelogram over the edge it was reached by.

use super::work::Work;
use super::{GridMesh, Malformed};
use crate::bitstream::mixer::PlainBits;
use crate::bitstream::mixture::Mixture;
use crate::bitstream::range_coder::BitCoder;
use crate::bitstream::residual::{Expectation, NUM_KINDS, ResidualModel};
use crate::bitstream::tables::log2;
use crate::mesh::Surface;
use crate::mesh::surface::{NO_CORNER, next, prev};
use std::collections::{HashMap, VecDeque};

/// Steps around a vertex in search of the neighbouring boundary edge.
const MAX_SWING: usize = 32;
/// Roughness of a vertex whose surroundings are not known.
const UNKNOWN_ROUGHNESS: i8 = -16;

/// What the encoder wants written: a surface and the cell of each vertex.
pub(crate) struct BaseTarget<'a> {
    pub(crate) surface: &'a Surface,
    pub(crate) positions: &'a [[i32; 3]],
}

/// The coded mesh, and where its parts come from in the target (empty when decoding).
#[cfg_attr(not(feature = "encoder"), allow(dead_code))]
pub(crate) struct Base {
    pub(crate) mesh: GridMesh,
    /// Target vertex of each vertex.
    pub(crate) vertex_source: Vec<u32>,
    /// Target corner of the first corner of each triangle.
    pub(crate) corner_source: Vec<u32>,
}

/// Codes a base mesh of `num_vertices` and `num_faces` with `precision` bits per coordinate.
///
/// Memory stays below a constant times the two counts, which the caller has checked.
#[cfg(any(feature = "encoder", test))]
pub(crate) fn code<B: BitCoder>(
    coder: &mut B,
    num_vertices: usize,
    num_faces: usize,
    precision: u32,
    target: Option<&BaseTarget>,
) -> Result<Base, Malformed> {
    let mut grower = Grower::new(num_vertices, num_faces, precision, target);
    grower.code_some(coder, &mut Work::unlimited())?;
    grower.finish()
}

/// How the place of a vertex is guessed.
#[derive(Clone, Copy)]
enum Guess {
    Parallelogram = 0,
    FirstOfSeed = 1,
    RestOfSeed = 2,
}

/// A base mesh that grows.
pub(crate) struct Grower<'a> {
    target: Option<&'a BaseTarget<'a>>,
    num_vertices: usize,
    num_faces: usize,
    limit: i32,
    triangles: Vec<[u32; 3]>,
    opposite: Vec<u32>,
    positions: Vec<[i32; 3]>,
    /// Corners that face a directed edge with no triangle beyond it yet.
    open: HashMap<(u32, u32), u32>,
    gates: VecDeque<u32>,
    syntax: PlainBits,
    residuals: ResidualModel,
    /// Running mean of the size of residuals, per kind of guess.
    mean_size: [f32; NUM_KINDS],
    vertex_source: Vec<u32>,
    /// Vertex of each target vertex, where it has one.
    vertex_of_target: Vec<u32>,
    corner_source: Vec<u32>,
    next_target_face: u32,
    target_face_done: Vec<bool>,
}

/// Contexts of the syntax bits.
mod context {
    pub(super) const HAS_FACE: usize = 0;
    pub(super) const IS_NEW: usize = 1;
    pub(super) const IS_NEW_IN_SEED: usize = 2;
    pub(super) const IS_RIGHT: usize = 3;
    pub(super) const IS_LEFT: usize = 4;
    pub(super) const COUNT: usize = 5;
}

impl<'a> Grower<'a> {
    pub(crate) fn new(
        num_vertices: usize,
        num_faces: usize,
        precision: u32,
        target: Option<&'a BaseTarget<'a>>,
    ) -> Self {
        let target_vertices = target.map_or(0, |t| t.positions.len());
        let target_faces = target.map_or(0, |t| t.surface.triangles.len());
        Self {
            target,
            num_vertices,
            num_faces,
            limit: (1_i64 << precision).min(i64::from(i32::MAX)) as i32,
            triangles: Vec::with_capacity(num_faces),
            opposite: Vec::with_capacity(3 * num_faces),
            positions: Vec::with_capacity(num_vertices),
            open: HashMap::new(),
            gates: VecDeque::new(),
            syntax: PlainBits::new(context::COUNT),
            residuals: ResidualModel::new(),
            mean_size: [(1_u32 << precision) as f32 / 8.0; NUM_KINDS],
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
        work: &mut Work,
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
    pub(crate) fn finish(self) -> Result<Base, Malformed> {
        let num_vertices = self.num_vertices;
        if self.positions.len() != num_vertices {
            return Err(Malformed("the base mesh has fewer vertices than announced"));
        }
        let surface = Surface::from_triangles(self.triangles, num_vertices)
            .map_err(|_| Malformed("the base mesh is not a surface"))?;
        let mesh = GridMesh {
            surface,
            positions: self.positions,
            roughness: vec![[UNKNOWN_ROUGHNESS; 2]; num_vertices],
        };
        Ok(Base { mesh, vertex_source: self.vertex_source, corner_source: self.corner_source })
    }

    /// Starts a component: the first target triangle that is not coded yet.
    fn seed<B: BitCoder>(&mut self, coder: &mut B) -> Result<(), Malformed> {
        while self.target_face_done.get(self.next_target_face as usize) == Some(&true) {
            self.next_target_face += 1;
        }
        let source = 3 * self.next_target_face;
        let mut triangle = [0; 3];
        for i in 0..3 {
            let wanted = self.target.map(|t| t.surface.vertex(source + i as u32));
            let known = wanted.map_or(u32::MAX, |w| self.vertex_of_target[w as usize]);
            if self.syntax.code(coder, context::IS_NEW_IN_SEED, known == u32::MAX) {
                let (guess, kind) = match (i, self.positions.last()) {
                    (0, Some(&last)) => (last, Guess::FirstOfSeed),
                    (0, None) => ([self.limit / 2; 3], Guess::FirstOfSeed),
                    _ => (self.positions[triangle[0] as usize], Guess::RestOfSeed),
                };
                triangle[i] = self.code_vertex(coder, guess, kind, wanted)?;
            } else {
                triangle[i] = self.code_known(coder, known)?;
            }
        }
        self.place(triangle, source)
    }

    /// Codes what lies beyond the edge that `gate` faces.
    fn grow<B: BitCoder>(&mut self, coder: &mut B, gate: u32) -> Result<(), Malformed> {
        let beyond = self.target.map_or(NO_CORNER, |t| {
            let source = self.corner_source[(gate / 3) as usize];
            t.surface.across(rotate(source, gate % 3))
        });
        if !self.syntax.code(coder, context::HAS_FACE, beyond != NO_CORNER) {
            return Ok(());
        }
        let vertex = |corner: u32| self.triangles[(corner / 3) as usize][(corner % 3) as usize];
        let (a, b, c) = (vertex(next(gate)), vertex(prev(gate)), vertex(gate));
        let wanted = (beyond != NO_CORNER).then(|| self.target.map(|t| t.surface.vertex(beyond))).flatten();
        let known = wanted.map_or(u32::MAX, |w| self.vertex_of_target[w as usize]);

        let tip = if self.syntax.code(coder, context::IS_NEW, known == u32::MAX) {
            let [pa, pb, pc] = [a, b, c].map(|v| self.positions[v as usize]);
            let guess = std::array::from_fn(|i| pa[i] + (pb[i] - pc[i]));
            self.code_vertex(coder, guess, Guess::Parallelogram, wanted)?
        } else {
            let right = self.boundary_neighbour(next(gate), next);
            let left = self.boundary_neighbour(prev(gate), prev);
            if right.is_some() && self.syntax.code(coder, context::IS_RIGHT, right == Some(known)) {
                right.unwrap_or(known)
            } else if left.is_some() && self.syntax.code(coder, context::IS_LEFT, left == Some(known)) {
                left.unwrap_or(known)
            } else {
                self.code_known(coder, known)?
            }
        };
        // The triangle beyond starts at its tip, so that it faces the gate with its first corner.
        self.place([tip, b, a], beyond)
    }

    /// The far end of the boundary edge next to a gate, around one of the gate's ends. `corner`
    /// faces the edge after the gate; `turn` is the direction around the vertex.
    fn boundary_neighbour(&self, mut corner: u32, turn: fn(u32) -> u32) -> Option<u32> {
        for _ in 0..MAX_SWING {
            let o = self.opposite[corner as usize];
            if o == NO_CORNER {
                // Turning by `next` looks around the edge's start, so the end is the far one.
                let far = turn(turn(corner));
                return Some(self.triangles[(far / 3) as usize][(far % 3) as usize]);
            }
            corner = turn(o);
        }
        None
    }

    /// Codes the name of a vertex that exists already.
    fn code_known<B: BitCoder>(&mut self, coder: &mut B, known: u32) -> Result<u32, Malformed> {
        let count = self.positions.len() as u32;
        let bits = 32 - count.leading_zeros();
        let vertex = coder.code_raw(known, bits);
        if vertex >= count {
            return Err(Malformed("the base mesh names a vertex before it exists"));
        }
        Ok(vertex)
    }

    fn code_vertex<B: BitCoder>(
        &mut self,
        coder: &mut B,
        guess: [i32; 3],
        kind: Guess,
        wanted: Option<u32>,
    ) -> Result<u32, Malformed> {
        let vertex = self.positions.len();
        if vertex == self.num_vertices {
            return Err(Malformed("the base mesh has more vertices than announced"));
        }
        let kind = kind as usize;
        let wanted_position = wanted.and_then(|w| self.target.map(|t| t.positions[w as usize]));
        let scale = self.mean_size[kind].max(0.3);
        let mut position = [0; 3];
        let mut size = 0.0;
        for axis in 0..3 {
            let expected = Expectation {
                origin: guess[axis],
                mixture: Mixture::around_zero(scale),
                best: 0,
                log_scale: log2(scale),
                kind,
                contexts: [axis, 3],
                sign: 2 * axis,
            };
            let value = wanted_position.map_or(0, |p| p[axis]);
            let value = self.residuals.code(coder, &expected, value);
            position[axis] = value
                .filter(|v| (0..self.limit).contains(v))
                .ok_or(Malformed("a base vertex lies outside the grid"))?;
            size += (i64::from(position[axis]) - i64::from(guess[axis])).unsigned_abs() as f32;
        }
        self.mean_size[kind] += (size / 3.0 - self.mean_size[kind]) * 0.2;
        self.positions.push(position);
        if let Some(w) = wanted {
            self.vertex_of_target[w as usize] = vertex as u32;
            self.vertex_source.push(w);
        }
        Ok(vertex as u32)
    }

    /// Adds a triangle and links it to the open edges it closes.
    fn place(&mut self, triangle: [u32; 3], source: u32) -> Result<(), Malformed> {
        let first = 3 * self.triangles.len() as u32;
        self.triangles.push(triangle);
        if self.target.is_some() {
            self.corner_source.push(source);
            self.target_face_done[(source / 3) as usize] = true;
        }
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
                    self.gates.push_back(corner);
                    if self.open.insert((from, to), corner).is_some() {
                        return Err(Malformed("two base triangles run along the same edge"));
                    }
                }
            }
        }
        Ok(())
    }
}

/// The corner `steps` after `corner` in its triangle.
fn rotate(corner: u32, steps: u32) -> u32 {
    (0..steps).fold(corner, |c, _| next(c))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bitstream::range_coder::{RangeDecoder, RangeEncoder};

    fn round_trip(triangles: &[[u32; 3]], num_vertices: usize) -> usize {
        let surface = Surface::from_triangles(triangles.to_vec(), num_vertices).unwrap();
        let positions: Vec<[i32; 3]> =
            (0..num_vertices as i32).map(|i| [i * 37 % 101, i * i % 97, i * 11 % 89]).collect();
        let target = BaseTarget { surface: &surface, positions: &positions };
        let mut encoder = RangeEncoder::new();
        let written = code(&mut encoder, num_vertices, triangles.len(), 7, Some(&target)).unwrap();
        let bytes = encoder.finish();
        let read = code(&mut RangeDecoder::new(&bytes), num_vertices, triangles.len(), 7, None).unwrap();

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
            if let Ok(base) = code(&mut RangeDecoder::new(&bytes), 9, 12, 5, None) {
                assert!(base.mesh.positions.iter().flatten().all(|c| (0..32).contains(c)));
            }
        }
    }
}
