//! Evenly spread points on a surface.
//!
//! The area of all triangles, laid end to end in their order, is divided into as many equal parts as there
//! are samples. Sample j lies in the triangle that the middle of part j falls into, so a triangle gets
//! samples in proportion to its area, to within one. Its place inside the triangle is term j of the
//! two-dimensional additive sequence of M. Roberts, *The Unreasonable Effectiveness of Quasirandom
//! Sequences* (2018): u = {j/ρ}, v = {j/ρ²}, with ρ³ = ρ + 1. The unit square is folded along its diagonal
//! onto the triangle.

use glam::DVec3;
use std::ops::Range;

/// 2^64/ρ and 2^64/ρ², rounded: the fractional part is then a product of integers that wraps around.
const STEPS: [u64; 2] = [0xC13F_A9A9_02A6_328F, 0x91E1_0DA5_C79E_7B1D];

/// Samples of a surface, each of which can be computed on its own.
pub(super) struct SurfaceSampler<'a> {
    triangles: &'a [[DVec3; 3]],
    /// Area of the triangles up to and including each one.
    area_up_to: Vec<f64>,
    num_samples: usize,
}

impl<'a> SurfaceSampler<'a> {
    /// `None` if the surface has no area.
    pub fn new(triangles: &'a [[DVec3; 3]], num_samples: usize) -> Option<Self> {
        let mut total = 0.0;
        let area_up_to: Vec<f64> = triangles
            .iter()
            .map(|[a, b, c]| {
                total += (b - a).cross(c - a).length() / 2.0;
                total
            })
            .collect();
        (total > 0.0 && num_samples > 0).then_some(Self { triangles, area_up_to, num_samples })
    }

    pub fn len(&self) -> usize {
        self.num_samples
    }

    /// The samples of a range of indices, each with its triangle.
    pub fn points(&self, range: Range<usize>) -> impl Iterator<Item = (usize, DVec3)> {
        let total = self.area_up_to.last().copied().unwrap_or_default();
        let area_at = move |sample: usize| (sample as f64 + 0.5) / self.num_samples as f64 * total;
        let first_area = area_at(range.start);
        let mut triangle = self.area_up_to.partition_point(|&area| area <= first_area);
        range.map(move |sample| {
            // Triangles without area are stepped over.
            while triangle + 1 < self.triangles.len() && self.area_up_to[triangle] <= area_at(sample) {
                triangle += 1;
            }
            let at = triangle.min(self.triangles.len() - 1);
            let [a, b, c] = self.triangles[at];
            let [u, v] = unit_square_point(sample as u64);
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            (at, a + u * (b - a) + v * (c - a))
        })
    }
}

/// Term `index` of the sequence in [0, 1)².
fn unit_square_point(index: u64) -> [f64; 2] {
    let to_unit = 1.0 / (1_u64 << 53) as f64;
    STEPS.map(|step| (index.wrapping_add(1).wrapping_mul(step) >> 11) as f64 * to_unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_powers_of_the_plastic_number() {
        let [u, v] = STEPS.map(|step| step as f64 / 2.0_f64.powi(64));
        let rho = 1.0 / u;
        assert!((rho.powi(3) - rho - 1.0).abs() < 1e-14);
        assert!((u * u - v).abs() < 1e-15);
    }

    #[test]
    fn samples_follow_area_and_skip_degenerate_triangles() {
        let (x, y) = (DVec3::X, DVec3::Y);
        let triangles = [[x; 3], [DVec3::ZERO, x, y], [x, x, y], [DVec3::ZERO, 3.0 * x, -y], [y; 3]];
        let sampler = SurfaceSampler::new(&triangles, 1000).unwrap();
        let points: Vec<DVec3> = sampler.points(0..1000).map(|(_, p)| p).collect();
        assert!(sampler.points(0..1000).all(|(t, p)| t == if p.y > 0.0 { 1 } else { 3 }));
        assert_eq!(points.iter().filter(|p| p.y > 0.0).count(), 250);
        let is_inside = |p: &DVec3| if p.y > 0.0 { p.x + p.y <= 1.0 } else { p.x / 3.0 - p.y <= 1.0 };
        assert!(points.iter().all(|p| p.z == 0.0 && p.x >= 0.0 && is_inside(p)));
        let pieces: Vec<DVec3> =
            (0..1000).step_by(100).flat_map(|k| sampler.points(k..k + 100)).map(|(_, p)| p).collect();
        assert_eq!(points, pieces);
        assert!(SurfaceSampler::new(&[[x; 3]], 10).is_none());
        assert!(SurfaceSampler::new(&[], 10).is_none());
    }

    #[test]
    fn samples_integrate_smooth_functions() {
        let triangle = [[DVec3::ZERO, DVec3::X, DVec3::Y]];
        let sampler = SurfaceSampler::new(&triangle, 10_000).unwrap();
        let mean = sampler.points(0..10_000).map(|(_, p)| p.x * p.x).sum::<f64>() / 10_000.0;
        // The second moment of a triangle: 2 ∫₀¹ x² (1 − x) dx = 1/6.
        assert!((mean - 1.0 / 6.0).abs() < 1e-4, "{mean}");
    }
}
