//! Damaged and hostile streams: an error of the right kind, and the last good mesh is still there.
#![cfg(feature = "encoder")]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

mod common;

use common::chunks::{self, Chunk, Row};
use common::valid::assert_valid;
use common::*;
use lwc::{
    DecodeError, Decoder, EncodeOptions, Limits, Partition, PassKind, Profile, Step, StreamInfo, encode,
};

/// Streams of a few hundred bytes with every kind of pass.
fn streams() -> Vec<(&'static str, Vec<u8>)> {
    let mut cases = Vec::new();
    let torus = noisy(torus(9, 5), 1, 0.02);
    for (name, mesh, partition, quantization, profile) in [
        ("torus", torus.clone(), Partition::WeightedError, 9, Profile::Small),
        ("grid", noisy(grid(7, 6, |x, y| 0.2 * x * y), 2, 0.05), Partition::Algorithm1, 8, Profile::Small),
        ("strip", noisy(strip(34), 3, 0.02), Partition::WeightedError, 7, Profile::Small),
        ("max torus", torus.clone(), Partition::WeightedError, 9, Profile::Max),
        ("fast torus", torus, Partition::WeightedError, 9, Profile::Fast),
        ("fast strip", noisy(strip(34), 3, 0.02), Partition::Algorithm1, 7, Profile::Fast),
    ] {
        if !profile.is_supported() {
            continue;
        }
        let mut options = EncodeOptions::default();
        options.partition = partition;
        options.profile = Some(profile);
        options.quantization_bits = quantization;
        options.steps_per_edge = Some(5.0);
        options.levels = Some(4);
        // Not the usual one, so that it is written.
        options.growth = 2.0;
        let stream = encode(&mesh, &options).unwrap().bytes;
        assert!((100..700).contains(&stream.len()), "{name}: {} bytes", stream.len());
        cases.push((name, stream));
    }
    cases
}

/// What a stream is when nothing happens to it: per pass its end and its mesh's checksum.
struct Clean {
    ends: Vec<usize>,
    checksums: Vec<u32>,
}

impl Clean {
    fn of(stream: &[u8]) -> Self {
        let mut decoder = Decoder::new(Limits::default());
        decoder.feed(stream).unwrap();
        let (mut ends, mut checksums) = (Vec::new(), Vec::new());
        while let Some(update) = decoder.step().unwrap() {
            ends.push(update.pass.end as usize);
            checksums.push(decoder.mesh().unwrap().checksum());
        }
        assert!(decoder.is_complete());
        Self { ends, checksums }
    }

    fn checksum(&self, done: usize) -> Option<u32> {
        done.checked_sub(1).map(|last| self.checksums[last])
    }
}

/// Decodes to the end or the first error. After every pass the mesh is valid; after an error it is
/// that of the last pass, and the decoder takes nothing more.
#[track_caller]
fn decode_all(stream: &[u8], limits: Limits, what: &str) -> (Decoder, Option<DecodeError>) {
    let mut decoder = Decoder::new(limits);
    let mut checksum = None;
    let error = loop {
        let step = if decoder.passes_done() == 0 { decoder.feed(stream) } else { Ok(()) };
        match step.and_then(|()| decoder.step()) {
            Ok(None) => break None,
            Ok(Some(_)) => {
                let mesh = decoder.mesh().expect("an update has a mesh");
                assert_valid(mesh, what);
                checksum = Some(mesh.checksum());
            }
            Err(error) => break Some(error),
        }
    };
    assert_eq!(decoder.mesh().map(|m| m.checksum()), checksum, "{what}: another mesh after {error:?}");
    if let Some(error) = &error {
        assert_ne!(*error, DecodeError::Failed, "{what}");
        assert!(!error.to_string().is_empty());
        for bytes in [&stream[..0], stream] {
            assert_eq!(decoder.push(bytes), Err(DecodeError::Failed), "{what}");
            assert_eq!(decoder.feed(bytes), Err(DecodeError::Failed), "{what}");
        }
        assert_eq!(decoder.step(), Err(DecodeError::Failed), "{what}");
        assert_eq!(decoder.mesh().map(|m| m.checksum()), checksum, "{what}: the mesh was lost");
    }
    let (done, same_error) = decode_in_slices(stream, limits);
    assert_eq!(same_error, error, "{what}: in slices");
    assert_eq!(done.passes_done(), decoder.passes_done(), "{what}: in slices");
    assert_eq!(done.mesh().map(|m| m.checksum()), checksum, "{what}: in slices");
    (decoder, error)
}

/// The same with passes that rest often.
fn decode_in_slices(stream: &[u8], limits: Limits) -> (Decoder, Option<DecodeError>) {
    let mut decoder = Decoder::new(limits);
    let mut step = decoder.feed(stream).map(|()| Step::Unfinished);
    loop {
        match step {
            Ok(Step::Waiting) => return (decoder, None),
            Ok(_) => step = decoder.step_within(19),
            Err(error) => return (decoder, Some(error)),
        }
    }
}

/// Decodes a stream that equals `stream` up to some byte, and checks that what comes before is there.
#[track_caller]
fn check_damaged(clean: &Clean, stream: &[u8], damaged: &[u8], what: &str) -> Option<DecodeError> {
    let same = stream.iter().zip(damaged).take_while(|(a, b)| a == b).count();
    let wanted = clean.ends.iter().filter(|&&end| end <= same).count();
    let (decoder, error) = decode_all(damaged, Limits::default(), what);
    assert_eq!(decoder.passes_done(), wanted, "{what}: {error:?}");
    assert_eq!(decoder.mesh().map(|m| m.checksum()), clean.checksum(wanted), "{what}: {error:?}");
    error
}

#[test]
fn every_flipped_bit_costs_what_follows_and_nothing_before() {
    for (name, stream) in streams() {
        let clean = Clean::of(&stream);
        let mut silent = 0;
        for offset in 0..stream.len() {
            for mask in (0..8).map(|bit| 1 << bit).chain([0xff, 0x0f]) {
                let mut damaged = stream.clone();
                damaged[offset] ^= mask;
                let what = format!("{name}, byte {offset} ^ {mask:#04x}");
                match (offset, check_damaged(&clean, &stream, &damaged, &what)) {
                    (0..3, error) => assert_eq!(error, Some(DecodeError::NotAStream), "{what}"),
                    (3, error) => assert!(matches!(error, Some(DecodeError::Unsupported(_))), "{what}"),
                    (_, Some(DecodeError::Checksum { .. } | DecodeError::Malformed { .. })) => {}
                    // A longer length waits for bytes that do not come.
                    (_, None) => silent += 1,
                    (_, error) => panic!("{what}: {error:?}"),
                }
            }
        }
        let frames = chunks::split(&stream).len();
        assert!(silent <= 20 * frames, "{name}: {silent} damages unnoticed in {frames} chunks");
    }
}

#[test]
fn every_byte_left_out_or_put_in_is_noticed() {
    for (name, stream) in streams() {
        let clean = Clean::of(&stream);
        for offset in 0..stream.len() {
            let mut shorter = stream.clone();
            shorter.remove(offset);
            check_damaged(&clean, &stream, &shorter, &format!("{name}, without byte {offset}"));
            for byte in [0, 0x53, 0xff] {
                let mut longer = stream.clone();
                longer.insert(offset, byte);
                check_damaged(&clean, &stream, &longer, &format!("{name}, {byte} before byte {offset}"));
            }
        }
    }
}

#[test]
fn a_stream_that_goes_on_as_rubbish_is_damaged_from_there() {
    for (name, stream) in streams() {
        let clean = Clean::of(&stream);
        let mut random = Random(1);
        for cut in 0..stream.len() {
            let mut damaged = stream[..cut].to_vec();
            damaged.extend((0..300).map(|_| random.next() as u8));
            check_damaged(&clean, &stream, &damaged, &format!("{name}, rubbish from byte {cut}"));
        }
    }
}

#[test]
fn bytes_after_the_end_are_ignored() {
    for (name, stream) in streams() {
        let clean = Clean::of(&stream);
        let mut longer = stream.clone();
        longer.extend_from_slice(&stream);
        longer.extend_from_slice(&[0xff; 50]);
        let (decoder, error) = decode_all(&longer, Limits::default(), name);
        assert_eq!((error, decoder.is_complete()), (None, true), "{name}");
        assert_eq!(decoder.passes_done(), clean.ends.len(), "{name}");
    }
}

#[test]
fn other_signatures_and_versions_are_told_apart() {
    let (_, stream) = streams().swap_remove(0);
    for version in [0, 2, 3, 255] {
        let mut newer = stream.clone();
        newer[3] = version;
        let (_, error) = decode_all(&newer, Limits::default(), "another version");
        let Some(DecodeError::Unsupported(message)) = error else { panic!("{error:?}") };
        assert!(message.contains(&version.to_string()), "{message}");
    }
    for other in [&b"PLY\n"[..], b"\0", b"L\0", b"lwc\x01", b"\x28\xb5\x2f\xfd"] {
        let (_, error) = decode_all(other, Limits::default(), "another file");
        assert_eq!(error, Some(DecodeError::NotAStream));
    }
}

#[test]
fn chunks_out_of_place_never_make_a_mesh_that_is_not_one() {
    for (name, stream) in streams() {
        let clean = Clean::of(&stream);
        let parts = chunks::split(&stream);
        let num_leading = parts.iter().take_while(|c| !c.is_pass()).count();
        let mut cases: Vec<(String, Vec<Chunk>)> = Vec::new();
        for i in 0..parts.len() {
            let mut dropped = parts.clone();
            dropped.remove(i);
            cases.push((format!("without chunk {i}"), dropped));
            let mut twice = parts.clone();
            twice.insert(i, parts[i].clone());
            cases.push((format!("chunk {i} twice"), twice));
            for j in 0..i {
                let mut swapped = parts.clone();
                swapped.swap(i, j);
                cases.push((format!("chunks {j} and {i} swapped"), swapped));
            }
        }
        for (case, chunks) in cases {
            let what = format!("{name}, {case}");
            let same = parts.iter().zip(&chunks).take_while(|(a, b)| a == b).count();
            let unharmed = same.saturating_sub(num_leading);
            let (decoder, error) = decode_all(&chunks::join(&chunks), Limits::default(), &what);
            assert!(decoder.passes_done() >= unharmed, "{what}: {error:?}");
            if decoder.passes_done() == unharmed {
                assert_eq!(decoder.mesh().map(|m| m.checksum()), clean.checksum(unharmed), "{what}");
            }
            let is_pass_of_another_shape = parts.get(same).zip(chunks.get(same)).is_some_and(|(a, b)| {
                a.is_pass() && b.is_pass() && (a.kind, a.payload.len()) != (b.kind, b.payload.len())
            });
            if is_pass_of_another_shape {
                // The table says how many bytes are read.
                assert!(error.is_some() || !decoder.is_complete(), "{what}");
            }
        }
    }
}

#[test]
fn the_leading_chunks_must_be_there_once_and_in_order() {
    let (name, stream) = streams().swap_remove(0);
    let parts = chunks::split(&stream);
    let kinds: Vec<u8> = parts.iter().take_while(|c| !c.is_pass()).map(|c| c.kind).collect();
    assert_eq!(kinds, b"HpcL");
    // How coarse meshes are shown changes no cell.
    let no_shrinkage_compensation = [&parts[..2], &parts[3..]].concat();
    let (decoder, error) = decode_all(&chunks::join(&no_shrinkage_compensation), Limits::default(), name);
    assert_eq!((error, decoder.is_complete()), (None, true));
    assert_eq!(decoder.mesh().unwrap().checksum(), *Clean::of(&stream).checksums.last().unwrap());
    // Provenance is for people only: it may be missing.
    let without = [&parts[..1], &parts[2..]].concat();
    let (decoder, error) = decode_all(&chunks::join(&without), Limits::default(), name);
    assert_eq!((error, decoder.is_complete()), (None, true));
    assert_eq!(decoder.info().unwrap().descriptor_code(), None);
    let orders: [&[usize]; 7] =
        [&[0, 0, 1, 2, 3], &[3, 0, 1], &[0, 1, 3, 3], &[0, 1, 3, 0], &[1, 3], &[0, 1], &[0, 2, 1, 2, 3]];
    for order in orders {
        let mut chunks: Vec<Chunk> = order.iter().map(|&i| parts[i].clone()).collect();
        chunks.extend_from_slice(&parts[4..]);
        let (decoder, error) = decode_all(&chunks::join(&chunks), Limits::default(), name);
        assert!(matches!(error, Some(DecodeError::Malformed { .. })), "{order:?}: {error:?}");
        assert!(decoder.mesh().is_none(), "{order:?}");
    }
}

#[test]
fn unknown_chunks_are_skipped_if_they_may_be() {
    for (name, stream) in streams() {
        let clean = Clean::of(&stream);
        let parts = chunks::split(&stream);
        for place in 0..=parts.len() {
            for payload in [&b""[..], b"a comment", &[0xff; 200]] {
                let with = |kind| {
                    let mut chunks = parts.clone();
                    chunks.insert(place, Chunk::new(kind, payload));
                    chunks::join(&chunks)
                };
                let what = format!("{name}, before chunk {place}");
                let (decoder, error) = decode_all(&with(b'z'), Limits::default(), &what);
                assert_eq!((error, decoder.is_complete()), (None, true), "{what}");
                assert_eq!(decoder.mesh().unwrap().checksum(), *clean.checksums.last().unwrap(), "{what}");

                let (decoder, error) = decode_all(&with(b'Z'), Limits::default(), &what);
                if place == parts.len() {
                    // Behind the last pass nothing is read.
                    assert_eq!((error, decoder.is_complete()), (None, true), "{what}");
                } else {
                    assert!(matches!(error, Some(DecodeError::Unsupported(_))), "{what}: {error:?}");
                    let done = parts[..place].iter().filter(|c| c.is_pass()).count();
                    assert_eq!(decoder.passes_done(), done, "{what}");
                }
            }
        }
    }
}

/// A mutated payload under a valid checksum. Passes before it are unharmed, what follows is a mesh or
/// an error.
#[track_caller]
fn check_hostile(clean: &Clean, chunks: &[Chunk], place: usize, what: &str) -> Option<DecodeError> {
    let before = chunks[..place].iter().filter(|c| c.is_pass()).count();
    let (decoder, error) = decode_all(&chunks::join_resized(chunks), Limits::default(), what);
    assert!(decoder.passes_done() >= before, "{what}: {error:?}");
    if decoder.passes_done() == before {
        assert_eq!(decoder.mesh().map(|m| m.checksum()), clean.checksum(before), "{what}: {error:?}");
    }
    error
}

#[test]
fn hostile_payloads_are_refused_or_meshes() {
    for (name, stream) in streams() {
        let clean = Clean::of(&stream);
        let parts = chunks::split(&stream);
        let mut errors = 0;
        for (place, part) in parts.iter().enumerate().filter(|(_, part)| part.is_pass()) {
            for offset in 0..part.payload.len() {
                for mask in [0x01, 0x10, 0x80, 0xff] {
                    let mut chunks = parts.clone();
                    chunks[place].payload[offset] ^= mask;
                    let what = format!("{name}, chunk {place}, byte {offset} ^ {mask:#04x}");
                    errors += usize::from(check_hostile(&clean, &chunks, place, &what).is_some());
                }
            }
        }
        assert!(errors > 0, "{name}: every mutation was a mesh");
    }
}

#[test]
fn payloads_of_other_lengths_are_refused_or_meshes() {
    for (name, stream) in streams() {
        let clean = Clean::of(&stream);
        let parts = chunks::split(&stream);
        for (place, part) in parts.iter().enumerate().filter(|(_, part)| part.is_pass()) {
            for length in 0..part.payload.len() {
                let mut chunks = parts.clone();
                chunks[place].payload.truncate(length);
                check_hostile(&clean, &chunks, place, &format!("{name}, chunk {place} of {length} bytes"));
            }
            let mut chunks = parts.clone();
            chunks[place].payload.extend([0; 40]);
            // Zeros are what a decoder reads behind a payload anyway.
            let (decoder, error) = decode_all(&chunks::join_resized(&chunks), Limits::default(), name);
            assert_eq!(error, None, "{name}, chunk {place} with zeros");
            assert_eq!(decoder.mesh().unwrap().checksum(), *clean.checksums.last().unwrap());
        }
    }
}

#[test]
fn random_payloads_are_refused_or_meshes() {
    let (name, stream) = streams().swap_remove(0);
    let clean = Clean::of(&stream);
    let parts = chunks::split(&stream);
    let mut random = Random(5);
    for round in 0..1500 {
        let mut chunks = parts.clone();
        let place = 4 + random.next() as usize % (parts.len() - 4);
        let payload = &mut chunks[place].payload;
        // All zeros and all ones are the ends of the coder's interval.
        match round % 4 {
            0 => payload.fill(0),
            1 => payload.fill(0xff),
            _ => payload.iter_mut().for_each(|byte| *byte = random.next() as u8),
        }
        check_hostile(&clean, &chunks, place, &format!("{name}, round {round}, chunk {place}"));
    }
}

#[test]
fn hostile_headers_and_tables_are_refused_or_meshes() {
    for (name, stream) in streams() {
        let clean = Clean::of(&stream);
        let parts = chunks::split(&stream);
        for (place, part) in parts.iter().enumerate().take_while(|(_, part)| !part.is_pass()) {
            for offset in 0..part.payload.len() {
                for value in [0, 1, 2, 0x1f, 0x7f, 0x80, 0xff] {
                    let mut chunks = parts.clone();
                    chunks[place].payload[offset] = value;
                    let what = format!("{name}, chunk {place}, byte {offset} = {value}");
                    let (decoder, error) = decode_all(&chunks::join(&chunks), Limits::default(), &what);
                    if chunks == parts {
                        assert_eq!(error, None, "{what}");
                    }
                    for position in decoder.mesh().iter().flat_map(|mesh| mesh.positions()) {
                        assert!(position.iter().all(|c| c.is_finite()), "{what}: {position:?}");
                    }
                }
            }
        }
        assert!(!clean.ends.is_empty());
    }
}

#[test]
fn counts_that_differ_from_the_payload_are_refused() {
    for (name, stream) in streams() {
        let parts = chunks::split(&stream);
        let table = parts.iter().position(|part| part.kind == b'L').unwrap();
        let rows = chunks::read_table(&parts[table].payload);
        for (pass, row) in rows.iter().enumerate() {
            // The precision and the faces of a base mesh are what the table says; every other count is
            // found again in the payload.
            let counts = if pass == 0 { 1..2 } else { 0..row.head.len() };
            for number in counts {
                for change in [-1, 1, 5] {
                    let mut rows = rows.clone();
                    let count = i64::from(row.head[number]) + change;
                    // 0 vertices would be a refinement.
                    let Some(count) = u32::try_from(count).ok().filter(|&c| c > 0 || number > 0) else {
                        continue;
                    };
                    if row.head == [0] {
                        continue;
                    }
                    rows[pass].head[number] = count;
                    let mut chunks = parts.clone();
                    chunks[table].payload = chunks::write_table(&rows);
                    let what = format!("{name}, pass {pass}, number {number} changed by {change}");
                    let (decoder, error) = decode_all(&chunks::join(&chunks), Limits::default(), &what);
                    assert!(matches!(error, Some(DecodeError::Malformed { .. })), "{what}: {error:?}");
                    assert!(decoder.passes_done() <= pass, "{what}");
                }
            }
        }
    }
}

/// A stream of nothing but a header, a table and passes of zeros.
fn claim(quantization_bits: u8, rows: &[(&[u32], u32)], sent: usize) -> Vec<u8> {
    let rows: Vec<Row> = rows.iter().map(|&(head, size)| Row { head: head.to_vec(), size }).collect();
    let mut chunks =
        vec![chunks::header(quantization_bits), Chunk { kind: b'L', payload: chunks::write_table(&rows) }];
    for (pass, row) in rows.iter().enumerate() {
        let kind = match (pass, &row.head[..]) {
            (0, _) => b'B',
            (_, [0]) => b'R',
            _ => b'S',
        };
        chunks.push(Chunk { kind, payload: vec![0; row.size.min(sent as u32) as usize] });
    }
    chunks::join(&chunks)
}

#[test]
fn huge_claims_in_few_bytes_are_refused() {
    let billions = 1_000_000_000;
    let cases: [(&str, Vec<u8>); 9] = [
        ("base", claim(12, &[(&[12, billions, billions], 40)], 40)),
        ("base faces", claim(12, &[(&[12, 100, u32::MAX], 40)], 40)),
        ("nothing", claim(12, &[(&[12, 0, 0], 0)], 40)),
        ("split", claim(12, &[(&[12, 3, 1], 9), (&[billions, 0], 40)], 40)),
        ("more vertices than indices", claim(12, &[(&[12, 1 << 30, 5], 1 << 28)], 40)),
        ("boundary", claim(12, &[(&[12, 3, 1], 9), (&[5, 6], 40)], 40)),
        ("base of many bits", claim(12, &[(&[u32::MAX, 3, 1], 9), (&[0], 4), (&[0], 4)], 40)),
        ("refined beyond the grid", claim(2, &[(&[2, 3, 1], 9), (&[0], 4)], 40)),
        ("too many passes", {
            let mut table = chunks::write_count(u32::MAX.into());
            table.extend([12, 3, 1, 9]);
            chunks::join(&[chunks::header(12), Chunk { kind: b'L', payload: table }])
        }),
    ];
    for (what, stream) in cases {
        let (decoder, error) = decode_all(&stream, Limits::default(), what);
        assert!(matches!(error, Some(DecodeError::Malformed { .. })), "{what}: {error:?}");
        assert!(decoder.mesh().is_none(), "{what}");
    }
    // Sums that leave 32 bits.
    let mut rows: Vec<(&[u32], u32)> = vec![(&[12, 3, 1], 9)];
    rows.extend(std::iter::repeat_n((&[1_000_000_000, 0][..], 1 << 28), 5));
    let (_, error) = decode_all(&claim(12, &rows, 9), Limits::default(), "sums");
    assert!(matches!(error, Some(DecodeError::Malformed { .. })), "{error:?}");
}

#[test]
fn claims_that_match_the_size_are_held_to_the_limits() {
    // The table is consistent, the announced payloads are large, and only the first byte arrives.
    let claim_with = |sent| claim(12, &[(&[12, 30_000_000, 60_000_000], 1_000_000)], sent);
    let stream = claim_with(0);
    let mut announced = stream[..stream.len() - 2].to_vec();
    assert_eq!(announced.last(), Some(&b'B'));
    // Whatever work that would be.
    let default = Limits { max_work: Some(u64::MAX), ..Limits::default() };
    let small = Limits { max_work: Some(u64::MAX), ..Limits::small() };
    let (decoder, error) = decode_all(&announced, default, "not there yet");
    assert_eq!((error, decoder.passes_done()), (None, 0));
    assert_eq!(decoder.info().unwrap().passes()[0].vertices, 30_000_000);
    announced.extend([0; 999_999]);
    let (_, error) = decode_all(&announced, small, "not there yet");
    assert_eq!(error, None);

    let whole = claim_with(1_000_000);
    let (_, error) = decode_all(&whole, small, "too many vertices");
    assert!(matches!(error, Some(DecodeError::Limit { what: "vertices", .. })), "{error:?}");
    let limits = Limits { max_vertices: u32::MAX, ..small };
    let (_, error) = decode_all(&whole, limits, "too much memory");
    assert!(matches!(error, Some(DecodeError::Limit { what: "memory", .. })), "{error:?}");
}

#[test]
fn a_chunk_longer_than_the_memory_allowed_is_refused_at_its_length() {
    let (_, stream) = streams().swap_remove(0);
    let clean = Clean::of(&stream);
    let mut longer = stream[..clean.ends[0]].to_vec();
    longer.extend([b'z', 0xff, 0xff, 0xff, 0xff, 0x0f]);
    let (decoder, error) = decode_all(&longer, Limits::small(), "a chunk of four gigabytes");
    assert!(matches!(error, Some(DecodeError::Limit { what: "memory", .. })), "{error:?}");
    assert_eq!(decoder.passes_done(), 1);
}

#[test]
fn limits_stop_at_the_first_pass_beyond_them() {
    for (name, stream) in streams() {
        let clean = Clean::of(&stream);
        let info = StreamInfo::read(&stream).unwrap().unwrap();
        for (i, pass) in info.passes().iter().enumerate().skip(1) {
            let before = &info.passes()[i - 1];
            if pass.kind != PassKind::Split {
                continue;
            }
            for (kind, limits) in [
                ("vertices", Limits { max_vertices: before.vertices, ..Limits::default() }),
                ("levels", Limits { max_levels: before.level, ..Limits::default() }),
            ] {
                let (decoder, error) = decode_all(&stream, limits, name);
                let Some(DecodeError::Limit { what, needed, allowed }) = error else { panic!("{error:?}") };
                assert_eq!(what, kind, "{name}, pass {i}");
                assert!(needed > allowed, "{name}, pass {i}: {needed} > {allowed}");
                assert_eq!(decoder.passes_done(), i, "{name}");
                assert_eq!(decoder.mesh().map(|m| m.checksum()), clean.checksum(i), "{name}, pass {i}");
            }
        }
        let last = info.passes().last().unwrap();
        let just = Limits { max_vertices: last.vertices, max_levels: last.level, ..Limits::default() };
        let (decoder, error) = decode_all(&stream, just, name);
        assert_eq!((error, decoder.is_complete()), (None, true), "{name}");
        let (decoder, error) = decode_all(&stream, Limits { max_memory: 100, ..Limits::default() }, name);
        assert!(matches!(error, Some(DecodeError::Limit { what: "memory", .. })), "{error:?}");
        assert!(decoder.mesh().is_none());
    }
}

#[test]
fn errors_do_not_depend_on_the_cuts() {
    let (name, stream) = streams().swap_remove(1);
    let parts = chunks::split(&stream);
    let mut random = Random(9);
    for round in 0..60 {
        let mut chunks = parts.clone();
        let place = 2 + random.next() as usize % (parts.len() - 2);
        let length = chunks[place].payload.len();
        chunks[place].payload[random.next() as usize % length] ^= 1 << (random.next() % 8);
        let hostile = chunks::join(&chunks);
        let (whole, error) = decode_all(&hostile, Limits::default(), name);
        let mut decoder = Decoder::new(Limits::default());
        let cut_error = hostile.chunks(1).find_map(|byte| decoder.push(byte).err());
        assert_eq!(cut_error, error, "round {round}, chunk {place}");
        let checksums = [&whole, &decoder].map(|d| d.mesh().map(|m| m.checksum()));
        assert_eq!(checksums[0], checksums[1], "round {round}, chunk {place}");
    }
}

#[test]
fn work_beyond_the_limit_is_refused_at_the_table_or_where_it_is_met() {
    for (name, stream) in streams() {
        let clean = Clean::of(&stream);
        let with = |max_work| Limits { max_work: Some(max_work), ..Limits::default() };
        let (whole, error) = decode_all(&stream, with(u64::MAX), name);
        assert_eq!(error, None, "{name}");
        let done = whole.work_done();
        // What the table forecasts is a bound on what is done.
        for allowed in [0, 1, done / 2, done - 1] {
            let (decoder, error) = decode_all(&stream, with(allowed), name);
            let Some(DecodeError::Limit { what: "work", needed, allowed: told }) = error else {
                panic!("{name}, {allowed} of {done}: {error:?}");
            };
            assert!(told == allowed && needed > allowed, "{name}: {needed} of {allowed}");
            let passes = decoder.passes_done();
            assert_eq!(decoder.mesh().map(|m| m.checksum()), clean.checksum(passes), "{name}");
            assert!(decoder.work_done() <= allowed, "{name}: {} of {allowed}", decoder.work_done());
        }
    }
}

/// A base mesh of many triangles in few bytes, and splits of one vertex that walk all of them.
#[test]
fn splits_that_cost_more_than_their_bytes_earn_are_refused() {
    let base: (&[u32], u32) = (&[12, 40_401, 80_000], 6000);
    let with = |split: &[u32], bytes, count| {
        let mut rows = vec![base];
        rows.extend(std::iter::repeat_n((split, bytes), count));
        claim(12, &rows, usize::MAX)
    };
    for (split, bytes, count) in
        [(&[1, 1][..], 12, 128), (&[1, 0], 60, 30), (&[64, 0], 9, 4096), (&[1, 1], 12, 4)]
    {
        let stream = with(split, bytes, count);
        let (decoder, error) = decode_all(&stream, Limits::default(), "splits of one vertex");
        assert!(matches!(error, Some(DecodeError::Limit { what: "work", .. })), "{error:?}");
        assert_eq!((decoder.passes_done(), decoder.work_done()), (0, 0), "{count} splits");
        // Nothing is decoded for what a stream says of itself.
        assert_eq!(StreamInfo::read(&stream).unwrap().unwrap().passes().len(), count + 1);
    }
    // Bytes that are there earn it.
    let (_, error) = decode_all(&with(&[10_000, 0], 20_000, 3), Limits::default(), "large splits");
    assert!(matches!(error, Some(DecodeError::Malformed { .. })), "{error:?}");
}
