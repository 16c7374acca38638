//! How far a triangulated hole lies from the star that was there.

use super::Star;
use crate::mesh::triangle::Triangle;
use glam::DVec3;

/// Scratch space.
#[derive(Default)]
pub(super) struct Deviation {
    /// The vertex and the middles of its spokes.
    samples: Vec<DVec3>,
    ring: Vec<DVec3>,
    left: Vec<usize>,
    triangles: Vec<Triangle>,
}

impl Deviation {
    pub(super) fn set(&mut self, star: &Star, positions: &[[f64; 3]]) {
        let centre = DVec3::from(positions[star.vertex as usize]);
        self.ring.clear();
        self.ring.extend(star.ring.iter().map(|&v| DVec3::from(positions[v as usize])));
        self.samples.clear();
        self.samples.push(centre);
        self.samples.extend(self.ring.iter().map(|&p| 0.5 * (p + centre)));
    }

    /// Sum of the squared lengths of the spokes: what a deviation is to be held against.
    pub(super) fn extent(&self) -> f64 {
        // Samples are half way along.
        4.0 * self.samples[1..].iter().map(|&p| p.distance_squared(self.samples[0])).sum::<f64>()
    }

    /// Sum of the squared distances of the star's samples, its vertex counting twice, from the
    /// triangles that cutting `ears` makes; or something above `bound` if that is above it.
    pub(super) fn of(&mut self, ears: impl Iterator<Item = usize>, bound: f64) -> f64 {
        self.left.clear();
        self.left.extend(0..self.ring.len());
        self.triangles.clear();
        for ear in ears {
            let count = self.left.len();
            let Some(k) = self.left.iter().position(|&i| i == ear) else { continue };
            let [p, n] = [(k + count - 1) % count, (k + 1) % count].map(|k| self.ring[self.left[k]]);
            self.triangles.push(Triangle::new(&[p, self.ring[ear], n]));
            self.left.remove(k);
        }
        self.of_triangles(bound, |_| 0)
    }

    /// The same of the fan around a ring vertex.
    pub(super) fn of_fan(&mut self, target: usize, bound: f64) -> f64 {
        let ring = &self.ring;
        let apex = ring[target];
        let (before, after) = ring.split_at(target);
        self.triangles.clear();
        let mut rest = after[1..].iter().chain(before);
        let Some(mut p) = rest.next() else { return f64::INFINITY };
        for q in rest {
            self.triangles.push(Triangle::new(&[apex, *p, *q]));
            p = q;
        }
        // A spoke ends between two triangles, the first of which starts one place before.
        let degree = self.ring.len();
        let at_end = |sample: usize| (sample + degree - target + degree - 3) % degree;
        self.of_triangles(bound, at_end)
    }

    /// `likely` says which triangle may be the nearest of a sample: with that one first, most others need no look.
    fn of_triangles(&self, bound: f64, likely: impl Fn(usize) -> usize) -> f64 {
        let mut sum = 0.0;
        for (i, &sample) in self.samples.iter().enumerate() {
            let (before, after) = self.triangles.split_at(likely(i).min(self.triangles.len()));
            let triangles = after.iter().chain(before);
            let nearest = triangles.fold(f64::INFINITY, |nearest, t| t.nearer(sample, nearest));
            sum += if i == 0 { 2.0 * nearest } else { nearest };
            if sum > bound {
                break;
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fan_that_keeps_a_ridge_deviates_less() {
        // A roof: the vertex and two opposite ring vertices lie on the ridge, z = 1.
        let positions =
            [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 1.0], [0.0, -1.0, 0.0]];
        let star = Star { vertex: 0, corners: vec![0; 4], ring: vec![1, 2, 3, 4] };
        let mut deviation = Deviation::default();
        deviation.set(&star, &positions);
        // Cutting off 2 and 4 leaves the diagonal 1–3, the ridge; the other one lies one below it.
        let along = deviation.of([1, 3].into_iter(), f64::INFINITY);
        let over = deviation.of([0, 2].into_iter(), f64::INFINITY);
        assert!(along < 1e-20, "{along}");
        assert!(over > 0.5, "{over}");
        assert!(deviation.of([0, 2].into_iter(), 0.1) > 0.1);
    }
}
