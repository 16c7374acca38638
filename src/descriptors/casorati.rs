//! Casorati curvature of a fitted paraboloid (section 4.1, eq. 10–11).

use super::paraboloid::Paraboloid;
use super::surface::{Surface, VectorSum};
use super::window::{LocalWindow, Window, map_windows};

/// D = √((κ1² + κ2²)/2); 0 without a fit.
pub(super) fn evaluate(surface: &Surface, window: &Window, progress: &(dyn Fn(usize) + Sync)) -> Vec<f64> {
    map_windows(surface, window, progress, |local| {
        fit_along_mean_normal(local).map_or(0.0, |paraboloid| {
            let (mean, half_difference) = paraboloid.curvatures();
            // κ1² + κ2² = 2H² + 2(H² − K).
            libm::hypot(mean, half_difference)
        })
    })
}

/// The paraboloid over the plane orthogonal to Σ n̂ of the window, steps 1 to 5 of section 4.1.
pub(super) fn fit_along_mean_normal(local: &LocalWindow) -> Option<Paraboloid> {
    let mut sum = VectorSum::default();
    for &u in local.members() {
        sum.add(local.surface.vertices[u as usize].normal);
    }
    let pseudonormal = sum.direction();
    if pseudonormal == glam::DVec3::ZERO {
        return None;
    }
    Paraboloid::fit(local, pseudonormal)
}
