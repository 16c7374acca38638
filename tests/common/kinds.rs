//! One small mesh of every kind that an encoder may meet, by name.

use super::*;

/// A strip of `n` quads whose ends are joined after half a turn: one side, one boundary.
pub fn moebius(n: u32) -> TriMesh {
    let point = |i: u32, side: f64| {
        let angle = turn(i, n);
        let (across, up) = (side * (angle / 2.0).cos(), side * (angle / 2.0).sin());
        [(2.0 + across) * angle.cos(), (2.0 + across) * angle.sin(), up]
    };
    let positions = (0..n).flat_map(|i| [point(i, -0.5), point(i, 0.5)]).collect();
    let triangles = (0..n).flat_map(|i| {
        let (a, b) = (2 * i, 2 * i + 1);
        let (c, d) = if i + 1 == n { (1, 0) } else { (a + 2, b + 2) };
        [[a, c, b], [b, c, d]]
    });
    build(positions, triangles.collect())
}

/// Three triangles at one edge, and no more.
pub fn edge_with_three_faces() -> TriMesh {
    let positions = vec![[0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.5], [-0.5, 0.8, 0.5], [-0.5, -0.8, 0.5]];
    build(positions, vec![[0, 1, 2], [0, 1, 3], [1, 0, 4]])
}

/// Two closed pyramids that share their tips' vertex.
pub fn vertex_with_two_fans() -> TriMesh {
    let mut positions = vec![[0.0; 3]];
    let mut triangles = Vec::new();
    for side in [1.0, -1.0] {
        let first = positions.len() as u32;
        positions.extend((0..6).map(|i| [side * turn(i, 6).cos(), turn(i, 6).sin(), side]));
        triangles.extend((0..6).map(|i| [0, first + i, first + (i + 1) % 6]));
    }
    build(positions, triangles)
}

/// A sphere with every seventh triangle turned over.
pub fn flipped_faces() -> TriMesh {
    let (positions, mut triangles) = sphere(2).into_parts();
    triangles.iter_mut().step_by(7).for_each(|t| t.swap(0, 1));
    build(positions, triangles)
}

/// A bumpy grid with triangles repeated, turned, degenerate, and vertices that nothing uses.
pub fn repeated_and_degenerate_faces() -> TriMesh {
    let (mut positions, mut triangles) = grid(9, 8, |x, y| (0.4 * x * y).sin()).into_parts();
    let again: Vec<[u32; 3]> = triangles.iter().step_by(5).map(|&[a, b, c]| [b, c, a]).collect();
    triangles.extend(again);
    triangles.push(triangles[3]);
    triangles.insert(4, [7, 7, 8]);
    triangles.push([9, 9, 9]);
    positions.insert(0, [1e6, -1e6, 3.0]);
    triangles.iter_mut().flatten().for_each(|v| *v += 1);
    positions.push([0.0, 0.0, -1e7]);
    build(positions, triangles)
}

/// Two meshes in one, the second moved to the side.
pub fn beside(one: TriMesh, other: TriMesh) -> TriMesh {
    let (mut positions, mut triangles) = one.into_parts();
    let first = positions.len() as u32;
    positions.extend(other.positions().iter().map(|p| [p[0] + 7.0, p[1], p[2]]));
    triangles.extend(other.triangles().iter().map(|t| t.map(|v| v + first)));
    build(positions, triangles)
}

/// Everything, each with its name.
pub fn every_kind() -> Vec<(&'static str, TriMesh)> {
    let bumpy = |x: f64, y: f64| 0.6 * (0.7 * x).sin() * (0.5 * y).cos();
    let scaled = |factor: f64| map_positions(noisy(sphere(2), 3, 0.02), move |p| p.map(|c| c * factor));
    let utm = map_positions(grid(20, 15, bumpy), |p| {
        [431_234.567 + p[0], 5_512_345.678 + p[1], 812.001 + p[2]].map(|c| (c * 1000.0).round() / 1000.0)
    });
    vec![
        ("single triangle", single_triangle()),
        ("tetrahedron", tetrahedron()),
        ("sphere", noisy(sphere(3), 1, 0.02)),
        ("torus", noisy(torus(24, 9), 2, 0.01)),
        ("genus 3", genus3()),
        ("open grid", grid(21, 17, bumpy)),
        ("flat grid", grid(23, 19, |_, _| 0.0)),
        ("cylinder", cylinder(14, 9)),
        ("strip", strip(301)),
        ("fan of valence 2000", fan(2000)),
        ("components", noisy(many_components(40), 4, 0.1)),
        ("fin", non_manifold_fin()),
        ("edge with three faces", edge_with_three_faces()),
        ("vertex with two fans", vertex_with_two_fans()),
        ("moebius", moebius(31)),
        ("flipped faces", flipped_faces()),
        ("repeated and degenerate faces", repeated_and_degenerate_faces()),
        ("all points equal", all_points_equal()),
        ("soup", soup(60, 220, 5)),
        ("dense soup", soup(9, 300, 6)),
        ("huge", scaled(1e307)),
        ("denormal", scaled(1e-310)),
        ("utm", utm),
    ]
}
