//! Distances between meshes whose distance is known.
#![cfg(feature = "metrics")]

use lwc::{
    TriMesh,
    metrics::{CompareError, CompareOptions, Comparison, Distance, compare},
};

fn measure(a: &TriMesh, b: &TriMesh) -> Comparison {
    compare(a, b, &CompareOptions::default()).expect("vertices in both")
}

/// The square [0, 1]² at height `z`, in `n` × `n` cells.
fn square(n: u32, z: f64) -> TriMesh {
    let at = |i: u32, j: u32| i * (n + 1) + j;
    let unit = |k: u32| f64::from(k) / f64::from(n);
    let positions = (0..=n).flat_map(|i| (0..=n).map(move |j| [unit(i), unit(j), z]));
    let cells = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    let faces = cells.flat_map(|(i, j)| {
        [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
    });
    TriMesh::new(positions.collect(), faces.collect()).expect("a valid mesh")
}

/// A sphere of the given radius: an octahedron, split `steps` times.
fn sphere(steps: u32, radius: f64) -> TriMesh {
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mut positions: Vec<[f64; 3]> = axes.into_iter().flat_map(|p| [p, p.map(|c: f64| -c)]).collect();
    let mut triangles =
        vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    for _ in 0..steps {
        let mut middles = std::collections::HashMap::new();
        let mut split = Vec::new();
        for [a, b, c] in triangles {
            let mut middle = |s: u32, t: u32| {
                *middles.entry((s.min(t), s.max(t))).or_insert_with(|| {
                    let (p, q) = (positions[s as usize], positions[t as usize]);
                    let sum: [f64; 3] = std::array::from_fn(|k| p[k] + q[k]);
                    let length = sum.iter().map(|c| c * c).sum::<f64>().sqrt();
                    positions.push(sum.map(|c| c / length));
                    positions.len() as u32 - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            split.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        triangles = split;
    }
    let positions = positions.into_iter().map(|p| p.map(|c| radius * c)).collect();
    TriMesh::new(positions, triangles).expect("a valid mesh")
}

/// The mesh with every coordinate changed.
fn moved(mesh: &TriMesh, change: impl Fn(usize, f64) -> f64) -> TriMesh {
    let positions = mesh.positions().iter().map(|p| std::array::from_fn(|k| change(k, p[k]))).collect();
    TriMesh::new(positions, mesh.triangles().to_vec()).expect("a valid mesh")
}

fn assert_near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} is not {expected} ± {tolerance}");
}

#[test]
fn parallel_planes_are_their_height_apart() {
    let found = measure(&square(7, 0.0), &square(3, 0.25));
    for Distance { rms, max } in [found.forward, found.backward] {
        assert_near(rms, 0.25, 1e-15);
        assert_near(max, 0.25, 1e-15);
    }
    assert_near(found.diagonal, 2.0_f64.sqrt(), 1e-15);
    assert_near(found.psnr_db(), -20.0 * (0.25 / 2.0_f64.sqrt()).log10(), 1e-12);
}

#[test]
fn a_tilted_plane_has_the_root_mean_square_of_its_heights() {
    // Heights 0 … 0.1 over the unit square, measured down to a plane that reaches beyond it.
    let tilted = square(1, 0.0);
    let tilted = TriMesh::new(
        tilted.positions().iter().map(|&[x, y, _]| [x, y, 0.1 * x]).collect(),
        tilted.triangles().to_vec(),
    )
    .unwrap();
    let floor = moved(&square(5, 0.0), |k, c| if k < 2 { 3.0 * c - 1.0 } else { c });
    let forward = measure(&tilted, &floor).forward;
    // The samples have an error: here 3e-5 of the value.
    assert_near(forward.rms, 0.1 / 3.0_f64.sqrt(), 1e-5);
    assert_near(forward.max, 0.1, 1e-15);
}

#[test]
fn concentric_spheres_are_their_radii_apart() {
    let found = measure(&sphere(6, 1.0), &sphere(6, 1.1));
    for Distance { rms, max } in [found.forward, found.backward] {
        assert_near(rms, 0.1, 2e-4);
        assert_near(max, 0.1, 2e-3);
    }
    // A coarse sphere lies inside the fine one, and a part of it far inside.
    let coarse = measure(&sphere(1, 1.0), &sphere(6, 1.0));
    assert!(coarse.forward.max > 0.15 && coarse.forward.max < 0.25, "{coarse:?}");
    assert_eq!(coarse.max(), coarse.forward.max.max(coarse.backward.max));
}

#[test]
fn a_mesh_is_at_no_distance_from_itself() {
    for mesh in [sphere(4, 1.0), square(9, 3.0), sphere(3, 1e-300), sphere(3, 1e300), sphere(3, f64::MAX)] {
        let found = measure(&mesh, &mesh);
        assert_eq!((found.forward, found.backward), (Distance::default(), Distance::default()));
        assert_eq!((found.rms_relative(), found.psnr_db()), (0.0, f64::INFINITY));
    }
    // Nor from itself with a finer triangulation, other indices and another order.
    let found = measure(&square(1, 0.5), &square(13, 0.5));
    assert_eq!(found.max(), 0.0);
}

#[test]
fn far_origins_cost_no_digits() {
    let utm = |mesh: &TriMesh| moved(mesh, |k, c| c + [4_500_000.0, 5_500_000.0, 1000.0][k]);
    let found = measure(&utm(&square(8, 0.0)), &utm(&square(8, 0.001)));
    assert_near(found.rms(), 0.001, 1e-12);
    assert_near(found.forward.max, 0.001, 1e-12);
    assert_near(found.diagonal, 2.0_f64.sqrt(), 1e-9);
}

#[test]
fn no_size_overflows_or_vanishes() {
    let small = measure(&sphere(4, 1.0), &sphere(4, 1.25));
    for factor in [1e-300, 1e-100, 1e100, 1e300] {
        let found = measure(&sphere(4, factor), &sphere(4, 1.25 * factor));
        assert_near(found.rms() / factor, small.rms(), 1e-9);
        assert_near(found.max() / factor, small.max(), 1e-9);
        assert_near(found.psnr_db(), small.psnr_db(), 1e-6);
    }
}

#[test]
fn the_rms_is_weighted_by_area() {
    // Nine tenths of the area at height 0 in two triangles, one tenth at height 1 in many.
    let low = moved(&square(1, 0.0), |k, c| if k == 0 { 0.9 * c } else { c });
    let high = moved(&square(20, 1.0), |k, c| if k == 0 { 0.1 * c + 0.9 } else { c });
    let (mut positions, mut triangles) = low.into_parts();
    let offset = positions.len() as u32;
    triangles.extend(high.triangles().iter().map(|t| t.map(|v| v + offset)));
    positions.extend(high.positions());
    let both = TriMesh::new(positions, triangles).unwrap();
    let floor = moved(&square(1, 0.0), |k, c| if k < 2 { 3.0 * c - 1.0 } else { c });
    assert_near(measure(&both, &floor).forward.rms, 0.1_f64.sqrt(), 1e-4);
}

#[test]
fn vertices_are_measured_even_with_few_samples() {
    let mut positions = square(4, 0.0).into_parts().0;
    positions[12][2] = 0.5;
    let spike = TriMesh::new(positions, square(4, 0.0).into_parts().1).unwrap();
    let found = compare(&spike, &square(4, 0.0), &CompareOptions::new().samples(10)).unwrap();
    assert_eq!(found.forward.max, 0.5);
}

#[test]
fn surfaces_without_area_are_segments_and_points() {
    let points = TriMesh::new(vec![[0.0, 0.0, 1.0], [1.0, 1.0, 3.0]], vec![]).unwrap();
    let plane = square(3, 0.0);
    let found = measure(&points, &plane);
    assert_near(found.forward.rms, 5.0_f64.sqrt(), 1e-12);
    assert_near(found.forward.max, 3.0, 1e-12);
    assert!(found.backward.max > 1.0);

    let segment = TriMesh::new(vec![[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [9.0; 3]], vec![[0, 1, 0]]).unwrap();
    let found = measure(&segment, &plane);
    assert_near(found.forward.rms, 1.0, 1e-15);
    assert_near(found.forward.max, 1.0, 1e-15);
    assert_near(found.backward.max, 2.0_f64.sqrt(), 1e-12);

    let one_point = TriMesh::new(vec![[2.0; 3]; 5], vec![[0, 1, 2], [3, 3, 3]]).unwrap();
    assert_eq!(measure(&one_point, &one_point).psnr_db(), f64::INFINITY);
    let shifted = measure(&one_point, &moved(&one_point, |_, c| c + 1.0));
    assert_near(shifted.rms(), 3.0_f64.sqrt(), 1e-12);
    assert_eq!((shifted.diagonal, shifted.rms_relative()), (0.0, f64::INFINITY));
}

#[test]
fn a_mesh_without_vertices_is_refused() {
    let (some, none) = (square(1, 0.0), TriMesh::default());
    let options = CompareOptions::default();
    assert_eq!(compare(&none, &some, &options), Err(CompareError::Empty { is_first: true }));
    assert_eq!(compare(&some, &none, &options), Err(CompareError::Empty { is_first: false }));
    let message = CompareError::Empty { is_first: false }.to_string();
    assert_eq!(message, "the second mesh has no vertices");
}

#[test]
fn the_number_of_threads_does_not_matter() {
    let (a, b) = (sphere(5, 1.0), moved(&sphere(3, 1.02), |k, c| c + 0.01 * k as f64));
    let with_threads = |count: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap();
        pool.install(|| measure(&a, &b))
    };
    let one = with_threads(1);
    assert!(one.rms() > 0.0);
    assert_eq!(one, with_threads(2));
    assert_eq!(one, with_threads(7));
}
