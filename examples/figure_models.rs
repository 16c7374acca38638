//! Models for the pictures in `docs/`, see `docs/figures.sh`: a wrinkled tube, a mesh with noise, and a
//! mesh bent along its z axis.
//!
//! ```text
//! cargo run --release --example figure_models -- tube OUTPUT
//! cargo run --release --example figure_models -- noise INPUT OUTPUT
//! cargo run --release --example figure_models -- bend INPUT OUTPUT
//! ```

use lwc::TriMesh;
use lwc::descriptors::mean_edge_length;
use lwc::experiment::Noise;
use std::f64::consts::TAU;

/// Vertices of the tube around and along.
const AROUND: u32 = 96;
const ALONG: u32 = 200;
/// Radius of the arc that the axis is bent to; the tube is 10 long.
const BEND_RADIUS: f64 = 3.6;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let (output, mesh) = match words[..] {
        ["tube", output] => (output, tube()?),
        ["noise", input, output] => {
            let mesh = lwc::io::read(input)?.mesh;
            let noise = Noise { deviation: 0.2, ..Noise::default() };
            (output, noise.perturb(&mesh, mean_edge_length(&mesh))?)
        }
        ["bend", input, output] => {
            let (positions, triangles) = lwc::io::read(input)?.mesh.into_parts();
            (output, TriMesh::new(positions.into_iter().map(bend).collect(), triangles)?)
        }
        _ => return Err("usage: figure_models tube OUT | noise IN OUT | bend IN OUT".into()),
    };
    lwc::io::write(output, &mesh)?;
    println!("{output}: {} vertices", mesh.num_vertices());
    Ok(())
}

/// A tube around z with round ends and slanting wrinkles.
fn tube() -> Result<TriMesh, lwc::MeshError> {
    let mut positions = vec![];
    for j in 0..ALONG {
        let along = (f64::from(j) + 0.5) / f64::from(ALONG);
        let z = 10.0 * along - 5.0;
        // Half ellipses close the ends.
        let end = (1.0 - ((z.abs() - 4.2).max(0.0) / 0.8).powi(2)).max(0.0).sqrt();
        for i in 0..AROUND {
            let angle = TAU * f64::from(i) / f64::from(AROUND);
            let wrinkle = 0.07 * (5.0 * angle + 4.0 * z).sin() + 0.03 * (17.0 * z - 3.0 * angle).cos();
            let radius = end * (1.0 + wrinkle);
            positions.push([radius * angle.cos(), radius * angle.sin(), z]);
        }
    }
    let ends = positions.len() as u32;
    positions.extend([[0.0, 0.0, -5.0], [0.0, 0.0, 5.0]]);
    let at = |i: u32, j: u32| j * AROUND + i % AROUND;
    let mut triangles = vec![];
    for i in 0..AROUND {
        for j in 0..ALONG - 1 {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
        triangles.push([at(i + 1, 0), at(i, 0), ends]);
        triangles.push([at(i, ALONG - 1), at(i + 1, ALONG - 1), ends + 1]);
    }
    TriMesh::new(positions, triangles)
}

/// Bends the z axis to an arc towards x.
fn bend([x, y, z]: [f64; 3]) -> [f64; 3] {
    let (sin, cos) = (z / BEND_RADIUS).sin_cos();
    let radius = BEND_RADIUS - x;
    [BEND_RADIUS - radius * cos, y, radius * sin]
}
