//! Surface variation (section 3.1, eq. 3–4).

use super::surface::Surface;
use super::window::{LocalWindow, Window, map_windows};

/// D = λ0 / (λ0 + λ1 + λ2) of the window's covariance; 0 with fewer than three vertices or a zero sum.
pub(super) fn evaluate(surface: &Surface, window: &Window, progress: &(dyn Fn(usize) + Sync)) -> Vec<f64> {
    map_windows(surface, window, progress, |local| variation(local))
}

fn variation(local: &LocalWindow) -> f64 {
    if local.len() < 3 {
        return 0.0;
    }
    let values = local.covariance().eigen().values;
    let sum: f64 = values.iter().sum();
    if sum > 0.0 { values[0] / sum } else { 0.0 }
}
