//! A stream may arrive in any pieces and end anywhere; what is there is always a mesh.
#![cfg(feature = "encoder")]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

mod common;

use common::kinds::beside;
use common::valid::assert_valid;
use common::*;
use lwc::{
    DecodeError, DecodeOptions, Decoder, EncodeOptions, LevelMesh, Limits, Partition, PassInfo, PassKind,
    Step, StreamInfo, TriMesh, Update, decode, encode,
};

/// Streams with splits inside and on the boundary, ears, several components, and refinements between
/// and after the splits.
fn streams() -> Vec<(&'static str, Vec<u8>)> {
    let bumpy = |x: f64, y: f64| 0.6 * (0.7 * x).sin() * (0.5 * y).cos();
    let mut cases = Vec::new();
    for (name, mesh, partition, quantization) in [
        ("sphere", noisy(sphere(2), 1, 0.02), Partition::WeightedError, 12),
        ("grid", noisy(grid(12, 11, bumpy), 2, 0.05), Partition::Algorithm1, 10),
        ("strip", noisy(strip(60), 3, 0.02), Partition::WeightedError, 9),
        ("torus", noisy(torus(9, 5), 4, 0.02), Partition::Algorithm1, 14),
        ("components", beside(torus(8, 5), noisy(strip(30), 6, 0.1)), Partition::WeightedError, 11),
        ("soup", soup(25, 60, 5), Partition::WeightedError, 8),
    ] {
        let mut options = EncodeOptions::default();
        options.partition = partition;
        options.quantization_bits = quantization;
        options.steps_per_edge = Some(6.0);
        cases.push((name, encode(&mesh, &options).unwrap().bytes));
    }
    cases
}

fn info_of(stream: &[u8]) -> StreamInfo {
    StreamInfo::read(stream).unwrap().unwrap()
}

/// Owned copy of a mesh: level, precision, cells, triangles.
#[derive(Clone, Debug, Default, PartialEq)]
struct Copied {
    level: u32,
    quantization_bits: u32,
    cells: Vec<[i32; 3]>,
    triangles: Vec<[u32; 3]>,
}

impl From<LevelMesh<'_>> for Copied {
    fn from(mesh: LevelMesh) -> Self {
        Self {
            level: mesh.level(),
            quantization_bits: mesh.quantization_bits(),
            cells: mesh.quantized_positions().to_vec(),
            triangles: mesh.triangles().to_vec(),
        }
    }
}

/// Bytes up to the end of a pass alone.
fn end_of_pass(pass: &PassInfo) -> u64 {
    pass.end - pass.stitching_bytes - pass.attribute_bytes
}

/// Update and mesh after every pass, one at a time.
fn steps(stream: &[u8]) -> Vec<(Update, Copied)> {
    let mut decoder = Decoder::new(Limits::default());
    decoder.feed(stream).unwrap();
    let mut steps = Vec::new();
    while let Some(update) = decoder.step().unwrap() {
        steps.push((update, decoder.mesh().unwrap().into()));
    }
    assert!(decoder.is_complete());
    steps
}

#[test]
fn the_streams_of_these_tests_have_all_kinds_of_passes() {
    for (name, stream) in streams() {
        let passes: Vec<PassKind> = info_of(&stream).passes().iter().map(|p| p.kind).collect();
        assert_eq!(passes[0], PassKind::Base, "{name}");
        assert!(passes.contains(&PassKind::Split) && passes.contains(&PassKind::Refine), "{name}");
        assert!(stream.len() < 4000, "{name}: {} bytes are too many for every prefix", stream.len());
    }
}

#[test]
fn every_prefix_is_the_mesh_of_its_last_complete_pass_and_more_in_a_preview() {
    for (name, stream) in streams() {
        let steps = steps(&stream);
        let info = info_of(&stream);
        let mut last = (0, 0);
        let mut num_previews = 0;
        for length in 0..=stream.len() {
            let prefix = &stream[..length];
            let done = info.passes().iter().filter(|p| end_of_pass(p) <= length as u64).count();
            let mut decoder = Decoder::new(Limits::default());
            let updates = decoder.push(prefix).unwrap();
            assert_eq!((updates.len(), decoder.passes_done()), (done, done), "{name}, {length} bytes");
            assert_eq!(decoder.is_complete(), length == stream.len(), "{name}, {length} bytes");
            let one_shot = decode(prefix, DecodeOptions::new());
            let preview = decoder.preview();
            match decoder.mesh() {
                None => assert_eq!((done, one_shot), (0, Err(DecodeError::NoMesh)), "{name}, {length} bytes"),
                Some(mesh) => {
                    let counts = (mesh.num_vertices(), mesh.num_triangles());
                    assert!(counts.0 >= last.0 && counts.1 >= last.1, "{name}, {length} bytes");
                    last = counts;
                    assert_eq!(Copied::from(mesh), steps[done - 1].1, "{name}, {length} bytes");
                    let preview = preview.unwrap();
                    assert_eq!(one_shot.unwrap(), preview, "{name}, {length} bytes");
                    let after = &steps[done.min(steps.len() - 1)].1;
                    assert_lies_between(&preview, mesh, after, &format!("{name}, {length} bytes"));
                    num_previews += usize::from(preview != mesh.to_tri_mesh());
                }
            }
        }
        assert!(10 * num_previews > stream.len(), "{name}: {num_previews} bytes make a difference");
    }
}

/// A preview is a surface, unless it is stitched, with vertices of the next mesh only: those it shares with the last complete
/// one where they are or one bit finer, and new ones in place.
fn assert_lies_between(preview: &TriMesh, last: LevelMesh, next: &Copied, what: &str) {
    let joined = last.to_tri_mesh();
    assert!((joined.num_vertices()..=next.cells.len()).contains(&preview.num_vertices()), "{what}");
    assert!((joined.num_triangles()..=next.triangles.len()).contains(&preview.num_triangles()), "{what}");
    if joined.num_vertices() < last.num_vertices() {
        return;
    }
    let mut edges = std::collections::HashSet::new();
    for t in preview.triangles() {
        for i in 0..3 {
            assert!(edges.insert((t[i], t[(i + 1) % 3])), "{what}: an edge twice");
        }
    }
}

#[test]
fn every_pass_leaves_a_valid_mesh_that_is_as_announced() {
    for (name, stream) in streams() {
        let mut decoder = Decoder::new(Limits::default());
        decoder.feed(&stream).unwrap();
        let passes = info_of(&stream).passes().to_vec();
        let mut end = None;
        for (i, pass) in passes.iter().enumerate() {
            let update = decoder.step().unwrap().unwrap();
            assert_eq!(update.pass, *pass);
            let mesh = decoder.mesh().unwrap();
            assert_valid(mesh, &format!("{name}, pass {i}"));
            let found = (mesh.level(), mesh.quantization_bits(), mesh.num_vertices(), mesh.num_triangles());
            let announced =
                (pass.level, pass.quantization_bits, pass.vertices as usize, pass.triangles as usize);
            assert_eq!(found, announced, "{name}, pass {i}");
            let start = end.replace(pass.end).unwrap_or(end_of_pass(pass) - pass.bytes);
            assert_eq!(start + pass.bytes, end_of_pass(pass), "{name}, pass {i}: passes follow each other");
        }
        assert_eq!(decoder.step(), Ok(None));
        assert_eq!(info_of(&stream).total_bytes(), stream.len() as u64);
    }
}

/// Pushes the pieces and returns all updates with the mesh after each push.
fn push_pieces<'a>(name: &str, stream: &'a [u8], pieces: impl Iterator<Item = &'a [u8]>) {
    let steps = steps(stream);
    let mut decoder = Decoder::new(Limits::default());
    let mut updates = Vec::new();
    for piece in pieces {
        updates.extend(decoder.push(piece).unwrap());
        let mesh = decoder.mesh().map(Copied::from);
        assert_eq!(mesh, updates.len().checked_sub(1).map(|i| steps[i].1.clone()), "{name}");
    }
    assert!(updates.iter().eq(steps.iter().map(|(update, _)| update)), "{name}: other updates");
    assert!(decoder.is_complete(), "{name}");
}

#[test]
fn one_byte_at_a_time_is_the_same() {
    for (name, stream) in streams() {
        push_pieces(name, &stream, stream.chunks(1));
    }
}

#[test]
fn random_cuts_are_the_same() {
    for (name, stream) in streams() {
        for seed in 0..40 {
            let mut random = Random(seed);
            let longest = [3, 20, 150, 2000][seed as usize % 4];
            let mut rest = &stream[..];
            let pieces = std::iter::from_fn(|| {
                // Empty pieces are pieces as well.
                let length = rest.len().min((random.next() % longest) as usize);
                let (piece, after) = rest.split_at(length);
                let is_left = !rest.is_empty();
                rest = after;
                is_left.then_some(piece)
            });
            push_pieces(name, &stream, pieces);
        }
    }
}

#[test]
fn feeding_does_not_decode() {
    let (_, stream) = streams().swap_remove(0);
    let mut decoder = Decoder::new(Limits::default());
    decoder.feed(&stream).unwrap();
    assert_eq!((decoder.passes_done(), decoder.mesh().is_none(), decoder.is_complete()), (0, true, false));
    assert!(decoder.step().unwrap().is_some());
    assert_eq!(decoder.passes_done(), 1);
    let rest = decoder.push(&[]).unwrap();
    assert_eq!(rest.len() + 1, info_of(&stream).passes().len());
}

/// Edges of the largest patch of these streams, or numbers of the longest array / 64.
const LARGEST_ITEM: u64 = 16;

#[test]
fn work_in_slices_gives_the_same_passes_and_shows_only_those() {
    for (name, stream) in streams() {
        let steps = steps(&stream);
        let mut whole = Decoder::new(Limits::default());
        whole.push(&stream).unwrap();
        let total = whole.work_done();
        // Stitching is taken in one go.
        let passes = whole.info().unwrap().passes().iter();
        let of_stitching =
            passes.filter(|pass| pass.stitching_bytes > 0).map(|pass| 4 * u64::from(pass.vertices));
        let largest_item = LARGEST_ITEM + of_stitching.max().unwrap_or(0);
        for work in [0, 1, 7, 50, 1000, u32::MAX] {
            let mut decoder = Decoder::new(Limits::default());
            let mut pieces = stream.chunks(30);
            let (mut done, mut unfinished) = (0, 0);
            while done < steps.len() {
                let what = format!("{name}, {work} units, after pass {done}");
                let before = decoder.work_done();
                let step = decoder.step_within(work).unwrap();
                let taken = decoder.work_done() - before;
                assert!(taken <= u64::from(work.max(1)) + largest_item, "{what}: {taken} units");
                match step {
                    Step::Finished(update) => {
                        assert_eq!(update, steps[done].0, "{what}");
                        done += 1;
                    }
                    Step::Unfinished => {
                        unfinished += 1;
                        // Bytes may come at any time.
                        decoder.feed(pieces.next().unwrap_or_default()).unwrap();
                    }
                    Step::Waiting => decoder.feed(pieces.next().unwrap()).unwrap(),
                }
                assert_eq!(decoder.passes_done(), done, "{what}");
                let shown = decoder.mesh().map(Copied::from);
                assert_eq!(shown.as_ref(), done.checked_sub(1).map(|i| &steps[i].1), "{what}");
            }
            assert!(decoder.is_complete());
            assert_eq!(decoder.step_within(work), Ok(Step::Waiting));
            assert!(if work < 50 { unfinished > 30 } else { work < u32::MAX || unfinished == 0 }, "{name}");
            assert_eq!(decoder.work_done(), total, "{name}, {work} units: other work");
        }
    }
}

#[test]
fn a_pass_that_rests_is_finished_by_whatever_comes_next() {
    for (name, stream) in streams() {
        let steps = steps(&stream);
        for rests in [1, 5, 25] {
            let mut decoder = Decoder::new(Limits::default());
            decoder.feed(&stream).unwrap();
            for (i, (update, mesh)) in steps.iter().enumerate() {
                for _ in 0..rests {
                    let (before, done) = (decoder.mesh().map(Copied::from), decoder.passes_done());
                    if decoder.step_within(3).unwrap() != Step::Unfinished {
                        break;
                    }
                    assert_eq!(decoder.mesh().map(Copied::from), before, "{name}");
                    let preview = decoder.preview();
                    assert_eq!(preview, decoder.mesh().map(|mesh| mesh.to_tri_mesh()), "{name}");
                    assert_eq!(decoder.passes_done(), done, "{name}");
                }
                if decoder.passes_done() == i {
                    assert_eq!(decoder.step().unwrap().as_ref(), Some(update), "{name}");
                }
                assert_eq!(&Copied::from(decoder.mesh().unwrap()), mesh, "{name}");
            }
        }
    }
}

#[test]
fn updates_name_all_that_changed() {
    for (name, stream) in streams() {
        let mut copy = Copied::default();
        for (update, mesh) in steps(&stream) {
            let what = format!("{name}, {:?}", update.pass);
            // A viewer's copy: only what the update names is taken from the new mesh.
            copy.cells.resize(update.pass.vertices as usize, [-1; 3]);
            copy.triangles.resize(update.pass.triangles as usize, [u32::MAX; 3]);
            if update.pass.kind == PassKind::Refine {
                assert_eq!(update.vertices, 0..update.pass.vertices, "{what}");
                assert!(update.new_triangles.is_empty() && update.rewritten_triangles.is_empty(), "{what}");
            }
            let range = |r: &std::ops::Range<u32>| r.start as usize..r.end as usize;
            copy.cells[range(&update.vertices)].copy_from_slice(&mesh.cells[range(&update.vertices)]);
            let mut triangles = update.rewritten_triangles.clone();
            assert!(triangles.iter().all(|r| r.start < r.end), "{what}: empty ranges");
            triangles.push(update.new_triangles.clone());
            assert!(triangles.is_sorted_by(|a, b| a.end <= b.start), "{what}: {triangles:?}");
            for r in &triangles {
                copy.triangles[range(r)].copy_from_slice(&mesh.triangles[range(r)]);
            }
            (copy.level, copy.quantization_bits) = (update.pass.level, update.pass.quantization_bits);
            assert_eq!(copy, mesh, "{what}");
        }
    }
}

#[test]
fn a_split_rewrites_few_triangles() {
    // The ranges must be worth having: a split leaves the triangles outside its patches alone.
    let (_, stream) = streams().swap_remove(1);
    let mut untouched = 0;
    for (update, _) in steps(&stream) {
        let rewritten: u32 = update.rewritten_triangles.iter().map(|r| r.end - r.start).sum();
        assert!(rewritten <= update.new_triangles.start);
        untouched += update.new_triangles.start - rewritten;
    }
    assert!(untouched > 0);
}

#[test]
fn a_level_is_the_mesh_before_the_next_split() {
    for (name, stream) in streams() {
        let (info, steps) = (info_of(&stream), steps(&stream));
        for level in 0..=info.finest_level() + 2 {
            let mut decoder = Decoder::with_options(DecodeOptions::new().level(level));
            decoder.push(&stream).unwrap();
            assert!(decoder.is_complete(), "{name}, level {level}");
            let wanted = info.passes().iter().rposition(|p| p.level <= level).unwrap();
            assert_eq!(Copied::from(decoder.mesh().unwrap()), steps[wanted].1, "{name}, level {level}");
            assert_eq!(decoder.mesh().unwrap().level(), level.min(info.finest_level()), "{name}");
            let one_shot = decode(&stream, DecodeOptions::new().level(level)).unwrap();
            assert_eq!(one_shot, decoder.mesh().unwrap().to_tri_mesh(), "{name}, level {level}");

            // Nothing behind the level is needed or looked at.
            let end = info.passes()[wanted].end as usize;
            let mut early = Decoder::with_options(DecodeOptions::new().level(level));
            early.push(&stream[..end]).unwrap();
            assert!(early.is_complete(), "{name}, level {level}");
            assert_eq!(early.push(&[0xff; 100]), Ok(Vec::new()), "{name}, level {level}");
        }
    }
}

#[test]
fn info_needs_the_table_and_nothing_more() {
    for (name, stream) in streams() {
        let whole = info_of(&stream);
        let first: &PassInfo = &whole.passes()[0];
        let table_end = (end_of_pass(first) - first.bytes) as usize;
        for length in 0..=stream.len() {
            let info = StreamInfo::read(&stream[..length]).unwrap();
            assert_eq!(info.is_some(), length >= table_end, "{name}, {length} bytes");
            if let Some(info) = info {
                assert_eq!(format!("{info:?}"), format!("{whole:?}"), "{name}, {length} bytes");
            }
        }
    }
}

#[test]
fn info_tells_the_options() {
    let mut options = EncodeOptions::default();
    options.quantization_bits = 13;
    options.window.rings = 3;
    options.window.radius = 2.5;
    options.growth = 1.25;
    options.partition = Partition::Algorithm1;
    let mesh = map_positions(sphere(2), |p| [p[0] * 3.0 + 10.0, p[1], p[2] - 1.0]);
    let encoded = encode(&mesh, &options).unwrap();
    let info = info_of(&encoded.bytes);
    assert_eq!(format!("{info:?}"), format!("{:?}", encoded.info));
    assert_eq!((info.quantization_bits(), info.window()), (13, Some((3, 2.5, 1.25))));
    assert_eq!(info.descriptor_code(), Some(options.descriptor as u8));
    assert_eq!(info.partition_code(), Some(Partition::Algorithm1 as u8));
    let (low, high) = mesh.bounding_box().unwrap();
    assert_eq!((info.origin(), info.side()), (low, high[0] - low[0]));
    let last = info.passes().last().unwrap();
    assert_eq!((last.vertices, last.triangles, last.quantization_bits), (162, 320, 13));
}
