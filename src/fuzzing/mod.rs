//! Bodies of the fuzz targets in `fuzz/`, shared with `tests/fuzz_regressions.rs`. Not part of the API.
//!
//! Each takes any bytes and panics if a promise of the library does not hold.

mod chunks;
mod tables;

pub use tables::ans;

use crate::bitstream::chunk::{self, kind};
use crate::bitstream::chunk_index::ChunkIndex;
use crate::bitstream::grid::{Grid, Lattice, MAX_QUANTIZATION_BITS, Spread};
use crate::bitstream::header::{Action, Header, Pass};
use crate::bitstream::pass_table;
use crate::bitstream::profile::Profile;
use crate::decoder::{Decoder, LevelMesh, Step, StreamInfo, Update};
use crate::descriptors::{Descriptor, Window};
use crate::encoder::{EncodeOptions, GridChoice, encode_with_attributes};
use crate::entropy::context_mixer::Mixing;
use crate::entropy::mixture::Mixture;
use crate::entropy::range_coder::{BitCoder, RangeDecoder, RangeEncoder};
use crate::entropy::residual::{CALLER_CONTEXTS, Expectation, NUM_KINDS, ResidualModel, SIGN_CONTEXTS};
use crate::error::{DecodeError, EncodeError};
use crate::io::{self, Format, TerrainOptions};
use crate::limits::Limits;
use crate::mesh::{
    Attribute, Attributes, Domain, NO_ENTRY, Semantic, Surface, TriMesh, Values, has_three_vertices,
};
use crate::passes::cost;
use crate::simplification::partition::Partition;
use crate::simplification::vertex_selection::Optimize;

const SMALL: Limits = Limits { max_memory: 64 << 20, max_vertices: 100_000, max_levels: 64, max_work: None };
/// Meshes up to here are walked after every pass, larger ones after the last.
const CHECKED_VERTICES: usize = 500;

/// Any bytes are a mesh, a coarser mesh, or an error that keeps the last mesh.
pub fn decode(data: &[u8]) {
    check_stream(&stream_from(data));
}

/// Chunks that are moved, doubled, left out, exchanged, renamed or changed are that, too. The first byte
/// counts the changes, three bytes each; a stream follows. Checksums, sizes and the index of trailing chunks
/// are repaired, so that damage reaches deep.
pub fn rearrange(data: &[u8]) {
    let Some((&head, rest)) = data.split_first() else { return };
    let Some((changes, stream)) = rest.split_at_checked(3 * usize::from(head % 16)) else { return };
    let mut stream = chunks::Stream::read(stream);
    changes.as_chunks::<3>().0.iter().for_each(|&change| stream.change(change));
    stream.mend(head & 16 == 0);
    check_stream(&stream.write());
}

fn check_stream(stream: &[u8]) {
    let _ = StreamInfo::read(stream);
    let mut decoder = Decoder::new(SMALL);
    if decoder.feed(stream).is_err() {
        return;
    }
    let mut good = None;
    loop {
        match decoder.step() {
            Ok(Some(_)) => {
                let Some(mesh) = decoder.mesh() else { panic!("an update without a mesh") };
                if mesh.num_vertices() <= CHECKED_VERTICES {
                    assert_valid(mesh);
                }
                good = Some(mesh.checksum());
            }
            Ok(None) => break,
            Err(_) => {
                assert_eq!(decoder.step(), Err(DecodeError::Failed));
                assert_eq!(decoder.feed(&[0]), Err(DecodeError::Failed));
                break;
            }
        }
    }
    assert_eq!(decoder.mesh().map(|m| m.checksum()), good);
    if let Some(mesh) = decoder.mesh() {
        assert_valid(mesh);
        assert_sound(mesh.to_tri_mesh());
    }
    if let Some(mesh) = decoder.mesh() {
        assert_fit(&decoder.attributes(), &mesh.to_manifold_mesh());
    }
    if let Some((preview, attributes)) = decoder.preview_with_attributes() {
        assert_fit(&attributes, &preview);
        if let Ok(Some(scene)) = io::Scene::unpack(&preview, &attributes) {
            scene.meshes.iter().for_each(|file| assert_fit(&file.attributes, &file.mesh));
        }
        assert_sound(preview);
    }
    let allowed = cost::earned(stream.len() as u64);
    assert!(decoder.work_done() <= allowed + (1 << 12), "{} units of {allowed}", decoder.work_done());
}

fn assert_fit(attributes: &Attributes, mesh: &TriMesh) {
    for attribute in &attributes.list {
        if let Err(error) = attribute.validate(mesh) {
            panic!("{}: {error}", attribute.name);
        }
    }
}

/// The same bytes, cut differently, give the same updates, meshes and error. The first eight bytes
/// choose the cuts.
pub fn split_independent(data: &[u8]) {
    let Some((seed, data)) = data.split_first_chunk::<8>() else { return };
    let stream = stream_from(data);
    // Memory depends on what a caller pushes at once, so it gets no part in this.
    let limits = Limits { max_memory: 1 << 32, ..SMALL };
    let (mut whole, mut cut) = (Trace::new(limits), Trace::new(limits));
    // Passes of the one rest, too.
    cut.work = 1 + u32::from(seed[0]);
    whole.push(&stream);
    let mut random = u64::from_le_bytes(*seed) | 1;
    let mut rest = &stream[..];
    while !rest.is_empty() {
        // xorshift64
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        let longest = [1, 5, 40, 1000][(random >> 60) as usize % 4];
        let (piece, after) = rest.split_at(rest.len().min(random as usize % (longest + 1)));
        cut.push(piece);
        rest = after;
    }
    assert_eq!(whole.updates, cut.updates);
    assert_eq!(whole.error, cut.error);
    assert_eq!(whole.decoder.is_complete(), cut.decoder.is_complete());
    if whole.error.is_none() {
        assert_eq!(whole.decoder.attribute_checksum(), cut.decoder.attribute_checksum());
    }
}

/// What a decoder reported while bytes were pushed.
struct Trace {
    decoder: Decoder,
    updates: Vec<(Update, Option<u32>)>,
    error: Option<DecodeError>,
    /// Units between two rests.
    work: u32,
}

impl Trace {
    fn new(limits: Limits) -> Self {
        Self { decoder: Decoder::new(limits), updates: Vec::new(), error: None, work: u32::MAX }
    }

    fn push(&mut self, bytes: &[u8]) {
        if self.error.is_some() {
            return;
        }
        let mut step = || {
            self.decoder.feed(bytes)?;
            loop {
                match self.decoder.step_within(self.work)? {
                    Step::Finished(update) => {
                        self.updates.push((update, self.decoder.mesh().map(|m| m.checksum())));
                    }
                    Step::Unfinished => {}
                    Step::Waiting => return Ok(()),
                }
            }
        };
        self.error = step().err();
    }
}

/// Any triangles over any points return exactly, cell by cell, through any options.
pub fn round_trip(data: &[u8]) {
    let mut input = Input(data);
    let options = options_from(&mut input);
    let seams = [input.u8(), input.u8()];
    let Some(mesh) = mesh_from(&mut input) else { return };
    let attributes = attributes_of(&mesh, seams, options.lossless);
    let encoded = match encode_with_attributes(&mesh, &attributes, &options, &|_| {}) {
        Ok(encoded) => encoded,
        Err(EncodeError::NoTriangles | EncodeError::BoundingBox | EncodeError::StepTooSmall { .. }) => return,
        Err(error) => panic!("{error}"),
    };
    let mut decoder = Decoder::new(Limits::default());
    if let Err(error) = decoder.feed(&encoded.bytes) {
        panic!("{error}");
    }
    loop {
        match decoder.step() {
            Ok(None) => break,
            Err(error) => panic!("{error}"),
            Ok(Some(_)) => {}
        }
        decoder.mesh().into_iter().for_each(assert_valid);
        let Some(level) = decoder.mesh() else { panic!("no mesh") };
        assert_fit(&decoder.attributes(), &level.to_manifold_mesh());
    }
    assert!(decoder.is_complete());
    let Some(decoded) = decoder.mesh() else { panic!("no mesh") };
    if !matches!(options.grid, GridChoice::Lattice(_)) {
        assert_eq!(decoded.quantization_bits(), options.quantization_bits);
    }
    let whole = decoded.to_tri_mesh();
    let bits =
        |mesh: &TriMesh| -> Vec<u64> { mesh.positions().iter().flatten().map(|x| x.to_bits()).collect() };
    if options.lossless && options.keep_order && options.keep_isolated && options.keep_degenerate {
        assert_eq!(bits(&whole), bits(&mesh));
        assert_eq!(whole.triangles(), mesh.triangles());
    }
    if !options.keep_isolated && !options.keep_degenerate {
        let usable = || mesh.triangles().iter().filter(|t| has_three_vertices(t));
        let mut used: Vec<u32> = usable().flatten().copied().collect();
        used.sort_unstable();
        used.dedup();
        assert_eq!((whole.num_vertices(), whole.num_triangles()), (used.len(), usable().count()));
        let wanted = match encoded.info.lattice() {
            None => quantized(&mesh, options.quantization_bits, encoded.info.side()),
            Some(lattice) => on_lattice(&mesh, lattice, encoded.info.lattice_offset()),
        };
        assert_eq!(cells_of(decoded), wanted);
    }
    let wanted = values_of(&mesh, &attributes);
    if options.lossless {
        let Some((whole, found)) = decoder.to_tri_mesh_with_attributes() else { panic!("no mesh") };
        assert_fit(&found, &whole);
        assert_eq!(values_of(&whole, &found), wanted);
    } else {
        assert_eq!(values_of(&decoded.to_manifold_mesh(), &decoder.attributes()), wanted);
    }
}

/// Attributes of every domain that decode exactly, any floats only if all bits are kept. The first number
/// says which, the second how often rows differ.
fn attributes_of(mesh: &TriMesh, [which, seams]: [u8; 2], is_lossless: bool) -> Attributes {
    let mix = |a: usize, b: usize| (a.wrapping_mul(2_654_435_761) ^ b.wrapping_mul(40_503)) >> 3;
    let every = 1 + usize::from(seams);
    let mut attributes = Attributes::default();
    if which & 1 != 0 {
        let values = (0..3 * mesh.num_vertices()).map(|k| (mix(k, 1) / every) as u8).collect();
        attributes.list.push(Attribute::new("c", Semantic::Color(0), Domain::Vertex, 3, Values::U8(values)));
    }
    if which & 2 != 0 {
        let value = |(t, v): (usize, &u32)| (mix(t / every, 2) as u8 & 3) ^ (*v as u8);
        let corners = mesh.triangles().iter().enumerate().flat_map(|(t, vs)| vs.iter().map(move |v| (t, v)));
        let values = Values::U8(corners.map(value).collect());
        let indices =
            (0..3 * mesh.num_triangles()).map(|k| if mix(k, 3) % 97 == 0 { NO_ENTRY } else { k as u32 });
        attributes.list.push(Attribute {
            indices: Some(indices.collect()),
            ..Attribute::new("w", Semantic::TexCoord(0), Domain::Corner, 1, values)
        });
    }
    if which & 4 != 0 {
        let names = (0..5).map(|k| format!("n{k}")).collect();
        let indices = (0..mesh.num_triangles()).map(|t| (mix(t / every, 4) % 5) as u32).collect();
        attributes.list.push(Attribute {
            indices: Some(indices),
            ..Attribute::new("m", Semantic::Material, Domain::Triangle, 1, Values::Names(names))
        });
    }
    if which & 8 != 0 {
        let values = (0..mesh.num_triangles()).map(|t| (mix(t, 5) / every) as i16 & 511).collect();
        attributes.list.push(Attribute::new(
            "f",
            Semantic::Generic,
            Domain::Triangle,
            1,
            Values::I16(values),
        ));
    }
    if which & 16 != 0 && is_lossless {
        let bits = |k: usize| (mix(k / every, 6) as u32).rotate_left(u32::from(which >> 5));
        let values = (0..9 * mesh.num_triangles()).map(|k| f32::from_bits(bits(k))).collect();
        attributes.list.push(Attribute::new("n", Semantic::Normal, Domain::Corner, 3, Values::F32(values)));
        let wide = |k: usize| f64::from_bits(u64::from(bits(k)) << 32 | u64::from(bits(k + 1)));
        let values = Values::F64((0..mesh.num_vertices()).map(wide).collect());
        attributes.list.push(Attribute::new("q", Semantic::Generic, Domain::Vertex, 1, values));
    }
    attributes
}

/// What all corners of the usable triangles have, in an order that does not depend on that of the triangles.
fn values_of(mesh: &TriMesh, attributes: &Attributes) -> Vec<Vec<Option<Vec<String>>>> {
    let value = |attribute: &Attribute, row: usize| match attribute.values.names() {
        Some(names) => vec![names[row].clone()],
        None => {
            let n = attribute.num_components;
            (row * n..row * n + n).map(|k| format!("{:?}", attribute.values.bits(k))).collect()
        }
    };
    let corner = |t: usize, c: usize| {
        let rows = attributes.list.iter().map(move |a| (a, a.entry_at_corner(mesh, t, c)));
        rows.map(|(a, row)| row.map(|row| value(a, row))).collect::<Vec<_>>()
    };
    let usable = |&t: &usize| has_three_vertices(&mesh.triangles()[t]);
    let turned = |t: usize| {
        let corners = [0, 1, 2].map(|c| corner(t, c));
        (0..3).map(|k| [0, 1, 2].map(|c| corners[(k + c) % 3].clone()).concat()).min().unwrap_or_default()
    };
    let mut all: Vec<_> = (0..mesh.num_triangles()).filter(usable).map(turned).collect();
    all.sort_unstable();
    all
}

/// Any bits under any probabilities, and any residuals under any densities, return.
pub fn range_coder(data: &[u8]) {
    let mut input = Input(data);
    if input.u8() % 2 == 0 {
        let bits: Vec<(bool, u32)> = std::iter::from_fn(|| {
            (!input.0.is_empty()).then(|| (input.u8() % 2 == 1, u32::from(input.u16()).max(1)))
        })
        .collect();
        let mut encoder = RangeEncoder::new();
        bits.iter().for_each(|&(bit, p1)| assert_eq!(encoder.code(bit, p1), bit));
        let bytes = encoder.finish();
        let mut decoder = RangeDecoder::new(&bytes);
        bits.iter().for_each(|&(bit, p1)| assert_eq!(decoder.code(false, p1), bit));
        assert!(!decoder.is_exhausted());
    } else {
        let mixing = if input.flag() { Mixing::Specialised } else { Mixing::Plain };
        let cases: Vec<Case> =
            std::iter::from_fn(|| (!input.0.is_empty()).then(|| Case::from(&mut input))).collect();
        let (mut encoder, mut model) = (RangeEncoder::new(), ResidualModel::new(mixing));
        for case in &cases {
            let coded = model.code(&mut encoder, &case.expectation, case.value);
            assert_eq!(coded, Some(case.value));
        }
        let bytes = encoder.finish();
        let (mut decoder, mut model) = (RangeDecoder::new(&bytes), ResidualModel::new(mixing));
        for case in &cases {
            assert_eq!(model.code(&mut decoder, &case.expectation, 0), Some(case.value));
        }
        assert!(!decoder.is_exhausted());
    }
}

/// A residual within the ranges that passes keep to.
struct Case {
    expectation: Expectation,
    value: i32,
}

impl Case {
    fn from(input: &mut Input) -> Self {
        let mut mixture = Mixture::default();
        let mut log_scales = [0.0; 4];
        for (i, log_scale) in log_scales.iter_mut().enumerate() {
            *log_scale = f32::from(input.u8() % 37) - 4.0;
            mixture.centre.0[i] = (input.u32() as i32 >> (input.u8() % 31)) as f32 / 3.0;
            mixture.sharpness.0[i] = (-*log_scale).exp2();
            mixture.weight.0[i] = 0.02 + f32::from(input.u8()) / 256.0;
        }
        let best = usize::from(input.u8()) % log_scales.len();
        let expectation = Expectation {
            origin: (input.u32() as i32) >> (2 + input.u8() % 29),
            mixture,
            best,
            log_scale: log_scales[best],
            kind: usize::from(input.u8()) % NUM_KINDS,
            contexts: [0; 2].map(|_| usize::from(input.u8()) % CALLER_CONTEXTS),
            sign: usize::from(input.u8()) % SIGN_CONTEXTS,
        };
        Self { expectation, value: (input.u32() as i32) >> (input.u8() % 31) }
    }
}

/// Any bytes as a file of `format` are a mesh with valid attributes or an error; both survive being written.
pub fn read_mesh(data: &[u8], format: Format) {
    let Ok(file) = io::read_bytes(data, format) else { return };
    for attribute in &file.attributes.list {
        attribute.validate(&file.mesh).expect("readers give valid attributes");
    }
    let mut bytes = Vec::new();
    let written = io::write_with_attributes_to(&mut bytes, &file.mesh, &file.attributes, format);
    let Ok(losses) = written else { return };
    let again = io::read_bytes(&bytes, format).expect("a written mesh is readable");
    assert_eq!(again.mesh.num_triangles(), file.mesh.num_triangles());
    // The others are rounded to float32.
    if matches!(format, Format::Obj | Format::Ply) {
        assert!(again.mesh == file.mesh, "a written mesh reads differently");
        for attribute in &file.attributes.list {
            let has_values =
                (0..attribute.domain.num_elements(&file.mesh)).any(|k| attribute.entry(k).is_some());
            let is_same = |other: &Attribute| {
                other.name == attribute.name && have_equal_values(&file.mesh, attribute, other)
            };
            let found = again.attributes.list.iter().any(is_same);
            let is_said = losses.iter().any(|loss| loss.subject.starts_with(&attribute.name));
            assert!(found || is_said || !has_values, "{} reads differently", attribute.name);
        }
    }
}

/// Any bytes as a point cloud are a surface or an error. The first byte chooses options.
pub fn read_terrain(data: &[u8]) {
    ignore_panics_of_laz();
    let (&choice, data) = data.split_first().unwrap_or((&0, data));
    let options = TerrainOptions {
        last_returns_only: choice & 1 != 0,
        cell_size: (choice & 2 != 0).then_some(f64::from(choice)),
        max_points: (choice & 4 != 0).then_some(usize::from(choice)),
        classes: (choice & 8 != 0).then(|| vec![choice >> 4, 2]),
        longest_edge: (choice & 16 != 0).then_some(f64::from(choice)),
    };
    let Ok(file) = io::read_terrain_bytes(data, &options) else { return };
    for attribute in &file.attributes.list {
        attribute.validate(&file.mesh).expect("readers give valid attributes");
    }
    assert!(options.max_points.is_none_or(|most| file.mesh.num_vertices() <= most));
}

/// The reader catches panics of that crate, but a fuzzer would end at the first.
fn ignore_panics_of_laz() {
    static ONCE: std::sync::Once = std::sync::Once::new();
    ONCE.call_once(|| {
        let hook = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            if !panic.location().is_some_and(|place| place.file().contains("/laz-")) {
                hook(panic);
            }
        }));
    });
}

/// Whether two attributes look the same from every corner, except for values that one of them lacks.
fn have_equal_values(mesh: &TriMesh, a: &Attribute, b: &Attribute) -> bool {
    let n = a.num_components;
    // Colours, and numbers where a format has no such type, are written in another type that has them, too.
    let is_same_type = a.values.component_type() == b.values.component_type();
    let number = |attribute: &Attribute, entry: usize, k: usize| {
        if is_same_type {
            attribute.values.bits(entry * n + k)
        } else {
            let float = attribute.number(entry, k)? as f32;
            Some(u64::from(if float.is_nan() { f32::NAN.to_bits() } else { float.to_bits() }))
        }
    };
    let value = |attribute: &Attribute, triangle: usize, corner: usize| {
        let entry = attribute.entry_at_corner(mesh, triangle, corner)?;
        let numbers: Vec<_> = (0..n).map(|k| number(attribute, entry, k)).collect();
        Some((numbers, attribute.values.names().map(|names| names[entry].clone())))
    };
    n == b.num_components
        && (0..3 * mesh.num_triangles()).all(|k| {
            let (a, b) = (value(a, k / 3, k % 3), value(b, k / 3, k % 3));
            a.is_none() || b.is_none() || a == b
        })
}

/// Panics unless indices are in range and coordinates finite.
fn assert_sound(mesh: TriMesh) {
    let (positions, triangles) = mesh.into_parts();
    let mesh = TriMesh::new(positions, triangles);
    assert!(mesh.is_ok(), "{:?}", mesh.err());
}

/// Panics unless the mesh is what [`LevelMesh`] promises.
fn assert_valid(mesh: LevelMesh) {
    let surface = Surface::from_triangles(mesh.triangles().to_vec(), mesh.num_vertices());
    assert!(surface.is_ok(), "{:?}", surface.err());
    let limit = 1 << mesh.quantization_bits();
    assert!(
        mesh.quantized_positions().iter().flatten().all(|c| (0..limit).contains(c)),
        "a cell off the grid"
    );
}

// ---- Streams from arbitrary bytes --------------------------------------------------------------

/// The first byte chooses: bytes as they are, chunks with lengths and checksums repaired, or a
/// framing made up around arbitrary payloads.
fn stream_from(data: &[u8]) -> Vec<u8> {
    match data.split_first() {
        None => Vec::new(),
        Some((mode, data)) => match mode % 3 {
            0 => data.to_vec(),
            1 => {
                let mut stream = chunks::Stream::read(data);
                stream.mend(false);
                stream.write()
            }
            _ => made_up(data),
        },
    }
}

/// A well-framed stream whose counts and payloads are the input.
fn made_up(data: &[u8]) -> Vec<u8> {
    let mut input = Input(data);
    let quantization_bits = 1 + u32::from(input.u8()) % MAX_QUANTIZATION_BITS;
    let base_bits = 1 + u32::from(input.u8()) % quantization_bits;
    let kinds = input.u8();
    let profile = kinds % 2;
    let grid = if kinds & 2 == 0 {
        Grid::cube(quantization_bits, [0.0; 3], 1.0)
    } else {
        let lattice = Lattice { origin: [0.1, 0.0, -5.0], step: [0.3, 1e-3, 70.0] };
        let offset = [-i64::from(kinds), 0, i64::from(kinds) << 40];
        Grid { quantization_bits, spread: Spread::Lattice { lattice, offset } }
    };
    let base = Pass {
        action: Action::Base { quantization_bits: base_bits },
        vertices: 3 + u32::from(input.u8()),
        triangles: 1 + u32::from(input.u16() % 512),
        bytes: 0,
    };
    let mut passes = vec![base];
    for _ in 0..input.u8() % 16 {
        let vertices = u32::from(input.u8());
        let on_boundary = u32::from(input.u8()).min(vertices);
        let (action, faces) =
            if vertices == 0 { (Action::Refine, 0) } else { (Action::Split, 2 * vertices - on_boundary) };
        passes.push(Pass { action, vertices, triangles: faces, bytes: 0 });
    }
    let mut payloads = Vec::new();
    for pass in &mut passes {
        let size = usize::from(input.u8()).min(input.0.len());
        let (payload, rest) = input.0.split_at(size);
        input.0 = rest;
        payloads.push(payload);
        pass.bytes = size as u32;
    }
    let mut piece = || {
        let size = usize::from(input.u8()).min(input.0.len());
        let (piece, rest) = input.0.split_at(size);
        input.0 = rest;
        piece
    };
    let stitching = piece();
    let trailing = [kind::LOOSE, kind::EXACT, kind::VALUES, kind::ORDER].map(|kind| (kind, piece()));
    let announced = ChunkIndex {
        stitching: if stitching.is_empty() { Vec::new() } else { vec![(0, stitching.len() as u32)] },
        trailing: trailing.map(|(kind, payload)| (kind, payload.len() as u32)).to_vec(),
    };
    let mut bytes = chunk::SIGNATURE.to_vec();
    bytes.push(chunk::VERSION);
    chunk::write(&mut bytes, kind::HEADER, &Header { grid, is_usual: true, profile }.write());
    chunk::write(&mut bytes, kind::ANNOUNCED, &announced.write());
    chunk::write(&mut bytes, kind::PASSES, &pass_table::write_passes(&passes));
    for (i, (pass, payload)) in passes.iter().zip(payloads).enumerate() {
        let kind = match pass.action {
            Action::Base { .. } => kind::BASE,
            Action::Split => kind::SPLIT,
            Action::Refine => kind::REFINE,
        };
        chunk::write(&mut bytes, kind, payload);
        if i == 0 && !stitching.is_empty() {
            chunk::write(&mut bytes, kind::STITCHING, stitching);
        }
    }
    trailing.iter().for_each(|(kind, payload)| chunk::write(&mut bytes, *kind, payload));
    bytes
}

// ---- Meshes from arbitrary bytes ---------------------------------------------------------------

/// Bytes taken off the front; zeros when they have run out.
struct Input<'a>(&'a [u8]);

impl Input<'_> {
    fn bytes<const N: usize>(&mut self) -> [u8; N] {
        let mut taken = [0; N];
        let there = self.0.len().min(N);
        taken[..there].copy_from_slice(&self.0[..there]);
        self.0 = &self.0[there..];
        taken
    }

    fn u8(&mut self) -> u8 {
        self.bytes::<1>()[0]
    }

    fn flag(&mut self) -> bool {
        self.u8() % 2 == 1
    }

    fn u16(&mut self) -> u16 {
        u16::from_le_bytes(self.bytes())
    }

    fn u32(&mut self) -> u32 {
        u32::from_le_bytes(self.bytes())
    }
}

fn options_from(input: &mut Input) -> EncodeOptions {
    EncodeOptions {
        descriptor: Descriptor::ALL[usize::from(input.u8()) % Descriptor::ALL.len()],
        partition: Partition::ALL[usize::from(input.u8()) % Partition::ALL.len()],
        quantization_bits: 1 + u32::from(input.u8()) % 30,
        levels: Some(u32::from(input.u8() % 16)).filter(|&levels| levels < 15),
        optimize: Optimize::ALL[usize::from(input.u8()) % Optimize::ALL.len()],
        steps_per_edge: Some(f64::from(1 + input.u8() % 64) * 0.5).filter(|&steps| steps > 2.0),
        lossless: input.flag(),
        keep_order: input.flag(),
        keep_isolated: input.flag(),
        keep_degenerate: input.flag(),
        window: Window { rings: 1 + u32::from(input.u8() % 4), ..Window::default() },
        growth: 1.0 + f64::from(input.u8() % 8),
        profile: Some(Profile::ALL[usize::from(input.u8()) % Profile::ALL.len()]),
        ..efforts_and_grids(input.u8())
    }
}

/// Where the grid was not always chosen, the number had no effect.
fn efforts_and_grids(number: u8) -> EncodeOptions {
    let size = f64::from(number / 9);
    let grid = match number / 3 % 5 {
        0 | 1 => GridChoice::Auto,
        2 => GridChoice::Cube,
        3 => GridChoice::step([0.1 + size, 0.3, 1e-3 * (size + 1.0)]),
        _ => GridChoice::Lattice(Lattice {
            origin: [1e3 * size, -0.1, size],
            step: [0.5, 1e9, 0.1].map(|s| s * (1.0 + size)),
        }),
    };
    EncodeOptions { effort: [5, 0, 9][usize::from(number) % 3], grid, ..EncodeOptions::default() }
}

/// Few vertices, so that triangles meet; their coordinates are of one of four kinds.
fn mesh_from(input: &mut Input) -> Option<TriMesh> {
    let num_vertices = 1 + usize::from(input.u8() % 96);
    let kind = input.u8() % 4;
    let mut coordinate = || match kind {
        0 => f64::from(input.u8() % 4),
        1 => f64::from(input.u8() as i8),
        2 => f64::from(f32::from_le_bytes(input.bytes())),
        _ => f64::from_le_bytes(input.bytes()),
    };
    let positions: Vec<[f64; 3]> = (0..num_vertices).map(|_| std::array::from_fn(|_| coordinate())).collect();
    let mut triangles = Vec::new();
    while !input.0.is_empty() {
        triangles.push(input.bytes::<3>().map(|v| u32::from(v) % num_vertices as u32));
    }
    TriMesh::new(positions, triangles).ok()
}

type CellTriangle = [[i32; 3]; 3];

/// Oriented triangles in grid cells, each from its smallest corner on, sorted.
fn canonical(triangles: impl Iterator<Item = CellTriangle>) -> Vec<CellTriangle> {
    let rotated =
        |[a, b, c]: CellTriangle| [[a, b, c], [b, c, a], [c, a, b]].into_iter().min().unwrap_or([a; 3]);
    let mut triangles: Vec<CellTriangle> = triangles.map(rotated).collect();
    triangles.sort_unstable();
    triangles
}

fn cells_of(mesh: LevelMesh) -> Vec<CellTriangle> {
    canonical(mesh.triangles().iter().map(|t| t.map(|v| mesh.quantized_positions()[v as usize])))
}

/// The usable triangles of `mesh` on a lattice, counted from a point of it.
fn on_lattice(mesh: &TriMesh, Lattice { origin, step }: Lattice, offset: [i64; 3]) -> Vec<CellTriangle> {
    let usable = mesh.triangles().iter().filter(|t| has_three_vertices(t));
    let cell = |v: u32| {
        let position = mesh.positions()[v as usize];
        let point = |a: usize| ((position[a] - origin[a]) / step[a] + 0.5).floor();
        std::array::from_fn(|a| (point(a) - offset[a] as f64) as i32)
    };
    canonical(usable.map(|t| t.map(cell)))
}

/// The usable triangles of `mesh` on the grid that the vertices they use span.
fn quantized(mesh: &TriMesh, quantization_bits: u32, side: f64) -> Vec<CellTriangle> {
    let usable = || mesh.triangles().iter().filter(|t| has_three_vertices(t));
    let at = |v: u32| mesh.positions()[v as usize];
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for p in usable().flatten().map(|&v| at(v)) {
        low = std::array::from_fn(|a| low[a].min(p[a]));
        high = std::array::from_fn(|a| high[a].max(p[a]));
    }
    let longest = (0..3).map(|a| high[a] - low[a]).fold(0.0, f64::max);
    let magnitude = low.iter().chain(&high).fold(longest, |m, x| m.max(x.abs()));
    assert!((side - longest).abs() <= 8.0 * f64::EPSILON * magnitude, "side {side} in place of {longest}");
    let steps = f64::from((1_u32 << quantization_bits) - 1);
    let cell = |v: u32| {
        std::array::from_fn(|a| {
            let offset = at(v)[a] - low[a];
            let product = offset * steps;
            // Only the largest doubles overflow.
            let scaled = if product.is_finite() { product / side } else { offset / side * steps };
            if side > 0.0 { (scaled + 0.5).floor() as i32 } else { 0 }
        })
    };
    canonical(usable().map(|t| t.map(cell)))
}
