//! Normal field variation with normal voting (section 3.2, eq. 7–9).

use glam::DVec3;

use super::surface::Surface;
use super::symmetric::{Sym3, oriented};
use super::window::{LocalWindow, Window, map_windows};

/// Two passes: the voted normal n̄ of every vertex, then its variation over the windows.
pub(super) fn evaluate(surface: &Surface, window: &Window, progress: &(dyn Fn(usize) + Sync)) -> Vec<f64> {
    let voted = map_windows(surface, window, &|done| progress(done / 2), |local| voted_normal(local));
    map_windows(surface, window, &|done| progress(done - done / 2), |local| variation(local, &voted))
}

/// n̄, the dominant eigenvector of C_normal = Σ w ñ ñᵀ / ‖ñ‖² (eq. 8) on the side of n̂; 0 without votes.
///
/// The vote of u is ñ = n̂ − 2 (n̂·d) d with d the unit vector from v to u (eq. 7), or n̂ at the place of v.
fn voted_normal(local: &LocalWindow) -> DVec3 {
    let mut votes = Sym3::default();
    for (u, d, weight) in local.weighted() {
        let normal = local.surface.vertices[u].normal;
        let square = d.length_squared();
        let vote = if square > 0.0 { normal - d * (2.0 * normal.dot(d) / square) } else { normal };
        let length = vote.length_squared();
        if length > 0.0 {
            votes.add_outer(vote, weight / length);
        }
    }
    if votes.trace() > 0.0 { oriented(votes.eigen().vectors[2], local.normal()) } else { DVec3::ZERO }
}

/// D = (1/S) Σ w (1 − n̄(v)·n̄(u)) (eq. 9), as ½‖n̄(v) − n̄(u)‖²: the same for unit vectors, and flat parts
/// are not ordered by rounding errors.
fn variation(local: &LocalWindow, voted: &[DVec3]) -> f64 {
    let centre = voted[local.members()[0] as usize];
    if centre == DVec3::ZERO {
        return 0.0;
    }
    let (mut sum, mut weights) = (0.0, 0.0);
    for (u, _, weight) in local.weighted() {
        sum += weight * 0.5 * centre.distance_squared(voted[u]);
        weights += weight;
    }
    sum / weights
}
