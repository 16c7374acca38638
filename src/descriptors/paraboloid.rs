//! Least-squares paraboloid over a window (section 4.1, eq. 10) and its curvatures.

use glam::DVec3;
use nalgebra::{DMatrix, Matrix5, Vector5};

use super::window::{LANES, LocalWindow};

/// f(x, y) = ax² + bxy + cy² + dx + ey, the graph over a plane through the centre of the window.
#[derive(Clone, Copy, Debug)]
pub(super) struct Paraboloid {
    pub(super) a: f64,
    pub(super) b: f64,
    pub(super) c: f64,
    pub(super) d: f64,
    pub(super) e: f64,
}

/// Number of coefficients, and of vertices besides the centre that determine them.
const UNKNOWNS: usize = 5;
/// Vertices whose normals point further than this to the other side are outliers.
const OUTLIER: f64 = -1e-9;
/// The system is singular if the ratio of its extreme singular values, columns of unit length, is this small.
const SINGULAR: f64 = 1e-8;
/// Largest square of the condition number that is left to the normal equations: the error they add is about
/// this many rounding errors.
const NORMAL_EQUATIONS_LIMIT: f64 = 1e6;

impl Paraboloid {
    /// Fits the vertices of the window whose normals do not oppose `axis`, in a frame at the centre with z
    /// along `axis`, a unit vector.
    ///
    /// `None` with fewer than five usable vertices besides the centre, or a singular system. Values derived
    /// from the fit must not depend on the directions of x and y in the tangent plane.
    pub(super) fn fit(local: &LocalWindow, axis: DVec3) -> Option<Self> {
        let frame = Frame::new(axis);
        let (moments, usable) = Moments::of_window(local, &frame);
        if usable < UNKNOWNS {
            return None;
        }
        let lengths = moments.squared_lengths().map(f64::sqrt);
        if lengths.contains(&0.0) {
            return None;
        }
        let solution = match moments.solve(&lengths) {
            Some(solution) => solution,
            None => solve_by_qr(local, &frame, &lengths)?,
        };
        let [a, b, c, d, e] = std::array::from_fn(|i| solution[i] / lengths[i]);
        Some(Self { a, b, c, d, e })
    }

    /// Mean curvature H and half the difference of the principal curvatures √(H² − K), at the origin:
    /// κ1,2 = H ∓ the latter.
    pub(super) fn curvatures(&self) -> (f64, f64) {
        let Self { a, b, c, d, e } = *self;
        // First and second fundamental forms.
        let (e1, f1, g1) = (1.0 + d * d, d * e, 1.0 + e * e);
        let w2 = 1.0 + d * d + e * e;
        let w = w2.sqrt();
        let (l, m, n) = (2.0 * a / w, b / w, 2.0 * c / w);
        // The second form in an orthonormal basis of the tangent plane whose first vector is along ∂x.
        // Its deviator gives H² − K = ((s11 − s22)/2)² + s12² without the cancellation of that difference.
        let s11 = l / e1;
        let s12 = (m - f1 / e1 * l) / w;
        let s22 = (n * e1 * e1 - 2.0 * f1 * e1 * m + f1 * f1 * l) / (e1 * w2);
        let mean = (e1 * n - 2.0 * f1 * m + g1 * l) / (2.0 * w2);
        (mean, libm::hypot(0.5 * (s11 - s22), s12))
    }
}

/// Orthonormal, z along the pseudonormal.
struct Frame {
    x: DVec3,
    y: DVec3,
    z: DVec3,
}

impl Frame {
    fn new(axis: DVec3) -> Self {
        let (x, y) = axis.any_orthonormal_pair();
        Self { x, y, z: axis }
    }

    /// Whether vertex `u` takes part in the fit.
    #[inline]
    fn accepts(&self, local: &LocalWindow, u: u32) -> bool {
        local.surface.vertices[u as usize].normal.dot(self.z) >= OUTLIER
    }
}

/// Sums over the window of the products that the normal equations need.
struct Moments {
    x2: f64,
    xy: f64,
    y2: f64,
    x3: f64,
    x2y: f64,
    xy2: f64,
    y3: f64,
    x4: f64,
    x3y: f64,
    x2y2: f64,
    xy3: f64,
    y4: f64,
    x2z: f64,
    xyz: f64,
    y2z: f64,
    xz: f64,
    yz: f64,
}

/// One number of as many members as are looked at together.
type Row = [f64; LANES];

#[inline(always)]
fn product(a: &Row, b: &Row) -> Row {
    std::array::from_fn(|lane| a[lane] * b[lane])
}

impl Moments {
    /// The moments of the usable vertices and their number, the centre (whose row is zero) not counted.
    fn of_window(local: &LocalWindow, frame: &Frame) -> (Self, usize) {
        let [dx, dy, dz] = local.offsets();
        let mut sums = [[0.0; LANES]; 17];
        let mut usable = 0;
        let chunks = dx.chunks_exact(LANES).zip(dy.chunks_exact(LANES)).zip(dz.chunks_exact(LANES));
        for (members, ((dx, dy), dz)) in local.members().chunks(LANES).zip(chunks) {
            let mut keep = [0.0; LANES];
            for (keep, &u) in keep.iter_mut().zip(members) {
                let accepted = frame.accepts(local, u);
                *keep = f64::from(u8::from(accepted));
                usable += usize::from(accepted);
            }
            // Whole rows at a time, which compilers make vectors of.
            let row = |values: &[f64]| -> Row { std::array::from_fn(|lane| values[lane] * keep[lane]) };
            let (dx, dy, dz) = (row(dx), row(dy), row(dz));
            let along = |axis: DVec3| -> Row {
                std::array::from_fn(|lane| dx[lane] * axis.x + dy[lane] * axis.y + dz[lane] * axis.z)
            };
            let (x, y, z) = (along(frame.x), along(frame.y), along(frame.z));
            let (x2, xy, y2) = (product(&x, &x), product(&x, &y), product(&y, &y));
            let terms = [
                x2,
                xy,
                y2, //
                product(&x2, &x),
                product(&x2, &y),
                product(&x, &y2),
                product(&y2, &y), //
                product(&x2, &x2),
                product(&x2, &xy),
                product(&x2, &y2),
                product(&xy, &y2),
                product(&y2, &y2), //
                product(&x2, &z),
                product(&xy, &z),
                product(&y2, &z),
                product(&x, &z),
                product(&y, &z),
            ];
            for (sum, term) in sums.as_flattened_mut().iter_mut().zip(terms.as_flattened()) {
                *sum += term;
            }
        }
        usable -= usize::from(frame.accepts(local, local.members()[0]));
        let [x2, xy, y2, x3, x2y, xy2, y3, x4, x3y, x2y2, xy3, y4, x2z, xyz, y2z, xz, yz] =
            sums.map(|lanes| lanes.iter().sum::<f64>());
        let moments = Self { x2, xy, y2, x3, x2y, xy2, y3, x4, x3y, x2y2, xy3, y4, x2z, xyz, y2z, xz, yz };
        (moments, usable)
    }

    /// Squared lengths of the columns x², xy, y², x, y.
    fn squared_lengths(&self) -> [f64; UNKNOWNS] {
        [self.x4, self.x2y2, self.y4, self.x2, self.y2]
    }

    /// Solves the normal equations with columns of unit length by a Cholesky factorisation, `None` if they
    /// are too badly conditioned to be trusted.
    fn solve(&self, lengths: &[f64; UNKNOWNS]) -> Option<[f64; UNKNOWNS]> {
        let gram = [
            [self.x4, 0.0, 0.0, 0.0, 0.0],
            [self.x3y, self.x2y2, 0.0, 0.0, 0.0],
            [self.x2y2, self.xy3, self.y4, 0.0, 0.0],
            [self.x3, self.x2y, self.xy2, self.x2, 0.0],
            [self.x2y, self.xy2, self.y3, self.xy, self.y2],
        ];
        let right = [self.x2z, self.xyz, self.y2z, self.xz, self.yz];
        let scale = lengths.map(f64::recip);

        // Cholesky: gram = L·Lᵀ; only the reciprocals of the diagonal are kept.
        let mut l = [[0.0; UNKNOWNS]; UNKNOWNS];
        let mut pivot = [0.0; UNKNOWNS];
        for i in 0..UNKNOWNS {
            for j in 0..i {
                let dot: f64 = (0..j).map(|k| l[i][k] * l[j][k]).sum();
                l[i][j] = (gram[i][j] * scale[i] * scale[j] - dot) * pivot[j];
            }
            let left: f64 = 1.0 - (0..i).map(|k| l[i][k] * l[i][k]).sum::<f64>();
            // A pivot is at least the smallest eigenvalue.
            if left.is_nan() || left * NORMAL_EQUATIONS_LIMIT < 1.0 {
                return None;
            }
            pivot[i] = left.sqrt().recip();
        }

        // L⁻¹; the sum of its squares is the trace of the inverse, which bounds the condition.
        let mut inverse = [[0.0; UNKNOWNS]; UNKNOWNS];
        let mut trace_of_inverse = 0.0;
        for i in 0..UNKNOWNS {
            let mut row = [0.0; UNKNOWNS];
            row[i] = pivot[i];
            for (j, entry) in row[..i].iter_mut().enumerate() {
                let dot: f64 = (j..i).map(|k| l[i][k] * inverse[k][j]).sum();
                *entry = -dot * pivot[i];
            }
            trace_of_inverse += row.iter().map(|entry| entry * entry).sum::<f64>();
            inverse[i] = row;
        }
        if trace_of_inverse * UNKNOWNS as f64 > NORMAL_EQUATIONS_LIMIT {
            return None;
        }
        let forward: [f64; UNKNOWNS] =
            std::array::from_fn(|i| (0..=i).map(|j| inverse[i][j] * right[j] * scale[j]).sum());
        Some(std::array::from_fn(|j| (j..UNKNOWNS).map(|i| inverse[i][j] * forward[i]).sum()))
    }
}

/// The careful way: QR of the columns of unit length, then a singular value decomposition of R.
#[cold]
fn solve_by_qr(local: &LocalWindow, frame: &Frame, lengths: &[f64; UNKNOWNS]) -> Option<[f64; UNKNOWNS]> {
    let [dx, dy, dz] = local.offsets();
    let rows: Vec<DVec3> = (local.members().iter().enumerate())
        .filter(|&(_, &u)| frame.accepts(local, u))
        .map(|(i, _)| DVec3::new(dx[i], dy[i], dz[i]))
        .map(|d| DVec3::new(d.dot(frame.x), d.dot(frame.y), d.dot(frame.z)))
        .collect();
    // The heights are the last column, so that R holds the rotated right-hand side too.
    let system = DMatrix::from_fn(rows.len(), UNKNOWNS + 1, |i, j| {
        let DVec3 { x, y, z } = rows[i];
        match j {
            0..UNKNOWNS => [x * x, x * y, y * y, x, y][j] / lengths[j],
            _ => z,
        }
    });
    let r = system.qr().r();
    let triangle: Matrix5<f64> = r.fixed_view::<UNKNOWNS, UNKNOWNS>(0, 0).into_owned();
    let right: Vector5<f64> = r.fixed_view::<UNKNOWNS, 1>(0, UNKNOWNS).into_owned();
    let svd = triangle.try_svd(true, true, f64::EPSILON, 1000)?;
    let singular = svd.singular_values.min() <= SINGULAR * svd.singular_values.max();
    if singular { None } else { svd.solve(&right, 0.0).ok().map(Into::into) }
}
