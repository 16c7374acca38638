//! The experiment of section 6: the same removals as the encoder's Algorithm 1, distances by brute force,
//! and the program around it.
#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

mod common;

use assert_cmd::Command;
use common::*;
use lwc::descriptors::{Descriptor, NormalWeights, PcaQuadric, Window, mean_edge_length, mean_window_size};
use lwc::experiment::{Experiment, Noise, Settings, Step, Units};
use lwc::{DecodeOptions, Decoder, EncodeError, EncodeOptions, Partition, PassKind, TriMesh};
use nalgebra::{DMatrix, Vector3};
use std::collections::BTreeSet;
use std::path::Path;

fn bumpy() -> TriMesh {
    noisy(grid(14, 17, |x, y| (0.4 * x).sin() + 0.1 * y * y), 3, 0.15)
}

fn settings(levels: u32) -> Settings {
    let mut settings = Settings::default();
    settings.levels = levels;
    settings
}

fn run(mesh: &TriMesh, noise: Option<Noise>, descriptor: Descriptor) -> Vec<Step> {
    Experiment::new(mesh, noise).unwrap().run(descriptor, &settings(3), &|_| ())
}

/// Steps without their times.
fn facts(steps: &[Step]) -> Vec<(usize, usize, u64, u64)> {
    steps.iter().map(|s| (s.vertices, s.odd, s.apd.to_bits(), s.mean_window.to_bits())).collect()
}

/// Distance of `v` from the total-least-squares plane of `ring`, by SVD.
fn plane_distance(v: [f64; 3], ring: &[[f64; 3]]) -> f64 {
    let points: Vec<Vector3<f64>> = ring.iter().map(|&p| Vector3::from(p)).collect();
    let centroid = points.iter().sum::<Vector3<f64>>() / points.len() as f64;
    let rows =
        DMatrix::from_fn(points.len().max(3), 3, |i, j| points.get(i).map_or(0.0, |p| p[j] - centroid[j]));
    let svd = rows.svd(false, true);
    let least = (0..3).min_by(|&a, &b| svd.singular_values[a].total_cmp(&svd.singular_values[b])).unwrap();
    let normal = svd.v_t.unwrap().row(least).transpose();
    normal.dot(&(Vector3::from(v) - centroid)).abs()
}

/// Vertices before each step and mean plane distance, from a stream of the encoder.
fn by_encoder(mesh: &TriMesh, descriptor: Descriptor, levels: u32) -> Vec<(usize, f64)> {
    let mut options = EncodeOptions::default();
    options.descriptor = descriptor;
    options.partition = Partition::Algorithm1;
    options.levels = Some(levels);
    options.quantization_bits = 30;
    let stream = lwc::encode(mesh, &options).unwrap();
    let fine = lwc::decode(&stream.bytes, DecodeOptions::new()).unwrap();
    // Updates name what is new, not what is shown elsewhere.
    let mut decoder = Decoder::with_options(DecodeOptions::new().shrinkage_compensation(false));
    decoder.feed(&stream.bytes).unwrap();
    let mut steps = Vec::new();
    while let Some(update) = decoder.step().unwrap() {
        if update.pass.kind != PassKind::Split {
            continue;
        }
        let level = decoder.mesh().unwrap();
        let distances: Vec<f64> = update
            .vertices
            .clone()
            .map(|v| {
                let faces = level.triangles().iter().filter(|t| t.contains(&v));
                let ring: BTreeSet<u32> = faces.flatten().copied().filter(|&u| u != v).collect();
                let ring: Vec<[f64; 3]> = ring.iter().map(|&u| fine.positions()[u as usize]).collect();
                if ring.len() < 3 { 0.0 } else { plane_distance(fine.positions()[v as usize], &ring) }
            })
            .collect();
        steps.push((level.num_vertices(), distances.iter().sum::<f64>() / distances.len() as f64));
    }
    steps.reverse();
    steps
}

#[test]
fn steps_are_those_of_the_encoder_and_distances_those_of_brute_force() {
    let mesh = bumpy();
    let mean_edge = mean_edge_length(&mesh);
    for descriptor in Descriptor::ALL {
        let steps = run(&mesh, None, descriptor);
        let expected = by_encoder(&mesh, descriptor, 3);
        assert_eq!(steps.len(), expected.len());
        for (step, (vertices, distance)) in steps.iter().zip(expected) {
            assert_eq!(step.vertices, vertices, "{descriptor}");
            let apd = distance / mean_edge;
            assert!((step.apd - apd).abs() < 1e-6 * apd, "{descriptor}: {} and {apd}", step.apd);
            assert_eq!(step.odd_share, step.odd as f64 / step.vertices as f64);
        }
    }
}

#[test]
fn a_plane_has_no_distance_and_scale_does_not_matter() {
    let flat = grid(12, 12, |_, _| 0.0);
    assert!(run(&flat, None, Descriptor::Pca).iter().all(|step| step.apd < 1e-12 && step.odd > 0));
    let mesh = bumpy();
    let large = map_positions(mesh.clone(), |p| p.map(|x| 1024.0 * x));
    for descriptor in Descriptor::ALL {
        let (small, large) = (run(&mesh, None, descriptor), run(&large, None, descriptor));
        assert_eq!(facts(&small), facts(&large), "{descriptor}");
    }
}

#[test]
fn units_of_the_file_are_the_mean_edge_if_that_is_one() {
    let mesh = bumpy();
    let scale = 1.0 / mean_edge_length(&mesh);
    let unit = map_positions(mesh, |p| p.map(|x| x * scale));
    let mut of_file = settings(2);
    of_file.units = Units::Model;
    let experiment = Experiment::new(&unit, None).unwrap();
    let large = Experiment::new(&map_positions(unit, |p| p.map(|x| 100.0 * x)), None).unwrap();
    let odd = |experiment: &Experiment, descriptor, settings: &Settings| {
        let steps = experiment.run(descriptor, settings, &|_| ());
        steps.iter().map(|step| (step.odd, (step.apd * 1e9).round())).collect::<Vec<_>>()
    };
    let usual = settings(2);
    for descriptor in [Descriptor::PcaQem, Descriptor::Pca] {
        let expected = odd(&experiment, descriptor, &usual);
        assert_eq!(odd(&experiment, descriptor, &of_file), expected);
        // Only a descriptor with a length of its own sees that a file is in other units.
        let sees_units = odd(&large, descriptor, &of_file) != expected;
        assert_eq!(sees_units, descriptor == Descriptor::PcaQem, "{descriptor}");
    }
}

#[test]
fn other_readings_change_what_they_are_about() {
    let experiment = Experiment::new(&bumpy(), None).unwrap();
    let apds = |descriptor, normals, pca_quadric| {
        let mut settings = settings(2);
        settings.readings.normals = normals;
        settings.readings.pca_quadric = pca_quadric;
        experiment.run(descriptor, &settings, &|_| ()).iter().map(|step| step.apd).collect::<Vec<_>>()
    };
    for descriptor in Descriptor::ALL {
        let usual = apds(descriptor, NormalWeights::Area, PcaQuadric::Window);
        let uses_normals = descriptor == Descriptor::Nfv;
        for normals in [NormalWeights::Angle, NormalWeights::Uniform] {
            let other = apds(descriptor, normals, PcaQuadric::Window);
            assert!(other == usual || !matches!(descriptor, Descriptor::Pca | Descriptor::Sqem));
            assert!(other != usual || !uses_normals, "{descriptor} {normals:?}");
        }
        let other = apds(descriptor, NormalWeights::Area, PcaQuadric::Vertex);
        assert_eq!(other != usual, descriptor == Descriptor::PcaQem, "{descriptor}");
    }
}

#[test]
fn noise_drives_the_partition_only() {
    let mesh = bumpy();
    let noise = |deviation, seed| Some(Noise { deviation, seed });
    let without = run(&mesh, None, Descriptor::Harris3d);
    let almost = run(&mesh, noise(1e-13, 1), Descriptor::Harris3d);
    assert_eq!(
        without.iter().map(|s| s.odd).collect::<Vec<_>>(),
        almost.iter().map(|s| s.odd).collect::<Vec<_>>()
    );
    assert!(without.iter().zip(&almost).all(|(a, b)| a.apd == b.apd));
    let noisy = run(&mesh, Some(Noise::default()), Descriptor::Harris3d);
    assert_eq!(facts(&noisy), facts(&run(&mesh, Some(Noise::default()), Descriptor::Harris3d)));
    assert_ne!(facts(&noisy), facts(&run(&mesh, noise(1.0 / 3.0, 2), Descriptor::Harris3d)));
    // Distances on a plane stay zero however much noise there is.
    let flat = grid(12, 12, |_, _| 0.0);
    assert!(run(&flat, Some(Noise::default()), Descriptor::Pca).iter().all(|step| step.apd < 1e-12));
}

#[test]
fn noise_has_its_deviation() {
    let mesh = sphere(4);
    let noisy = Noise { deviation: 0.5, seed: 9 }.perturb(&mesh, 0.1).unwrap();
    let moved: Vec<f64> = noisy
        .positions()
        .iter()
        .flatten()
        .zip(mesh.positions().iter().flatten())
        .map(|(a, b)| a - b)
        .collect();
    let (count, mean) = (moved.len() as f64, moved.iter().sum::<f64>() / moved.len() as f64);
    let deviation = (moved.iter().map(|x| x * x).sum::<f64>() / count).sqrt();
    assert!(mean.abs() < 4.0 * 0.05 / count.sqrt(), "{mean}");
    assert!((deviation / 0.05 - 1.0).abs() < 4.0 / (2.0 * count).sqrt(), "{deviation}");
}

#[test]
fn windows_of_a_regular_mesh_have_their_size() {
    // All but the neighbours are out of reach: 7 of a hexagonal lattice's vertices, 3 of a triangle's.
    let window = Window { rings: 4, radius: 1.2 };
    let hexagonal =
        map_positions(grid(60, 60, |_, _| 0.0), |[x, y, _]| [x - 0.5 * y, 0.75_f64.sqrt() * y, 0.0]);
    let edge = mean_edge_length(&hexagonal);
    let size = mean_window_size(&hexagonal, &window, edge);
    assert!(size > 6.7 && size < 7.0, "{size}");
    assert_eq!(mean_window_size(&single_triangle(), &window, 1.0), 3.0 - 2.0 / 3.0);
    assert_eq!(mean_window_size(&hexagonal, &Window { radius: 0.0, ..window }, edge), 0.0);
}

#[test]
fn nothing_to_remove_is_no_steps_and_nothing_at_all_an_error() {
    assert_eq!(run(&single_triangle(), None, Descriptor::Pca), []);
    let empty = build(vec![[0.0; 3]], vec![]);
    assert!(matches!(Experiment::new(&empty, None), Err(EncodeError::NoTriangles)));
}

fn lwc(folder: &Path, line: &str) -> std::process::Output {
    let mut command = Command::cargo_bin("lwc").unwrap();
    command.current_dir(folder).args(line.split_whitespace()).output().unwrap()
}

#[test]
fn the_program_writes_goes_on_and_ranks() {
    let folder = tempfile::tempdir().unwrap();
    lwc::io::write(folder.path().join("a.ply"), &bumpy()).unwrap();
    lwc::io::write(folder.path().join("b.obj"), &noisy(sphere(3), 1, 0.02)).unwrap();
    let ok = |line: &str| {
        let output = lwc(folder.path(), line);
        assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    let csv = || std::fs::read_to_string(folder.path().join("out/results.csv")).unwrap();

    let said = ok("experiment a.ply --output out --levels 3 --descriptors pca,nfv");
    assert!(said.contains("Ranking over 1 mesh;"), "{said}");
    // Two descriptors lie as far above the mean as below it.
    let of_mean = |name: &str, column: usize| -> f64 {
        let line = said.lines().skip_while(|line| !line.starts_with("Ranking"));
        let line = line.skip(2).find(|line| line.contains(name)).unwrap();
        line.split_whitespace().nth(column).unwrap().parse().unwrap()
    };
    for column in [3, 7] {
        assert!((of_mean("pca", column) + of_mean("nfv", column) - 200.0).abs() < 0.2, "{said}");
    }
    let first = csv();
    assert_eq!(first.lines().count(), 1 + 2 * 3, "{first}");
    let columns = first.lines().next().unwrap().split(',').count();
    assert!(first.lines().all(|line| line.split(',').count() == columns));

    // What is there stays there, bit by bit, times included; the rest is added.
    let said = ok("experiment a.ply b.obj --output out --levels 3 --descriptors pca,nfv,sqem --noise");
    assert_eq!(said.lines().filter(|line| line.contains("steps, mean apd")).count(), 6);
    assert_eq!(csv().lines().count(), 1 + 2 * 3 + 2 * 3 * 3);
    assert!(csv().starts_with(&first));
    let said = ok("experiment a.ply b.obj --output out --levels 3 --descriptors all --noise");
    assert_eq!(said.lines().filter(|line| line.contains("steps, mean apd")).count(), 8);
    assert!(
        said.contains("Ranking over 1 mesh;") && said.contains("Ranking over 2 meshes with noise;"),
        "{said}"
    );
    let json: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("out/results.json")).unwrap()).unwrap();
    assert_eq!(json["runs"].as_array().unwrap().len(), 2 + 14);
    for name in ["a.svg", "a.png", "a-relative.svg", "a-noise.svg", "b-noise.png", "b-noise-relative.png"] {
        assert!(folder.path().join("out").join(name).metadata().unwrap().len() > 1000, "{name}");
    }

    let other = lwc(folder.path(), "experiment a.ply --output out --levels 4");
    assert_eq!(other.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&other.stderr).contains("other settings"));
    let unknown = lwc(folder.path(), "experiment a.ply --output out --descriptors pca,nonsense");
    assert_eq!(unknown.status.code(), Some(2));
}
