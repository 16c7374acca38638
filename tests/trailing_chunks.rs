//! Chunks beside the passes (`format/SPEC.md`, sections 4.4, 7.6 to 7.9 and 7.12) that are damaged, hostile or missing.
#![cfg(feature = "encoder")]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

mod common;

use common::chunks::{self, Chunk, take_varint, varint};
use common::*;
use lwc::mesh::{Attribute, Attributes, Domain, Semantic, Values};
use lwc::{
    DecodeError, DecodeOptions, Decoder, EncodeOptions, Limits, TriMesh, decode, encode,
    encode_with_attributes,
};

/// A mesh of everything: cut, loose, with strange floats.
fn mesh() -> TriMesh {
    let (mut positions, mut triangles) = noisy(grid(9, 8, |x, y| 0.2 * x * y), 1, 0.05).into_parts();
    triangles.iter_mut().skip(30).step_by(3).for_each(|t| t.swap(0, 1));
    positions.extend([[1.0, -0.0, 0.5], [-1.0, 1e-300, 0.5]]);
    triangles.extend([[72, 72, 3], [5, 6, 5]]);
    build(positions, triangles)
}

/// Numbers that no bits tell, on all of it.
fn attributes(mesh: &TriMesh) -> Attributes {
    let mut random = Random(5);
    let mut of = |domain: Domain, num_components: usize| {
        let count = domain.num_elements(mesh) * num_components;
        let values = Values::F32((0..count).map(|_| random.unit() as f32).collect());
        Attribute::new("q", Semantic::Generic, domain, num_components, values)
    };
    let mut normals = of(Domain::Vertex, 3);
    normals.semantic = Semantic::Normal;
    let Values::F32(values) = &mut normals.values else { unreachable!() };
    for n in values.chunks_exact_mut(3) {
        let length = n.iter().map(|x| x * x).sum::<f32>().sqrt();
        n.iter_mut().for_each(|x| *x /= length);
    }
    let mut attributes = Attributes::default();
    attributes.list = vec![of(Domain::Corner, 2), of(Domain::Triangle, 1), normals];
    attributes
}

fn stream() -> Vec<u8> {
    let mut options = EncodeOptions::default();
    options.keep_isolated = true;
    options.keep_degenerate = true;
    options.lossless = true;
    options.keep_order = true;
    let mesh = mesh();
    encode_with_attributes(&mesh, &attributes(&mesh), &options, &|_| {}).unwrap().bytes
}

/// The stream with the lengths that `t` gives made those of the chunks that are there.
fn join_announced(chunks: &[Chunk]) -> Vec<u8> {
    let mut chunks = chunks.to_vec();
    let size = |kind: u8, i: usize| {
        chunks.iter().filter(|c| c.kind == kind).nth(i).map_or(0, |c| c.payload.len() as u32)
    };
    let place = chunks.iter().position(|c| c.kind == b't').unwrap();
    let mut old = &chunks[place].payload[..];
    let count = take_varint(&mut old);
    let mut payload = varint(count);
    for i in 0..count as usize {
        payload.extend(varint(take_varint(&mut old)));
        take_varint(&mut old);
        payload.extend(varint(size(b'g', i)));
    }
    while let Some((&kind, mut rest)) = old.split_first() {
        take_varint(&mut rest);
        old = rest;
        payload.push(kind);
        payload.extend(varint(size(kind, 0)));
    }
    chunks[place].payload = payload;
    chunks::join(&chunks)
}

fn is_beside(chunk: &Chunk) -> bool {
    b"gixvo".contains(&chunk.kind)
}

/// Decodes; whatever comes of it, the meshes are sound and the passes those of the clean stream.
#[track_caller]
fn check(stream: &[u8], what: &str) -> Result<bool, DecodeError> {
    let mut decoder = Decoder::new(Limits { max_memory: 64 << 20, ..Limits::default() });
    let result = decoder.push(stream);
    if let Some(mesh) = decoder.mesh() {
        let (positions, triangles) = mesh.to_tri_mesh().into_parts();
        assert!(TriMesh::new(positions, triangles).is_ok(), "{what}");
        let (place, count) = mesh.stitched_vertices();
        assert!(place.len() == mesh.num_vertices() && place.iter().all(|&v| (v as usize) < count), "{what}");
    }
    if let Some((mesh, attributes)) = decoder.to_tri_mesh_with_attributes() {
        attributes.list.iter().for_each(|a| assert_eq!(a.validate(&mesh), Ok(()), "{what}"));
    }
    if result.is_err() {
        assert_eq!(decoder.push(&[0]), Err(DecodeError::Failed), "{what}");
    }
    result.map(|_| decoder.is_complete())
}

#[test]
fn the_stream_of_these_tests_has_all_chunks() {
    let kinds: Vec<u8> = chunks::split(&stream()).iter().map(|c| c.kind).collect();
    assert!(b"tgixvo".iter().all(|kind| kinds.contains(kind)), "{kinds:?}");
    assert_eq!(check(&stream(), "clean"), Ok(true));
    assert_eq!(join_announced(&chunks::split(&stream())), stream());
}

#[test]
fn hostile_payloads_are_refused_or_meshes() {
    let chunks = chunks::split(&stream());
    let mut random = Random(1);
    let (mut num_refused, mut num_meshes) = (0, 0);
    for (i, chunk) in chunks.iter().enumerate().filter(|(_, c)| is_beside(c) && !c.payload.is_empty()) {
        for round in 0..300 {
            let mut damaged = chunks.clone();
            let payload = &mut damaged[i].payload;
            match round % 4 {
                0 => payload[(random.next() % chunk.payload.len() as u64) as usize] = random.next() as u8,
                1 => payload.truncate((random.next() % chunk.payload.len() as u64) as usize),
                2 => payload.iter_mut().for_each(|byte| *byte = random.next() as u8),
                _ => payload.iter_mut().skip(4).for_each(|byte| *byte = [0, 0xff][round / 4 % 2]),
            }
            let what = format!("{}, round {round}", char::from(chunk.kind));
            match check(&join_announced(&damaged), &what) {
                Ok(_) => num_meshes += 1,
                Err(DecodeError::Malformed { .. } | DecodeError::Limit { .. }) => num_refused += 1,
                Err(error) => panic!("{what}: {error}"),
            }
        }
    }
    assert!(num_refused > 300 && num_meshes > 50, "{num_refused} refused, {num_meshes} meshes");
}

#[test]
fn hostile_announcements_are_refused_or_meshes() {
    let chunks = chunks::split(&stream());
    let place = chunks.iter().position(|c| c.kind == b't').unwrap();
    let mut random = Random(2);
    for round in 0..400 {
        let mut damaged = chunks.clone();
        let payload = &mut damaged[place].payload;
        let at = (random.next() % payload.len() as u64) as usize;
        match round % 3 {
            0 => payload[at] = random.next() as u8,
            1 => payload.truncate(at),
            _ => payload.insert(at, random.next() as u8),
        }
        let is_complete = check(&chunks::join(&damaged), &format!("round {round}"));
        assert!(damaged == chunks || is_complete != Ok(true) || round % 3 == 1, "round {round}");
    }
    let with = |payload: &[u8]| {
        let mut damaged = chunks.clone();
        damaged[place].payload = payload.to_vec();
        check(&chunks::join(&damaged), "announced")
    };
    let malformed = |result| matches!(result, Err(DecodeError::Malformed { .. }));
    assert!(malformed(with(&[1, 200, 1, 5])), "stitching of a pass that is not there");
    assert!(malformed(with(&[0, b'S', 5])), "a critical chunk behind the passes");
    assert!(malformed(with(&[0, b'x', 5, b'x', 5])), "a chunk twice");
    let mut twice = chunks.clone();
    twice.insert(place, chunks[place].clone());
    assert!(malformed(check(&chunks::join(&twice), "two announcements")));
}

#[test]
fn missing_and_misplaced_chunks_are_noticed() {
    let chunks = chunks::split(&stream());
    for (i, chunk) in chunks.iter().enumerate().filter(|(_, c)| is_beside(c)) {
        let mut without = chunks.clone();
        without.remove(i);
        let result = check(&chunks::join(&without), "missing");
        let kind = char::from(chunk.kind);
        // Another pass, or stitching of another length, may stand in its place.
        let is_noticed = match result {
            Ok(is_complete) => !is_complete,
            Err(DecodeError::Malformed { .. }) => kind == 'g',
            Err(_) => false,
        };
        assert!(is_noticed, "{kind}");
    }
    let mut late = chunks.clone();
    let place = late.iter().position(|c| c.kind == b't').unwrap();
    late.swap(place, place + 1);
    // Behind the table it announces nothing: all it names is skipped.
    assert_eq!(check(&chunks::join(&late), "late"), Ok(true));
}

#[test]
fn who_does_not_know_them_has_the_cut_surface() {
    let stream = stream();
    let known = decode(&stream, DecodeOptions::new()).unwrap();
    let bare: Vec<Chunk> =
        chunks::split(&stream).into_iter().filter(|c| !b"tgixvo".contains(&c.kind)).collect();
    let mut decoder = Decoder::new(Limits::default());
    decoder.push(&chunks::join(&bare)).unwrap();
    let cut = decoder.mesh().unwrap();
    assert!(decoder.is_complete());
    assert!(cut.num_vertices() > known.num_vertices());
    let mut whole = Decoder::new(Limits::default());
    whole.push(&stream).unwrap();
    assert_eq!(whole.mesh().unwrap().checksum(), cut.checksum());
}

#[test]
fn limits_hold_for_what_is_loose() {
    let n = 3000;
    let mut positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    positions.extend((0..n).map(|i| [f64::from(i) / f64::from(n), 0.5, 0.5]));
    let mut options = EncodeOptions::default();
    options.keep_isolated = true;
    let stream = encode(&build(positions, vec![[0, 1, 2]]), &options).unwrap().bytes;
    for (max_vertices, is_refused) in [(3002, true), (3003, false)] {
        let limits = Limits { max_vertices, ..Limits::default() };
        let result = decode(&stream, DecodeOptions::new().limits(limits));
        assert_eq!(matches!(result, Err(DecodeError::Limit { .. })), is_refused, "{max_vertices}");
    }
}

#[test]
fn any_cut_gives_the_same_end() {
    let stream = stream();
    let wanted = decode(&stream, DecodeOptions::new()).unwrap();
    assert_eq!(wanted, mesh());
    for size in [1, 7, 64] {
        let mut decoder = Decoder::new(Limits::default());
        for piece in stream.chunks(size) {
            decoder.push(piece).unwrap();
        }
        assert!(decoder.is_complete());
        assert_eq!(decoder.mesh().unwrap().to_tri_mesh(), wanted, "pieces of {size} bytes");
    }
}
