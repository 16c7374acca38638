//! PCA and PCA-QEM of vertices with attributes, in d dimensions (section 5.2).
//!
//! The window is that of the positions (eq. 1), and so are its weights; the vectors of eq. 3 and 27–33 are
//! followed by the attributes.

use nalgebra::{DMatrix, DVector};

use super::features::Features;
use super::surface::Surface;
use super::window::{LocalWindow, Window, map_windows};

/// Share of the variation outside the two strongest directions, which those of a surface are. In three
/// dimensions this is eq. 4 (ours: the paper names no other).
pub(super) fn variation(
    surface: &Surface,
    features: &Features,
    window: &Window,
    progress: &(dyn Fn(usize) + Sync),
) -> Vec<f64> {
    map_windows(surface, window, progress, |local| {
        if local.len() < 3 {
            return 0.0;
        }
        let Some(eigen) = covariance(local, features).try_symmetric_eigen(f64::EPSILON, 1000) else {
            return 0.0;
        };
        let mut values: Vec<f64> = eigen.eigenvalues.iter().map(|value| value.max(0.0)).collect();
        values.sort_by(f64::total_cmp);
        let sum: f64 = values.iter().sum();
        if sum > 0.0 { values[..values.len() - 2].iter().sum::<f64>() / sum } else { 0.0 }
    })
}

/// Eq. 25–26 with Q^PCA of d dimensions.
pub(super) fn pca_qem(
    surface: &Surface,
    features: &Features,
    window: &Window,
    progress: &(dyn Fn(usize) + Sync),
) -> Vec<f64> {
    let metrics = map_windows(surface, window, &|done| progress(done / 2), |local| {
        Some(principal_metric(covariance(local, features)))
    });
    map_windows(surface, window, &|done| progress(done - done / 2), |local| {
        mean_error(local, features, &metrics)
    })
}

/// (u − v) / l̄ and the differences of the attributes.
fn offset(local: &LocalWindow, features: &Features, member: usize) -> DVector<f64> {
    let members = local.members();
    let position = local.offsets().map(|axis| axis[member]);
    let [there, here] = [members[member], members[0]].map(|v| features.row(local.surface.mesh_vertex(v)));
    let further = there.iter().zip(here).map(|(u, v)| u - v);
    DVector::from_iterator(3 + here.len(), position.into_iter().chain(further))
}

/// Σ (u − ū)(u − ū)ᵀ (eq. 3).
fn covariance(local: &LocalWindow, features: &Features) -> DMatrix<f64> {
    let size = 3 + features.num_components();
    let (mut sum, mut squares) = (DVector::zeros(size), DMatrix::zeros(size, size));
    for member in 0..local.len() {
        let d = offset(local, features, member);
        squares.ger(1.0, &d, &d, 1.0);
        sum += d;
    }
    squares.ger(-1.0 / local.len() as f64, &sum, &sum, 1.0);
    squares
}

/// M = Σ α_j² e_j e_jᵀ with α_j = 1 / (1 + λ_j) (eq. 27–32); 0 where there are no eigenvectors.
fn principal_metric(covariance: DMatrix<f64>) -> DMatrix<f64> {
    let size = covariance.nrows();
    let mut metric = DMatrix::zeros(size, size);
    if let Some(eigen) = covariance.try_symmetric_eigen(f64::EPSILON, 1000) {
        for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
            let alpha = (1.0 + value.max(0.0)).recip();
            metric.ger(alpha * alpha, &vector, &vector, 1.0);
        }
    }
    metric
}

/// As [`super::quadric::mean_error`].
fn mean_error(local: &LocalWindow, features: &Features, metrics: &[Option<DMatrix<f64>>]) -> f64 {
    let size = 3 + features.num_components();
    let (mut a, mut b, mut c) = (DMatrix::zeros(size, size), DVector::<f64>::zeros(size), 0.0);
    let (mut weights, mut first, mut second) =
        (0.0, DVector::<f64>::zeros(size), DMatrix::<f64>::zeros(size, size));
    for (member, (u, _, weight)) in local.weighted().enumerate() {
        let Some(metric) = &metrics[u] else { continue };
        let d = offset(local, features, member);
        let image = metric * &d;
        a += metric * weight;
        b.axpy(-weight, &image, 1.0);
        c += weight * image.dot(&d);
        weights += weight;
        first.axpy(weight, &d, 1.0);
        second.ger(weight, &d, &d, 1.0);
    }
    (a.dot(&second) + 2.0 * b.dot(&first) + c * weights) / (weights * weights)
}
