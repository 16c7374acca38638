//! What goes in comes out: the same vertices and triangles, however they hang together, and with options the
//! very floats, what is loose, and the order.
#![cfg(feature = "encoder")]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

mod common;

use common::corpus::corpus;
use common::kinds::every_kind;
use common::*;
use lwc::{DecodeOptions, Decoder, EncodeOptions, Limits, Partition, TriMesh, decode, encode};
use std::collections::HashMap;

fn is_usable(&[a, b, c]: &[u32; 3]) -> bool {
    a != b && b != c && c != a
}

fn everything() -> EncodeOptions {
    let mut options = EncodeOptions::default();
    options.keep_isolated = true;
    options.keep_degenerate = true;
    options.lossless = true;
    options.keep_order = true;
    options
}

/// Vertices and faces in another order, faces turned; and the new index of each vertex.
fn shuffled(mesh: &TriMesh, seed: u64) -> TriMesh {
    let mut random = Random(seed);
    let mut below = |n: usize| (random.next() % n as u64) as usize;
    let n = mesh.num_vertices();
    let mut name: Vec<u32> = (0..n as u32).collect();
    (1..n).for_each(|i| name.swap(i, below(i + 1)));
    let mut positions = vec![[0.0; 3]; n];
    name.iter().zip(mesh.positions()).for_each(|(&to, &p)| positions[to as usize] = p);
    let mut triangles: Vec<[u32; 3]> = mesh.triangles().iter().map(|t| t.map(|v| name[v as usize])).collect();
    (1..triangles.len()).for_each(|i| triangles.swap(i, below(i + 1)));
    triangles.iter_mut().for_each(|t| t.rotate_left(below(3)));
    build(positions, triangles)
}

/// The bits of all coordinates and the triangles: equality of floats takes −0 for 0.
fn bits(mesh: &TriMesh) -> (Vec<[u64; 3]>, Vec<[u32; 3]>) {
    (mesh.positions().iter().map(|p| p.map(f64::to_bits)).collect(), mesh.triangles().to_vec())
}

/// A description of a mesh that does not depend on its order, as far as a few rounds of looking around tell
/// vertices of one place apart: for each vertex a number, sorted, and for each face three, turned and sorted.
fn signature(mesh: &TriMesh, places: &[[u64; 3]]) -> (Vec<u64>, Vec<[u64; 3]>) {
    let mix = |x: u64| Random(x).next();
    let mut hash: Vec<u64> = places.iter().map(|p| p.iter().fold(1, |h, &c| mix(h ^ c))).collect();
    for _ in 0..6 {
        let mut sum = vec![0_u64; hash.len()];
        for &[a, b, c] in mesh.triangles() {
            for [v, n, p] in [[a, b, c], [b, c, a], [c, a, b]] {
                let corner = mix(hash[n as usize].rotate_left(7) ^ mix(hash[p as usize]));
                sum[v as usize] = sum[v as usize].wrapping_add(corner);
            }
        }
        hash.iter_mut().zip(sum).for_each(|(h, s)| *h = mix(*h ^ s));
    }
    let turned = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| hash[v as usize]);
        [a, b, c].min([b, c, a]).min([c, a, b])
    };
    let mut faces: Vec<[u64; 3]> = mesh.triangles().iter().map(turned).collect();
    let mut vertices = hash.clone();
    vertices.sort_unstable();
    faces.sort_unstable();
    (vertices, faces)
}

/// The cells of a mesh on the grid of a stream.
fn cells(mesh: &TriMesh, stream: &[u8]) -> Vec<[u64; 3]> {
    let info = lwc::StreamInfo::read(stream).unwrap().unwrap();
    let steps = 2f64.powi(info.quantization_bits() as i32) - 1.0;
    let (origin, side) = (info.origin(), info.side());
    let cell = |x: f64, axis: usize| {
        let scaled = ((x - origin[axis]) / side * steps + 0.5).floor();
        if side > 0.0 { scaled as u64 } else { 0 }
    };
    mesh.positions().iter().map(|p| std::array::from_fn(|axis| cell(p[axis], axis))).collect()
}

/// Only what triangles of three vertices use.
fn usable(mesh: &TriMesh) -> TriMesh {
    let triangles: Vec<[u32; 3]> = mesh.triangles().iter().copied().filter(is_usable).collect();
    let mut name = HashMap::new();
    let mut positions = Vec::new();
    let mut named = |v: u32| {
        *name.entry(v).or_insert_with(|| {
            positions.push(mesh.positions()[v as usize]);
            positions.len() as u32 - 1
        })
    };
    let triangles = triangles.into_iter().map(|t| t.map(&mut named)).collect();
    build(positions, triangles)
}

/// Positions of finest cells that differ from the input at all are too coarse to be told from the next cell.
fn is_on_grid(name: &str) -> bool {
    !["huge", "denormal", "all points equal"].contains(&name)
}

#[track_caller]
fn assert_same_connectivity(mesh: &TriMesh, options: &EncodeOptions, name: &str) -> usize {
    let stream = encode(mesh, options).unwrap().bytes;
    let decoded = decode(&stream, DecodeOptions::new()).unwrap();
    let wanted = usable(mesh);
    assert_eq!(decoded.num_vertices(), wanted.num_vertices(), "{name}: vertices");
    assert_eq!(decoded.num_triangles(), wanted.num_triangles(), "{name}: faces");
    if is_on_grid(name) {
        let (found, wanted) =
            (signature(&decoded, &cells(&decoded, &stream)), signature(&wanted, &cells(&wanted, &stream)));
        assert!(found.0 == wanted.0, "{name}: other vertices");
        assert!(found.1 == wanted.1, "{name}: other faces");
    }
    stream.len()
}

#[test]
fn every_kind_keeps_its_connectivity() {
    for (name, mesh) in every_kind() {
        for partition in Partition::ALL {
            let mut options = EncodeOptions::default();
            options.partition = partition;
            assert_same_connectivity(&mesh, &options, name);
        }
    }
}

#[test]
fn double_fins_and_repeated_sheets_keep_their_vertices() {
    let fin = |faces: &[[u32; 3]]| {
        let (positions, mut triangles) = non_manifold_fin().into_parts();
        triangles.extend(faces);
        build(positions, triangles)
    };
    // The fin once more, and from behind.
    for (name, mesh) in [
        ("again", fin(&[[24, 31, 49]])),
        ("behind", fin(&[[31, 24, 49]])),
        ("turned", fin(&[[31, 49, 24], [49, 31, 24], [24, 31, 49]])),
    ] {
        assert_same_connectivity(&mesh, &EncodeOptions::default(), name);
    }
    // Two sheets at one place with vertices of their own must not be joined.
    let (positions, triangles) = grid(6, 5, |x, y| 0.1 * x * y).into_parts();
    let n = positions.len() as u32;
    let twice = [&triangles[..], &triangles.iter().map(|t| t.map(|v| v + n)).collect::<Vec<_>>()].concat();
    let mesh = build([&positions[..], &positions].concat(), twice);
    assert_same_connectivity(&mesh, &EncodeOptions::default(), "two sheets");
}

#[test]
fn coarse_levels_have_no_cracks() {
    let (positions, mut triangles) =
        noisy(grid(30, 30, |x, y| 0.1 * (x * 0.3).sin() * y), 1, 0.02).into_parts();
    // A row of faces turned over: the surface is cut along two lines.
    triangles.iter_mut().skip(58 * 14).take(58).for_each(|t| t.swap(0, 1));
    let mesh = build(positions, triangles);
    let stream = encode(&mesh, &EncodeOptions::default()).unwrap();
    assert!(stream.repair.repeated_vertices >= 58);
    let base = decode(&stream.bytes, DecodeOptions::new().level(0)).unwrap();
    let mut faces_at: HashMap<(u32, u32), usize> = HashMap::new();
    for &[a, b, c] in base.triangles() {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *faces_at.entry((from.min(to), from.max(to))).or_default() += 1;
        }
    }
    // The boundary is that of the square.
    let on_rim = |v: u32| {
        let [x, y, _] = base.positions()[v as usize];
        x.abs().max(y.abs()) > 14.3
    };
    for ((a, b), count) in faces_at {
        assert!(count == 2 || on_rim(a) && on_rim(b), "a crack from {a} to {b} in the base mesh");
    }
}

#[test]
fn many_sheets_are_stitched_as_they_come() {
    // Every other face of a grid turned over: hardly a vertex that is not cut.
    let (positions, mut triangles) = noisy(grid(25, 25, |x, y| 0.1 * x * y), 1, 0.02).into_parts();
    triangles.iter_mut().step_by(2).for_each(|t| t.swap(0, 1));
    assert_same_connectivity(&build(positions, triangles), &EncodeOptions::default(), "turned faces");
    assert_same_connectivity(&soup(500, 2000, 3), &EncodeOptions::default(), "soup");
}

#[test]
fn encoding_again_or_in_another_order_gives_the_same_bytes() {
    for (name, mesh) in every_kind() {
        for bits in [1, 7, 12, 20] {
            let mut options = EncodeOptions::default();
            options.quantization_bits = bits;
            let stream = encode(&mesh, &options).unwrap().bytes;
            for seed in 0..3 {
                let again = encode(&shuffled(&mesh, seed), &options).unwrap().bytes;
                assert!(again == stream, "{name}, {bits} bits, order {seed}");
            }
            let decoded = decode(&stream, DecodeOptions::new()).unwrap();
            let again = encode(&decoded, &options).unwrap().bytes;
            assert!(again == stream, "{name}, {bits} bits, decoded");
        }
    }
}

#[test]
fn everything_comes_back_as_it_was() {
    for (name, mesh) in every_kind() {
        for quantization in [1, 12, 24] {
            let mut options = everything();
            options.quantization_bits = quantization;
            let encoded = encode(&mesh, &options).unwrap();
            let decoded = decode(&encoded.bytes, DecodeOptions::new()).unwrap();
            assert!(bits(&decoded) == bits(&mesh), "{name}, {quantization} bits");
            let repair = encoded.repair;
            assert_eq!((repair.isolated_vertices, repair.degenerate_triangles), (0, 0), "{name}");
        }
    }
}

#[test]
fn strange_floats_return_bit_for_bit() {
    let odd =
        [0.0, -0.0, 1e-45_f32, -1e-45, f32::MIN_POSITIVE, f32::MAX / 4.0, -f32::MAX / 4.0, 0.1, -1.0 / 3.0];
    let mut random = Random(5);
    let mut narrow: Vec<[f64; 3]> =
        odd.iter().map(|&x| [f64::from(x), f64::from(-x), f64::from(odd[2])]).collect();
    let small = |random: &mut Random| f64::from((random.unit() as f32 - 0.5) * 1e-3);
    narrow.extend((0..200).map(|_| std::array::from_fn(|_| small(&mut random))));
    let mut wide = narrow.clone();
    wide.extend([[f64::MIN_POSITIVE, 5e-324, -5e-324], [1e300, -1e-300, 0.1], [std::f64::consts::PI; 3]]);
    let decimal: Vec<[f64; 3]> =
        (0..200).map(|_| std::array::from_fn(|_| (random.unit() * 1e5).round() / 1e3 - 0.0)).collect();
    for (name, positions) in [("narrow", narrow), ("wide", wide), ("decimal", decimal)] {
        let n = positions.len() as u32;
        let mesh = build(positions, (2..n).map(|i| [i - 2, i - 1, i]).collect());
        let decoded = decode(&encode(&mesh, &everything()).unwrap().bytes, DecodeOptions::new()).unwrap();
        assert!(bits(&decoded) == bits(&mesh), "{name}");
    }
}

#[test]
fn each_option_alone_keeps_what_it_says() {
    let mesh = kinds::repeated_and_degenerate_faces();
    let with = |change: fn(&mut EncodeOptions)| {
        let mut options = EncodeOptions::default();
        change(&mut options);
        let encoded = encode(&mesh, &options).unwrap();
        let decoded = decode(&encoded.bytes, DecodeOptions::new()).unwrap();
        (encoded, decoded)
    };
    let (plain, decoded) = with(|_| {});
    assert_eq!((plain.repair.isolated_vertices, plain.repair.degenerate_triangles), (2, 2));
    let sizes = |mesh: &TriMesh| (mesh.num_vertices(), mesh.num_triangles());
    let (n, m) = sizes(&mesh);
    assert_eq!(sizes(&decoded), (n - 2, m - 2));
    let (kept, decoded) = with(|o| o.keep_isolated = true);
    assert_eq!((kept.repair.isolated_vertices, kept.repair.degenerate_triangles), (0, 2));
    assert_eq!(sizes(&decoded), (n, m - 2));
    let (kept, decoded) = with(|o| o.keep_degenerate = true);
    assert_eq!((kept.repair.isolated_vertices, kept.repair.degenerate_triangles), (2, 0));
    assert_eq!(sizes(&decoded), (n - 2, m));
    assert_eq!(decoded.triangles().iter().filter(|t| !is_usable(t)).count(), 2);
    let (_, decoded) = with(|o| o.lossless = true);
    let sorted = |mesh: &TriMesh| {
        let mut bits = bits(mesh).0;
        bits.sort_unstable();
        bits
    };
    assert!(sorted(&decoded) == sorted(&usable(&mesh)));
    let (_, decoded) = with(|o| o.keep_order = true);
    let turned = mesh.triangles().iter().filter(|t| is_usable(t)).map(|t| t.map(|v| v - 1));
    assert!(decoded.triangles().iter().copied().eq(turned));
}

#[test]
fn a_level_below_the_finest_waits_for_nothing_behind_the_passes() {
    let mesh = noisy(sphere(3), 1, 0.02);
    let stream = encode(&mesh, &everything()).unwrap();
    let info = &stream.info;
    assert!(info.trailing().len() == 2 && info.total_bytes() == stream.bytes.len() as u64);
    let finest = info.finest_level();
    let passes_end = info.passes().last().unwrap().end as usize;
    for (level, bytes, is_complete) in [
        (finest - 1, passes_end, true),
        (finest, passes_end, false),
        (finest, stream.bytes.len() - 1, false),
        (finest, stream.bytes.len(), true),
        (finest + 9, stream.bytes.len(), true),
    ] {
        let mut decoder = Decoder::with_options(DecodeOptions::new().level(level));
        decoder.push(&stream.bytes[..bytes]).unwrap();
        assert_eq!(decoder.is_complete(), is_complete, "level {level} of {bytes} bytes");
    }
}

/// Files that are read: each keeps its vertices and faces. The table: `cargo test --release --test exact -- --nocapture`.
#[test]
fn the_corpus_keeps_its_connectivity() {
    let Some(corpus) = corpus() else { return };
    let bad = std::fs::read_dir(corpus.join("bad")).unwrap().map(|entry| entry.unwrap().path());
    let mut paths: Vec<_> = bad.collect();
    paths.sort();
    paths.extend(
        ["suzanne.obj", "dragon-50k-fin.ply", "cycloidal.ply", "dragon-vrip-res2.ply.zst"]
            .map(|n| corpus.join(n)),
    );
    let mut num_checked = 0;
    for path in paths {
        let name = path.file_name().unwrap().to_str().unwrap();
        let Ok(file) = lwc::io::read(&path) else { continue };
        let Ok(encoded) = encode(&file.mesh, &EncodeOptions::default()) else { continue };
        num_checked += 1;
        let bytes = assert_same_connectivity(&file.mesh, &EncodeOptions::default(), name);
        let used = usable(&file.mesh).num_vertices();
        println!("{name}: {used} vertices, {} cut, {bytes} bytes", encoded.repair.repeated_vertices);
        let decoded =
            decode(&encode(&file.mesh, &everything()).unwrap().bytes, DecodeOptions::new()).unwrap();
        assert!(bits(&decoded) == bits(&file.mesh), "{name}: not the same mesh");
        let again = encode(&shuffled(&file.mesh, 1), &EncodeOptions::default()).unwrap().bytes;
        assert!(again == encoded.bytes, "{name}: other bytes for another order");
        let decoded = decode(&encoded.bytes, DecodeOptions::new()).unwrap();
        assert!(
            encode(&decoded, &EncodeOptions::default()).unwrap().bytes == encoded.bytes,
            "{name}: decoded"
        );
        let _ = Limits::default();
    }
    assert!(num_checked > 20, "only {num_checked} files");
}
