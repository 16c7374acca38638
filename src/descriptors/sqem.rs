//! Smoothed quadric error metric (section 5.1, eq. 22–26).

use super::quadric::mean_error;
use super::surface::Surface;
use super::symmetric::Sym3;
use super::window::{Window, map_windows};

/// Eq. 25–26 with Q_u the sum of the plane quadrics of the faces at u.
pub(super) fn evaluate(surface: &Surface, window: &Window, progress: &(dyn Fn(usize) + Sync)) -> Vec<f64> {
    let matrices = face_matrices(surface);
    map_windows(surface, window, progress, |local| mean_error(local, &matrices))
}

/// Σ n nᵀ over the faces at each vertex, unit normals, no area weight. The planes contain the vertex, so this
/// is all of its quadric in coordinates centred there.
fn face_matrices(surface: &Surface) -> Vec<Sym3> {
    let mut matrices = vec![Sym3::default(); surface.num_vertices()];
    for (face, cross) in surface.faces() {
        let Some(normal) = cross.try_normalize() else { continue };
        for &v in face {
            matrices[v as usize].add_outer(normal, 1.0);
        }
    }
    matrices
}
