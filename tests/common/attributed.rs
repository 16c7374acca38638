//! Meshes with attributes.

use super::*;
use lwc::mesh::{Attribute, Attributes, Domain, Semantic, Values};

pub fn all(list: Vec<Attribute>) -> Attributes {
    let mut attributes = Attributes::default();
    attributes.list = list;
    attributes
}

pub fn positions(mesh: &TriMesh) -> impl Iterator<Item = [f64; 3]> + '_ {
    mesh.positions().iter().copied()
}

pub fn colours(mesh: &TriMesh) -> Attribute {
    let values = positions(mesh).flat_map(|p| p.map(|x| (127.0 + 60.0 * (2.0 * x).sin()) as u8)).collect();
    Attribute::new("red green blue", Semantic::Color(0), Domain::Vertex, 3, Values::U8(values))
}

/// A torus of n × m cut open into one rectangle: seams along both circles, which meet once.
pub fn atlas(n: u32, m: u32) -> (TriMesh, Attribute) {
    let mesh = torus(n, m);
    let mut values = Vec::new();
    for triangle in mesh.triangles() {
        let places = triangle.map(|v| [v / m, v % m]);
        for [i, j] in places {
            let round = |x: u32, k: usize, all: u32| {
                let is_far = places.iter().any(|p| p[k] == all - 1);
                f64::from(if x == 0 && is_far { all } else { x }) / f64::from(all)
            };
            values.extend([round(i, 0, n) as f32, round(j, 1, m) as f32]);
        }
    }
    let uv = Attribute::new("texcoord", Semantic::TexCoord(0), Domain::Corner, 2, Values::F32(values));
    (mesh, uv)
}

pub fn flat_normals(mesh: &TriMesh) -> Attribute {
    let mut values = Vec::new();
    for t in mesh.triangles() {
        let [a, b, c] = t.map(|v| mesh.positions()[v as usize]);
        let (u, v) = ([b[0] - a[0], b[1] - a[1], b[2] - a[2]], [c[0] - a[0], c[1] - a[1], c[2] - a[2]]);
        let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        let length = n.iter().map(|x| x * x).sum::<f64>().sqrt();
        (0..3).for_each(|_| values.extend(n.map(|x| (x / length) as f32)));
    }
    Attribute::new("vn", Semantic::Normal, Domain::Corner, 3, Values::F32(values))
}

pub fn materials(mesh: &TriMesh) -> Attribute {
    let names = ["north", "south", "middle"].map(String::from).to_vec();
    let centre = |t: &[u32; 3]| t.iter().map(|&v| mesh.positions()[v as usize][2]).sum::<f64>() / 3.0;
    let index = |z: f64| {
        if z > 0.3 {
            0
        } else if z < -0.3 {
            1
        } else {
            2
        }
    };
    let indices = mesh.triangles().iter().map(|t| index(centre(t))).collect();
    Attribute {
        indices: Some(indices),
        ..Attribute::new("usemtl", Semantic::Material, Domain::Face, 1, Values::Names(names))
    }
}
