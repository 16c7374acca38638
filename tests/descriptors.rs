//! The seven descriptors against a slow transcription of the paper, surfaces of known curvature, symmetries
//! of the definition, and meshes that are hardly meshes.
#![cfg(feature = "encoder")]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

mod common;
mod oracle;

use common::*;
use lwc::TriMesh;
use lwc::descriptors::{
    Descriptor, Features, FeaturesError, Window, evaluate, evaluate_with_features, evaluate_with_progress,
    mean_edge_length,
};
use lwc::mesh::{Attribute, Domain, Semantic, Values};
use std::sync::atomic::{AtomicUsize, Ordering};

fn window(rings: u32, radius: f64) -> Window {
    Window { rings, radius }
}

fn values(descriptor: Descriptor, mesh: &TriMesh) -> Vec<f64> {
    evaluate(descriptor, mesh, &Window::default(), mean_edge_length(mesh))
}

/// Each value equals its expectation to `relative`, or to `relative` of 1e-2 when that is smaller.
#[track_caller]
fn assert_close(values: &[f64], expected: &[f64], relative: f64, what: &str) {
    assert_eq!(values.len(), expected.len(), "{what}");
    for (v, (value, expected)) in values.iter().zip(expected).enumerate() {
        let tolerance = relative * expected.abs().max(1e-2);
        assert!((value - expected).abs() <= tolerance, "{what}, vertex {v}: {value} but {expected}");
    }
}

fn assert_matches_oracle(mesh: &TriMesh, windows: &[Window], relative: f64, what: &str) {
    let mean_edge = mean_edge_length(mesh);
    assert_close(&[mean_edge], &[oracle::mean_edge_length(mesh)], 1e-13, what);
    for window in windows {
        for descriptor in Descriptor::ALL {
            let values = evaluate(descriptor, mesh, window, mean_edge);
            let expected = oracle::evaluate(descriptor, mesh, window, mean_edge);
            assert_close(&values, &expected, relative, &format!("{descriptor} on {what}, {window:?}"));
        }
    }
}

const WINDOWS: [Window; 4] = [
    Window { rings: 4, radius: 3.0 },
    Window { rings: 1, radius: 1.6 },
    Window { rings: 2, radius: 50.0 },
    Window { rings: 7, radius: 1.9 },
];

// Tolerance of the comparisons: both sides carry some tens of rounding errors (1e-14), multiplied by the
// condition of the fit (at most 1e3 where normal equations serve) and of the eigenvector (the inverse of
// the relative gap of the spectrum, below 1e3 on these meshes).
const AGREEMENT: f64 = 1e-9;

#[test]
fn oracle_agrees_on_noisy_sphere() {
    assert_matches_oracle(&noisy(sphere(3), 1, 0.03), &WINDOWS, AGREEMENT, "noisy sphere");
}

#[test]
fn oracle_agrees_on_torus() {
    assert_matches_oracle(&noisy(torus(30, 12), 2, 1e-3), &WINDOWS, AGREEMENT, "torus");
}

#[test]
fn oracle_agrees_on_open_saddle() {
    let saddle = noisy(grid(17, 15, |x, y| 0.05 * x * y), 3, 0.1);
    assert_matches_oracle(&saddle, &WINDOWS, AGREEMENT, "saddle");
}

#[test]
fn oracle_agrees_on_non_manifold_soup() {
    // Short paths leave the ball all the time here.
    assert_matches_oracle(&soup(200, 320, 4), &[window(2, 0.7), window(3, 0.5)], AGREEMENT, "soup");
    assert_matches_oracle(&noisy(non_manifold_fin(), 5, 0.05), &WINDOWS, AGREEMENT, "fin");
}

#[test]
fn oracle_agrees_on_high_valence() {
    assert_matches_oracle(&noisy(fan(60), 6, 0.05), &WINDOWS, AGREEMENT, "fan");
}

#[test]
fn oracle_agrees_on_small_and_sharp_meshes() {
    assert_matches_oracle(&noisy(genus3(), 7, 0.05), &WINDOWS, AGREEMENT, "genus 3");
    assert_matches_oracle(&noisy(many_components(5), 8, 0.2), &WINDOWS, AGREEMENT, "tetrahedra");
    assert_matches_oracle(&single_triangle(), &WINDOWS, AGREEMENT, "triangle");
}

#[test]
fn oracle_agrees_where_the_fit_is_nearly_singular() {
    // Two rows of vertices nearly on a conic through the centre: condition about 1e4, beyond the normal
    // equations, which a backward stable solution turns into 1e-12, and values of 1e4 into less.
    let strip = noisy(strip(40), 9, 1e-4);
    assert_matches_oracle(&strip, &[window(4, 3.0)], 1e-7, "strip");
}

#[test]
fn oracle_agrees_on_coarser_levels_of_a_finer_mesh() {
    let mesh = noisy(sphere(2), 10, 0.05);
    for descriptor in Descriptor::ALL {
        let (window, finest) = (window(4, 6.75), 0.4 * mean_edge_length(&mesh));
        let values = evaluate(descriptor, &mesh, &window, finest);
        assert_close(&values, &oracle::evaluate(descriptor, &mesh, &window, finest), AGREEMENT, "coarse");
    }
}

#[test]
fn sphere_has_its_radius() {
    let mesh = sphere(4);
    let mean_edge = mean_edge_length(&mesh);
    // The paraboloid takes ρ²/2 + ρ⁴/8 for a parabola: off by less than ρ²/4 at the rim, ρ = 3 l̄.
    let bias = 9.0 * mean_edge * mean_edge / 4.0;
    let curvature = values(Descriptor::Casorati, &mesh);
    assert!(curvature.iter().all(|k| (k / mean_edge - 1.0).abs() < bias));
    // atan((κ2 + κ1)/(κ2 − κ1)) with |κ2 − κ1| ≤ bias·κ, as the windows are not round.
    let index = values(Descriptor::ShapeIndex, &mesh);
    assert!(index.iter().all(|s| (s - 1.0).abs() < bias));
}

#[test]
fn cylinder_has_one_curvature() {
    let (around, rings) = (80, 21);
    let mesh = cylinder(around, rings);
    let mean_edge = mean_edge_length(&mesh);
    let bias = 9.0 * mean_edge * mean_edge / 4.0;
    let curvature = values(Descriptor::Casorati, &mesh);
    let index = values(Descriptor::ShapeIndex, &mesh);
    // Away from the two ends.
    for v in (around * 5..around * (rings - 5)).map(|v| v as usize) {
        assert!((curvature[v] / mean_edge * 2f64.sqrt() - 1.0).abs() < bias);
        assert!((index[v] - 0.5).abs() < bias);
    }
}

#[test]
fn saddle_is_exact_at_its_centre() {
    // z = kxy is in the space of the fit and its centre in a symmetric window, so only rounding remains.
    let mesh = grid(13, 13, |x, y| 0.1 * x * y);
    let (centre, mean_edge) = (6 * 13 + 6, mean_edge_length(&mesh));
    let reach = 3.0 / mean_edge;
    let curvature = evaluate(Descriptor::Casorati, &mesh, &window(4, reach), mean_edge)[centre];
    let index = evaluate(Descriptor::ShapeIndex, &mesh, &window(4, reach), mean_edge)[centre];
    assert!(index < 1e-9, "{index}");
    // The diagonals tilt the sum of normals by nothing, as the saddle is odd under a quarter turn.
    assert!((curvature / (0.1 * mean_edge) - 1.0).abs() < 1e-9, "{curvature}");
}

#[test]
fn plane_is_flat_but_for_pca_qem() {
    let plane = grid(20, 20, |x, y| 0.3 * x - 0.7 * y + 11.0);
    for descriptor in Descriptor::ALL {
        let values = values(descriptor, &plane);
        if descriptor == Descriptor::PcaQem {
            assert!(values.iter().all(|&d| d > 1e-6));
        } else {
            // Coordinates of 1e1 spoil heights by 1e-15. The shape index has no scale: below it is noise
            // unless the curvatures stay under the 1e-12 of its definition, and they do.
            assert!(values.iter().all(|&d| d < 1e-12), "{descriptor}");
        }
    }
}

fn transformed(mesh: &TriMesh, f: impl Fn([f64; 3]) -> [f64; 3]) -> TriMesh {
    map_positions(mesh.clone(), f)
}

/// Coordinates rounded to 2^-20, so that a translation by integers below 2^32 is exact.
fn dyadic(mesh: TriMesh) -> TriMesh {
    let unit = f64::from(1 << 20);
    map_positions(mesh, |p| p.map(|c| (c * unit).round() / unit))
}

#[test]
fn translation_changes_no_bit() {
    let mesh = dyadic(noisy(torus(24, 10), 11, 0.05));
    let far = transformed(&mesh, |p| [p[0] + 500_000.0, p[1] + 5_000_000.0, p[2] - 4000.0]);
    for descriptor in Descriptor::ALL {
        assert_eq!(values(descriptor, &mesh), values(descriptor, &far), "{descriptor}");
    }
}

#[test]
fn scale_by_a_power_of_two_changes_no_bit() {
    let mesh = noisy(torus(24, 10), 12, 0.05);
    for exponent in [-900, -100, 1, 332, 900] {
        let scaled = transformed(&mesh, |p| p.map(|c| c * 2f64.powi(exponent)));
        for descriptor in Descriptor::ALL {
            assert_eq!(values(descriptor, &mesh), values(descriptor, &scaled), "{descriptor} {exponent}");
        }
    }
}

#[test]
fn rotation_and_scale_change_rounding_only() {
    let mesh = noisy(torus(24, 10), 13, 0.05);
    let (sin, cos) = 0.7f64.sin_cos();
    for scale in [1.0, 1e-42, 1e-30, 1e-3, 1e100, 1e200] {
        let turned = transformed(&mesh, |[x, y, z]| {
            let (x, y) = (cos * x - sin * y, sin * x + cos * y);
            [scale * (cos * x + sin * z), scale * y, scale * (cos * z - sin * x)]
        });
        for descriptor in Descriptor::ALL {
            let what = format!("{descriptor} at {scale}");
            assert_close(&values(descriptor, &turned), &values(descriptor, &mesh), AGREEMENT, &what);
        }
    }
}

#[test]
fn order_of_vertices_does_not_matter() {
    let mesh = noisy(sphere(3), 14, 0.03);
    let n = mesh.num_vertices();
    let renamed = |v: usize| (v * 5 + 3) % n; // 642 and 5 are coprime
    let mut positions = vec![[0.0; 3]; n];
    for v in 0..n {
        positions[renamed(v)] = mesh.positions()[v];
    }
    let triangles = mesh.triangles().iter().map(|t| t.map(|v| renamed(v as usize) as u32)).collect();
    let other = build(positions, triangles);
    for descriptor in Descriptor::ALL {
        let (values, others) = (values(descriptor, &mesh), values(descriptor, &other));
        let back: Vec<f64> = (0..n).map(|v| others[renamed(v)]).collect();
        assert_close(&back, &values, AGREEMENT, descriptor.name());
    }
}

#[test]
fn number_of_threads_changes_no_bit() {
    let mesh = noisy(sphere(4), 15, 0.02);
    let with_threads = |threads, descriptor| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| values(descriptor, &mesh))
    };
    for descriptor in Descriptor::ALL {
        assert_eq!(with_threads(1, descriptor), with_threads(4, descriptor), "{descriptor}");
    }
}

#[test]
fn repeated_faces_count_each_time() {
    let mesh = noisy(sphere(2), 16, 0.05);
    let (positions, mut triangles) = mesh.clone().into_parts();
    triangles.extend_from_within(..);
    let doubled = build(positions, triangles);
    let expected: Vec<f64> = values(Descriptor::Sqem, &mesh).iter().map(|d| 2.0 * d).collect();
    assert_close(&values(Descriptor::Sqem, &doubled), &expected, AGREEMENT, "sqem");
    assert_close(&values(Descriptor::Pca, &doubled), &values(Descriptor::Pca, &mesh), AGREEMENT, "pca");
}

#[test]
fn isolated_vertices_and_faces_of_two_vertices_are_zero() {
    let (mut positions, mut triangles) = noisy(sphere(2), 17, 0.05).into_parts();
    let first = positions.len();
    positions.extend([[0.1; 3], [1e300, -1e300, 0.0], [0.2; 3]]);
    let with_isolated = build(positions.clone(), triangles.clone());
    triangles.push([first as u32, first as u32 + 1, first as u32]);
    let with_degenerate = build(positions, triangles);
    assert_eq!(mean_edge_length(&with_isolated), mean_edge_length(&with_degenerate));
    for descriptor in Descriptor::ALL {
        let values = values(descriptor, &with_degenerate);
        assert!(values[first..].iter().all(|&d| d == 0.0), "{descriptor}");
        assert!(values[..first].iter().any(|&d| d > 0.0), "{descriptor}");
    }
}

fn odd_meshes() -> Vec<(&'static str, TriMesh)> {
    let empty = TriMesh::default();
    let points = build(vec![[1.0; 3]; 4], vec![]);
    let needle = build(vec![[0.0; 3], [1e-200; 3], [f64::MAX; 3]], vec![[0, 1, 2]]);
    let extreme = transformed(&tetrahedron(), |p| p.map(|c| c * f64::MAX));
    let subnormal = transformed(&sphere(1), |p| p.map(|c| c * 1e-320));
    let apart = transformed(&many_components(3), |p| if p[0] > 2.0 { p.map(|c| c * 1e305) } else { p });
    let flat_line = transformed(&strip(30), |p| [p[0], 0.0, 0.0]);
    vec![
        ("empty", empty),
        ("points", points),
        ("needle", needle),
        ("extreme", extreme),
        ("subnormal", subnormal),
        ("apart", apart),
        ("flat line", flat_line),
        ("all equal", all_points_equal()),
        ("fan", fan(2000)),
        ("tetrahedron", tetrahedron()),
        ("triangle", single_triangle()),
        ("strip", strip(9)),
        ("fin", non_manifold_fin()),
        ("soup", soup(30, 200, 18)),
        ("genus 3", genus3()),
    ]
}

#[test]
fn odd_meshes_windows_and_lengths_give_finite_values() {
    let windows = [
        Window::default(),
        window(0, 3.0),
        window(u32::MAX, f64::INFINITY),
        window(2, 0.0),
        window(2, -1.0),
        window(2, f64::NAN),
        window(3, 1e300),
        window(3, 1e-300),
    ];
    for (name, mesh) in odd_meshes() {
        let mean_edge = mean_edge_length(&mesh);
        assert!(mean_edge.is_finite() && mean_edge >= 0.0, "{name}: {mean_edge}");
        let lengths = [mean_edge, 0.0, f64::NAN, f64::INFINITY, -1.0, 1e-300, f64::from_bits(1), f64::MAX];
        // A window of every vertex at each of 2000 is slow and says nothing more.
        let windows = if name == "fan" { &windows[..1] } else { &windows[..] };
        for (window, length) in windows.iter().flat_map(|w| lengths.map(|l| (w, l))) {
            for descriptor in Descriptor::ALL {
                let values = evaluate(descriptor, &mesh, window, length);
                assert_eq!(values.len(), mesh.num_vertices());
                let good = |d: &f64| d.is_finite() && *d >= 0.0 && d.is_sign_positive();
                assert!(values.iter().all(good), "{descriptor} on {name}, {window:?}, {length}: {values:?}");
            }
        }
    }
}

#[test]
fn meshes_without_extent_are_zero() {
    let mesh = all_points_equal();
    assert_eq!(mean_edge_length(&mesh), 0.0);
    for descriptor in Descriptor::ALL {
        assert!(values(descriptor, &mesh).iter().all(|&d| d == 0.0));
        assert!(evaluate(descriptor, &mesh, &Window::default(), 1.0).iter().all(|&d| d == 0.0));
    }
}

#[test]
fn mean_edge_counts_each_edge_once() {
    assert_eq!(mean_edge_length(&TriMesh::default()), 0.0);
    let expected = (2.0 + 2f64.sqrt()) / 3.0;
    assert_close(&[mean_edge_length(&single_triangle())], &[expected], 1e-15, "triangle");
    assert_close(&[mean_edge_length(&tetrahedron())], &[8f64.sqrt()], 1e-15, "tetrahedron");
    let huge = transformed(&tetrahedron(), |p| p.map(|c| c * 1e300));
    assert_close(&[mean_edge_length(&huge) / 1e300], &[8f64.sqrt()], 1e-15, "huge tetrahedron");
}

#[test]
fn progress_adds_up() {
    let mesh = sphere(4);
    for descriptor in Descriptor::ALL {
        let done = AtomicUsize::new(0);
        let count = |n| {
            done.fetch_add(n, Ordering::Relaxed);
        };
        evaluate_with_progress(descriptor, &mesh, &Window::default(), mean_edge_length(&mesh), &count);
        assert_eq!(done.into_inner(), mesh.num_vertices(), "{descriptor}");
    }
}

#[test]
fn names_parse_back() {
    for descriptor in Descriptor::ALL {
        assert_eq!(descriptor.name().parse(), Ok(descriptor));
        assert_eq!(descriptor.to_string(), descriptor.name());
    }
    assert!("harris".parse::<Descriptor>().unwrap_err().to_string().contains("`harris`"));
    assert_eq!(Descriptor::default(), Descriptor::Harris3d);
}

/// Two components per vertex, with a range of 1 in the wider.
fn shades(mesh: &TriMesh, shade: impl Fn([f64; 3]) -> [f64; 2]) -> Attribute {
    let values = mesh.positions().iter().flat_map(|&p| shade(p)).collect();
    Attribute::new("shade", Semantic::Generic, Domain::Vertex, 2, Values::F64(values))
}

fn with_shades(descriptor: Descriptor, mesh: &TriMesh, shade: &Attribute, weight: f64) -> Vec<f64> {
    let features = Features::new(mesh, &[(shade, weight)]).unwrap();
    let mean_edge = mean_edge_length(mesh);
    evaluate_with_features(descriptor, mesh, &features, &Window::default(), mean_edge, &|_| ()).unwrap()
}

#[test]
fn attributes_of_no_weight_change_nothing() {
    let mesh = noisy(sphere(3), 1, 0.03);
    let shade = shades(&mesh, |[x, y, _]| [x.sin(), x * y]);
    for descriptor in [Descriptor::Pca, Descriptor::PcaQem] {
        let augmented = with_shades(descriptor, &mesh, &shade, 0.0);
        assert_close(&augmented, &values(descriptor, &mesh), AGREEMENT, descriptor.name());
    }
}

#[test]
fn oracle_agrees_in_five_dimensions() {
    let mesh = noisy(grid(17, 15, |x, y| 0.05 * x * y), 3, 0.1);
    let mut shade = shades(&mesh, |[x, y, z]| [(3.0 * x).sin(), z - y]);
    let range = |k: usize| {
        let column = |v: usize| shade.number(v, k).unwrap();
        let all = || (0..mesh.num_vertices()).map(column);
        all().fold(f64::MIN, f64::max) - all().fold(f64::MAX, f64::min)
    };
    let scale = 1.0 / range(0).max(range(1));
    if let Values::F64(values) = &mut shade.values {
        values.iter_mut().for_each(|value| *value *= scale);
    }
    let weight = 4.0;
    let further: Vec<[f64; 2]> =
        (0..mesh.num_vertices()).map(|v| [0, 1].map(|k| weight * shade.number(v, k).unwrap())).collect();
    let window = Window::default();
    for descriptor in [Descriptor::Pca, Descriptor::PcaQem] {
        let expected =
            oracle::evaluate_augmented(descriptor, &mesh, &further, &window, mean_edge_length(&mesh));
        let found = with_shades(descriptor, &mesh, &shade, weight);
        assert_close(&found, &expected, AGREEMENT, descriptor.name());
    }
}

#[test]
fn an_edge_of_colour_is_salient_on_a_plane() {
    let mesh = grid(21, 21, |_, _| 0.0);
    let shade = shades(&mesh, |[x, _, _]| [f64::from(x > 0.5), 0.0]);
    let at = |x: f64| mesh.positions().iter().position(|p| p[0] == x && p[1] == 0.0).unwrap();
    let pca = with_shades(Descriptor::Pca, &mesh, &shade, 10.0);
    assert!(pca[at(0.0)] > 0.01 && pca[at(1.0)] > 0.01 && pca[at(-6.0)] < 1e-12, "{pca:?}");
    // Where more varies, its metric is shorter; away from the edge nothing does.
    let pca_qem = with_shades(Descriptor::PcaQem, &mesh, &shade, 10.0);
    let without = values(Descriptor::PcaQem, &mesh);
    assert_close(&[pca_qem[at(-6.0)]], &[without[at(-6.0)]], AGREEMENT, "away");
    assert!((pca_qem[at(0.0)] / without[at(0.0)] - 1.0).abs() > 0.1);
    let features = Features::new(&mesh, &[(&shade, 1.0)]).unwrap();
    let harris =
        evaluate_with_features(Descriptor::Harris3d, &mesh, &features, &Window::default(), 1.0, &|_| ());
    assert_eq!(harris, Err(FeaturesError::Descriptor { descriptor: Descriptor::Harris3d }));
}
