//! How much memory encoder and decoder take, and that no stream can make a decoder take much.
#![cfg(feature = "encoder")]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

mod common;
#[path = "common/heap.rs"]
mod heap;

use common::chunks::{self, Chunk, Row};
use common::*;
use heap::{peak, turn};
use lwc::{DecodeError, Decoder, EncodeOptions, Limits, Profile, TriMesh, encode};

/// Tables that are made once, and threads.
fn warm_up() {
    let stream = encode(&sphere(2), &EncodeOptions::default()).unwrap().bytes;
    Decoder::new(Limits::default()).push(&stream).unwrap();
}

fn large_meshes() -> [(&'static str, TriMesh); 2] {
    let bumpy = |x: f64, y: f64| 9.0 * (0.05 * x).sin() * (0.03 * y).cos();
    [("sphere", noisy(sphere(7), 1, 0.001)), ("grid", noisy(grid(320, 320, bumpy), 2, 0.2))]
}

#[test]
fn encoder_and_decoder_stay_within_their_bytes_per_vertex() {
    let _turn = turn();
    warm_up();
    for (name, mesh) in large_meshes() {
        let vertices = mesh.num_vertices();
        assert!(vertices > 100_000);
        let (stream, encoding) = peak(|| encode(&mesh, &EncodeOptions::default()).unwrap().bytes);
        let mut decoder = Decoder::new(Limits::default());
        let ((), decoding) = peak(|| {
            // As a network would bring it.
            stream.chunks(1 << 14).for_each(|bytes| drop(decoder.push(bytes).unwrap()));
        });
        assert!(decoder.is_complete());
        let per_vertex = |bytes: usize| bytes as f64 / vertices as f64;
        println!(
            "{name}: {vertices} vertices, encoder {:.0} and decoder {:.0} bytes per vertex",
            per_vertex(encoding),
            per_vertex(decoding)
        );
        assert!(per_vertex(encoding) <= 700.0, "{name}: encoder {:.0}", per_vertex(encoding));
        assert!(per_vertex(decoding) <= 250.0, "{name}: decoder {:.0}", per_vertex(decoding));
    }
}

#[test]
fn what_limits_allow_is_an_upper_bound() {
    let _turn = turn();
    warm_up();
    for (name, mesh) in large_meshes() {
        let mut options = EncodeOptions::default();
        let small = encode(&mesh, &options).unwrap().bytes;
        options.profile = Some(Profile::Max);
        let max = encode(&mesh, &options).unwrap().bytes;
        // Whatever memory is allowed, the decoder holds no more, and says so when it stops.
        for (stream, max_memory) in
            [1, 4, 8, 16, 24, 48].into_iter().flat_map(|m| [(&small, m << 20), (&max, m << 20)])
        {
            let limits = Limits { max_memory, ..Limits::default() };
            let mut decoder = Decoder::new(limits);
            let (error, held) = peak(|| stream.chunks(1 << 12).find_map(|bytes| decoder.push(bytes).err()));
            assert!(held as u64 <= max_memory, "{name}: {held} bytes of {max_memory}");
            match error {
                Some(DecodeError::Limit { what: "memory", needed, allowed }) => {
                    assert!(needed > allowed && allowed == max_memory, "{name}: {needed} of {allowed}");
                }
                None => assert!(decoder.is_complete(), "{name}"),
                Some(error) => panic!("{name}: {error}"),
            }
        }
    }
}

/// A header, a table of `rows`, and then `chunks`.
fn claim(rows: &[Row], chunks: &[Chunk]) -> Vec<u8> {
    let table = Chunk { kind: b'L', payload: chunks::write_table(rows) };
    chunks::join(&[&[chunks::header(12), table], chunks].concat())
}

fn row(head: &[u32], size: u32) -> Row {
    Row { head: head.to_vec(), size }
}

#[test]
fn streams_that_claim_much_in_few_bytes_get_nothing() {
    let _turn = turn();
    warm_up();
    let triangle = || Chunk::new(b'B', &[0x12; 9]);
    let billion = 1 << 30;
    let mut many_passes = vec![row(&[12, 3, 1], 9)];
    many_passes.extend((0..4096).map(|_| row(&[64, 0], 1)));
    let mut too_many_passes = chunks::write_count(u32::MAX.into());
    too_many_passes.extend([12, 3, 1, 9]);
    let cases = [
        ("a base of a billion", claim(&[row(&[12, billion, billion], 9)], &[triangle()])),
        (
            "a base of a billion with as many bytes announced",
            claim(&[row(&[12, billion / 5, billion / 5], billion)], &[triangle()]),
        ),
        (
            "a split of a billion",
            claim(&[row(&[12, 3, 1], 9), row(&[billion / 5, 0], billion)], &[triangle()]),
        ),
        ("four thousand passes", claim(&many_passes, &[triangle()])),
        ("four billion passes", {
            chunks::join(&[chunks::header(12), Chunk { kind: b'L', payload: too_many_passes }])
        }),
        ("a chunk of four gigabytes", {
            let mut stream = claim(&[row(&[12, 3, 1], u32::MAX)], &[]);
            stream.extend([b'B', 0xff, 0xff, 0xff, 0xff, 0x0f]);
            stream
        }),
        ("a skippable chunk of four gigabytes", {
            let mut stream = chunks::SIGNATURE.to_vec();
            stream.extend([b'z', 0xff, 0xff, 0xff, 0xff, 0x0f]);
            stream
        }),
    ];
    for (what, stream) in cases {
        for limits in [Limits::default(), Limits::small()] {
            let mut decoder = Decoder::new(limits);
            let (result, held) = peak(|| decoder.push(&stream).err());
            assert!(held < 3 << 20, "{what}: {held} bytes, {result:?}");
            assert!(!decoder.is_complete(), "{what}");
        }
    }
}

#[test]
fn rubbish_payloads_take_what_their_counts_need() {
    let _turn = turn();
    warm_up();
    // The most that a payload of this size may claim, filled with every kind of rubbish.
    const SIZE: u32 = 500;
    let counts = 64 * (SIZE + 1);
    let mut random = Random(3);
    for round in 0..20 {
        let payload: Vec<u8> = match round {
            0 => vec![0; SIZE as usize],
            1 => vec![0xff; SIZE as usize],
            _ => (0..SIZE).map(|_| random.next() as u8).collect(),
        };
        for (vertices, faces) in [(counts, counts), (3, counts), (counts, 1)] {
            let base = Chunk { kind: b'B', payload: payload.clone() };
            let stream = claim(&[row(&[12, vertices, faces], SIZE)], &[base]);
            let mut decoder = Decoder::new(Limits::default());
            let (_, held) = peak(|| decoder.push(&stream).err());
            let allowed = (2 << 20) + 300 * counts as usize;
            assert!(held < allowed, "round {round}: {held} bytes for {vertices} vertices, {faces} faces");
        }
    }
}

/// Beyond the limit: the table of passes, which may have 4097 rows, and tables of the coder that are made once.
const SLACK: usize = 1 << 20;

/// Decodes piece by piece within several limits, and measures.
fn check_limits(what: &str, stream: &[u8]) -> usize {
    let mut num_refused = 0;
    for max_memory in [128 << 10, 1 << 20, 3 << 20, 12 << 20, 40 << 20] {
        let limits = Limits { max_memory, ..Limits::default() };
        let decode = || {
            let mut decoder = Decoder::new(limits);
            let error = stream.chunks(1 << 12).find_map(|bytes| decoder.push(bytes).err());
            matches!(error, Some(DecodeError::Limit { what: "memory", .. }))
        };
        let (is_refused, held) = peak(decode);
        assert!(held <= max_memory as usize + SLACK, "{what}: {held} bytes of {max_memory}");
        num_refused += usize::from(is_refused);
    }
    num_refused
}

fn golden() -> Vec<(String, Vec<u8>)> {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("format/golden");
    let folders = if cfg!(feature = "fast") { vec![root.join("fast"), root] } else { vec![root] };
    let files = folders.iter().flat_map(|folder| std::fs::read_dir(folder).unwrap());
    let paths = files.map(|entry| entry.unwrap().path());
    let streams = paths.filter(|path| path.extension().is_some_and(|ending| ending == "lwc"));
    streams.map(|path| (path.display().to_string(), std::fs::read(&path).unwrap())).collect()
}

#[test]
fn no_golden_stream_takes_more_memory_than_is_allowed_whatever_happens_to_it() {
    let _turn = turn();
    warm_up();
    let mut random = Random(3);
    let streams = golden();
    assert!(streams.len() > 30);
    for (name, stream) in streams {
        check_limits(&name, &stream);
        let parts = chunks::split(&stream);
        for round in 0..12 {
            let mut mutated = parts.clone();
            for _ in 0..1 + round % 3 {
                let place = random.next() as usize % mutated.len();
                let Chunk { kind, payload } = &mut mutated[place];
                if *kind != b'L' && !payload.is_empty() {
                    let at = random.next() as usize % payload.len();
                    payload[at] = [0, 0x7f, 0xff, random.next() as u8][random.next() as usize % 4];
                }
            }
            check_limits(&format!("{name}, round {round}"), &chunks::join_resized(&mutated));
        }
    }
}

/// A golden stream with more in front of its passes.
fn with_head(added: &[Chunk], profile: u8) -> Vec<u8> {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("format/golden");
    let mut parts = chunks::split(&std::fs::read(root.join("single-triangle.lwc")).unwrap());
    parts[0].payload[0] = parts[0].payload[0] & 3 | profile << 2;
    let table = parts.iter().position(|chunk| chunk.kind == b'L').unwrap();
    parts.splice(table..table, added.iter().cloned());
    chunks::join(&parts)
}

/// So many things of `bytes` each, behind their number.
fn many(count: usize, bytes: &[u8]) -> Vec<u8> {
    [chunks::varint(count as u32), bytes.repeat(count)].concat()
}

#[test]
fn what_stands_before_the_passes_is_counted_too() {
    let _turn = turn();
    warm_up();
    let n = 200_000;
    let scene = |meshes, instances| {
        let payload = [many(meshes, &[0]), many(instances, &[0, 0, 0])].concat();
        Chunk { kind: b'n', payload }
    };
    let declarations = |attributes: Vec<u8>, libraries: Vec<u8>, passes: Vec<u8>| Chunk {
        kind: b'd',
        payload: [attributes, libraries, passes].concat(),
    };
    // A number of a vertex, uniform in one bit.
    let number = [&[0, 0, 0, 0, 1, 1, 0, 1][..], &[0; 16]].concat();
    // Names of faces: 60,000 empty ones.
    let names = [&[0, 4, 2, 0, 8, 1, 2][..], &many(60_000, &[0])].concat();
    let cases = [
        ("instances", with_head(&[scene(1, n)], 0), 3),
        ("meshes", with_head(&[scene(n, 1)], 0), 3),
        ("images", with_head(&[Chunk { kind: b'm', payload: [&[0][..], &many(n, &[0])].concat() }], 0), 2),
        ("libraries", with_head(&[declarations(vec![0], many(n, &[0]), many(1, &[0]))], 0), 3),
        ("tables of names", with_head(&[declarations(many(9, &names), vec![0], many(1, &[1]))], 0), 3),
        ("passes", with_head(&[declarations(vec![0], vec![0], many(n, &[0]))], 0), 1),
        ("models", with_head(&[declarations(many(64, &number), vec![0], many(1, &[9]))], 0), 4),
        ("large models", with_head(&[declarations(many(64, &number), vec![0], many(1, &[9]))], 2), 5),
        ("compensation", with_head(&[Chunk { kind: b'c', payload: vec![0; n] }], 0), 1),
        (
            "all of that",
            with_head(&[scene(n / 2, n / 2), declarations(many(3, &names), many(n, &[0]), many(1, &[1]))], 2),
            4,
        ),
    ];
    for (what, stream, least) in cases {
        let num_refused = check_limits(what, &stream);
        assert!(num_refused >= least, "{what}: refused {num_refused} times");
    }
}
