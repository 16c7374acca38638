//! What an exact round trip is: the oriented triangles of the input, on the grid of
//! `format/SPEC.md`, computed here without the codec.
#![allow(dead_code)]

use lwc::{
    DecodeOptions, Decoder, EncodeOptions, Encoded, Lattice, LevelMesh, Limits, RepairReport, StreamInfo,
    TriMesh, decode, encode,
};

/// A triangle by the grid cells of its corners.
pub type CellTriangle = [[i64; 3]; 3];

/// The usable part of a mesh on a grid.
pub struct Quantized {
    /// Oriented triangles, each from its smallest corner on, sorted.
    pub triangles: Vec<CellTriangle>,
    /// Vertices that they use.
    pub used_vertices: usize,
    /// Triangles left out because they name a vertex twice.
    pub degenerate_triangles: usize,
}

/// g = floor((x − min)·(2^q − 1)/s + ½), min per axis and s the largest side, both over the vertices
/// that usable triangles use.
pub fn quantize(mesh: &TriMesh, quantization_bits: u32) -> Quantized {
    quantize_on(mesh, quantization_bits, None)
}

/// The same with the side of a stream, which may differ from the largest one by roundings of numbers as large
/// as the coordinates.
pub fn quantize_on(mesh: &TriMesh, quantization_bits: u32, side_of_stream: Option<f64>) -> Quantized {
    let usable: Vec<[u32; 3]> =
        mesh.triangles().iter().copied().filter(|&[a, b, c]| a != b && b != c && c != a).collect();
    let mut used: Vec<u32> = usable.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();

    // A power of two scales exactly; it keeps the products of huge coordinates finite.
    let largest =
        used.iter().flat_map(|&v| mesh.positions()[v as usize]).fold(0.0, |m: f64, c| m.max(c.abs()));
    let unit = if largest > 1e290 { 2f64.powi(-64) } else { 1.0 };
    let at = |v: u32| mesh.positions()[v as usize].map(|c| c * unit);
    let low: [f64; 3] =
        std::array::from_fn(|axis| used.iter().map(|&v| at(v)[axis]).fold(f64::INFINITY, f64::min));
    let high: [f64; 3] =
        std::array::from_fn(|axis| used.iter().map(|&v| at(v)[axis]).fold(f64::NEG_INFINITY, f64::max));
    let side = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max);
    let side = match side_of_stream.map(|side| side * unit) {
        Some(exact) => {
            let magnitude = low.iter().chain(&high).fold(side, |m: f64, c| m.max(c.abs()));
            assert!(
                (exact - side).abs() <= 8.0 * magnitude * f64::EPSILON,
                "side {exact} in place of {side}"
            );
            exact
        }
        None => side,
    };
    let steps = (2f64.powi(quantization_bits as i32)) - 1.0;
    let cell = |v: u32| -> [i64; 3] {
        std::array::from_fn(|axis| match side {
            0.0 => 0,
            _ => ((at(v)[axis] - low[axis]) * steps / side + 0.5).floor() as i64,
        })
    };
    Quantized {
        triangles: canonical(usable.iter().map(|t| t.map(cell))),
        used_vertices: used.len(),
        degenerate_triangles: mesh.num_triangles() - usable.len(),
    }
}

/// The same on the grid of a stream, whichever it is.
fn quantize_like(info: &StreamInfo, mesh: &TriMesh) -> Quantized {
    let in_cube = quantize_on(mesh, info.quantization_bits(), None);
    let Some(Lattice { origin, step }) = info.lattice() else {
        return quantize_on(mesh, info.quantization_bits(), Some(info.side()));
    };
    let cell = |v: u32| -> [i64; 3] {
        let p = mesh.positions()[v as usize];
        std::array::from_fn(|a| {
            ((p[a] - origin[a]) / step[a] + 0.5).floor() as i64 - info.lattice_offset()[a]
        })
    };
    let usable = mesh.triangles().iter().filter(|&&[a, b, c]| a != b && b != c && c != a);
    Quantized { triangles: canonical(usable.map(|t| t.map(cell))), ..in_cube }
}

/// Where the stream has a cell, to a few roundings.
fn place(info: &StreamInfo, cell: [i32; 3]) -> [f64; 3] {
    let steps = 2f64.powi(info.quantization_bits() as i32) - 1.0;
    let offset = info.lattice_offset();
    std::array::from_fn(|axis| match info.lattice() {
        None => info.origin()[axis] + f64::from(cell[axis]) / steps * info.side(),
        Some(Lattice { origin, step }) => {
            origin[axis] + (offset[axis] + i64::from(cell[axis])) as f64 * step[axis]
        }
    })
}

/// The triangles of a decoded mesh in the same form.
pub fn cell_triangles(mesh: LevelMesh) -> Vec<CellTriangle> {
    let cell = |v: u32| mesh.quantized_positions()[v as usize].map(i64::from);
    canonical(mesh.triangles().iter().map(|t| t.map(cell)))
}

/// Turns each triangle to its smallest corner, keeping the orientation, and sorts.
pub fn canonical(triangles: impl Iterator<Item = CellTriangle>) -> Vec<CellTriangle> {
    let mut triangles: Vec<CellTriangle> = triangles
        .map(|[a, b, c]| [[a, b, c], [b, c, a], [c, a, b]].into_iter().min().expect("three rotations"))
        .collect();
    triangles.sort_unstable();
    triangles
}

/// Encodes, decodes and compares.
#[track_caller]
pub fn assert_round_trip(mesh: &TriMesh, options: &EncodeOptions, what: &str) -> Encoded {
    let encoded = match encode(mesh, options) {
        Ok(encoded) => encoded,
        Err(error) => panic!("{what}: {error}"),
    };
    assert_exact(mesh, options.quantization_bits, &encoded.bytes, &encoded.repair, what);
    encoded
}

/// The finest mesh of the stream holds every usable triangle of `mesh`, and nothing else.
#[track_caller]
pub fn assert_exact(
    mesh: &TriMesh,
    quantization_bits: u32,
    stream: &[u8],
    report: &RepairReport,
    what: &str,
) {
    let mut decoder = Decoder::new(Limits::default());
    if let Err(error) = decoder.push(stream) {
        panic!("{what}: {error}");
    }
    assert!(decoder.is_complete(), "{what}: passes are missing");
    let decoded = decoder.mesh().expect("a complete stream has a mesh");
    let info = decoder.info().expect("a complete stream has a table");
    let wanted = quantize_like(info, mesh);
    assert_eq!(decoded.quantization_bits(), quantization_bits, "{what}");
    assert_eq!(report.degenerate_triangles, wanted.degenerate_triangles, "{what}");
    assert_eq!(report.isolated_vertices, mesh.num_vertices() - wanted.used_vertices, "{what}");
    assert_eq!(decoded.num_vertices(), wanted.used_vertices + report.repeated_vertices, "{what}");
    assert_eq!(decoded.num_triangles(), wanted.triangles.len(), "{what}");
    assert!(cell_triangles(decoded) == wanted.triangles, "{what}: other triangles");

    // Positions in model units are those of the cells, in the view and in the one-shot result.
    let magnitude = info.origin().iter().fold(info.side(), |m, o| m.max(o.abs()));
    for (position, cell) in decoded.positions().into_iter().zip(decoded.quantized_positions()) {
        for (axis, wanted) in place(info, *cell).into_iter().enumerate() {
            // A handful of roundings of numbers up to `magnitude`, or of the smallest numbers.
            let tolerance = magnitude * 1e-15 + 1e-322;
            assert!((position[axis] - wanted).abs() <= tolerance, "{what}: {position:?} off the grid");
        }
    }
    let one_shot = decode(stream, DecodeOptions::new()).expect("decoded a moment ago");
    assert_eq!(one_shot, decoded.to_tri_mesh(), "{what}");
    assert_eq!(one_shot.num_vertices(), wanted.used_vertices, "{what}");
    assert_eq!(one_shot.num_triangles(), wanted.triangles.len(), "{what}");
}
