//! Chunks behind the last pass in every order: each refers to what stands before it (`format/SPEC.md`, section 4.4).
#![cfg(feature = "assets")]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

mod common;

use common::chunks::{self, Chunk};
use lwc::{DecodeError, Decoder, Limits, TriMesh};
use std::path::Path;

/// The golden streams.
fn streams() -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("format/golden");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let streams = files.filter(|path| path.extension().is_some_and(|ending| ending == "lwc"));
    streams.map(|path| (path.display().to_string(), std::fs::read(&path).unwrap())).collect()
}

/// Every order of so many things.
fn permutations(count: usize) -> Vec<Vec<usize>> {
    if count == 0 {
        return vec![Vec::new()];
    }
    let shorter = permutations(count - 1);
    let place = |order: &Vec<usize>, at: usize| {
        let mut longer = order.clone();
        longer.insert(at, count - 1);
        longer
    };
    shorter.iter().flat_map(|order| (0..count).map(move |at| place(order, at))).collect()
}

/// What a decoder makes of a stream.
fn decode(stream: &[u8]) -> (Option<TriMesh>, Option<DecodeError>) {
    let mut decoder = Decoder::new(Limits::default());
    let error = decoder.push(stream).err();
    let Some((mesh, attributes)) = decoder.preview_with_attributes() else { return (None, error) };
    let num_vertices = mesh.num_vertices() as u32;
    assert!(mesh.triangles().iter().flatten().all(|&v| v < num_vertices), "a vertex that does not exist");
    attributes.list.iter().for_each(|attribute| attribute.validate(&mesh).unwrap());
    (Some(mesh), error)
}

/// Whether each of these kinds comes behind those it refers to.
fn is_in_order(kinds: &[u8]) -> bool {
    let place = |kind: u8| kinds.iter().position(|&k| k == kind);
    let is_before = |a, b| place(a).zip(place(b)).is_none_or(|(a, b)| a < b);
    let pairs = [(b'i', b'x'), (b'i', b'v'), (b'i', b'o'), (b'x', b'o'), (b'v', b'o')];
    pairs.into_iter().all(|(a, b)| is_before(a, b))
}

#[test]
fn every_order_of_trailing_chunks_is_refused_or_the_same_mesh() {
    let (mut num_refused, mut num_taken) = (0, 0);
    for (name, stream) in streams() {
        let parts = chunks::split(&stream);
        let last = parts.iter().rposition(Chunk::is_pass).unwrap();
        let first = last + 1 + parts[last + 1..].iter().take_while(|c| b"ag".contains(&c.kind)).count();
        let (before, trailing) = parts.split_at(first);
        if trailing.len() < 2 {
            continue;
        }
        let (whole, error) = decode(&stream);
        assert_eq!(error, None, "{name}");
        for order in permutations(trailing.len()) {
            let moved: Vec<Chunk> = order.iter().map(|&i| trailing[i].clone()).collect();
            let kinds: Vec<u8> = moved.iter().map(|chunk| chunk.kind).collect();
            let (mesh, error) = decode(&chunks::join_announced(&[before, &moved].concat()));
            if is_in_order(&kinds) {
                assert_eq!((error, &mesh), (None, &whole), "{name}: {}", String::from_utf8_lossy(&kinds));
                num_taken += 1;
            } else {
                assert!(matches!(error, Some(DecodeError::Malformed { .. })), "{name}: {error:?}");
                num_refused += 1;
            }
        }
    }
    assert!(num_refused >= 10 && num_taken >= 4, "{num_refused} refused, {num_taken} taken");
}

/// Left out, or twice, as announced.
#[test]
fn trailing_chunks_that_are_missing_or_doubled_never_make_a_mesh_that_is_none() {
    for (name, stream) in streams() {
        let parts = chunks::split(&stream);
        let last = parts.iter().rposition(Chunk::is_pass).unwrap();
        for i in last + 1..parts.len() {
            let mut dropped = parts.clone();
            dropped.remove(i);
            let (mesh, error) = decode(&chunks::join_announced(&dropped));
            assert!(mesh.is_some() || error.is_some(), "{name}, without chunk {i}");
            let mut doubled = parts.clone();
            doubled.insert(i, parts[i].clone());
            let is_trailing = !b"agz".contains(&parts[i].kind) && parts[i].kind.is_ascii_lowercase();
            let (_, error) = decode(&chunks::join_announced(&doubled));
            let is_refused = matches!(error, Some(DecodeError::Malformed { .. }));
            assert!(
                is_refused || !is_trailing || parts.iter().all(|c| c.kind != b't'),
                "{name}, chunk {i}: {error:?}"
            );
        }
    }
}
