//! Writes the model in `tests/data`: a trefoil knot with ribs and a few thousand vertices.
//!
//! ```text
//! cargo run --release --example make_knot tests/data/knot.ply
//! ```

use std::f64::consts::TAU;

/// Vertices along the knot and around its tube.
const ALONG: u32 = 240;
const AROUND: u32 = 18;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("usage: make_knot OUTPUT")?;
    let mesh = lwc::TriMesh::new(positions(), triangles())?;
    lwc::io::write(&path, &mesh)?;
    println!("{path}: {} vertices, {} triangles", mesh.num_vertices(), mesh.num_triangles());
    Ok(())
}

/// Centre line: the (2, 3) torus knot.
fn centre(t: f64) -> [f64; 3] {
    let (a, b) = (2.0 * t, 3.0 * t);
    [(2.0 + b.cos()) * a.cos(), (2.0 + b.cos()) * a.sin(), b.sin()]
}

fn positions() -> Vec<[f64; 3]> {
    let mut positions = Vec::new();
    for i in 0..ALONG {
        let t = TAU * f64::from(i) / f64::from(ALONG);
        let step = 1e-4;
        let (before, here, after) = (centre(t - step), centre(t), centre(t + step));
        let tangent = unit(sub(after, before));
        let inward = sub(scale(here, 2.0), add(before, after));
        let normal = unit(sub(inward, scale(tangent, dot(inward, tangent))));
        let binormal = cross(tangent, normal);
        for j in 0..AROUND {
            let angle = TAU * f64::from(j) / f64::from(AROUND);
            let ribs = 1.0 + 0.12 * (24.0 * t).sin() + 0.05 * (5.0 * angle + 9.0 * t).cos();
            let offset = add(scale(normal, angle.cos()), scale(binormal, angle.sin()));
            // Stored as float32, so that the file is small.
            positions.push(add(here, scale(offset, 0.38 * ribs)).map(|c| f64::from(c as f32)));
        }
    }
    positions
}

fn triangles() -> Vec<[u32; 3]> {
    let at = |i: u32, j: u32| i % ALONG * AROUND + j % AROUND;
    let mut triangles = Vec::new();
    for i in 0..ALONG {
        for j in 0..AROUND {
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    triangles
}

fn add(p: [f64; 3], q: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| p[i] + q[i])
}

fn sub(p: [f64; 3], q: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| p[i] - q[i])
}

fn scale(p: [f64; 3], s: f64) -> [f64; 3] {
    p.map(|c| c * s)
}

fn dot(p: [f64; 3], q: [f64; 3]) -> f64 {
    (0..3).map(|i| p[i] * q[i]).sum()
}

fn unit(p: [f64; 3]) -> [f64; 3] {
    scale(p, 1.0 / dot(p, p).sqrt())
}

fn cross(p: [f64; 3], q: [f64; 3]) -> [f64; 3] {
    [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
}
