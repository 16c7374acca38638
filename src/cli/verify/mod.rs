//! `lwc encode --verify`: the stream decodes to the mesh on the grid, and to what else the options promise.
//!
//! Grid and comparison are written a second time here, so that encoder and decoder cannot agree on a mistake.

mod attributes;
mod exact;
mod grid;
mod triangle;

use super::bar::Part;
use super::exit::Failure;
use grid::{Cell, ExpectedGrid};
use lwc::io::MeshFile;
use lwc::{Decoder, EncodeOptions, Encoded, Limits, StreamInfo, TriMesh};
use std::hash::{DefaultHasher, Hash, Hasher};
use triangle::{is_usable, turned};

/// Sizes of the pieces that the decoder gets, over and over: one byte, and lengths that divide nothing.
const PIECES: [usize; 6] = [1, 3, 17, 997, 65_521, 7];

/// Compares the triangles of the decoded stream with those of `mesh`, as multisets of oriented triples of
/// grid cells, and the vertices, each with all its triangles; with the options for it coordinates bit for bit
/// and the order.
///
/// Returns in words what was compared.
///
/// # Errors
/// If anything differs.
pub fn verify(
    file: &MeshFile,
    options: &EncodeOptions,
    encoded: &Encoded,
    part: Part,
) -> Result<String, Failure> {
    let (mesh, attributes) = (&file.mesh, &file.attributes);
    let check = || {
        let decoder = decode(encoded, part.between(0.0, 0.5))?;
        let expected = Quantized::new(mesh, options, &encoded.info);
        compare_surface(&expected, encoded, &decoder)?;
        part.set(0.7);
        let (decoded, found) = decoder.to_tri_mesh_with_attributes().ok_or("there is no mesh")?;
        compare_whole(&kept(mesh, options), &decoded, &expected, options)?;
        part.set(0.8);
        let cells: Vec<Cell> = mesh.positions().iter().map(|&p| expected.grid.cell(p)).collect();
        attributes::compare(mesh, attributes, &cells, options, &decoder)?;
        if found.scene != attributes.scene || found.gltf_materials != attributes.gltf_materials {
            return Err("the scene or its materials differ".to_owned());
        }
        part.set(0.9);
        if options.lossless {
            exact::compare((mesh, attributes), (&decoded, &found), options)?;
        }
        part.set(1.0);
        Ok(())
    };
    check().map_err(Failure::Verification)?;
    Ok(in_words(!attributes.list.is_empty(), options))
}

/// `all triangles, positions on the grid, attributes to the step of their bits, order`.
fn in_words(has_attributes: bool, options: &EncodeOptions) -> String {
    let positions = if options.lossless { "positions bit for bit" } else { "positions on the grid" };
    let values =
        if options.lossless { "attributes bit for bit" } else { "attributes to the step of their bits" };
    let all = [
        Some("all triangles"),
        Some(positions),
        has_attributes.then_some(values),
        options.keep_order.then_some("order"),
    ];
    all.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

fn decode(encoded: &Encoded, part: Part) -> Result<Decoder, String> {
    // These bytes are our own: no limits.
    let limits =
        Limits { max_memory: u64::MAX, max_vertices: u32::MAX, max_levels: u32::MAX, max_work: None };
    let mut decoder = Decoder::new(limits);
    let mut rest = &encoded.bytes[..];
    let mut passes = encoded.info.passes().iter();
    for size in PIECES.into_iter().cycle() {
        let (piece, after) = rest.split_at(size.min(rest.len()));
        rest = after;
        decoder.feed(piece).map_err(|e| e.to_string())?;
        while let Some(update) = decoder.step().map_err(|e| e.to_string())? {
            let pass = passes.next().ok_or("there are more passes than announced")?;
            let mesh = decoder.mesh().ok_or("there is no mesh after a pass")?;
            let found = (mesh.num_vertices(), mesh.num_triangles(), mesh.level(), mesh.quantization_bits());
            let expected =
                (pass.vertices as usize, pass.triangles as usize, pass.level, pass.quantization_bits);
            if update.pass != *pass || found != expected {
                let kind = pass.kind.name();
                return Err(format!("the {kind} pass that ends at byte {} gives another mesh", pass.end));
            }
        }
        part.set(1.0 - rest.len() as f64 / encoded.bytes.len() as f64);
        if rest.is_empty() {
            break;
        }
    }
    if !decoder.is_complete() || passes.next().is_some() {
        return Err("the stream is incomplete".into());
    }
    Ok(decoder)
}

fn compare_surface(expected: &Quantized, encoded: &Encoded, decoder: &Decoder) -> Result<(), String> {
    let decoded = decoder.mesh().ok_or("there is no mesh")?;
    let info = &encoded.info;
    if !expected.grid.is_that_of(info) || decoded.quantization_bits() != info.quantization_bits() {
        return Err("the grid differs".into());
    }
    let num_vertices = expected.num_vertices + encoded.repair.repeated_vertices;
    if decoded.num_vertices() != num_vertices {
        return Err(format!("{} vertices in place of {num_vertices}", decoded.num_vertices()));
    }
    if decoded.num_triangles() != expected.triangles.len() {
        let (found, wanted) = (decoded.num_triangles(), expected.triangles.len());
        return Err(format!("{found} triangles in place of {wanted}"));
    }
    let cells = decoded.quantized_positions();
    let found = sorted(decoded.triangles().iter().map(|t| t.map(|v| cells[v as usize])));
    let differing = num_missing(&expected.triangles, &found);
    if differing > 0 {
        return Err(format!("{differing} of {} triangles are missing", found.len()));
    }
    Ok(())
}

/// Compares all vertices and triangles, without their order or with it.
fn compare_whole(
    mesh: &TriMesh,
    decoded: &TriMesh,
    grid: &Quantized,
    options: &EncodeOptions,
) -> Result<(), String> {
    let sizes = |mesh: &TriMesh| (mesh.num_vertices(), mesh.num_triangles());
    if sizes(mesh) != sizes(decoded) {
        let ((v, f), (n, m)) = (sizes(decoded), sizes(mesh));
        return Err(format!("{v} vertices and {f} triangles in place of {n} and {m}"));
    }
    let place = |p: [f64; 3]| match options.lossless {
        true => p.map(f64::to_bits),
        false => grid.grid.cell(p).map(|c| c as u64),
    };
    let [wanted, found]: [Vec<[u64; 3]>; 2] =
        [mesh, decoded].map(|mesh| mesh.positions().iter().map(|&p| place(p)).collect());
    if options.keep_order && (wanted != found || mesh.triangles() != decoded.triangles()) {
        return Err("the order of vertices or triangles differs".into());
    }
    if (options.lossless || grid.grid.is_told_by_places()) && stars(mesh, &wanted) != stars(decoded, &found) {
        return Err("vertices have other triangles".into());
    }
    Ok(())
}

/// What a stream keeps of a mesh.
fn kept(mesh: &TriMesh, options: &EncodeOptions) -> TriMesh {
    let is_kept = |t: &&[u32; 3]| options.keep_degenerate || is_usable(t);
    let triangles: Vec<[u32; 3]> = mesh.triangles().iter().filter(is_kept).copied().collect();
    let mut is_named = vec![options.keep_isolated; mesh.num_vertices()];
    triangles.iter().flatten().for_each(|&v| is_named[v as usize] = true);
    let mut name = vec![0; mesh.num_vertices()];
    let vertices = (0..mesh.num_vertices()).filter(|&v| is_named[v]);
    let positions: Vec<[f64; 3]> = vertices
        .enumerate()
        .map(|(i, v)| {
            name[v] = i as u32;
            mesh.positions()[v]
        })
        .collect();
    let triangles = triangles.into_iter().map(|t| t.map(|v| name[v as usize])).collect();
    TriMesh::new(positions, triangles).unwrap_or_default()
}

/// For each vertex a hash of its place and of the places of all its triangles, sorted.
fn stars(mesh: &TriMesh, places: &[[u64; 3]]) -> Vec<u64> {
    let hash = |what: &dyn Fn(&mut DefaultHasher)| {
        let mut hasher = DefaultHasher::new();
        what(&mut hasher);
        hasher.finish()
    };
    let mut stars: Vec<u64> = places.iter().map(|place| hash(&|h| place.hash(h))).collect();
    for &[a, b, c] in mesh.triangles() {
        for [v, n, p] in [[a, b, c], [b, c, a], [c, a, b]] {
            let corner = hash(&|h| (places[n as usize], places[p as usize]).hash(h));
            stars[v as usize] = stars[v as usize].wrapping_add(corner);
        }
    }
    stars.sort_unstable();
    stars
}

/// A mesh on the grid.
struct Quantized {
    grid: ExpectedGrid,
    /// Vertices that usable triangles have.
    num_vertices: usize,
    /// Usable triangles, see [`sorted`].
    triangles: Vec<[Cell; 3]>,
}

impl Quantized {
    fn new(mesh: &TriMesh, options: &EncodeOptions, info: &StreamInfo) -> Self {
        let usable = || mesh.triangles().iter().filter(|t| is_usable(t));
        let mut is_used = vec![false; mesh.num_vertices()];
        usable().flatten().for_each(|&vertex| is_used[vertex as usize] = true);
        let grid = ExpectedGrid::new(kept(mesh, options).positions(), options, info);
        let cell = |vertex: u32| grid.cell(mesh.positions()[vertex as usize]);
        let triangles = sorted(usable().map(|t| t.map(cell)));
        Self { num_vertices: is_used.iter().filter(|&&used| used).count(), triangles, grid }
    }
}

/// Triangles in an order that depends on nothing but the multiset of oriented triangles: each begins with
/// the corner that makes it smallest.
fn sorted(triangles: impl Iterator<Item = [Cell; 3]>) -> Vec<[Cell; 3]> {
    let mut triangles: Vec<_> = triangles.map(turned).collect();
    triangles.sort_unstable();
    triangles
}

/// How many of `wanted` are not in `found`, both sorted.
fn num_missing(wanted: &[[Cell; 3]], found: &[[Cell; 3]]) -> usize {
    let mut found = found.iter().peekable();
    let is_missing = |triangle: &&[Cell; 3]| {
        while found.next_if(|f| f < triangle).is_some() {}
        found.next_if_eq(triangle).is_none()
    };
    wanted.iter().filter(is_missing).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::bar::Bar;
    use crate::cli::screen::Screen;

    fn bumpy_grid() -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
        let n = 12_u32;
        let height = |i: u32, j: u32| (f64::from(i) * 0.7).sin() * f64::from(j) * 0.1;
        let positions =
            (0..n * n).map(|v| (v / n, v % n)).map(|(i, j)| [f64::from(i), f64::from(j), height(i, j)]);
        let quad = |v: u32| [[v, v + n, v + n + 1], [v, v + n + 1, v + 1]];
        let inner = (0..n * n).filter(|v| v / n + 1 < n && v % n + 1 < n);
        (positions.collect(), inner.flat_map(quad).collect())
    }

    fn mesh(positions: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>) -> TriMesh {
        TriMesh::new(positions, triangles).unwrap()
    }

    fn verify(mesh: &TriMesh, quantization_bits: u32, encoded: &Encoded) -> Result<String, Failure> {
        let mut options = EncodeOptions::default();
        options.quantization_bits = quantization_bits;
        verify_with(mesh, &options, encoded)
    }

    fn verify_with(mesh: &TriMesh, options: &EncodeOptions, encoded: &Encoded) -> Result<String, Failure> {
        let mut file = MeshFile::default();
        file.mesh = mesh.clone();
        let bar = Bar::new(&Screen::default(), false);
        let [part] = bar.split([("verifying", 1.0)]);
        super::verify(&file, options, encoded, part)
    }

    fn encoded(mesh: &TriMesh) -> Encoded {
        lwc::encode(mesh, &EncodeOptions::default()).unwrap()
    }

    #[test]
    fn what_options_promise_is_looked_at() {
        let (mut positions, mut triangles) = bumpy_grid();
        positions.push([1e3, 0.0, -0.0]);
        triangles.extend([[0, 0, 144], [0, 12, 30]]);
        let mesh = mesh(positions, triangles);
        let mut options = EncodeOptions::default();
        let without = encoded(&mesh);
        (options.lossless, options.keep_order) = (true, true);
        assert!(verify_with(&mesh, &options, &without).is_err());
        (options.keep_isolated, options.keep_degenerate) = (true, true);
        verify_with(&mesh, &options, &lwc::encode(&mesh, &options).unwrap()).unwrap();
        options.keep_order = false;
        verify_with(&mesh, &options, &lwc::encode(&mesh, &options).unwrap()).unwrap();
        assert!(verify_with(&mesh, &options, &without).is_err());
    }

    #[test]
    fn a_stream_is_its_mesh_with_unusable_things_left_out() {
        let (mut positions, mut triangles) = bumpy_grid();
        positions.push([1e6, 0.0, 0.0]);
        triangles.extend([[0, 0, 144], [0, 12, 30]]);
        let mesh = mesh(positions, triangles);
        verify(&mesh, 12, &encoded(&mesh)).unwrap();
    }

    #[test]
    fn a_stream_of_another_mesh_is_found_out() {
        let (positions, triangles) = bumpy_grid();
        let right = encoded(&mesh(positions.clone(), triangles.clone()));
        let fails = |positions: Vec<_>, triangles: Vec<_>, quantization_bits, part: &str| {
            let error =
                verify(&mesh(positions, triangles), quantization_bits, &right).unwrap_err().to_string();
            assert!(error.contains(part), "{error}");
        };
        let mut moved = positions.clone();
        moved[40][2] += 0.05;
        fails(moved, triangles.clone(), 12, "6 of 242 triangles are missing");
        let mut shifted = positions.clone();
        shifted.iter_mut().for_each(|p| p[0] += 1.0);
        fails(shifted, triangles.clone(), 12, "grid");
        fails(positions.clone(), triangles.clone(), 11, "grid");
        let mut flipped = triangles.clone();
        flipped[7].swap(0, 1);
        fails(positions.clone(), flipped, 12, "1 of 242 triangles are missing");
        fails(positions, [&triangles[..], &triangles[3..4]].concat(), 12, "in place of");
    }

    #[test]
    fn a_damaged_or_cut_stream_is_found_out() {
        let (positions, triangles) = bumpy_grid();
        let mesh = mesh(positions, triangles);
        let mut cut = encoded(&mesh);
        cut.bytes.pop();
        assert!(verify(&mesh, 12, &cut).unwrap_err().to_string().contains("incomplete"));
        let mut damaged = encoded(&mesh);
        *damaged.bytes.last_mut().unwrap() ^= 1;
        assert!(verify(&mesh, 12, &damaged).is_err());
    }
}
