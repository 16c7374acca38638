//! Coarse meshes are shown closer to the surface than their vertices lie (`format/SPEC.md`, section 9.4).
#![cfg(all(feature = "encoder", feature = "metrics"))]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

mod common;

use lwc::metrics::{CompareOptions, compare};
use lwc::{DecodeOptions, Decoder, EncodeOptions, TriMesh, decode};

/// A sphere with waves, so that bends differ.
fn wavy_sphere() -> TriMesh {
    let (positions, triangles) = common::sphere(5).into_parts();
    let wave = |p: [f64; 3]| 1.0 + 0.1 * (5.0 * p[0]).sin() * (4.0 * p[1]).cos();
    TriMesh::new(positions.iter().map(|&p| p.map(|x| x * wave(p))).collect(), triangles).unwrap()
}

fn at_level(stream: &[u8], level: u32, compensate: bool) -> TriMesh {
    decode(stream, DecodeOptions::new().level(level).shrinkage_compensation(compensate)).unwrap()
}

#[test]
fn coarse_levels_come_closer_and_the_finest_is_exact() {
    let mesh = wavy_sphere();
    let encoded = lwc::encode(&mesh, &EncodeOptions::default()).unwrap();
    let db = |shown: &TriMesh| compare(&mesh, shown, &CompareOptions::new()).unwrap().psnr_db();
    let finest = encoded.info.finest_level();
    let mut gains = Vec::new();
    for level in finest / 4..=finest / 2 {
        let [shown, lazy] = [true, false].map(|compensate| at_level(&encoded.bytes, level, compensate));
        assert_eq!(shown.triangles(), lazy.triangles());
        gains.push(db(&shown) - db(&lazy));
    }
    let mean = gains.iter().sum::<f64>() / gains.len() as f64;
    assert!(gains.len() >= 4 && mean > 1.5, "{gains:?}");
    let [shown, lazy] = [true, false].map(|compensate| at_level(&encoded.bytes, finest, compensate));
    assert_eq!(shown, lazy);
}

#[test]
fn what_an_update_names_is_all_that_moves() {
    let encoded = lwc::encode(&wavy_sphere(), &EncodeOptions::default()).unwrap();
    for compensate in [true, false] {
        let mut decoder = Decoder::with_options(DecodeOptions::new().shrinkage_compensation(compensate));
        decoder.feed(&encoded.bytes).unwrap();
        let mut before: Vec<[f64; 3]> = Vec::new();
        let mut num_whole = 0;
        while let Some(update) = decoder.step().unwrap() {
            let now = decoder.mesh().unwrap().positions();
            let first = update.vertices.start as usize;
            num_whole += usize::from(first == 0);
            assert_eq!(before[..first], now[..first]);
            before = now;
        }
        let num_refinements =
            encoded.info.passes().iter().filter(|p| p.kind == lwc::PassKind::Refine).count();
        // The base mesh and refinements move all; with compensation most passes do.
        assert_eq!(num_whole > 1 + num_refinements, compensate);
    }
}

#[test]
fn a_plane_needs_none() {
    let plane = common::grid(40, 40, |_, _| 0.0);
    let encoded = lwc::encode(&plane, &EncodeOptions::default()).unwrap();
    assert!(encoded.info.passes().iter().all(|pass| pass.compensation() == [0.0; 2]));
}
