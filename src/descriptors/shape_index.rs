//! Shape index of a fitted paraboloid (section 4.1, eq. 12).

use std::f64::consts::FRAC_2_PI;

use super::casorati::fit_along_mean_normal;
use super::surface::Surface;
use super::window::{Window, map_windows};

/// Curvatures below this size are those of a plane.
const FLAT: f64 = 1e-12;

/// D = (2/π)·|atan((κ2 + κ1)/(κ2 − κ1))|: 0 for a saddle, ½ for a cylinder, 1 for a sphere. 0 also for a
/// plane and without a fit.
pub(super) fn evaluate(surface: &Surface, window: &Window, progress: &(dyn Fn(usize) + Sync)) -> Vec<f64> {
    map_windows(surface, window, progress, |local| {
        fit_along_mean_normal(local).map_or(0.0, |paraboloid| {
            let (mean, half_difference) = paraboloid.curvatures();
            // The larger of |κ1| and |κ2| is |H| + √(H² − K).
            if mean.abs() + half_difference < FLAT {
                0.0
            } else {
                FRAC_2_PI * libm::atan2(mean.abs(), half_difference)
            }
        })
    })
}
