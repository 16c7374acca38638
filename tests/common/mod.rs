//! Procedural meshes for the tests. All are counter-clockwise seen from outside or above.
#![allow(dead_code)]

pub mod attributed;
pub mod chunks;
pub mod corpus;
#[cfg(feature = "encoder")]
pub mod exact;
pub mod kinds;
pub mod valid;
#[cfg(feature = "cli")]
pub mod workshop;

use std::collections::HashMap;

use lwc::TriMesh;

/// Unit icosphere: 20·4^`subdiv` faces.
pub fn sphere(subdiv: u32) -> TriMesh {
    let t = (1.0 + 5f64.sqrt()) / 2.0;
    let mut positions: Vec<[f64; 3]> = [
        [-1.0, t, 0.0],
        [1.0, t, 0.0],
        [-1.0, -t, 0.0],
        [1.0, -t, 0.0],
        [0.0, -1.0, t],
        [0.0, 1.0, t],
        [0.0, -1.0, -t],
        [0.0, 1.0, -t],
        [t, 0.0, -1.0],
        [t, 0.0, 1.0],
        [-t, 0.0, -1.0],
        [-t, 0.0, 1.0],
    ]
    .map(unit)
    .to_vec();
    #[rustfmt::skip]
    let mut triangles: Vec<[u32; 3]> = vec![
        [0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11],
        [1, 5, 9], [5, 11, 4], [11, 10, 2], [10, 7, 6], [7, 1, 8],
        [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9],
        [4, 9, 5], [2, 4, 11], [6, 2, 10], [8, 6, 7], [9, 8, 1],
    ];
    for _ in 0..subdiv {
        let mut midpoints = HashMap::new();
        let mut midpoint = |a: u32, b: u32| {
            *midpoints.entry((a.min(b), a.max(b))).or_insert_with(|| {
                let (p, q) = (positions[a as usize], positions[b as usize]);
                positions.push(unit([p[0] + q[0], p[1] + q[1], p[2] + q[2]]));
                positions.len() as u32 - 1
            })
        };
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let (ab, bc, ca) = (midpoint(a, b), midpoint(b, c), midpoint(c, a));
                [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
            })
            .collect();
    }
    build(positions, triangles)
}

/// Torus of radii 2 and 0.7 around z, `n` vertices the long way and `m` the short way (both ≥ 3).
pub fn torus(n: u32, m: u32) -> TriMesh {
    let point = |i: u32, j: u32| {
        let (s, t) = (turn(i, n), turn(j, m));
        let ring = 2.0 + 0.7 * t.cos();
        [ring * s.cos(), ring * s.sin(), 0.7 * t.sin()]
    };
    let positions = (0..n).flat_map(|i| (0..m).map(move |j| point(i, j))).collect();
    let at = |i: u32, j: u32| (i % n) * m + j % m;
    build(positions, quads(n, m, at))
}

/// Open n × m grid of unit spacing centred at the origin, z = `height`(x, y). n, m ≥ 2.
pub fn grid(n: u32, m: u32, height: impl Fn(f64, f64) -> f64) -> TriMesh {
    let centred = |i: u32, n: u32| f64::from(i) - f64::from(n - 1) / 2.0;
    let positions = (0..n)
        .flat_map(|i| (0..m).map(move |j| (centred(i, n), centred(j, m))))
        .map(|(x, y)| [x, y, height(x, y)])
        .collect();
    build(positions, quads(n - 1, m - 1, |i, j| i * m + j))
}

/// Open cylinder of radius 1 around z: `n` vertices around (≥ 3), `m` rings (≥ 2), nearly square quads.
pub fn cylinder(n: u32, m: u32) -> TriMesh {
    let step = turn(1, n);
    let positions = (0..m)
        .flat_map(|j| (0..n).map(move |i| (turn(i, n), f64::from(j) * step)))
        .map(|(angle, z)| [angle.cos(), angle.sin(), z])
        .collect();
    build(positions, quads(n, m - 1, |i, j| j * n + i % n))
}

pub fn single_triangle() -> TriMesh {
    build(vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])
}

pub fn tetrahedron() -> TriMesh {
    build(
        vec![[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]],
        vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]],
    )
}

/// Closed fan around vertex 0, which lies above the rim. `valence` ≥ 3.
pub fn fan(valence: u32) -> TriMesh {
    let mut positions = vec![[0.0, 0.0, 0.5]];
    positions.extend((0..valence).map(|i| turn(i, valence)).map(|a| [a.cos(), a.sin(), 0.0]));
    build(positions, (0..valence).map(|i| [0, 1 + i, 1 + (i + 1) % valence]).collect())
}

/// Flat strip of `n` triangles, two vertices wide.
pub fn strip(n: u32) -> TriMesh {
    let positions = (0..n + 2).map(|i| [f64::from(i) * 0.5, f64::from(i % 2), 0.0]).collect();
    let flipped = |i: u32| if i.is_multiple_of(2) { [i, i + 2, i + 1] } else { [i, i + 1, i + 2] };
    build(positions, (0..n).map(flipped).collect())
}

/// Closed surface of genus 3: the faces of a slab of cubes with three holes.
pub fn genus3() -> TriMesh {
    let solid = |x: i32, y: i32, z: i32| {
        (0..7).contains(&x) && (0..3).contains(&y) && z == 0 && !(y == 1 && x % 2 == 1)
    };
    let mut indices = HashMap::new();
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for (x, y) in (0..7).flat_map(|x| (0..3).map(move |y| (x, y))).filter(|&(x, y)| solid(x, y, 0)) {
        for axis in 0..3 {
            for side in [-1, 1] {
                let mut beside = [x, y, 0];
                beside[axis] += side;
                if solid(beside[0], beside[1], beside[2]) {
                    continue;
                }
                let mut corner = |u: i32, w: i32| {
                    let mut p = [x, y, 0];
                    p[axis] += i32::from(side > 0);
                    p[(axis + 1) % 3] += u;
                    p[(axis + 2) % 3] += w;
                    *indices.entry(p).or_insert_with(|| {
                        positions.push(p.map(f64::from));
                        positions.len() as u32 - 1
                    })
                };
                let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                triangles.extend(if side > 0 { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] });
            }
        }
    }
    build(positions, triangles)
}

/// `n` separate tetrahedra in a row.
pub fn many_components(n: u32) -> TriMesh {
    let (corners, faces) = tetrahedron().into_parts();
    let positions = (0..n).flat_map(|i| corners.iter().map(move |c| [c[0] + 4.0 * f64::from(i), c[1], c[2]]));
    let triangles = (0..n).flat_map(|i| faces.iter().map(move |f| f.map(|v| v + 4 * i)));
    build(positions.collect(), triangles.collect())
}

/// A bumpy grid with one more face standing on an interior edge.
pub fn non_manifold_fin() -> TriMesh {
    let (mut positions, mut triangles) = grid(7, 7, |x, y| 0.3 * (x + 0.5 * y).sin()).into_parts();
    let tip = positions.len() as u32;
    positions.push([0.5, 0.0, 1.0]);
    triangles.push([24, 31, tip]);
    build(positions, triangles)
}

/// The connectivity of a sphere with every vertex at one place.
pub fn all_points_equal() -> TriMesh {
    let (positions, triangles) = sphere(1).into_parts();
    build(vec![[3.0, -2.0, 0.1]; positions.len()], triangles)
}

/// `mesh` with every coordinate moved by up to ±`amp`, uniformly, in vertex order x, y, z.
pub fn noisy(mesh: TriMesh, seed: u64, amp: f64) -> TriMesh {
    let mut random = Random(seed);
    map_positions(mesh, |p| p.map(|c| c + amp * (2.0 * random.unit() - 1.0)))
}

/// `mesh` with every position replaced.
pub fn map_positions(mesh: TriMesh, f: impl FnMut([f64; 3]) -> [f64; 3]) -> TriMesh {
    let (positions, triangles) = mesh.into_parts();
    build(positions.into_iter().map(f).collect(), triangles)
}

/// `num_triangles` random triples over `num_vertices` random points of the unit cube: repeated indices,
/// repeated faces, edges of many faces.
pub fn soup(num_vertices: u32, num_triangles: u32, seed: u64) -> TriMesh {
    let mut random = Random(seed);
    let positions = (0..num_vertices).map(|_| std::array::from_fn(|_| random.unit())).collect();
    let mut triangles: Vec<[u32; 3]> = (0..num_triangles)
        .map(|_| std::array::from_fn(|_| (random.next() % u64::from(num_vertices)) as u32))
        .collect();
    triangles.extend_from_within(..triangles.len() / 10);
    build(positions, triangles)
}

/// SplitMix64.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// A mesh that is known to be valid.
pub fn build(positions: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>) -> TriMesh {
    TriMesh::new(positions, triangles).expect("procedural meshes are valid")
}

/// Two triangles for each cell (i, j) of an n × m arrangement of vertices `at`(i, j).
fn quads(n: u32, m: u32, at: impl Fn(u32, u32) -> u32) -> Vec<[u32; 3]> {
    let mut triangles = Vec::new();
    for i in 0..n {
        for j in 0..m {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    triangles
}

fn turn(i: u32, n: u32) -> f64 {
    std::f64::consts::TAU * f64::from(i) / f64::from(n)
}

fn unit(p: [f64; 3]) -> [f64; 3] {
    let length = p.iter().map(|c| c * c).sum::<f64>().sqrt();
    p.map(|c| c / length)
}
