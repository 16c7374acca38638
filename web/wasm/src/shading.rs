//! Normals for drawing, and an estimate of how far the surface still is from the finest one.

/// Vertex normals of a mesh and its expected error, computed part by part.
#[derive(Default)]
pub struct Shading {
    normals: Vec<[f32; 3]>,
    expected_error: f64,
    stage: Stage,
    /// First triangle or vertex that the stage has not seen.
    next: usize,
    bulge: Bulge,
}

#[derive(Clone, Copy, Default, PartialEq)]
enum Stage {
    #[default]
    Clear,
    /// Normals of the triangles are added up.
    Sum,
    /// The sums become of unit length.
    Normalise,
    Measure,
    Done,
}

impl Shading {
    /// Forgets what was computed: the mesh has changed.
    pub fn restart(&mut self) {
        (self.stage, self.next, self.bulge) = (Stage::Clear, 0, Bulge::default());
    }

    /// Goes through at most `elements` vertices or triangles; true if everything is computed. `step`: side
    /// of a grid cell at the precision known so far.
    pub fn advance(
        &mut self,
        positions: &[[f32; 3]],
        triangles: &[[u32; 3]],
        step: f64,
        elements: usize,
    ) -> bool {
        let mut left = elements;
        while left > 0 && self.stage != Stage::Done {
            let (count, after) = match self.stage {
                Stage::Clear => (positions.len(), Stage::Sum),
                Stage::Sum => (triangles.len(), Stage::Normalise),
                Stage::Normalise => (positions.len(), Stage::Measure),
                _ => (triangles.len(), Stage::Done),
            };
            let part = self.next..count.min(self.next.saturating_add(left));
            left -= part.len();
            self.next = part.end;
            match self.stage {
                Stage::Clear => {
                    self.normals.truncate(part.start);
                    self.normals.reserve_exact(count - part.start);
                    self.normals.resize(part.end, [0.0; 3]);
                }
                Stage::Sum => self.sum(positions, &triangles[part]),
                Stage::Normalise => self.normals[part].iter_mut().for_each(normalise),
                _ => triangles[part].iter().for_each(|t| self.bulge.add(positions, &self.normals, t)),
            }
            if self.next == count {
                (self.stage, self.next) = (after, 0);
            }
            if self.stage == Stage::Done {
                self.expected_error = std::mem::take(&mut self.bulge).rms().hypot(step / 12_f64.sqrt());
            }
        }
        self.stage == Stage::Done
    }

    fn sum(&mut self, positions: &[[f32; 3]], triangles: &[[u32; 3]]) {
        for triangle in triangles {
            let normal = face_normal(positions, triangle);
            for &v in triangle {
                let sum = &mut self.normals[v as usize];
                *sum = std::array::from_fn(|axis| sum[axis] + normal[axis]);
            }
        }
    }

    pub fn normals(&self) -> &[[f32; 3]] {
        &self.normals
    }

    pub fn expected_error(&self) -> f64 {
        self.expected_error
    }
}

/// RMS over the area of how far an arc through both ends of an edge, upright on their normals, stands
/// above the middle of the edge: edge · (difference of the normals) / 8.
#[derive(Default)]
struct Bulge {
    sum: f64,
    area: f64,
}

impl Bulge {
    fn add(&mut self, positions: &[[f32; 3]], normals: &[[f32; 3]], triangle: &[u32; 3]) {
        let normal = face_normal(positions, triangle);
        let weight = f64::from(dot(normal, normal).sqrt());
        for (a, b) in [(0, 1), (1, 2), (2, 0)] {
            let (a, b) = (triangle[a] as usize, triangle[b] as usize);
            let edge = sub(positions[b], positions[a]);
            let turn = sub(normals[b], normals[a]);
            let bulge = f64::from(dot(edge, turn)) / 8.0;
            self.sum += weight * bulge * bulge;
        }
        self.area += 3.0 * weight;
    }

    fn rms(&self) -> f64 {
        if self.area > 0.0 { (self.sum / self.area).sqrt() } else { 0.0 }
    }
}

fn normalise(normal: &mut [f32; 3]) {
    let length = dot(*normal, *normal).sqrt();
    *normal = if length > 0.0 { normal.map(|c| c / length) } else { [0.0, 0.0, 1.0] };
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
