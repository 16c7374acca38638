//! The meshes that other tests build on are what their names say.

mod common;

use common::*;
use lwc::TriMesh;
use std::collections::HashMap;

/// Directed edges without an opposite, and V − E + F. Fails if two faces run the same way along an edge.
fn boundary_and_euler(mesh: &TriMesh) -> (usize, i64) {
    let mut directed = HashMap::new();
    for &[a, b, c] in mesh.triangles() {
        for edge in [(a, b), (b, c), (c, a)] {
            assert_eq!(directed.insert(edge, ()), None, "edge {edge:?} twice");
        }
    }
    let boundary = directed.keys().filter(|&&(a, b)| !directed.contains_key(&(b, a))).count();
    let edges = (directed.len() + boundary) / 2;
    (boundary, mesh.num_vertices() as i64 - edges as i64 + mesh.num_triangles() as i64)
}

fn volume(mesh: &TriMesh) -> f64 {
    let p = mesh.positions();
    let six_fold = mesh.triangles().iter().map(|t| {
        let [a, b, c] = t.map(|v| p[v as usize]);
        a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    });
    six_fold.sum::<f64>() / 6.0
}

#[test]
fn closed_meshes_face_outwards_and_have_their_genus() {
    for (mesh, euler) in [
        (sphere(0), 2),
        (sphere(3), 2),
        (torus(12, 5), 0),
        (tetrahedron(), 2),
        (genus3(), -4),
        (many_components(7), 14),
    ] {
        assert_eq!(boundary_and_euler(&mesh), (0, euler));
        assert!(volume(&mesh) > 0.0);
    }
}

#[test]
fn open_meshes_have_their_boundaries() {
    assert_eq!(boundary_and_euler(&grid(4, 6, |_, _| 0.0)), (16, 1));
    assert_eq!(boundary_and_euler(&cylinder(9, 4)), (18, 0));
    assert_eq!(boundary_and_euler(&single_triangle()), (3, 1));
    assert_eq!(boundary_and_euler(&fan(20)), (20, 1));
    assert_eq!(boundary_and_euler(&strip(11)), (13, 1));
}

#[test]
fn noise_repeats_itself_and_stays_small() {
    let (once, twice) = (noisy(sphere(2), 1, 0.1), noisy(sphere(2), 1, 0.1));
    assert_eq!(once, twice);
    assert_ne!(once, noisy(sphere(2), 2, 0.1));
    for (p, q) in once.positions().iter().zip(sphere(2).positions()) {
        assert!(p.iter().zip(q).all(|(a, b)| (a - b).abs() <= 0.1));
    }
}
