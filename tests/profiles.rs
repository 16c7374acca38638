//! All profiles of a mesh decode to the same meshes, pass by pass.
#![cfg(all(feature = "encoder", feature = "fast"))]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

mod common;

use common::chunks;
use common::exact::assert_round_trip;
use common::kinds::{beside, every_kind};
use common::*;
use lwc::{
    DecodeError, Decoder, EncodeOptions, Limits, Optimize, Partition, Profile, Step, TriMesh, encode,
    encode_with_attributes,
};

fn stream(mesh: &TriMesh, profile: Profile, partition: Partition) -> Vec<u8> {
    let mut options = EncodeOptions::default();
    options.profile = Some(profile);
    options.partition = partition;
    options.steps_per_edge = Some(6.0);
    encode(mesh, &options).unwrap().bytes
}

/// Level, precision and checksum after each pass, decoded in slices of `work`.
fn meshes(stream: &[u8], work: u32) -> Vec<(u32, u32, u32)> {
    let mut decoder = Decoder::new(Limits::default());
    decoder.feed(stream).unwrap();
    let mut meshes = Vec::new();
    loop {
        match decoder.step_within(work).unwrap() {
            Step::Finished(update) => {
                let mesh = decoder.mesh().unwrap();
                meshes.push((update.pass.level, update.pass.quantization_bits, mesh.checksum()));
            }
            Step::Unfinished => {}
            Step::Waiting => break,
        }
    }
    assert!(decoder.is_complete());
    meshes
}

#[test]
fn every_profile_gives_the_same_meshes() {
    for (name, mesh) in every_kind() {
        for partition in Partition::ALL {
            let small = meshes(&stream(&mesh, Profile::Small, partition), u32::MAX);
            for profile in [Profile::Max, Profile::Fast] {
                let what = format!("{name}, {}, {}", partition.name(), profile.name());
                let other = stream(&mesh, profile, partition);
                assert_eq!(meshes(&other, u32::MAX), small, "{what}");
                assert_eq!(meshes(&other, 7), small, "{what}, in slices");
            }
        }
    }
}

/// Meshes whose base is in tables.
#[test]
fn one_piece_is_the_same_mesh_in_every_profile() {
    let bumpy = |x: f64, y: f64| 0.6 * (0.7 * x).sin() * (0.5 * y).cos();
    let sheet = noisy(grid(60, 50, bumpy), 2, 0.05);
    for (name, mesh) in [
        ("torus", noisy(torus(70, 40), 1, 0.004)),
        ("sheet", sheet.clone()),
        ("pieces", beside(beside(genus3(), sheet), beside(sphere(2), noisy(torus(9, 7), 1, 0.02)))),
        ("soup", soup(2100, 700, 3)),
    ] {
        let stream = |profile| {
            let mut options = EncodeOptions::default();
            (options.levels, options.profile) = (Some(0), Some(profile));
            encode(&mesh, &options).unwrap().bytes
        };
        let (small, fast) = (stream(Profile::Small), stream(Profile::Fast));
        let base = chunks::split(&fast).into_iter().find(|chunk| chunk.kind == b'B').unwrap();
        assert_eq!(base.payload[0], 1, "{name}: not in tables");
        assert_eq!(meshes(&fast, u32::MAX), meshes(&small, u32::MAX), "{name}");
        assert_eq!(meshes(&fast, 50), meshes(&small, u32::MAX), "{name}, in slices");
        assert!(fast.len() * 10 < small.len() * 12, "{name}: {} and {} bytes", fast.len(), small.len());
    }
}

#[test]
fn fast_streams_return_at_every_precision() {
    for quantization in [1, 8, 16, 30] {
        for (name, mesh) in [("torus", noisy(torus(20, 9), 1, 0.02)), ("soup", soup(40, 90, 3))] {
            let mut options = EncodeOptions::default();
            (options.profile, options.quantization_bits) = (Some(Profile::Fast), quantization);
            let encoded = assert_round_trip(&mesh, &options, name);
            assert_eq!(encoded.info.profile(), Profile::Fast);
        }
    }
}

/// A stream that is cut gives the mesh of its last whole pass, and the bytes may come one by one.
#[test]
fn fast_streams_can_be_cut() {
    let stream = stream(&noisy(torus(20, 9), 1, 0.02), Profile::Fast, Partition::WeightedError);
    let whole = meshes(&stream, u32::MAX);
    let mut decoder = Decoder::new(Limits::default());
    for byte in stream.chunks(1) {
        for update in decoder.push(byte).unwrap() {
            let mesh = decoder.mesh().unwrap();
            assert_eq!(whole[decoder.passes_done() - 1].2, mesh.checksum(), "{update:?}");
        }
        let preview = decoder.preview().map(|mesh| mesh.num_triangles());
        assert_eq!(preview, decoder.mesh().map(|mesh| mesh.num_triangles()));
    }
    assert_eq!(decoder.passes_done(), whole.len());
}

/// What the profile is for: it is no larger, on meshes that are not tiny.
#[test]
fn max_is_smaller_than_small() {
    let bumpy = |x: f64, y: f64| 0.6 * (0.7 * x).sin() * (0.5 * y).cos();
    for (name, mesh) in
        [("torus", noisy(torus(70, 40), 1, 0.004)), ("grid", noisy(grid(60, 50, bumpy), 2, 0.05))]
    {
        let [max, small] = [Profile::Max, Profile::Small]
            .map(|profile| stream(&mesh, profile, Partition::WeightedError).len());
        assert!(max < small, "{name}: {max} and {small} bytes");
    }
}

#[test]
fn only_the_size_of_the_file_asks_for_max() {
    let mesh = noisy(torus(20, 9), 1, 0.02);
    let profile = |optimize: Optimize, profile: Option<Profile>| {
        let mut options = EncodeOptions::default();
        (options.optimize, options.profile) = (optimize, profile);
        encode(&mesh, &options).unwrap().info.profile()
    };
    for optimize in Optimize::ALL {
        let usual = if optimize == Optimize::Size { Profile::Max } else { Profile::Small };
        assert_eq!(profile(optimize, None), usual);
        for wanted in Profile::ALL {
            assert_eq!(profile(optimize, Some(wanted)), wanted);
        }
    }
}

/// The profile is that of the header, wherever the declarations stand.
#[test]
fn declarations_may_stand_before_the_header() {
    let mesh = noisy(sphere(2), 9, 0.02);
    for profile in Profile::ALL {
        let mut options = EncodeOptions::default();
        options.profile = Some(profile);
        let colours = attributed::all(vec![attributed::colours(&mesh)]);
        let stream = encode_with_attributes(&mesh, &colours, &options, &|_| {}).unwrap().bytes;
        let decoded = |stream: &[u8]| {
            let mut decoder = Decoder::new(Limits::default());
            decoder.push(stream).unwrap();
            assert!(decoder.is_complete());
            (decoder.mesh().unwrap().checksum(), decoder.attribute_checksum())
        };
        let mut chunks = chunks::split(&stream);
        let at = chunks.iter().position(|chunk| chunk.kind == b'd').unwrap();
        assert_eq!((at, chunks[0].kind), (1, b'H'));
        chunks.swap(0, 1);
        assert_eq!(decoded(&chunks::join(&chunks)), decoded(&stream), "{}", profile.name());
    }
}

#[test]
fn profiles_to_come_are_unsupported() {
    let mut chunks = chunks::split(&stream(&torus(9, 5), Profile::Small, Partition::WeightedError));
    chunks[0].payload[0] |= 3 << 2;
    let stream = chunks::join(&chunks);
    let error = Decoder::new(Limits::default()).push(&stream).unwrap_err();
    assert!(matches!(&error, DecodeError::Unsupported(what) if what.contains("profile 3")), "{error}");
}
