//! The descriptors, transcribed equation by equation with no regard for speed or for the implementation.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::f64::consts::{PI, TAU};

use lwc::TriMesh;
use lwc::descriptors::{Descriptor, Window};
use nalgebra::{DMatrix, DVector, Matrix3, Matrix4, SymmetricEigen, Vector3, Vector4};

type V = Vector3<f64>;

struct Oracle {
    faces: Vec<[usize; 3]>,
    neighbours: Vec<BTreeSet<usize>>,
    positions: Vec<V>,
    mean_edge: f64,
    rings: u32,
    r: f64,
    normals: Vec<V>,
}

pub fn mean_edge_length(mesh: &TriMesh) -> f64 {
    let p = positions(mesh);
    let edges: BTreeSet<(usize, usize)> = faces(mesh)
        .into_iter()
        .flat_map(|[a, b, c]| [(a, b), (b, c), (c, a)])
        .map(|(a, b)| (a.min(b), a.max(b)))
        .collect();
    edges.iter().map(|&(a, b)| (p[a] - p[b]).norm()).sum::<f64>() / edges.len().max(1) as f64
}

pub fn evaluate(descriptor: Descriptor, mesh: &TriMesh, window: &Window, mean_edge: f64) -> Vec<f64> {
    let oracle = Oracle::new(mesh, window, mean_edge);
    let vertices = 0..mesh.num_vertices();
    let has_neighbours = |v: &usize| !oracle.neighbours[*v].is_empty();
    let map = |f: &dyn Fn(usize) -> f64| -> Vec<f64> {
        vertices.clone().map(|v| if has_neighbours(&v) { f(v).max(0.0) } else { 0.0 }).collect()
    };
    match descriptor {
        Descriptor::Pca => map(&|v| oracle.pca(v)),
        Descriptor::Nfv => {
            let voted: Vec<V> = vertices.clone().map(|v| oracle.voted_normal(v)).collect();
            map(&|v| oracle.nfv(v, &voted))
        }
        Descriptor::Casorati => map(&|v| oracle.casorati(v)),
        Descriptor::ShapeIndex => map(&|v| oracle.shape_index(v)),
        Descriptor::Harris3d => map(&|v| oracle.harris3d(v)),
        Descriptor::Sqem => map(&|v| oracle.quadric_error(v, &|u, origin| oracle.face_quadric(u, origin))),
        Descriptor::PcaQem => {
            let metrics: Vec<_> = vertices.clone().map(|v| oracle.principal_metric(v)).collect();
            map(&|v| oracle.quadric_error(v, &|u, origin| quadric(metrics[u], oracle.offset(u, origin))))
        }
        _ => unreachable!("a descriptor without an oracle"),
    }
}

/// PCA and PCA-QEM with two more coordinates per vertex, in units of l̄.
pub fn evaluate_augmented(
    descriptor: Descriptor,
    mesh: &TriMesh,
    further: &[[f64; 2]],
    window: &Window,
    mean_edge: f64,
) -> Vec<f64> {
    let oracle = Oracle::new(mesh, window, mean_edge);
    let point = |u: usize, origin: usize| {
        let d = oracle.offset(u, origin);
        DVector::from_vec(vec![d[0], d[1], d[2], further[u][0], further[u][1]])
    };
    let eigen = |v: usize| {
        let members = oracle.window(v);
        let mean = members.iter().map(|&u| point(u, v)).sum::<DVector<f64>>() / members.len() as f64;
        let centred = members.iter().map(|&u| point(u, v) - &mean);
        SymmetricEigen::new(centred.map(|d| &d * d.transpose()).sum::<DMatrix<f64>>())
    };
    let metrics: Vec<DMatrix<f64>> = (0..mesh.num_vertices())
        .map(|v| {
            let eigen = eigen(v);
            let alphas = eigen.eigenvalues.map(|value| 1.0 / (1.0 + value.max(0.0)));
            let scale = DMatrix::from_diagonal(&alphas.component_mul(&alphas));
            &eigen.eigenvectors * scale * eigen.eigenvectors.transpose()
        })
        .collect();
    let quadric = |u: usize, v: usize| {
        let (m, p) = (&metrics[u], point(u, v));
        let b = -(m * &p);
        let mut q = m.clone().insert_row(5, 0.0).insert_column(5, 0.0);
        for i in 0..5 {
            (q[(i, 5)], q[(5, i)]) = (b[i], b[i]);
        }
        q[(5, 5)] = p.dot(&(m * &p));
        q
    };
    let value = |v: usize| match descriptor {
        Descriptor::Pca => {
            let mut values: Vec<f64> = eigen(v).eigenvalues.iter().map(|value| value.max(0.0)).collect();
            values.sort_by(f64::total_cmp);
            (values[0] + values[1] + values[2]) / values.iter().sum::<f64>()
        }
        _ => {
            let members = oracle.window(v);
            let weights: Vec<f64> = members.iter().map(|&u| oracle.weight(u, v)).collect();
            let sum: f64 = weights.iter().sum();
            let mean =
                members.iter().zip(&weights).map(|(&u, &w)| quadric(u, v) * w).sum::<DMatrix<f64>>() / sum;
            let errors = members.iter().zip(&weights).map(|(&u, &w)| {
                let x = point(u, v).insert_row(5, 1.0);
                w * x.dot(&(&mean * &x))
            });
            errors.sum::<f64>() / sum
        }
    };
    (0..mesh.num_vertices()).map(value).collect()
}

fn positions(mesh: &TriMesh) -> Vec<V> {
    mesh.positions().iter().map(|&p| V::from(p)).collect()
}

fn faces(mesh: &TriMesh) -> Vec<[usize; 3]> {
    let faces = mesh.triangles().iter().map(|t| t.map(|v| v as usize));
    faces.filter(|[a, b, c]| a != b && b != c && a != c).collect()
}

/// Ascending eigenpairs.
fn eigen(m: Matrix3<f64>) -> Vec<(f64, V)> {
    let eigen = SymmetricEigen::new(m);
    let mut pairs: Vec<(f64, V)> =
        (0..3).map(|i| (eigen.eigenvalues[i].max(0.0), eigen.eigenvectors.column(i).into_owned())).collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    pairs
}

fn orient(e: V, normal: V) -> V {
    let dot = e.dot(&normal);
    let decides = if dot.abs() > 1e-9 { dot } else { e[e.iamax()] };
    if decides < 0.0 { -e } else { e }
}

/// (x − p)ᵀ M (x − p) as a 4 × 4 matrix.
fn quadric(m: Matrix3<f64>, p: V) -> Matrix4<f64> {
    let b = -m * p;
    let mut q = Matrix4::zeros();
    q.fixed_view_mut::<3, 3>(0, 0).copy_from(&m);
    q.fixed_view_mut::<3, 1>(0, 3).copy_from(&b);
    q.fixed_view_mut::<1, 3>(3, 0).copy_from(&b.transpose());
    q[(3, 3)] = p.dot(&(m * p));
    q
}

impl Oracle {
    fn new(mesh: &TriMesh, window: &Window, mean_edge: f64) -> Self {
        let mut neighbours = vec![BTreeSet::new(); mesh.num_vertices()];
        for [a, b, c] in faces(mesh) {
            for (u, v) in [(a, b), (b, c), (c, a)] {
                neighbours[u].insert(v);
                neighbours[v].insert(u);
            }
        }
        let mut oracle = Self {
            faces: faces(mesh),
            neighbours,
            positions: positions(mesh),
            mean_edge,
            rings: window.rings,
            r: window.radius,
            normals: Vec::new(),
        };
        oracle.normals = (0..mesh.num_vertices()).map(|v| oracle.vertex_normal(v)).collect();
        oracle
    }

    fn offset(&self, u: usize, origin: usize) -> V {
        (self.positions[u] - self.positions[origin]) / self.mean_edge
    }

    fn cross(&self, [a, b, c]: [usize; 3]) -> V {
        self.offset(b, a).cross(&self.offset(c, a))
    }

    fn vertex_normal(&self, v: usize) -> V {
        let crosses: Vec<V> = self.faces.iter().filter(|f| f.contains(&v)).map(|&f| self.cross(f)).collect();
        direction(&crosses)
    }

    /// Equation 1.
    fn window(&self, v: usize) -> Vec<usize> {
        let mut distance = BTreeMap::from([(v, 0)]);
        let mut queue = VecDeque::from([v]);
        while let Some(u) = queue.pop_front() {
            if distance[&u] == self.rings {
                continue;
            }
            for &w in &self.neighbours[u] {
                if !distance.contains_key(&w) {
                    distance.insert(w, distance[&u] + 1);
                    queue.push_back(w);
                }
            }
        }
        let inside = |&u: &usize| self.offset(u, v).norm_squared() <= self.r * self.r * (1.0 + 1e-9);
        distance.into_keys().filter(inside).collect()
    }

    fn weight(&self, u: usize, v: usize) -> f64 {
        (-self.offset(u, v).norm_squared() / (self.r / 3.0).powi(2)).exp()
    }

    /// Equation 3.
    fn covariance(&self, v: usize) -> Matrix3<f64> {
        let window = self.window(v);
        let mean = window.iter().map(|&u| self.offset(u, v)).sum::<V>() / window.len() as f64;
        window
            .iter()
            .map(|&u| self.offset(u, v) - mean)
            .map(|d| d * d.transpose())
            .fold(Matrix3::zeros(), |sum, outer| sum + outer)
    }

    /// Equation 4.
    fn pca(&self, v: usize) -> f64 {
        let eigen = eigen(self.covariance(v));
        let sum: f64 = eigen.iter().map(|pair| pair.0).sum();
        if self.window(v).len() < 3 || sum == 0.0 { 0.0 } else { eigen[0].0 / sum }
    }

    /// Equations 7 and 8.
    fn voted_normal(&self, v: usize) -> V {
        let mut votes = Matrix3::zeros();
        for u in self.window(v) {
            let n = self.normals[u];
            let d = self.offset(u, v);
            let vote = if d.norm() > 0.0 { n - 2.0 * n.dot(&d) / d.norm_squared() * d } else { n };
            if vote.norm() > 0.0 {
                votes += self.weight(u, v) * vote * vote.transpose() / vote.norm_squared();
            }
        }
        if votes == Matrix3::zeros() { V::zeros() } else { orient(eigen(votes)[2].1, self.normals[v]) }
    }

    /// Equation 9.
    fn nfv(&self, v: usize, voted: &[V]) -> f64 {
        if voted[v] == V::zeros() {
            return 0.0;
        }
        let window = self.window(v);
        let s: f64 = window.iter().map(|&u| self.weight(u, v)).sum();
        let variation = |u: usize| 0.5 * (voted[v] - voted[u]).norm_squared();
        window.iter().map(|&u| self.weight(u, v) * variation(u)).sum::<f64>() / s
    }

    /// Equation 10 by a singular value decomposition of the whole system, columns of unit length.
    fn fit(&self, v: usize, z: V) -> Option<[f64; 5]> {
        let usable: Vec<usize> =
            self.window(v).into_iter().filter(|&u| self.normals[u].dot(&z) >= -1e-9 && u != v).collect();
        if usable.len() < 5 {
            return None;
        }
        let x = (if z.x.abs() < 0.5 { V::x() } else { V::y() }).cross(&z).normalize();
        let y = z.cross(&x);
        let mut rows = DMatrix::zeros(usable.len(), 5);
        let mut heights = DVector::zeros(usable.len());
        for (i, &u) in usable.iter().enumerate() {
            let d = self.offset(u, v);
            let (x, y) = (d.dot(&x), d.dot(&y));
            rows.row_mut(i).copy_from_slice(&[x * x, x * y, y * y, x, y]);
            heights[i] = d.dot(&z);
        }
        let lengths: Vec<f64> = rows.column_iter().map(|c| c.norm()).collect();
        if lengths.contains(&0.0) {
            return None;
        }
        for (mut column, length) in rows.column_iter_mut().zip(&lengths) {
            column /= *length;
        }
        let svd = rows.svd(true, true);
        if svd.singular_values.min() <= 1e-8 * svd.singular_values.max() {
            return None;
        }
        let solution = svd.solve(&heights, 0.0).expect("both factors were asked for");
        Some(std::array::from_fn(|i| solution[i] / lengths[i]))
    }

    fn curvatures(&self, v: usize) -> Option<(f64, f64)> {
        let normals: Vec<V> = self.window(v).iter().map(|&u| self.normals[u]).collect();
        let pseudonormal = direction(&normals);
        if pseudonormal == V::zeros() {
            return None;
        }
        let [a, b, c, d, e] = self.fit(v, pseudonormal)?;
        let (e1, f1, g1) = (1.0 + d * d, d * e, 1.0 + e * e);
        let w = (1.0 + d * d + e * e).sqrt();
        let (l, m, n) = (2.0 * a / w, b / w, 2.0 * c / w);
        let k = (l * n - m * m) / (e1 * g1 - f1 * f1);
        let h = (e1 * n - 2.0 * f1 * m + g1 * l) / (2.0 * (e1 * g1 - f1 * f1));
        let root = (h * h - k).max(0.0).sqrt();
        Some((h - root, h + root))
    }

    /// Equation 11.
    fn casorati(&self, v: usize) -> f64 {
        self.curvatures(v).map_or(0.0, |(k1, k2)| ((k1 * k1 + k2 * k2) / 2.0).sqrt())
    }

    /// Equation 12.
    fn shape_index(&self, v: usize) -> f64 {
        match self.curvatures(v) {
            None => 0.0,
            Some((k1, k2)) if k1.abs() < 1e-12 && k2.abs() < 1e-12 => 0.0,
            Some((k1, k2)) if k1 == k2 => 1.0,
            Some((k1, k2)) => 2.0 / PI * ((k2 + k1) / (k2 - k1)).atan().abs(),
        }
    }

    /// Equations 17 to 21.
    fn harris3d(&self, v: usize) -> f64 {
        let axis = orient(eigen(self.covariance(v))[0].1, self.normals[v]);
        let Some([a, b, c, d, e]) = self.fit(v, axis) else { return 0.0 };
        let (factor, r2) = (TAU.sqrt() * self.r, self.r * self.r);
        let aa = factor * (4.0 * a * a * r2 + b * b * r2 + d * d);
        let bb = factor * (b * b * r2 + 4.0 * c * c * r2 + e * e);
        let cc = factor * (2.0 * a * b * r2 + 2.0 * b * c * r2 + d * e);
        2.0 * (aa * bb - cc * cc) / (1e-5 + aa + bb)
    }

    /// Equations 22 to 24, planes through any corner of the face, coordinates centred at `origin`.
    fn face_quadric(&self, u: usize, origin: usize) -> Matrix4<f64> {
        let mut sum = Matrix4::zeros();
        for &face in self.faces.iter().filter(|f| f.contains(&u)) {
            if let Some(n) = self.cross(face).try_normalize(0.0) {
                sum += quadric(n * n.transpose(), self.offset(face[0], origin));
            }
        }
        sum
    }

    /// Equations 27 to 30.
    fn principal_metric(&self, p: usize) -> Matrix3<f64> {
        let outer = |(lambda, e): (f64, V)| e * e.transpose() / (1.0 + lambda).powi(2);
        eigen(self.covariance(p)).into_iter().map(outer).fold(Matrix3::zeros(), |sum, m| sum + m)
    }

    /// Equations 25 and 26.
    fn quadric_error(&self, v: usize, quadric_of: &dyn Fn(usize, usize) -> Matrix4<f64>) -> f64 {
        let window = self.window(v);
        let s: f64 = window.iter().map(|&u| self.weight(u, v)).sum();
        let sum = window.iter().map(|&u| self.weight(u, v) * quadric_of(u, v));
        let q = sum.fold(Matrix4::zeros(), |sum, m| sum + m) / s;
        let value = |u: usize| {
            let d = self.offset(u, v);
            let x = Vector4::new(d.x, d.y, d.z, 1.0);
            x.dot(&(q * x))
        };
        window.iter().map(|&u| self.weight(u, v) * value(u)).sum::<f64>() / s
    }
}

fn direction(terms: &[V]) -> V {
    let sum: V = terms.iter().sum();
    let lengths: f64 = terms.iter().map(|t| t.norm()).sum();
    if sum.norm() <= 1e-12 * lengths { V::zeros() } else { sum.normalize() }
}
