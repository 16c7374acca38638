//! Streams that every version must decode to the same bits: `format/golden/*.lwc`, with the mesh after
//! each pass in `format/golden/checksums.txt`.
//!
//! Once the format is frozen a changed checksum is a broken promise. Until then, or for new streams:
//!
//! ```text
//! LWC_UPDATE_GOLDEN=1 cargo test --test golden
//! ```
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

mod common;

use common::chunks;
use common::valid::assert_valid;
use lwc::mesh::ComponentType;
use lwc::{Decoder, Limits, PassKind, StreamInfo};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("format/golden")
}

/// Those of the profile fast have a folder of their own: not every decoder reads them.
#[cfg(feature = "fast")]
fn fast_folder() -> PathBuf {
    folder().join("fast")
}

/// Names and bytes, sorted by name; made anew first if that is wanted.
fn streams() -> Vec<(String, Vec<u8>)> {
    #[cfg(feature = "encoder")]
    make::update_if_wanted();
    let streams = streams_in(&folder());
    assert!(streams.len() >= 10, "only {} golden streams", streams.len());
    streams
}

fn streams_in(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut streams: Vec<(String, Vec<u8>)> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "lwc"))
        .map(|path| {
            let name = path.file_name().unwrap().to_str().unwrap().to_owned();
            (name, std::fs::read(&path).unwrap())
        })
        .collect();
    streams.sort();
    streams
}

const HEADING: &str = "# file, pass, kind, level, quantization bits, vertices, triangles, checksum of the mesh after the pass\n";

/// The lines of `checksums.txt` for one stream.
fn lines_of(name: &str, stream: &[u8]) -> String {
    let mut decoder = Decoder::new(Limits::default());
    decoder.feed(stream).unwrap();
    let (mut lines, mut pass) = (String::new(), 0);
    while let Some(update) = decoder.step().unwrap_or_else(|error| panic!("{name}: {error}")) {
        let mesh = decoder.mesh().unwrap();
        assert_valid(mesh, name);
        let kind = update.pass.kind.name();
        let (level, quantization_bits) = (mesh.level(), mesh.quantization_bits());
        let (vertices, faces) = (mesh.num_vertices(), mesh.num_triangles());
        let checksum = mesh.checksum();
        writeln!(lines, "{name} {pass} {kind} {level} {quantization_bits} {vertices} {faces} {checksum:08x}")
            .unwrap();
        if mesh.has_shrinkage_compensation() {
            let checksum = checksum_of_whole(&mesh.to_manifold_mesh());
            writeln!(
                lines,
                "{name} {pass} shown {level} {quantization_bits} {vertices} {faces} {checksum:08x}"
            )
            .unwrap();
        }
        pass += 1;
    }
    assert!(decoder.is_complete(), "{name} is not complete");
    if chunks::split(stream).iter().any(|chunk| chunk.kind == b't') {
        let mesh = decoder.mesh().unwrap();
        let (level, quantization_bits, whole) = (mesh.level(), mesh.quantization_bits(), mesh.to_tri_mesh());
        let (vertices, faces) = (whole.num_vertices(), whole.num_triangles());
        let checksum = checksum_of_whole(&whole);
        writeln!(lines, "{name} {pass} whole {level} {quantization_bits} {vertices} {faces} {checksum:08x}")
            .unwrap();
    }
    lines
}

/// Section 9.2: counts, positions, triangles.
fn checksum_of_whole(mesh: &lwc::TriMesh) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(&(mesh.num_vertices() as u32).to_le_bytes());
    hasher.update(&(mesh.num_triangles() as u32).to_le_bytes());
    mesh.positions().iter().flatten().for_each(|x| hasher.update(&x.to_le_bytes()));
    mesh.triangles().iter().flatten().for_each(|v| hasher.update(&v.to_le_bytes()));
    hasher.finalize()
}

#[test]
fn every_golden_stream_decodes_to_its_checksums() {
    check(&streams(), &folder());
}

#[cfg(feature = "fast")]
#[test]
fn every_fast_golden_stream_decodes_to_its_checksums() {
    // Made anew, if that is wanted, with the others.
    streams();
    let streams = streams_in(&fast_folder());
    assert!(streams.len() >= 9, "only {} golden streams", streams.len());
    check(&streams, &fast_folder());
}

fn check(streams: &[(String, Vec<u8>)], folder: &Path) {
    let recorded = std::fs::read_to_string(folder.join("checksums.txt")).unwrap();
    let mut found = HEADING.to_owned();
    for (name, stream) in streams {
        found += &lines_of(name, stream);
    }
    for (found, recorded) in found.lines().zip(recorded.lines()) {
        assert_eq!(found, recorded);
    }
    assert_eq!(found.lines().count(), recorded.lines().count());
}

/// The lines of `attributes.txt` for one stream: a checksum after each pass and the values behind it.
fn attribute_lines_of(name: &str, stream: &[u8]) -> String {
    let info = StreamInfo::read(stream).unwrap().unwrap();
    let mut lines = String::new();
    if info.attributes().is_empty() {
        return lines;
    }
    for (pass, end) in info.passes().iter().map(|pass| pass.end as usize).enumerate() {
        let mut decoder = Decoder::new(Limits::default());
        decoder.push(&stream[..end]).unwrap();
        let (mesh, attributes) = decoder.to_tri_mesh_with_attributes().unwrap();
        assert!(attributes.list.iter().all(|attribute| attribute.validate(&mesh).is_ok()), "{name}");
        writeln!(lines, "{name} {pass} {:08x}", decoder.attribute_checksum()).unwrap();
    }
    let mut decoder = Decoder::new(Limits::default());
    decoder.push(stream).unwrap();
    writeln!(lines, "{name} end {:08x}", checksum_of_values(&decoder)).unwrap();
    lines
}

/// Section 9.2: what the elements of the assembled mesh have.
fn checksum_of_values(decoder: &Decoder) -> u32 {
    let (mesh, attributes) = decoder.to_tri_mesh_with_attributes().unwrap();
    let mut hasher = crc32fast::Hasher::new();
    for attribute in &attributes.list {
        for element in 0..attribute.domain.num_elements(&mesh) {
            let Some(row) = attribute.entry(element) else {
                hasher.update(&[0]);
                continue;
            };
            hasher.update(&[1]);
            if let Some(names) = attribute.values.names() {
                hasher.update(&(names[row].len() as u32).to_le_bytes());
                hasher.update(names[row].as_bytes());
            }
            let size = attribute.values.component_type().map_or(0, ComponentType::num_bytes);
            let n = attribute.num_components;
            for bits in (row * n..(row + 1) * n).filter_map(|k| attribute.values.bits(k)) {
                hasher.update(&bits.to_le_bytes()[..size]);
            }
        }
    }
    hasher.finalize()
}

#[test]
fn the_attributes_of_every_golden_stream_decode_to_their_checksums() {
    check_attributes(&streams(), &folder());
}

#[cfg(feature = "fast")]
#[test]
fn the_attributes_of_every_fast_golden_stream_decode_to_their_checksums() {
    streams();
    check_attributes(&streams_in(&fast_folder()), &fast_folder());
}

fn check_attributes(streams: &[(String, Vec<u8>)], folder: &Path) {
    let recorded = std::fs::read_to_string(folder.join("attributes.txt")).unwrap();
    let found: String = streams.iter().map(|(name, stream)| attribute_lines_of(name, stream)).collect();
    assert_eq!(found, recorded);
    assert!(found.lines().count() > 10);
}

#[test]
fn the_golden_streams_are_small() {
    for (name, stream) in streams() {
        assert!(stream.len() < 3000, "{name}: {} bytes", stream.len());
    }
}

/// Each part of the syntax occurs in some stream.
#[test]
fn the_golden_streams_cover_the_syntax() {
    let mut seen: BTreeMap<&str, bool> = BTreeMap::new();
    for (_, stream) in streams() {
        let chunks = chunks::split(&stream);
        let info = StreamInfo::read(&stream).unwrap().unwrap();
        let payload = |kind| &chunks.iter().find(|c| c.kind == kind).unwrap().payload;
        let rows = chunks::read_table(payload(b'L'));
        let kinds: Vec<PassKind> = info.passes().iter().map(|p| p.kind).collect();
        let is_padded = |i: usize, row: &chunks::Row| {
            let touched = if row.head == [0] { info.passes()[i].vertices } else { row.head[0] };
            i > 0 && row.size > 0 && row.size == touched.div_ceil(64) - 1
        };
        let exact = |head: &[u8]| chunks.iter().any(|c| c.kind == b'x' && c.payload.starts_with(head));
        let is_in_front = |chunks: &[chunks::Chunk], kind| {
            let place = |kind| chunks.iter().position(|c| c.kind == kind);
            place(kind).is_some_and(|m| Some(m) < place(b'L'))
        };
        let last_split = kinds.iter().rposition(|&k| k == PassKind::Split);
        for (feature, is_there) in [
            ("narrow header", payload(b'H')[0] & 1 == 0),
            ("wide header", payload(b'H')[0] & 1 == 1),
            ("cube", payload(b'H')[0] & 16 == 0),
            ("lattice from its origin on", payload(b'H')[0] & 48 == 16),
            ("lattice with an offset", payload(b'H')[0] & 49 == 49),
            ("narrow lattice with an offset", payload(b'H')[0] & 49 == 48),
            ("lattice and exact coordinates", payload(b'H')[0] & 16 > 0 && exact(&[])),
            ("lattice and compensation", payload(b'H')[0] & 16 > 0 && chunks.iter().any(|c| c.kind == b'c')),
            ("30 bits", info.quantization_bits() == 30),
            ("provenance in the header", payload(b'H')[0] & 2 == 2),
            ("provenance in a chunk", chunks.iter().any(|c| c.kind == b'p')),
            ("no provenance", info.descriptor_code().is_none()),
            ("balanced", info.partition_code() == Some(0)),
            ("algorithm1", info.partition_code() == Some(1)),
            ("base only", kinds == [PassKind::Base]),
            ("boundary vertices", rows.iter().skip(1).any(|r| r.head.len() == 2 && r.head[1] > 0)),
            ("all inside", rows.iter().skip(1).any(|r| r.head.len() == 2 && r.head[1] == 0)),
            (
                "refinement before a split",
                last_split.is_some_and(|last| kinds[..last].contains(&PassKind::Refine)),
            ),
            ("refinement last", kinds.last() == Some(&PassKind::Refine)),
            ("padding", rows.iter().enumerate().any(|(i, row)| is_padded(i, row))),
            ("attributes", chunks.iter().any(|c| c.kind == b'd') && chunks.iter().any(|c| c.kind == b'a')),
            ("unknown chunk", chunks.iter().any(|c| !b"HpdnmkLBSRatgixvo".contains(&c.kind))),
            ("stitching in the base mesh", chunks.iter().filter(|c| c.kind == b'g').count() == 1),
            ("stitching in splits", chunks.iter().filter(|c| c.kind == b'g').count() > 1),
            ("loose", chunks.iter().any(|c| c.kind == b'i')),
            ("exact floats", exact(&[0, 0])),
            ("exact doubles", exact(&[1, 0])),
            ("exact decimals", chunks.iter().any(|c| c.kind == b'x' && (1..32).contains(&c.payload[1]))),
            ("exact binary fractions", chunks.iter().any(|c| c.kind == b'x' && c.payload[1] >= 32)),
            ("exact values", chunks.iter().any(|c| c.kind == b'v' && c.payload.starts_with(&[1]))),
            ("order", chunks.iter().any(|c| c.kind == b'o')),
            ("scene", chunks.iter().any(|c| c.kind == b'n')),
            ("metadata", chunks.iter().any(|c| c.kind == b'k')),
            ("materials in front", is_in_front(&chunks, b'm')),
            ("materials behind", chunks.iter().any(|c| c.kind == b'm') && !is_in_front(&chunks, b'm')),
        ] {
            *seen.entry(feature).or_default() |= is_there;
        }
    }
    let missing: Vec<&str> =
        seen.into_iter().filter(|&(_, is_there)| !is_there).map(|(name, _)| name).collect();
    assert!(missing.is_empty(), "no golden stream has: {missing:?}");
}

#[cfg(feature = "encoder")]
mod make {
    use super::common::chunks::{self, Chunk};
    use super::common::kinds::beside;
    use super::common::*;
    use lwc::descriptors::Descriptor;
    use lwc::mesh::{
        Attribute, ComponentType, Domain, GltfMaterials, IDENTITY, Instance, NO_ENTRY, SceneTable, Semantic,
        Values,
    };
    use lwc::{
        EncodeOptions, GridChoice, Lattice, Partition, Profile, TriMesh, encode, encode_with_attributes,
    };
    use std::path::Path;
    use std::sync::Once;

    /// Writes all streams and their checksums, once, if `LWC_UPDATE_GOLDEN` is set.
    pub fn update_if_wanted() {
        static ONCE: Once = Once::new();
        ONCE.call_once(|| {
            if std::env::var_os("LWC_UPDATE_GOLDEN").is_some() {
                update();
            }
        });
    }

    fn update() {
        write(all(), &super::folder());
        #[cfg(feature = "fast")]
        write(all_fast(), &super::fast_folder());
    }

    fn write(mut streams: Vec<(&'static str, Vec<u8>)>, folder: &Path) {
        std::fs::create_dir_all(folder).unwrap();
        streams.sort();
        let mut checksums = super::HEADING.to_owned();
        let mut attributes = String::new();
        for (name, stream) in streams {
            let name = format!("{name}.lwc");
            std::fs::write(folder.join(&name), &stream).unwrap();
            checksums += &super::lines_of(&name, &stream);
            attributes += &super::attribute_lines_of(&name, &stream);
        }
        std::fs::write(folder.join("checksums.txt"), checksums).unwrap();
        if !attributes.is_empty() {
            std::fs::write(folder.join("attributes.txt"), attributes).unwrap();
        }
    }

    fn bumpy(x: f64, y: f64) -> f64 {
        0.6 * (0.7 * x).sin() * (0.5 * y).cos()
    }

    /// With attributes of every kind.
    fn torn_grid(profile: Profile) -> Vec<u8> {
        let mesh = noisy(grid(9, 8, bumpy), 15, 0.05);
        let mut options = EncodeOptions::default();
        options.profile = Some(profile);
        let list = attributed::torn(&mesh);
        encode_with_attributes(&mesh, &attributed::all(list), &options, &|_| {}).unwrap().bytes
    }

    #[cfg(feature = "fast")]
    fn all_fast() -> Vec<(&'static str, Vec<u8>)> {
        let fast = |mesh: &TriMesh, bits| {
            stream(mesh, |o| (o.profile, o.quantization_bits) = (Some(Profile::Fast), bits))
        };
        vec![
            ("tetrahedron", fast(&tetrahedron(), 12)),
            ("open-grid", fast(&noisy(grid(16, 13, bumpy), 2, 0.05), 12)),
            ("torus-30-bits", fast(&noisy(torus(20, 9), 1, 0.02), 30)),
            ("soup", fast(&soup(30, 60, 5), 9)),
            // Passes with all kinds of streams.
            ("large-torus", fast(&noisy(torus(100, 50), 1, 0.002), 7)),
            ("torn-grid", torn_grid(Profile::Fast)),
            // A base mesh in tables: handles, boundaries and components; coordinates that repeat.
            ("in-one-piece", {
                let sheet = noisy(grid(30, 20, bumpy), 4, 0.05);
                let mesh = beside(noisy(torus(60, 40), 1, 0.004), beside(genus3(), sheet));
                in_one_piece(&mesh, 11)
            }),
            ("rails-in-one-piece", {
                let jump = |x: f64| x + 0.4 * (7.0 * x).sin();
                let rails = map_positions(grid(60, 45, |_, _| 0.0), |[x, y, z]| [jump(x), jump(y), z]);
                in_one_piece(&rails, 14)
            }),
            ("strip-with-ears", {
                stream(&noisy(strip(120), 3, 0.02), |o| {
                    (o.partition, o.profile) = (Partition::Algorithm1, Some(Profile::Fast));
                })
            }),
        ]
    }

    #[cfg(feature = "fast")]
    fn in_one_piece(mesh: &TriMesh, bits: u32) -> Vec<u8> {
        stream(mesh, |o| (o.profile, o.levels, o.quantization_bits) = (Some(Profile::Fast), Some(0), bits))
    }

    fn stream(mesh: &TriMesh, change: impl Fn(&mut EncodeOptions)) -> Vec<u8> {
        let mut options = EncodeOptions::default();
        change(&mut options);
        encode(mesh, &options).unwrap().bytes
    }

    fn attributed(mesh: &TriMesh, list: Vec<Attribute>) -> Vec<u8> {
        let (attributes, options) = (attributed::all(list), EncodeOptions::default());
        encode_with_attributes(mesh, &attributes, &options, &|_| {}).unwrap().bytes
    }

    fn all() -> Vec<(&'static str, Vec<u8>)> {
        let default = |_: &mut EncodeOptions| {};
        let torus = noisy(torus(20, 9), 1, 0.02);
        let commented = {
            let mut chunks = chunks::split(&stream(&noisy(sphere(2), 9, 0.02), default));
            chunks.insert(1, Chunk::new(b'z', b"a chunk that decoders skip"));
            chunks.insert(4, Chunk::new(b'z', b""));
            chunks.push(Chunk::new(b'z', &[0xff; 9]));
            chunks::join(&chunks)
        };
        vec![
            ("single-triangle", stream(&single_triangle(), default)),
            ("tetrahedron", stream(&tetrahedron(), default)),
            ("torus", stream(&torus, default)),
            ("open-grid", stream(&noisy(grid(16, 13, bumpy), 2, 0.05), default)),
            ("strip-with-ears", {
                stream(&noisy(strip(120), 3, 0.02), |o| o.partition = Partition::Algorithm1)
            }),
            ("non-manifold", stream(&noisy(non_manifold_fin(), 4, 0.02), default)),
            ("soup", stream(&soup(30, 60, 5), |o| o.quantization_bits = 9)),
            (
                "components",
                stream(&beside(sphere(1), beside(grid(5, 5, bumpy), tetrahedron())), |o| {
                    o.levels = Some(3);
                }),
            ),
            ("genus-3", stream(&genus3(), |o| o.quantization_bits = 8)),
            ("utm-30-bits", {
                let shift = |p: [f64; 3]| [431_234.567 + p[0], 5_512_345.678 + p[1], 812.001 + p[2]];
                stream(&map_positions(noisy(grid(9, 8, bumpy), 6, 0.1), shift), |o| o.quantization_bits = 30)
            }),
            ("one-bit", stream(&noisy(sphere(2), 7, 0.02), |o| o.quantization_bits = 1)),
            ("late-precision", stream(&torus, |o| o.steps_per_edge = Some(3.0))),
            ("precision-at-once", stream(&torus, |o| o.steps_per_edge = Some(1e9))),
            ("algorithm1", {
                stream(&noisy(sphere(2), 8, 0.02), |o| {
                    o.partition = Partition::Algorithm1;
                    o.descriptor = Descriptor::Nfv;
                    o.window.rings = 2;
                    o.growth = 2.0;
                })
            }),
            (
                "flat-grid",
                stream(&flat_grid(), |o| {
                    o.quantization_bits = 10;
                    o.steps_per_edge = Some(1.0);
                }),
            ),
            ("unknown-chunks", commented),
            ("lattice-with-offset", {
                let step = [0.01, 0.02, 0.003];
                stream(&noisy(sphere(2), 16, 0.02), |o| {
                    o.grid = on(Lattice { origin: [0.3, -7.1, 1e4], step })
                })
            }),
            ("lattice-of-float32", {
                let lattice = Lattice { origin: [0.0; 3], step: [0.125, 0.0625, 0.25] };
                stream(&noisy(grid(9, 8, bumpy), 17, 0.05), |o| o.grid = on(lattice))
            }),
            ("lattice-exact", {
                let lattice = Lattice { origin: [-5.0, 2.5, 0.1], step: [0.1, 1e-3, 0.7] };
                stream(&noisy(single_and_loose(), 18, 0.01), |o| {
                    everything(o);
                    o.grid = on(lattice);
                })
            }),
            ("own-step-of-each-axis", {
                let thin = map_positions(torus.clone(), |p| [1e4 * p[0], p[1], 1e-3 * p[2]]);
                stream(&thin, |o| o.quantization_bits = 10)
            }),
            ("max-bumps", stream(&noisy(grid(36, 30, bumpy), 2, 0.03), |o| o.profile = Some(Profile::Max))),
            ("max-strip-with-ears", {
                stream(&noisy(strip(120), 3, 0.02), |o| {
                    (o.partition, o.profile) = (Partition::Algorithm1, Some(Profile::Max));
                })
            }),
            ("max-in-one-piece", {
                stream(&noisy(grid(16, 13, bumpy), 2, 0.05), |o| {
                    (o.levels, o.profile) = (Some(0), Some(Profile::Max));
                })
            }),
            ("max-torn-grid", torn_grid(Profile::Max)),
            ("exact-floats", {
                let narrow = map_positions(noisy(sphere(1), 3, 0.05), |p| p.map(|x| f64::from(x as f32)));
                stream(&narrow, everything)
            }),
            ("exact-doubles", stream(&noisy(single_and_loose(), 4, 0.01), everything)),
            ("exact-decimals", {
                let rounded =
                    map_positions(noisy(grid(7, 7, bumpy), 5, 0.1), |p| p.map(|x| (x * 1e3).round() / 1e3));
                stream(&rounded, |o| o.lossless = true)
            }),
            ("exact-fractions", {
                let rounded = map_positions(noisy(grid(7, 7, bumpy), 5, 0.1), |p| {
                    p.map(|x| (x * 1e3).round() / 1024.0)
                });
                stream(&rounded, |o| o.lossless = true)
            }),
            ("turned-faces", {
                let (positions, mut triangles) = noisy(grid(12, 12, bumpy), 6, 0.02).into_parts();
                triangles.iter_mut().skip(60).step_by(2).for_each(|t| t.swap(0, 1));
                stream(&build(positions, triangles), |o| o.quantization_bits = 8)
            }),
            ("colours", {
                let mesh = noisy(sphere(2), 10, 0.02);
                attributed(&mesh, vec![attributed::colours(&mesh)])
            }),
            ("texture-seams", {
                let (mesh, uv) = attributed::atlas(18, 9);
                attributed(&mesh, vec![uv])
            }),
            ("flat-normals", {
                let mesh = noisy(sphere(1), 11, 0.02);
                attributed(&mesh, vec![attributed::flat_normals(&mesh)])
            }),
            ("materials", {
                let (mesh, mut uv) = attributed::atlas(12, 8);
                let mut rows: Vec<u32> = (0..uv.num_entries() as u32).collect();
                rows[30..90].fill(NO_ENTRY);
                uv.indices = Some(rows);
                let areas = (0..mesh.num_triangles()).map(|t| (t as f64 * 0.1).sin()).collect();
                let areas =
                    Attribute::new("area", Semantic::Generic, Domain::Triangle, 1, Values::F64(areas));
                attributed(&mesh, vec![attributed::materials(&mesh), areas, uv])
            }),
            ("vertex-normals", {
                let mesh = noisy(grid(9, 8, bumpy), 12, 0.1);
                attributed(&mesh, attributed::vertex_normals(&mesh))
            }),
            ("many-channels", {
                let mesh = noisy(grid(8, 7, bumpy), 13, 0.05);
                attributed(&mesh, attributed::of_many_channels(&mesh))
            }),
            ("torn-strip", {
                let mesh = noisy(strip(90), 14, 0.02);
                let mut options = EncodeOptions::default();
                options.partition = Partition::Algorithm1;
                let list = attributed::torn(&mesh);
                encode_with_attributes(&mesh, &attributed::all(list), &options, &|_| {}).unwrap().bytes
            }),
            ("assembled", {
                let mesh = beside(noisy(non_manifold_fin(), 4, 0.02), single_and_loose());
                let mut options = EncodeOptions::default();
                everything(&mut options);
                let list = attributed::torn(&mesh);
                encode_with_attributes(&mesh, &attributed::all(list), &options, &|_| {}).unwrap().bytes
            }),
            ("exact-values", {
                let mesh = beside(strip(9), single_and_loose());
                let mut options = EncodeOptions::default();
                everything(&mut options);
                let nasty =
                    |domain, scalar, semantic, seed| attributed::nasty(&mesh, domain, scalar, semantic, seed);
                let mut list = attributed::smooth_normals(&mesh).to_vec();
                list.push(nasty(Domain::Vertex, ComponentType::U32, Semantic::Generic, 4));
                list.push(nasty(Domain::Corner, ComponentType::F32, Semantic::TexCoord(0), 6));
                list.push(nasty(Domain::Triangle, ComponentType::F64, Semantic::Generic, 2));
                list.push(attributed::materials(&mesh));
                encode_with_attributes(&mesh, &attributed::all(list), &options, &|_| {}).unwrap().bytes
            }),
            ("metadata", metadata()),
            ("scene", scene()),
            ("late-materials", {
                let mut chunks = chunks::split(&scene());
                let from = chunks.iter().position(|c| c.kind == b'm').unwrap();
                let materials = chunks.remove(from);
                let size = chunks::varint(materials.payload.len() as u32);
                let announced = [&[0, b'm'][..], &size].concat();
                let table = chunks.iter().position(|c| c.kind == b'L').unwrap();
                chunks.insert(table, Chunk::new(b't', &announced));
                chunks.push(materials);
                chunks::join(&chunks)
            }),
        ]
    }

    fn on(lattice: Lattice) -> GridChoice {
        GridChoice::Lattice(lattice)
    }

    /// A tetrahedron somewhere on Earth.
    fn metadata() -> Vec<u8> {
        let mut attributes = attributed::all(Vec::new());
        let pair = |key: &str, text: &str| (key.to_owned(), text.to_owned());
        attributes.metadata = [pair("crs.wkt", "GEOGCS[\"Höhe\"]"), pair("crs.geokeys", "")].into();
        let options = EncodeOptions::default();
        encode_with_attributes(&tetrahedron(), &attributes, &options, &|_| {}).unwrap().bytes
    }

    /// Two meshes in three places, with a material each.
    fn scene() -> Vec<u8> {
        let mesh = beside(tetrahedron(), sphere(0));
        let number = |t: usize| u32::from(t >= 4);
        let which = (0..mesh.num_triangles()).map(number).collect();
        let which = Attribute::new("scene mesh", Semantic::Generic, Domain::Triangle, 1, Values::U32(which));
        let mut attributes = attributed::all(vec![which, attributed::materials(&mesh)]);
        let place = |mesh, name: &str, transform| Instance { mesh, name: name.into(), transform };
        let [x, y, z] = IDENTITY;
        attributes.scene = Some(SceneTable {
            exponents: vec![0, -2],
            instances: vec![
                place(0, "", IDENTITY),
                place(1, "Baum", [[1.0, 0.0, 0.0, 2.5], y, z]),
                place(1, "turned", [[0.0, -1.0, 0.0, 2.5], x, z]),
                place(0, "exact", [[0.1, 0.0, 0.0, 0.0], y, z]),
            ],
        });
        let json = r#"{"materials":[{"name":"north"},{"name":"south"}]}"#.to_owned();
        let mut materials = GltfMaterials::default();
        (materials.json, materials.images) = (json, vec![vec![1, 2, 3]]);
        attributes.gltf_materials = Some(materials);
        encode_with_attributes(&mesh, &attributes, &EncodeOptions::default(), &|_| {}).unwrap().bytes
    }

    fn everything(options: &mut EncodeOptions) {
        options.keep_isolated = true;
        options.keep_degenerate = true;
        options.lossless = true;
        options.keep_order = true;
    }

    /// A tetrahedron, vertices without triangles, and triangles that name a vertex twice.
    fn single_and_loose() -> TriMesh {
        let (mut positions, mut triangles) = tetrahedron().into_parts();
        positions.extend([[5.0, -0.0, 1e-310], [5.0, 0.0, 0.0], [0.25, 3.0, 1.0]]);
        triangles.insert(1, [2, 2, 5]);
        triangles.extend([[6, 6, 6], [0, 1, 0]]);
        build(positions, triangles)
    }

    /// A flat grid whose vertices have zeros in all low bits, so that refinements cost nearly nothing
    /// and need padding.
    fn flat_grid() -> TriMesh {
        let size = 32;
        let flat = grid(size, size, |_, _| 0.0);
        let on_cells = map_positions(flat, |p| [32.0 * (p[0] + 15.5), 32.0 * (p[1] + 15.5), 0.0]);
        // The corner of the box makes a step of the grid a unit.
        beside_at(on_cells, single_triangle(), 1022.0)
    }

    fn beside_at(one: TriMesh, other: TriMesh, x: f64) -> TriMesh {
        beside(one, map_positions(other, |p| [p[0] + x - 7.0, p[1], p[2]]))
    }
}
