//! Thresholds for noise, from the data alone.

use super::{Decomposition, Options, Prediction};
use crate::descriptors::Descriptor;
use crate::error::EncodeError;
use crate::mesh::TriMesh;
use glam::DVec3;

/// Median of the absolute values of a Gaussian variable over its standard deviation.
const MEDIAN_OF_GAUSSIAN: f64 = 0.674_489_750_196_082;

/// What was done to one level.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Threshold {
    /// The level, 1 to L.
    pub level: usize,
    /// Standard deviation of the noise in its details, model units.
    pub noise: f64,
    /// Details across the surface that were smaller are 0 now, the others smaller by this much; infinite if
    /// there was nothing but noise. Model units.
    pub threshold: f64,
}

/// `mesh` without the noise that is independent from vertex to vertex, and the thresholds of each run.
///
/// The mean of seven runs of [`Decomposition::denoise`], with the flat prediction and the update, each with
/// the levels that another descriptor makes. The few vertices that a run leaves on its coarse levels keep
/// most of their noise, as the details hold only a sixth of it; but they are other ones each time. (Averaging
/// over shifts of the grid is the same idea: Coifman and Donoho, 1995.) `options.descriptor`,
/// `options.prediction` and `options.update` have no influence.
///
/// # Errors
/// As [`Decomposition::new`].
pub fn denoised(mesh: &TriMesh, options: &Options) -> Result<(TriMesh, Vec<Vec<Threshold>>), EncodeError> {
    denoised_with_progress(mesh, options, &|_| ())
}

/// As [`denoised`], telling `progress` after each level of each run which share of the work is done, 0 to 1.
///
/// # Errors
/// As [`denoised`].
pub fn denoised_with_progress(
    mesh: &TriMesh,
    options: &Options,
    progress: &dyn Fn(f64),
) -> Result<(TriMesh, Vec<Vec<Threshold>>), EncodeError> {
    let runs = Descriptor::ALL.len() as f64;
    let mut sums = vec![DVec3::ZERO; mesh.num_vertices()];
    let mut thresholds = Vec::new();
    for descriptor in Descriptor::ALL {
        let options = Options { descriptor, prediction: Prediction::Flat, update: true, ..*options };
        let before = thresholds.len() as f64;
        let of_run = |done: f64| progress((before + done) / runs);
        let mut decomposition = Decomposition::new_with_progress(mesh, &options, &of_run)?;
        thresholds.push(decomposition.denoise());
        let run = decomposition.reconstruct();
        // Differences, so that far origins cost no digits.
        let moves = run.positions().iter().zip(mesh.positions());
        sums.iter_mut().zip(moves).for_each(|(sum, (&to, &from))| {
            *sum += DVec3::from_array(to) - DVec3::from_array(from);
        });
    }
    let moved = mesh.positions().iter().zip(&sums);
    let positions = moved.map(|(&from, &sum)| (DVec3::from_array(from) + sum / runs).to_array()).collect();
    Ok((TriMesh::from_valid_parts(positions, mesh.triangles().to_vec()), thresholds))
}

impl Decomposition {
    /// Removes noise that is independent from vertex to vertex, and returns the thresholds, finest level
    /// first.
    ///
    /// - Its deviation σ comes from the finest details across the surface: median of their sizes / 0.6745
    ///   (Donoho and Johnstone, 1994), over what a deviation of 1 becomes there.
    /// - What it becomes on each level is found by decomposing noise of deviation 1 with the same rings,
    ///   weights and update.
    /// - Each level is thresholded softly at σ_k² / σ_x, where σ_x² is what its variance has beyond the noise
    ///   (*BayesShrink*; Chang, Yu and Vetterli, 2000).
    ///
    /// Meant for a decomposition with the flat prediction and the update. A rough surface without noise
    /// looks noisy to it.
    pub fn denoise(&mut self) -> Vec<Threshold> {
        let gains = self.noise_gains();
        let Some((&finest_gain, finest)) = gains.last().zip(self.details.last()) else {
            return Vec::new();
        };
        let deviation = median_size(finest) / MEDIAN_OF_GAUSSIAN / finest_gain.max(f64::MIN_POSITIVE);
        let mut thresholds = Vec::new();
        for (k, details) in self.details.iter_mut().enumerate().rev() {
            let noise = deviation * gains[k];
            let variance = details.iter().map(|d| d.z * d.z).sum::<f64>() / details.len().max(1) as f64;
            let signal = (variance - noise * noise).max(0.0).sqrt();
            let threshold = if noise == 0.0 { 0.0 } else { noise * noise / signal };
            details
                .iter_mut()
                .for_each(|d| *d = DVec3::from_array(d.to_array().map(|x| shrunk(x, threshold))));
            let [noise, threshold] = [noise, threshold].map(|length| length / self.unit);
            thresholds.push(Threshold { level: k + 1, noise, threshold });
        }
        thresholds
    }

    /// Root mean square, per level, of the details of noise of deviation 1.
    fn noise_gains(&self) -> Vec<f64> {
        let mut random = Noise(0x9e37_79b9_7f4a_7c15);
        let num_vertices = self.hierarchy.num_vertices(self.num_levels());
        let mut values: Vec<f64> = (0..num_vertices).map(|_| random.next()).collect();
        let mut gains: Vec<f64> = Vec::new();
        for split in self.splits.iter().rev() {
            let details = split.analyse_scalars(&mut values);
            let sum: f64 = details.iter().map(|d| d * d).sum();
            gains.push((sum / details.len().max(1) as f64).sqrt());
        }
        gains.reverse();
        gains
    }
}

/// Soft thresholding.
fn shrunk(x: f64, threshold: f64) -> f64 {
    x.signum() * (x.abs() - threshold).max(0.0)
}

fn median_size(details: &[DVec3]) -> f64 {
    let mut sizes: Vec<f64> = details.iter().map(|d| d.z.abs()).collect();
    let middle = sizes.len() / 2;
    if sizes.is_empty() { 0.0 } else { *sizes.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

/// Numbers of mean 0 and deviation 1, equally spread; only their second moments matter. SplitMix64
/// (Steele, Lea and Flood, 2014).
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        let unit = ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64;
        (2.0 * unit - 1.0) * 3_f64.sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn soft_thresholds_shrink_to_zero() {
        assert_eq!([3.0, -3.0, 0.5, -0.5].map(|x| shrunk(x, 1.0)), [2.0, -2.0, 0.0, -0.0]);
        assert_eq!(shrunk(-7.0, f64::INFINITY), 0.0);
        assert_eq!(shrunk(-7.0, 0.0), -7.0);
    }

    #[test]
    fn noise_has_deviation_one() {
        let mut random = Noise(1);
        let values: Vec<f64> = (0..100_000).map(|_| random.next()).collect();
        let mean = values.iter().sum::<f64>() / 1e5;
        let variance = values.iter().map(|x| x * x).sum::<f64>() / 1e5;
        assert!(mean.abs() < 0.02 && (variance - 1.0).abs() < 0.02, "{mean} {variance}");
    }
}
