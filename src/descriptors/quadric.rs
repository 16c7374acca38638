//! Quadrics averaged over a window, and their mean value over it (section 5, eq. 25–26).

use glam::DVec3;

use super::symmetric::Sym3;
use super::window::LocalWindow;

/// D = (1/S) Σ w (u,1)ᵀ Q_W (u,1) with Q_W = (1/S) Σ w Q_u.
///
/// The quadric of vertex u vanishes there to second order, Q_u(x) = (x − u)ᵀ A_u (x − u), and is given by
/// its `matrices[u]` alone; eq. 24 prints b with the wrong sign. Coordinates are centred at v.
pub(super) fn mean_error(local: &LocalWindow, matrices: &[Sym3]) -> f64 {
    // S·Q_W in block form: a, b, c.
    let (mut a, mut b, mut c) = (Sym3::default(), DVec3::ZERO, 0.0);
    // Σ w, Σ w u and Σ w u uᵀ.
    let (mut weights, mut first, mut second) = (0.0, DVec3::ZERO, Sym3::default());
    for (u, d, weight) in local.weighted() {
        let image = matrices[u].times(d);
        a.add_scaled(&matrices[u], weight);
        b -= image * weight;
        c += weight * image.dot(d);
        weights += weight;
        first += d * weight;
        second.add_outer(d, weight);
    }
    (a.inner(&second) + 2.0 * b.dot(first) + c * weights) / (weights * weights)
}

/// D = (1/S) Σ w (u,1)ᵀ Q_v (u,1) with the quadric of the centre alone.
pub(super) fn own_error(local: &LocalWindow, matrices: &[Sym3]) -> f64 {
    let metric = &matrices[local.members()[0] as usize];
    let (mut sum, mut weights) = (0.0, 0.0);
    for (_, d, weight) in local.weighted() {
        sum += weight * metric.times(d).dot(d);
        weights += weight;
    }
    sum / weights
}
