//! Base mesh and details: exact inverse, bands, rigid motions, noise, and details put back on a changed
//! coarse mesh.
#![cfg(feature = "encoder")]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

mod common;

use common::kinds::every_kind;
use common::*;
use lwc::multiresolution::{Decomposition, DetailTransfer, EditError, Options, Prediction, denoised};
use lwc::{DecodeOptions, EncodeOptions, Limits, Partition, TriMesh};

const WAYS: [(Prediction, bool); 4] = [
    (Prediction::Flat, false),
    (Prediction::Flat, true),
    (Prediction::Curved, false),
    (Prediction::Curved, true),
];

fn options(prediction: Prediction, update: bool) -> Options {
    let mut options = Options::default();
    options.prediction = prediction;
    options.update = update;
    options
}

/// Largest difference of coordinates of the same number, over the longest side of the box of `a`.
fn difference(a: &TriMesh, b: &TriMesh) -> f64 {
    assert_eq!(a.triangles(), b.triangles());
    let (low, high) = a.bounding_box().unwrap();
    let side = (0..3).map(|k| high[k] - low[k]).fold(f64::MIN_POSITIVE, f64::max);
    let coordinates = a.positions().as_flattened().iter().zip(b.positions().as_flattened());
    coordinates.map(|(x, y)| (x - y).abs()).fold(0.0, f64::max) / side
}

/// A turn about an oblique axis and a shift.
fn moved(p: [f64; 3]) -> [f64; 3] {
    let (s, c) = 0.8_f64.sin_cos();
    let [x, y, z] = [c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]];
    let (s, c) = (-1.9_f64).sin_cos();
    [x + 3.0, c * y - s * z - 7.0, s * y + c * z + 0.5]
}

fn bumpy_sphere() -> TriMesh {
    map_positions(noisy(sphere(4), 5, 0.004), |p| {
        let height = 1.0 + 0.05 * (9.0 * p[0]).sin() * (7.0 * p[1]).cos();
        p.map(|x| height * x)
    })
}

#[test]
fn unit_gains_are_the_identity_on_every_kind_of_mesh() {
    for (name, mesh) in every_kind() {
        for (prediction, update) in WAYS {
            for partition in Partition::ALL {
                let mut options = options(prediction, update);
                options.partition = partition;
                let Ok(mut decomposition) = Decomposition::new(&mesh, &options) else { continue };
                (1..=decomposition.num_levels()).for_each(|level| decomposition.scale_details(level, 1.0));
                let difference = difference(&mesh, &decomposition.reconstruct());
                assert!(difference < 1e-11, "{name} {prediction:?} {update}: {difference}");
            }
        }
    }
}

#[test]
fn levels_nest_and_the_finest_is_the_mesh() {
    let mesh = bumpy_sphere();
    let decomposition = Decomposition::new(&mesh, &Options::default()).unwrap();
    let levels = decomposition.num_levels();
    assert!(levels > 5 && decomposition.num_vertices(0) <= 60, "{levels}");
    for level in 1..=levels {
        let (coarse, fine) = (decomposition.level_mesh(level - 1), decomposition.level_mesh(level));
        assert_eq!(fine.num_vertices() - coarse.num_vertices(), decomposition.details(level).len());
        assert_eq!(
            coarse.positions(),
            &fine.positions()[..coarse.num_vertices()],
            "without update evens stay"
        );
        let sum: f64 = decomposition.details(level).flatten().map(|x| x * x).sum();
        let rms = (sum / decomposition.details(level).len() as f64).sqrt();
        assert!((decomposition.rms(level) - rms).abs() <= 1e-12 * rms);
    }
    assert_eq!(decomposition.num_vertices(levels), mesh.num_vertices());
}

/// A second, plain way to the surface that prediction alone makes of M^k: no details at all above k.
#[test]
fn gain_zero_above_a_level_is_the_prediction_only_surface() {
    let mesh = bumpy_sphere();
    let mut options = options(Prediction::Flat, false);
    options.levels = Some(3);
    let mut decomposition = Decomposition::new(&mesh, &options).unwrap();
    let coarse = decomposition.level_mesh(2);
    decomposition.scale_details(3, 0.0);
    let fine = decomposition.level_mesh(3);
    assert_eq!(&fine.positions()[..coarse.num_vertices()], coarse.positions());
    let mut largest = 0.0_f64;
    for v in coarse.num_vertices()..fine.num_vertices() {
        // A mean with weights ≥ 0 lies within the box of the ring.
        let faces = fine.triangles().iter().filter(|t| t.contains(&(v as u32)));
        let ring: Vec<[f64; 3]> =
            faces.flatten().filter(|&&u| u != v as u32).map(|&u| fine.positions()[u as usize]).collect();
        for k in 0..3 {
            let low = ring.iter().map(|p| p[k]).fold(f64::MAX, f64::min);
            let high = ring.iter().map(|p| p[k]).fold(f64::MIN, f64::max);
            assert!((low - 1e-12..=high + 1e-12).contains(&fine.positions()[v][k]));
        }
        largest = largest.max(ring.len() as f64);
    }
    assert!(largest >= 5.0);
    // The removed details were not nothing, and doubling what is nothing changes nothing.
    assert!(difference(&mesh, &decomposition.reconstruct()) > 1e-4);
    let once = decomposition.reconstruct();
    decomposition.scale_details(3, 2.0);
    assert_eq!(once, decomposition.reconstruct());
}

#[test]
fn a_curved_prediction_misses_less_of_a_sphere() {
    let mesh = sphere(4);
    let rms = |prediction| {
        let mut options = options(prediction, false);
        options.levels = Some(2);
        let decomposition = Decomposition::new(&mesh, &options).unwrap();
        decomposition.rms(2)
    };
    let (flat, curved) = (rms(Prediction::Flat), rms(Prediction::Curved));
    assert!(curved < 0.2 * flat, "{curved} and {flat}");
}

#[test]
fn a_rigid_motion_of_the_coarse_mesh_moves_the_fine_mesh_rigidly() {
    for mesh in [bumpy_sphere(), noisy(grid(20, 30, |x, y| (0.3 * x).sin() * (0.2 * y).cos()), 2, 0.1)] {
        let mut encode = EncodeOptions::default();
        encode.quantization_bits = 14;
        let stream = lwc::encode(&mesh, &encode).unwrap().bytes;
        let fine = lwc::decode(&stream, DecodeOptions::new()).unwrap();
        for level in [0, 2, 5] {
            let coarse = lwc::decode(&stream, DecodeOptions::new().level(level)).unwrap();
            let edition = DetailTransfer::new(&stream, coarse.num_vertices(), Limits::default()).unwrap();
            assert_eq!((edition.level(), edition.coarse()), (level as usize, &coarse));
            let same = edition.clone().apply(&coarse).unwrap();
            assert!(difference(&fine, &same) < 1e-11, "level {level}");
            let turned = edition.apply(&map_positions(coarse, moved)).unwrap();
            let difference = difference(&map_positions(fine.clone(), moved), &turned);
            assert!(difference < 1e-10, "level {level}: {difference}");
        }
    }
}

#[test]
fn a_bent_coarse_mesh_carries_its_details_along() {
    // A rippled strip, bent round a cylinder: the ripples stand across the cylinder, as high as before.
    let ripple = |x: f64| 0.2 * (1.3 * x).sin();
    let mesh = grid(160, 12, |x, _| ripple(x));
    let radius = 60.0;
    let bend = |[x, y, z]: [f64; 3]| {
        let angle = x / radius;
        [(radius + z) * angle.sin(), y, (radius + z) * angle.cos()]
    };
    let stream = lwc::encode(&mesh, &EncodeOptions::default()).unwrap();
    let level = stream.info.finest_level() - 4;
    let coarse = lwc::decode(&stream.bytes, DecodeOptions::new().level(level)).unwrap();
    let edition = DetailTransfer::new(&stream.bytes, coarse.num_vertices(), Limits::default()).unwrap();
    let bent = edition.apply(&map_positions(coarse, bend)).unwrap();
    let fine = lwc::decode(&stream.bytes, DecodeOptions::new()).unwrap();
    let errors: Vec<f64> = bent
        .positions()
        .iter()
        .zip(fine.positions())
        .map(|(p, &q)| {
            let expected = bend(q);
            (0..3).map(|k| (p[k] - expected[k]).powi(2)).sum::<f64>().sqrt()
        })
        .collect();
    let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
    assert!(rms < 0.02, "{rms}: a tenth of the ripples");
}

#[test]
fn a_wrong_mesh_is_refused_with_a_clear_error() {
    let stream = lwc::encode(&bumpy_sphere(), &EncodeOptions::default()).unwrap().bytes;
    let coarse = lwc::decode(&stream, DecodeOptions::new().level(3)).unwrap();
    let new = |bytes: &[u8], n| DetailTransfer::new(bytes, n, Limits::default());
    let edition = new(&stream, coarse.num_vertices()).unwrap();

    let Err(EditError::Vertices { found: 7, levels }) = new(&stream, 7) else { panic!("seven") };
    assert!(levels.contains(&coarse.num_vertices()) && levels.is_sorted());
    let (positions, triangles) = coarse.clone().into_parts();
    let mut flipped = triangles.clone();
    flipped[4].swap(0, 1);
    let error = edition.clone().apply(&build(positions.clone(), flipped)).unwrap_err();
    assert!(matches!(error, EditError::Faces { differing: 1, level: 3, .. }), "{error}");
    let fewer = build(positions.clone(), triangles[1..].to_vec());
    assert!(matches!(edition.clone().apply(&fewer), Err(EditError::Faces { differing: 1, .. })));
    let more = build([&positions[..], &[[0.0; 3]]].concat(), triangles.clone());
    assert!(matches!(edition.clone().apply(&more), Err(EditError::Vertices { .. })));
    // Another order of faces and corners is the same mesh.
    let turned = build(positions, triangles.iter().rev().map(|&[a, b, c]| [b, c, a]).collect());
    assert!(edition.apply(&turned).is_ok());

    assert_eq!(new(&stream[..stream.len() - 1], coarse.num_vertices()).unwrap_err(), EditError::Incomplete);
    assert!(matches!(new(b"nonsense", 5), Err(EditError::Stream(_))));
}

#[test]
fn denoising_a_noisy_sphere_lowers_its_error() {
    let error = |mesh: &TriMesh| {
        let squares =
            mesh.positions().iter().map(|p| (p.iter().map(|x| x * x).sum::<f64>().sqrt() - 1.0).powi(2));
        (squares.sum::<f64>() / mesh.num_vertices() as f64).sqrt()
    };
    let mesh = noisy(sphere(5), 11, 0.01);
    let (smooth, thresholds) = denoised(&mesh, &Options::default()).unwrap();
    assert!(thresholds.iter().all(|run| run[0].level == run.len() && run.iter().all(|t| t.noise > 0.0)));
    // The noise is uniform, of deviation 0.01 / √3.
    let found = thresholds.iter().map(|run| run[0].noise).sum::<f64>() / thresholds.len() as f64;
    assert!((0.8..1.4).contains(&(found / 0.01 * 3_f64.sqrt())), "{found}");
    let (before, after) = (error(&mesh), error(&smooth));
    println!(
        "RMS error of a noisy sphere: {before:.6} before, {after:.6} after, {:.2} times",
        after / before
    );
    assert!(after < 0.4 * before, "{before} to {after}");
    // A clean sphere is left almost alone.
    let after = error(&denoised(&sphere(5), &Options::default()).unwrap().0);
    assert!(after < 0.1 * before, "{after}");
}
