//! Every kind of mesh comes back exactly, through every option, and the same bytes come out each time.
#![cfg(feature = "encoder")]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

mod common;

use common::exact::{assert_round_trip, quantize};
use common::kinds::every_kind;
use common::*;
use lwc::descriptors::Descriptor;
use lwc::{EncodeError, EncodeOptions, Partition, TriMesh, encode};

fn options(partition: Partition, quantization: u32, levels: Option<u32>) -> EncodeOptions {
    let mut options = EncodeOptions::default();
    options.partition = partition;
    options.quantization_bits = quantization;
    options.levels = levels;
    options
}

#[test]
fn every_kind_returns_from_every_partition() {
    for (name, mesh) in every_kind() {
        for partition in Partition::ALL {
            let what = format!("{name}, {}", partition.name());
            assert_round_trip(&mesh, &options(partition, 12, None), &what);
        }
    }
}

#[test]
fn every_precision_and_number_of_levels_returns() {
    let kinds = ["sphere", "open grid", "moebius", "soup", "genus 3", "utm", "tetrahedron", "strip"];
    for (name, mesh) in every_kind().into_iter().filter(|(name, _)| kinds.contains(name)) {
        for partition in Partition::ALL {
            for quantization in [1, 8, 16, 24, 30] {
                for levels in [Some(0), Some(1), Some(3), None] {
                    let options = options(partition, quantization, levels);
                    let encoded = assert_round_trip(&mesh, &options, &format!("{name}, {options:?}"));
                    let finest = encoded.info.finest_level();
                    assert!(levels.is_none_or(|n| finest <= n), "{name}: {finest} levels of {levels:?}");
                }
            }
        }
    }
}

#[test]
fn every_descriptor_returns() {
    for (name, mesh) in [
        ("sphere", noisy(sphere(3), 1, 0.03)),
        ("grid", noisy(grid(17, 15, |x, y| 0.05 * x * y), 2, 0.05)),
        ("soup", soup(40, 90, 3)),
    ] {
        for descriptor in Descriptor::ALL {
            for partition in Partition::ALL {
                let mut options = options(partition, 12, None);
                options.descriptor = descriptor;
                assert_round_trip(&mesh, &options, &format!("{name}, {descriptor}, {}", partition.name()));
            }
        }
    }
}

#[test]
fn every_window_and_schedule_returns() {
    let mesh = noisy(torus(20, 9), 4, 0.02);
    for (rings, radius, growth, steps_per_edge) in
        [(1, 1.0, 1.0, 0.5), (8, 20.0, 16.0, 1.0), (2, 1e-3, 1.5, 100.0), (4, 3.0, 1.5, 1e9)]
    {
        let mut options = options(Partition::WeightedError, 14, None);
        options.window.rings = rings;
        options.window.radius = radius;
        options.growth = growth;
        options.steps_per_edge = Some(steps_per_edge);
        assert_round_trip(&mesh, &options, &format!("{options:?}"));
    }
}

#[test]
fn a_coarse_grid_folds_everything_and_still_returns() {
    // One bit per axis: nearly all triangles lose their area, many coincide.
    for (name, mesh) in every_kind() {
        assert_round_trip(&mesh, &options(Partition::WeightedError, 1, None), name);
    }
}

#[test]
fn small_meshes_make_small_streams() {
    let size =
        |mesh: &TriMesh| assert_round_trip(mesh, &EncodeOptions::default(), "a small mesh").bytes.len();
    assert!(size(&tetrahedron()) < 100, "{} bytes", size(&tetrahedron()));
    assert!(size(&single_triangle()) < 100, "{} bytes", size(&single_triangle()));
}

#[test]
fn nothing_to_encode_is_an_error() {
    let points = vec![[0.0; 3], [1.0; 3]];
    for triangles in [vec![], vec![[0, 0, 1], [1, 1, 1]]] {
        let mesh = build(points.clone(), triangles);
        assert_eq!(encode(&mesh, &EncodeOptions::default()).err(), Some(EncodeError::NoTriangles));
    }
    let mesh = build(vec![[-1e308; 3], [1e308; 3], [0.0; 3]], vec![[0, 1, 2]]);
    assert_eq!(encode(&mesh, &EncodeOptions::default()).err(), Some(EncodeError::BoundingBox));
}

#[test]
fn an_option_out_of_range_is_an_error() {
    type Change = fn(&mut EncodeOptions);
    let changes: [(&str, Change); 8] = [
        ("quantization bits", |o| o.quantization_bits = 0),
        ("quantization bits", |o| o.quantization_bits = 31),
        ("levels", |o| o.levels = Some(129)),
        ("rings", |o| o.window.rings = 0),
        ("radius", |o| o.window.radius = f64::NAN),
        ("radius", |o| o.window.radius = 0.0),
        ("growth", |o| o.growth = 0.5),
        ("steps per edge", |o| o.steps_per_edge = Some(f64::INFINITY)),
    ];
    for (name, change) in changes {
        let mut options = EncodeOptions::default();
        change(&mut options);
        let error = encode(&tetrahedron(), &options).err();
        assert!(matches!(error, Some(EncodeError::Option { option, .. }) if option == name), "{error:?}");
    }
}

#[test]
fn the_same_bytes_whatever_the_threads() {
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let (one, four) = (pool(1), pool(4));
    for (name, mesh) in [
        ("sphere", noisy(sphere(4), 7, 0.02)),
        ("grid", noisy(grid(40, 30, |_, _| 0.0), 8, 0.1)),
        ("soup", soup(200, 500, 9)),
    ] {
        for partition in Partition::ALL {
            for descriptor in Descriptor::ALL {
                let mut options = options(partition, 12, None);
                options.descriptor = descriptor;
                let bytes = || encode(&mesh, &options).unwrap().bytes;
                let first = one.install(bytes);
                assert!(first == one.install(bytes), "{name}, {descriptor}: not the same twice");
                assert!(first == four.install(bytes), "{name}, {descriptor}: four threads differ");
            }
        }
    }
}

#[test]
fn the_quantizer_of_these_tests_rounds_halves_up() {
    let positions = vec![[0.0, 10.0, -1.0], [3.0, 10.5, -1.0], [1.5, 10.0, -1.0], [99.0; 3]];
    let mesh = build(positions, vec![[1, 2, 0], [1, 1, 0]]);
    let quantized = quantize(&mesh, 2);
    assert_eq!(quantized.triangles, [[[0, 0, 0], [3, 1, 0], [2, 0, 0]]]);
    assert_eq!((quantized.used_vertices, quantized.degenerate_triangles), (3, 1));
}

#[cfg(feature = "io")]
mod corpus {
    use super::*;
    use common::corpus::corpus;
    use std::path::PathBuf;

    /// Larger meshes take part in optimised builds only.
    const LARGE: usize = 100_000;

    fn files(folder: &str) -> Vec<PathBuf> {
        let Some(corpus) = corpus() else { return Vec::new() };
        let entries = std::fs::read_dir(corpus.join(folder)).unwrap();
        let mut files: Vec<PathBuf> = entries
            .map(|entry| entry.unwrap().path())
            .filter(|path| lwc::io::Format::from_path(path).is_some())
            .collect();
        files.sort();
        assert!(!files.is_empty(), "no meshes in {}", corpus.join(folder).display());
        files
    }

    #[test]
    fn every_mesh_returns() {
        for path in files(".") {
            let mesh = lwc::io::read(&path).unwrap().mesh;
            if mesh.num_vertices() > LARGE && cfg!(debug_assertions) {
                println!("skipped: {} is large, run with --release", path.display());
                continue;
            }
            assert_round_trip(&mesh, &EncodeOptions::default(), &path.display().to_string());
        }
    }

    #[test]
    fn every_bad_mesh_returns_or_is_refused() {
        let mut returned = 0;
        let files = files("bad");
        for path in &files {
            let Ok(file) = lwc::io::read(path) else { continue };
            for partition in Partition::ALL {
                for quantization in [1, 12, 30] {
                    let options = options(partition, quantization, None);
                    match encode(&file.mesh, &options) {
                        Err(EncodeError::NoTriangles | EncodeError::BoundingBox) => {}
                        _ => {
                            assert_round_trip(&file.mesh, &options, &path.display().to_string());
                            returned += 1;
                        }
                    }
                }
            }
        }
        assert!(files.is_empty() || returned >= 100, "only {returned} round trips");
    }
}

#[test]
fn every_effort_returns_and_more_of_it_is_no_larger() {
    let mesh = noisy(torus(24, 12), 3, 0.02);
    for optimize in lwc::Optimize::ALL {
        let sizes: Vec<usize> = [0, 3, 5, 7, 9]
            .into_iter()
            .map(|effort| {
                let mut options = EncodeOptions::default();
                (options.optimize, options.effort) = (optimize, effort);
                let what = format!("{}, effort {effort}", optimize.name());
                assert_round_trip(&mesh, &options, &what).bytes.len()
            })
            .collect();
        if optimize == lwc::Optimize::Size {
            assert!(sizes.is_sorted_by(|a, b| a >= b), "{sizes:?}");
        }
    }
    let mut options = EncodeOptions::default();
    options.effort = 10;
    assert!(matches!(encode(&mesh, &options), Err(EncodeError::Option { option: "effort", .. })));
}
