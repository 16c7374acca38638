//! Symmetric 3 × 3 matrices and their eigenvectors.

use glam::DVec3;

/// A symmetric 3 × 3 matrix.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sym3 {
    pub(crate) xx: f64,
    pub(crate) xy: f64,
    pub(crate) xz: f64,
    pub(crate) yy: f64,
    pub(crate) yz: f64,
    pub(crate) zz: f64,
}

/// Eigenvalues in ascending order, never negative, and the unit eigenvectors that belong to them.
pub(crate) struct Eigen {
    pub(crate) values: [f64; 3],
    pub(crate) vectors: [DVec3; 3],
}

impl Sym3 {
    /// Adds weight·v·vᵀ.
    #[inline]
    pub(crate) fn add_outer(&mut self, v: DVec3, weight: f64) {
        let s = v * weight;
        self.xx += s.x * v.x;
        self.xy += s.x * v.y;
        self.xz += s.x * v.z;
        self.yy += s.y * v.y;
        self.yz += s.y * v.z;
        self.zz += s.z * v.z;
    }

    /// Adds weight·m.
    #[inline]
    pub(crate) fn add_scaled(&mut self, m: &Sym3, weight: f64) {
        self.xx += weight * m.xx;
        self.xy += weight * m.xy;
        self.xz += weight * m.xz;
        self.yy += weight * m.yy;
        self.yz += weight * m.yz;
        self.zz += weight * m.zz;
    }

    #[inline]
    pub(crate) fn times(&self, v: DVec3) -> DVec3 {
        DVec3::new(
            self.xx * v.x + self.xy * v.y + self.xz * v.z,
            self.xy * v.x + self.yy * v.y + self.yz * v.z,
            self.xz * v.x + self.yz * v.y + self.zz * v.z,
        )
    }

    pub(crate) fn trace(&self) -> f64 {
        self.xx + self.yy + self.zz
    }

    /// Sum of the products of the entries, the trace of the product of the matrices.
    pub(crate) fn inner(&self, m: &Sym3) -> f64 {
        let diagonal = self.xx * m.xx + self.yy * m.yy + self.zz * m.zz;
        diagonal + 2.0 * (self.xy * m.xy + self.xz * m.xz + self.yz * m.yz)
    }

    /// All eigenpairs by cyclic Jacobi rotations. Meant for positive semidefinite matrices: what rounding
    /// makes negative becomes 0.
    pub(crate) fn eigen(&self) -> Eigen {
        let mut a = [[self.xx, self.xy, self.xz], [self.xy, self.yy, self.yz], [self.xz, self.yz, self.zz]];
        let mut vectors = [DVec3::X, DVec3::Y, DVec3::Z];
        // Convergence is quadratic: four or five sweeps in practice.
        for _ in 0..32 {
            let mut rotated = false;
            for (p, q, r) in [(0, 1, 2), (0, 2, 1), (1, 2, 0)] {
                let off = a[p][q];
                if off.abs() <= 0.5 * f64::EPSILON * (a[p][p] * a[q][q]).abs().sqrt() {
                    continue;
                }
                rotated = true;
                let theta = (a[q][q] - a[p][p]) / (2.0 * off);
                let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
                let c = 1.0 / (t * t + 1.0).sqrt();
                let s = t * c;
                a[p][p] -= t * off;
                a[q][q] += t * off;
                (a[p][q], a[q][p]) = (0.0, 0.0);
                let (rp, rq) = (a[r][p], a[r][q]);
                a[r][p] = c * rp - s * rq;
                a[r][q] = s * rp + c * rq;
                (a[p][r], a[q][r]) = (a[r][p], a[r][q]);
                let (vp, vq) = (vectors[p], vectors[q]);
                vectors[p] = vp * c - vq * s;
                vectors[q] = vp * s + vq * c;
            }
            if !rotated {
                break;
            }
        }
        let diagonal = [a[0][0], a[1][1], a[2][2]];
        let mut order = [0, 1, 2];
        order.sort_by(|&i, &j| diagonal[i].total_cmp(&diagonal[j]));
        Eigen {
            values: order.map(|i| if diagonal[i] > 0.0 { diagonal[i] } else { 0.0 }),
            vectors: order.map(|i| vectors[i].normalize_or(DVec3::X)),
        }
    }

    /// Unit eigenvector of the smallest eigenvalue of a positive semidefinite matrix.
    ///
    /// Newton's iteration on the characteristic polynomial climbs from 0 to λ0; the eigenvector is then
    /// orthogonal to the rows of C − λ0·I. With the trace scaled to 1 its error is about
    /// 1e-17 / ((λ1 − λ0)(λ2 − λ0))², so a small gap is left to [`Sym3::eigen`].
    pub(crate) fn smallest_eigenvector(&self) -> DVec3 {
        const SMALLEST_GAP: f64 = 2e-3;
        let scale = self.trace().recip();
        let [xx, xy, xz, yy, yz, zz] =
            [self.xx, self.xy, self.xz, self.yy, self.yz, self.zz].map(|entry| entry * scale);
        let (minor_x, minor_y, minor_z) = (yy * zz - yz * yz, xx * zz - xz * xz, xx * yy - xy * xy);
        let minors = minor_x + minor_y + minor_z;
        let determinant = xx * minor_x - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
        let mut lambda = 0.0;
        for _ in 0..16 {
            let value = ((lambda - 1.0) * lambda + minors) * lambda - determinant;
            let slope = (3.0 * lambda - 2.0) * lambda + minors;
            let step = value / slope;
            lambda -= step;
            if step.abs() <= 1e-17 {
                break;
            }
        }
        let rows = [
            DVec3::new(xx - lambda, xy, xz),
            DVec3::new(xy, yy - lambda, yz),
            DVec3::new(xz, yz, zz - lambda),
        ];
        let crosses = [rows[0].cross(rows[1]), rows[1].cross(rows[2]), rows[2].cross(rows[0])];
        let squares = crosses.map(|cross| cross.length_squared());
        let mut best = 0;
        for i in 1..3 {
            if squares[i] > squares[best] {
                best = i;
            }
        }
        if squares[best] > SMALLEST_GAP * SMALLEST_GAP {
            crosses[best] / squares[best].sqrt()
        } else {
            // Also where the above met a zero trace or a NaN.
            self.eigen().vectors[0]
        }
    }
}

/// `axis` or its opposite: on the side of `normal`, or with a positive largest component when that does
/// not decide (ours).
pub(crate) fn oriented(axis: DVec3, normal: DVec3) -> DVec3 {
    const UNDECIDED: f64 = 1e-9;
    let mut sign = axis.dot(normal);
    if sign.abs() <= UNDECIDED {
        sign = axis.x;
        for component in [axis.y, axis.z] {
            if component.abs() > sign.abs() {
                sign = component;
            }
        }
    }
    if sign < 0.0 { -axis } else { axis }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Matrix3;

    /// Matrices with given eigenvalues in many orientations.
    fn matrices(values: [f64; 3]) -> impl Iterator<Item = Sym3> {
        (0..50).map(move |i| {
            let t = i as f64;
            let x = DVec3::new((1.3 * t).sin(), (2.1 * t).cos(), 0.3 + (0.7 * t).sin()).normalize();
            let (y, z) = x.any_orthonormal_pair();
            let mut m = Sym3::default();
            for (value, axis) in values.into_iter().zip([x, y, z]) {
                m.add_outer(axis, value);
            }
            m
        })
    }

    const SPECTRA: [[f64; 3]; 9] = [
        [0.0, 0.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 1.0, 1.0],
        [1.0, 1.0, 1.0],
        [1e-3, 2.0, 2.1],
        [1e-12, 1e-6, 1.0],
        [1.0, 1.0 + 1e-9, 2.0],
        [3e40, 7e40, 8e40],
        [2e-80, 3e-80, 9e-80],
    ];

    #[test]
    fn jacobi_agrees_with_nalgebra() {
        for spectrum in SPECTRA {
            for m in matrices(spectrum) {
                let eigen = m.eigen();
                let dense = Matrix3::new(m.xx, m.xy, m.xz, m.xy, m.yy, m.yz, m.xz, m.yz, m.zz);
                let mut expected: Vec<f64> = dense.symmetric_eigenvalues().iter().copied().collect();
                expected.sort_by(f64::total_cmp);
                // Both are backward stable: a few rounding errors of the largest entry.
                let tolerance = 1e-14 * spectrum[2];
                for (value, expected) in eigen.values.iter().zip(&expected) {
                    assert!((value - expected).abs() <= tolerance, "{spectrum:?}: {value} {expected}");
                }
                for (value, vector) in eigen.values.iter().zip(eigen.vectors) {
                    assert!((vector.length() - 1.0).abs() < 1e-14);
                    assert!((m.times(vector) - vector * *value).length() <= tolerance);
                }
            }
        }
    }

    #[test]
    fn smallest_eigenvector_has_small_residual() {
        for spectrum in SPECTRA {
            for m in matrices(spectrum) {
                let axis = m.smallest_eigenvector();
                let residual = m.times(axis) - axis * spectrum[0];
                assert!((axis.length() - 1.0).abs() < 1e-14);
                assert!(residual.length() <= 1e-11 * spectrum[2], "{spectrum:?}: {residual}");
            }
        }
    }

    #[test]
    fn orientation_without_a_normal_follows_the_largest_component() {
        let axis = DVec3::new(0.6, -0.8, 0.0);
        assert_eq!(oriented(axis, DVec3::ZERO), -axis);
        assert_eq!(oriented(axis, DVec3::X), axis);
        let tie = DVec3::new(-0.5, 0.5, 0.1).normalize();
        assert_eq!(oriented(tie, DVec3::ZERO), -tie);
    }
}
