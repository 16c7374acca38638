//! Harris response of a fitted paraboloid (section 4.2, eq. 17–21).

use std::f64::consts::TAU;

use glam::DVec3;

use super::paraboloid::Paraboloid;
use super::surface::Surface;
use super::symmetric::oriented;
use super::window::{Window, map_windows};

/// The ε of eq. 21.
const EPSILON: f64 = 1e-5;

/// D = 2·det(M) / (ε + tr M); 0 without a fit. The paraboloid stands on the window's principal plane.
pub(super) fn evaluate(surface: &Surface, window: &Window, progress: &(dyn Fn(usize) + Sync)) -> Vec<f64> {
    let r = window.r();
    map_windows(surface, window, progress, |local| {
        let axis = oriented(local.covariance().smallest_eigenvector(), local.normal());
        Paraboloid::fit(local, axis).map_or(0.0, |paraboloid| response(&paraboloid, r))
    })
}

/// Eq. 21 with the integrals of eq. 18–20 in closed form.
///
/// With p = (2ar, br, d) and q = (br, 2cr, e), the gradient's components as functions of u/r, v/r and 1,
/// A = √(2π)·r·p·p, B = √(2π)·r·q·q and C = √(2π)·r·p·q, so that AB − C² = 2πr²·‖p × q‖² without cancellation.
fn response(&Paraboloid { a, b, c, d, e }: &Paraboloid, r: f64) -> f64 {
    let p = DVec3::new(2.0 * a * r, b * r, d);
    let q = DVec3::new(b * r, 2.0 * c * r, e);
    let determinant = TAU * r * r * p.cross(q).length_squared();
    let trace = TAU.sqrt() * r * (p.length_squared() + q.length_squared());
    2.0 * determinant / (EPSILON + trace)
}
