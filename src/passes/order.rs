//! The order of a file (`format/SPEC.md`, section 7.9): which vertex and which triangle comes next,
//! named by what is next to the last ones.

use super::{EXHAUSTED, Malformed};
use crate::entropy::numbers::Numbers;
use crate::entropy::range_coder::BitCoder;
use crate::mesh::{CornersAt, TriMesh};

/// The places of the vertices and triangles of a mesh in the file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Order {
    /// The vertex that comes at each place.
    pub(crate) vertices: Vec<u32>,
    /// Three times the triangle that comes at each place, and which of its corners is the first.
    pub(crate) corners: Vec<u32>,
}

/// Vertices or triangles that are considered before a number is coded in full.
const MOST_CANDIDATES: usize = 24;
/// Places back whose neighbours are candidates.
const DEPTH: usize = 6;

impl Order {
    /// The mesh in the order of the file.
    pub(crate) fn apply(&self, positions: &[[f64; 3]], faces: &[[u32; 3]]) -> TriMesh {
        let mut place = vec![0_u32; positions.len()];
        self.vertices.iter().zip(0..).for_each(|(&v, i)| place[v as usize] = i);
        let turned = self.corners.iter().map(|&corner| {
            let (face, first) = (faces[(corner / 3) as usize], (corner % 3) as usize);
            [0, 1, 2].map(|i| place[face[(first + i) % 3] as usize])
        });
        TriMesh::from_decoded_parts(
            self.vertices.iter().map(|&v| positions[v as usize]).collect(),
            turned.collect(),
        )
    }
}

/// Codes the order of a mesh of this many vertices with these triangles, degenerate ones included.
pub(crate) fn code<B: BitCoder>(
    coder: &mut B,
    num_vertices: usize,
    faces: &[[u32; 3]],
    target: Option<&Order>,
) -> Result<Order, Malformed> {
    let at = CornersAt::new(faces, num_vertices);
    let vertices = code_vertices(coder, num_vertices, faces, &at, target.map(|t| &t.vertices[..]))?;
    let corners = code_corners(coder, &vertices, faces, &at, target.map(|t| &t.corners[..]))?;
    Ok(Order { vertices, corners })
}

fn code_vertices<B: BitCoder>(
    coder: &mut B,
    num_vertices: usize,
    faces: &[[u32; 3]],
    at: &CornersAt,
    target: Option<&[u32]>,
) -> Result<Vec<u32>, Malformed> {
    let mut picker = Picker::new(num_vertices);
    for place in 0..num_vertices {
        picker.candidates.clear();
        for back in 1..=DEPTH.min(place) {
            let v = picker.order[place - back];
            for &c in at.at(v).iter().take(MOST_CANDIDATES) {
                let face = faces[(c / 3) as usize];
                let i = face.iter().position(|&u| u == v).unwrap_or(0);
                picker.consider(face[(i + 1) % 3]);
                picker.consider(face[(i + 2) % 3]);
            }
        }
        picker.code(coder, target.map(|t| t[place]))?;
    }
    Ok(picker.order)
}

fn code_corners<B: BitCoder>(
    coder: &mut B,
    vertices: &[u32],
    faces: &[[u32; 3]],
    at: &CornersAt,
    target: Option<&[u32]>,
) -> Result<Vec<u32>, Malformed> {
    let mut place = vec![0_u32; vertices.len()];
    vertices.iter().zip(0..).for_each(|(&v, i)| place[v as usize] = i);
    let mut picker = Picker::new(faces.len());
    let mut turns = Numbers::new(4);
    let mut corners: Vec<u32> = Vec::with_capacity(faces.len());
    let (mut lowest, mut done_there, mut last_turn) = (0, 0, 3);
    for i in 0..faces.len() {
        picker.candidates.clear();
        for back in 1..=DEPTH.min(i) {
            let corner = corners[i - back];
            let face = faces[(corner / 3) as usize];
            // The newest vertices first: strips and fans go on there.
            for k in [2, 1, 0] {
                let v = face[((corner + k) % 3) as usize];
                at.at(v).iter().take(MOST_CANDIDATES).for_each(|&c| picker.consider(c / 3));
            }
        }
        // Files that go by their vertices return to the first one that is not done.
        while let Some(&v) = vertices.get(lowest) {
            let rest = &at.at(v)[done_there..];
            let num_done = rest.iter().take_while(|&&c| picker.is_done[(c / 3) as usize]).count();
            done_there += num_done;
            if num_done < rest.len() {
                rest[num_done..].iter().take(MOST_CANDIDATES).for_each(|&c| picker.consider(c / 3));
                break;
            }
            (lowest, done_there) = (lowest + 1, 0);
        }
        let face = picker.code(coder, target.map(|t| t[i] / 3))?;
        let lowest_corner =
            (0..3_u32).min_by_key(|&k| place[faces[face as usize][k as usize] as usize]).unwrap_or(0);
        let wanted = target.map_or(0, |t| (t[i] % 3 + 3 - lowest_corner) % 3);
        let turn = turns.code(coder, last_turn, u64::from(wanted)) % 3;
        last_turn = turn as usize;
        corners.push(3 * face + (lowest_corner + turn as u32) % 3);
    }
    Ok(corners)
}

/// Things that come one after the other, each once.
struct Picker {
    order: Vec<u32>,
    is_done: Vec<bool>,
    /// What may come next, likely ones first.
    candidates: Vec<u32>,
    models: Numbers,
    /// Whether a candidate came the last two times.
    history: usize,
    last: i64,
}

impl Picker {
    fn new(count: usize) -> Self {
        Self {
            order: Vec::with_capacity(count),
            is_done: vec![false; count],
            candidates: Vec::new(),
            models: Numbers::new(5),
            history: 0,
            last: -1,
        }
    }

    fn consider(&mut self, it: u32) {
        if self.candidates.len() == MOST_CANDIDATES || self.is_done[it as usize] {
            return;
        }
        if !self.candidates.contains(&it) {
            self.candidates.push(it);
        }
    }

    /// Codes which one comes next: its place among the candidates and one, or 0 and the way from the last.
    fn code<B: BitCoder>(&mut self, coder: &mut B, wanted: Option<u32>) -> Result<u32, Malformed> {
        let malformed = Err(Malformed("an order that is none"));
        let rank = wanted.and_then(|w| self.candidates.iter().position(|&c| c == w));
        let rank = self.models.code(coder, self.history, rank.map_or(0, |rank| rank as u64 + 1));
        self.history = (self.history << 1 | usize::from(rank > 0)) & 3;
        let next = if rank > 0 {
            let Some(&next) = self.candidates.get(rank as usize - 1) else { return malformed };
            next
        } else {
            let way = self.models.code_signed(coder, 4, wanted.map_or(0, |w| i64::from(w) - self.last));
            match u32::try_from(self.last + way)
                .ok()
                .filter(|&n| self.is_done.get(n as usize) == Some(&false))
            {
                Some(next) => next,
                None => return malformed,
            }
        };
        if coder.is_exhausted() {
            return Err(Malformed(EXHAUSTED));
        }
        self.is_done[next as usize] = true;
        self.last = i64::from(next);
        self.order.push(next);
        Ok(next)
    }
}
