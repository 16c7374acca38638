//! What rounding to the grid does to a mesh.

use lwc::{StreamInfo, TriMesh};

/// More triangles than this share of all that collapse or turn are worth a warning.
const MOST_LOST: f64 = 0.01;
const MAX_BITS: u32 = 30;

/// The grid of a stream, and what it costs the mesh that was encoded.
pub struct GridLoss {
    /// Side of a cell, model units.
    pub step: f64,
    /// Largest distance of a vertex from its place in the finest level, model units.
    pub largest_error: f64,
    /// Triangles that have no area on the grid, or face the other way, though they do not in the mesh.
    pub triangles_lost: usize,
    /// The fewest bits with which few triangles are lost, if too many are and 30 bits help.
    pub bits_that_do: Option<u32>,
}

impl GridLoss {
    /// Of a mesh and its stream, unless the stream keeps its coordinates bit for bit.
    pub fn new(mesh: &TriMesh, info: &StreamInfo, is_lossless: bool) -> Option<Self> {
        if is_lossless || info.side() <= 0.0 {
            return None;
        }
        let grid = |bits: u32| Grid { origin: info.origin(), steps: steps(bits) / info.side() };
        let used = grid(info.quantization_bits());
        let triangles_lost = used.triangles_lost(mesh);
        let most = (MOST_LOST * mesh.num_triangles() as f64) as usize;
        let mut finer = info.quantization_bits() + 1..=MAX_BITS;
        let is_enough = |bits: &u32| grid(*bits).triangles_lost(mesh) <= most;
        let bits_that_do = if triangles_lost > most { finer.find(is_enough) } else { None };
        let (step, largest_error) = (info.step(), used.largest_error(mesh));
        Some(Self { step, largest_error, triangles_lost, bits_that_do })
    }

    /// A warning if too many triangles are lost.
    pub fn warning(&self, mesh: &TriMesh) -> Option<String> {
        let (lost, all) = (self.triangles_lost, mesh.num_triangles());
        let advice = match self.bits_that_do {
            Some(bits) => format!("`-q {bits}` keeps them"),
            None => "`--lossless` keeps them".to_owned(),
        };
        let is_much = lost as f64 > MOST_LOST * all as f64;
        is_much.then(|| {
            format!(
                "{lost} of {all} triangles collapse or turn over on the grid, which is too coarse: {advice}"
            )
        })
    }
}

fn steps(bits: u32) -> f64 {
    ((1_u64 << bits) - 1) as f64
}

struct Grid {
    origin: [f64; 3],
    /// Steps to a model unit.
    steps: f64,
}

impl Grid {
    fn cell(&self, position: [f64; 3]) -> [i64; 3] {
        std::array::from_fn(|axis| {
            ((position[axis] - self.origin[axis]) * self.steps).round_ties_even() as i64
        })
    }

    fn largest_error(&self, mesh: &TriMesh) -> f64 {
        let error = |&vertex: &u32| {
            let position = mesh.positions()[vertex as usize];
            let cell = self.cell(position);
            let off = |axis: usize| position[axis] - self.origin[axis] - cell[axis] as f64 / self.steps;
            (0..3).map(|axis| off(axis).powi(2)).sum::<f64>()
        };
        mesh.triangles().as_flattened().iter().map(error).fold(0.0, f64::max).sqrt()
    }

    fn triangles_lost(&self, mesh: &TriMesh) -> usize {
        let is_lost = |triangle: &&[u32; 3]| {
            let corners = triangle.map(|v| mesh.positions()[v as usize]);
            let cells = corners.map(|corner| self.cell(corner).map(|c| c as f64));
            let (before, after) = (cross(corners), cross(cells));
            let is_flat = before == [0.0; 3];
            !is_flat && (0..3).map(|axis| before[axis] * after[axis]).sum::<f64>() <= 0.0
        };
        mesh.triangles().iter().filter(is_lost).count()
    }
}

/// Twice the area of a triangle, along its normal.
fn cross([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    let [u, v] = [b, c].map(|p| -> [f64; 3] { std::array::from_fn(|axis| p[axis] - a[axis]) });
    std::array::from_fn(|axis| {
        let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
        u[next] * v[last] - u[last] * v[next]
    })
}
