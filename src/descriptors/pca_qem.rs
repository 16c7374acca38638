//! Quadric error metric from principal components (section 5.2, eq. 27–33).

use super::quadric::{mean_error, own_error};
use super::readings::PcaQuadric;
use super::surface::Surface;
use super::symmetric::{Eigen, Sym3};
use super::window::{LocalWindow, Window, map_windows};

/// Eq. 25–26 with Q^PCA in place of Q (ours). Positive even on a plane.
pub(super) fn evaluate(
    surface: &Surface,
    window: &Window,
    quadric: PcaQuadric,
    progress: &(dyn Fn(usize) + Sync),
) -> Vec<f64> {
    let matrices = map_windows(surface, window, &|done| progress(done / 2), |local| principal_metric(local));
    let error = match quadric {
        PcaQuadric::Window => mean_error,
        PcaQuadric::Vertex => own_error,
    };
    map_windows(surface, window, &|done| progress(done - done / 2), |local| error(local, &matrices))
}

/// M = Σ α_j² e_j e_jᵀ with α_j = 1 / (1 + λ_j), eigenpairs of the window's covariance (eq. 27–30).
fn principal_metric(local: &LocalWindow) -> Sym3 {
    let Eigen { values, vectors } = local.covariance().eigen();
    let mut metric = Sym3::default();
    for (value, vector) in values.into_iter().zip(vectors) {
        let alpha = (1.0 + value).recip();
        metric.add_outer(vector, alpha * alpha);
    }
    metric
}
