//! Normals for drawing, and a guess of how far the surface still is from the finest one.

/// Vertex normals of a mesh and its expected error.
#[derive(Default)]
pub struct Shading {
    normals: Vec<[f32; 3]>,
    expected_error: f64,
}

impl Shading {
    /// Computes everything anew. `step`: side of a grid cell at the precision known so far.
    pub fn update(&mut self, positions: &[[f32; 3]], triangles: &[[u32; 3]], step: f64) {
        self.normals.clear();
        self.normals.resize(positions.len(), [0.0; 3]);
        for triangle in triangles {
            let normal = face_normal(positions, triangle);
            for &v in triangle {
                let sum = &mut self.normals[v as usize];
                *sum = std::array::from_fn(|axis| sum[axis] + normal[axis]);
            }
        }
        for normal in &mut self.normals {
            let length = dot(*normal, *normal).sqrt();
            *normal = if length > 0.0 { normal.map(|c| c / length) } else { [0.0, 0.0, 1.0] };
        }
        self.expected_error = self.sagitta(positions, triangles).hypot(step / 12_f64.sqrt());
    }

    /// RMS over the area of how far an arc through both ends of an edge, upright on their normals, stands
    /// above the middle of the edge: edge · (difference of the normals) / 8.
    fn sagitta(&self, positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> f64 {
        let (mut sum, mut area) = (0.0, 0.0);
        for triangle in triangles {
            let normal = face_normal(positions, triangle);
            let weight = f64::from(dot(normal, normal).sqrt());
            for (a, b) in [(0, 1), (1, 2), (2, 0)] {
                let (a, b) = (triangle[a] as usize, triangle[b] as usize);
                let edge = sub(positions[b], positions[a]);
                let turn = sub(self.normals[b], self.normals[a]);
                let bulge = f64::from(dot(edge, turn)) / 8.0;
                sum += weight * bulge * bulge;
            }
            area += 3.0 * weight;
        }
        if area > 0.0 { (sum / area).sqrt() } else { 0.0 }
    }

    pub fn normals(&self) -> &[[f32; 3]] {
        &self.normals
    }

    pub fn expected_error(&self) -> f64 {
        self.expected_error
    }
}

/// Twice the area long.
fn face_normal(positions: &[[f32; 3]], triangle: &[u32; 3]) -> [f32; 3] {
    let [a, b, c] = triangle.map(|v| positions[v as usize]);
    let (u, v) = (sub(b, a), sub(c, a));
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

fn sub(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
