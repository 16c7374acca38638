//! Meshes that are valid, or become so, and hard on algorithms: vertices with very many neighbours, very many
//! faces at one place, pieces that nothing tells apart. Each of about as many faces as wanted.

use lwc::TriMesh;
use std::f64::consts::{PI, TAU};

type Point = [f64; 3];

/// Makes a mesh of about so many faces.
pub type Generator = fn(usize) -> TriMesh;

/// What all others are measured by.
pub const GRID: (&str, Generator) = ("grid", grid);

/// Every kind, by name.
pub const ALL: [(&str, Generator); 29] = [
    ("fan", fan),
    ("open fan", open_fan),
    ("bipyramid", bipyramid),
    ("fan with ears", fan_with_ears),
    ("many bipyramids", many_bipyramids),
    ("bouquet", bouquet),
    ("bouquet of tetrahedra", bouquet_of_tetrahedra),
    ("isolated triangles", isolated_triangles),
    ("coincident triangles", coincident_triangles),
    ("outlier", outlier),
    ("coincident cubes", coincident_cubes),
    ("coincident quads", coincident_quads),
    ("instances", instances),
    ("repeated face", repeated_face),
    ("repeated grid", repeated_grid),
    ("strip", strip),
    ("one place", one_place),
    ("one line", one_line),
    ("faces at an edge", faces_at_an_edge),
    ("turned faces at an edge", turned_faces_at_an_edge),
    ("tetrahedra at an edge", tetrahedra_at_an_edge),
    ("dense soup", dense_soup),
    ("sparse soup", sparse_soup),
    ("sphere", sphere),
    ("turned sphere", turned_sphere),
    ("Moebius strip", moebius_strip),
    ("stacked grids", stacked_grids),
    ("degenerate faces", degenerate_triangles),
    ("loose vertices", loose_vertices),
];

/// A fixed sequence of numbers.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, end: usize) -> u32 {
        (self.next() % end as u64) as u32
    }

    /// In [−1, 1)³.
    fn point(&mut self) -> Point {
        [0; 3].map(|_: i32| (self.next() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0)
    }
}

fn mesh(positions: Vec<Point>, triangles: Vec<[u32; 3]>) -> TriMesh {
    TriMesh::new(positions, triangles).expect("indices within the vertices")
}

fn plus(p: Point, q: Point, share: f64) -> Point {
    [0, 1, 2].map(|k| p[k] + share * q[k])
}

/// Points of an arc around the z axis.
fn arc(count: usize, angle: f64, z: f64) -> impl Iterator<Item = Point> {
    (0..count).map(move |i| angle * i as f64 / count as f64).map(move |t| [t.cos(), t.sin(), z])
}

/// `first`, then consecutive numbers to `end`, closed to a circle.
fn around(hub: u32, first: u32, end: u32) -> impl Iterator<Item = [u32; 3]> {
    (first..end).map(move |v| [hub, v, if v + 1 == end { first } else { v + 1 }])
}

/// The same piece again and again, each with vertices of its own.
fn copies(piece: &TriMesh, count: usize) -> TriMesh {
    let n = piece.num_vertices();
    let shifted = |k: usize| piece.triangles().iter().map(move |t| t.map(|v| v + (k * n) as u32));
    mesh(piece.positions().repeat(count), (0..count).flat_map(shifted).collect())
}

/// A flat grid of squares with one diagonal each.
fn grid(faces: usize) -> TriMesh {
    let side = (faces as f64 / 2.0).sqrt() as u32;
    rectangle(side, side)
}

fn rectangle(across: u32, up: u32) -> TriMesh {
    let positions = (0..=across).flat_map(|x| (0..=up).map(move |y| [f64::from(x), f64::from(y), 0.0]));
    let corner = |x, y| x * (up + 1) + y;
    let square = |x, y| {
        let [a, b, c, d] = [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
        [[a, b, c], [a, c, d]]
    };
    let triangles = (0..across).flat_map(|x| (0..up).flat_map(move |y| square(x, y))).collect();
    mesh(positions.collect(), triangles)
}

/// A cone around one vertex.
fn fan(faces: usize) -> TriMesh {
    let positions = std::iter::once([0.0, 0.0, 0.3]).chain(arc(faces, TAU, 0.0)).collect();
    mesh(positions, around(0, 1, faces as u32 + 1).collect())
}

fn open_fan(faces: usize) -> TriMesh {
    let positions = std::iter::once([0.0, 0.0, 0.3]).chain(arc(faces + 1, 1.9 * PI, 0.0)).collect();
    mesh(positions, (1..=faces as u32).map(|v| [0, v, v + 1]).collect())
}

fn bipyramid(faces: usize) -> TriMesh {
    let rim = faces / 2;
    let positions = [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]].into_iter().chain(arc(rim, TAU, 0.0)).collect();
    let end = rim as u32 + 2;
    let below = around(1, 2, end).map(|[a, b, c]| [a, c, b]);
    mesh(positions, around(0, 2, end).chain(below).collect())
}

/// With a triangle outside each edge of the rim.
fn fan_with_ears(faces: usize) -> TriMesh {
    let fan = open_fan(faces / 2);
    let (mut positions, mut triangles) = (fan.positions().to_vec(), fan.triangles().to_vec());
    for &[_, a, b] in fan.triangles() {
        triangles.push([b, a, positions.len() as u32]);
        let middle = plus(positions[a as usize], positions[b as usize], 1.0);
        positions.push(middle.map(|c| 0.75 * c));
    }
    mesh(positions, triangles)
}

fn many_bipyramids(faces: usize) -> TriMesh {
    let count = faces.isqrt();
    let one = bipyramid(count);
    let all = copies(&one, count);
    let place = |(i, &p): (usize, &Point)| plus(p, [3.0, 0.0, 0.0], (i / one.num_vertices()) as f64);
    mesh(all.positions().iter().enumerate().map(place).collect(), all.triangles().to_vec())
}

/// Triangles that have one vertex in common.
fn bouquet(faces: usize) -> TriMesh {
    let mut random = Random(1);
    let positions = std::iter::once([0.0; 3]).chain((0..2 * faces).map(|_| random.point())).collect();
    mesh(positions, (0..faces as u32).map(|i| [0, 1 + 2 * i, 2 + 2 * i]).collect())
}

fn bouquet_of_tetrahedra(faces: usize) -> TriMesh {
    let mut random = Random(2);
    let (mut positions, mut triangles) = (vec![[0.0; 3]], Vec::new());
    for i in (1..).step_by(3).take(faces / 4) {
        let centre = random.point();
        positions.extend((0..3).map(|_| plus(centre, random.point(), 0.05)));
        triangles.extend([[0, i, i + 1], [0, i + 1, i + 2], [0, i + 2, i], [i, i + 2, i + 1]]);
    }
    mesh(positions, triangles)
}

fn isolated_triangles(faces: usize) -> TriMesh {
    let mut random = Random(3);
    let mut positions = Vec::with_capacity(3 * faces);
    for _ in 0..faces {
        let centre = random.point();
        positions.extend((0..3).map(|_| plus(centre, random.point(), 0.01)));
    }
    mesh(positions, (0..faces as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
}

/// Equal triangles at one place, each with vertices of its own.
fn coincident_triangles(faces: usize) -> TriMesh {
    copies(&mesh(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]), faces)
}

/// One vertex so far away that all others are in one cell.
fn outlier(faces: usize) -> TriMesh {
    let near = isolated_triangles(faces);
    let mut positions = near.positions().to_vec();
    positions[0] = [1e6, 0.0, 0.0];
    mesh(positions, near.triangles().to_vec())
}

/// Equal cubes at one place.
fn coincident_cubes(faces: usize) -> TriMesh {
    let corners = (0..8).map(|i| [i >> 2 & 1, i >> 1 & 1, i & 1].map(f64::from)).collect();
    let sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
    let triangles = sides.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    copies(&mesh(corners, triangles), faces / 12)
}

/// Equal squares at one place.
fn coincident_quads(faces: usize) -> TriMesh {
    let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    copies(&mesh(corners, vec![[0, 1, 2], [0, 2, 3]]), faces / 2)
}

/// What merging the instances of one mesh gives if none has a place of its own.
fn instances(faces: usize) -> TriMesh {
    copies(&sphere(60), faces / sphere(60).num_triangles())
}

/// One face of a tetrahedron, again and again.
fn repeated_face(faces: usize) -> TriMesh {
    let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mut triangles = vec![[0, 3, 1], [1, 3, 2], [2, 3, 0]];
    triangles.resize(faces, [0, 1, 2]);
    mesh(corners, triangles)
}

/// All faces of a grid, eight times.
fn repeated_grid(faces: usize) -> TriMesh {
    let grid = grid(faces / 8);
    mesh(grid.positions().to_vec(), grid.triangles().repeat(8))
}

fn strip(faces: usize) -> TriMesh {
    rectangle(1, faces as u32 / 2)
}

/// A grid whose vertices are all at one place.
fn one_place(faces: usize) -> TriMesh {
    let grid = grid(faces);
    mesh(vec![[1.0; 3]; grid.num_vertices()], grid.triangles().to_vec())
}

/// A grid whose vertices are anywhere on a line.
fn one_line(faces: usize) -> TriMesh {
    let (grid, mut random) = (grid(faces), Random(4));
    let positions = grid.positions().iter().map(|_| [random.point()[0], 0.0, 0.0]).collect();
    mesh(positions, grid.triangles().to_vec())
}

/// Like the leaves of a book.
fn faces_at_an_edge(faces: usize) -> TriMesh {
    let positions = [[0.0; 3], [0.0, 0.0, 1.0]].into_iter().chain(arc(faces, TAU, 0.5)).collect();
    mesh(positions, (2..faces as u32 + 2).map(|v| [0, 1, v]).collect())
}

fn turned_faces_at_an_edge(faces: usize) -> TriMesh {
    let book = faces_at_an_edge(faces);
    let turn = |&[a, b, v]: &[u32; 3]| if v % 2 == 1 { [b, a, v] } else { [a, b, v] };
    mesh(book.positions().to_vec(), book.triangles().iter().map(turn).collect())
}

fn tetrahedra_at_an_edge(faces: usize) -> TriMesh {
    let mut random = Random(5);
    let count = faces / 4;
    let free = (0..2 * count).map(|_| random.point());
    let positions = [[0.0; 3], [0.0, 0.0, 1.0]].into_iter().chain(free).collect();
    let one = |v: u32| [[0, 1, v], [1, 0, v + 1], [0, v, v + 1], [1, v + 1, v]];
    mesh(positions, (2..).step_by(2).take(count).flat_map(one).collect())
}

/// Random faces over few vertices.
fn dense_soup(faces: usize) -> TriMesh {
    soup(faces, faces.isqrt())
}

fn sparse_soup(faces: usize) -> TriMesh {
    soup(faces, faces / 4)
}

fn soup(faces: usize, vertices: usize) -> TriMesh {
    let mut random = Random(6);
    let positions = (0..vertices).map(|_| random.point()).collect();
    mesh(positions, (0..faces).map(|_| [0; 3].map(|_: i32| random.below(vertices))).collect())
}

/// By latitude and longitude: the poles have many neighbours.
pub fn sphere(faces: usize) -> TriMesh {
    let rows = ((faces as f64 / 4.0).sqrt() as u32).max(3);
    let across = 2 * rows;
    let mut positions = vec![[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    for row in 1..rows {
        let (sin, cos) = (PI * f64::from(row) / f64::from(rows)).sin_cos();
        positions.extend(arc(across as usize, TAU, cos).map(|[x, y, z]| [sin * x, sin * y, z]));
    }
    let at = |row: u32, k: u32| 2 + row * across + k % across;
    let mut triangles: Vec<[u32; 3]> = (0..across).map(|k| [0, at(0, k), at(0, k + 1)]).collect();
    for (row, k) in (0..rows - 2).flat_map(|row| (0..across).map(move |k| (row, k))) {
        let [a, b, c, d] = [at(row, k), at(row + 1, k), at(row + 1, k + 1), at(row, k + 1)];
        triangles.extend([[a, b, c], [a, c, d]]);
    }
    triangles.extend((0..across).map(|k| [at(rows - 2, k + 1), at(rows - 2, k), 1]));
    mesh(positions, triangles)
}

/// Every other face the other way round, at random.
fn turned_sphere(faces: usize) -> TriMesh {
    let (sphere, mut random) = (sphere(faces), Random(7));
    let turn = |&[a, b, c]: &[u32; 3]| if random.below(2) == 0 { [b, a, c] } else { [a, b, c] };
    mesh(sphere.positions().to_vec(), sphere.triangles().iter().map(turn).collect())
}

fn moebius_strip(faces: usize) -> TriMesh {
    let length = faces as u32 / 2;
    let edge = |side: f64| {
        arc(length as usize, TAU, 0.0).enumerate().map(move |(i, [x, y, _])| {
            let half = PI * i as f64 / f64::from(length);
            let r = 1.0 + 0.3 * side * half.cos();
            [r * x, r * y, 0.3 * side * half.sin()]
        })
    };
    let (s, last) = (length, 2 * length - 1);
    let inner = (0..s - 1).flat_map(|i| [[i, i + 1, s + i], [i + 1, s + i + 1, s + i]]);
    let triangles = inner.chain([[s - 1, s, last], [s, 0, last]]).collect();
    mesh(edge(1.0).chain(edge(-1.0)).collect(), triangles)
}

/// Thirty-two equal grids at one place.
fn stacked_grids(faces: usize) -> TriMesh {
    copies(&grid(faces / 32), 32)
}

/// Faces that name a vertex twice, and one that does not.
fn degenerate_triangles(faces: usize) -> TriMesh {
    let (n, mut random) = (faces as u32 - 1, Random(8));
    let positions = (0..n).map(|_| random.point()).collect();
    mesh(positions, (0..n).map(|i| [i, i, (i + 1) % n]).chain([[0, 1, 2]]).collect())
}

/// Vertices of no face, and one face.
fn loose_vertices(faces: usize) -> TriMesh {
    let mut random = Random(9);
    mesh((0..faces).map(|_| random.point()).collect(), vec![[0, 1, 2]])
}
