//! What surrounds a vertex that is to be predicted: its ring, and the vertices across the ring's
//! edges (`format/SPEC.md`, section 8.1).

use super::vec3::{Vec3, add, cross, norm, scale, sub};

/// Directions in which the ring mean may be corrected; see [`Outlook::features`].
pub(crate) const NUM_FEATURES: usize = 3;

/// The vertex across a ring edge.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Tip {
    /// The edge lies on the boundary.
    None,
    /// The true third vertex of the triangle outside.
    Fine(Vec3),
    /// That vertex is not known yet; this is the one that stood there in the coarse mesh.
    Coarse(Vec3),
}

/// Known positions around an unknown vertex.
#[derive(Default)]
pub(crate) struct Neighbourhood {
    /// Neighbours, counter-clockwise.
    pub(crate) ring: Vec<Vec3>,
    /// Across the ring edges `ring[i]`–`ring[i + 1]`: as many as the ring has vertices if it is
    /// closed, else one fewer.
    pub(crate) tips: Vec<Tip>,
}

/// What a neighbourhood says of the vertex inside.
pub(crate) struct Outlook {
    /// Mean of the ring.
    pub(crate) mean: Vec3,
    /// Corrections of `mean` that a linear predictor may weigh: towards the parallelograms over
    /// true outer vertices, over coarse outer vertices, and towards the mean weighted by inverse
    /// distances (for an open ring: towards the middle of its ends).
    pub(crate) features: [Vec3; NUM_FEATURES],
    /// Area vector of the ring polygon.
    pub(crate) normal: Vec3,
    /// Mean distance of the ring from its mean, at least [`MIN_LENGTH`].
    pub(crate) length: f64,
}

/// Length that stands in for a collapsed ring, in grid steps.
const MIN_LENGTH: f64 = 0.25;

impl Neighbourhood {
    pub(crate) fn clear(&mut self) {
        self.ring.clear();
        self.tips.clear();
    }

    pub(crate) fn is_closed(&self) -> bool {
        self.ring.len() == self.tips.len()
    }

    /// Summarises the neighbourhood. The ring must not be empty.
    pub(crate) fn outlook(&self) -> Outlook {
        let degree = self.ring.len();
        let count = degree as f64;
        let mut sum = [0.0; 3];
        for &p in &self.ring {
            sum = add(sum, p);
        }
        let mean = scale(sum, 1.0 / count);

        let mut total_distance = 0.0;
        let mut by_inverse = ([0.0; 3], 0.0);
        for &p in &self.ring {
            let d = sub(p, mean);
            let distance = norm(d);
            total_distance += distance;
            let weight = 1.0 / (distance + MIN_LENGTH);
            by_inverse = (add(by_inverse.0, scale(d, weight)), by_inverse.1 + weight);
        }
        let length = (total_distance / count).max(MIN_LENGTH);

        let mut normal = [0.0; 3];
        let mut fine = [0.0; 3];
        let mut coarse = [0.0; 3];
        for i in 0..degree {
            let (p, q) = (self.ring[i], self.ring[if i + 1 == degree { 0 } else { i + 1 }]);
            let (dp, dq) = (sub(p, mean), sub(q, mean));
            normal = add(normal, cross(dp, dq));
            if i >= self.tips.len() {
                continue;
            }
            let both = add(dp, dq);
            match self.tips[i] {
                Tip::None => {}
                Tip::Fine(tip) => fine = add(fine, sub(both, sub(tip, mean))),
                Tip::Coarse(tip) => coarse = add(coarse, sub(both, sub(tip, mean))),
            }
        }
        let ends = if self.is_closed() {
            scale(by_inverse.0, 1.0 / by_inverse.1)
        } else {
            scale(add(sub(self.ring[0], mean), sub(self.ring[degree - 1], mean)), 0.5)
        };
        Outlook {
            mean,
            features: [scale(fine, 1.0 / count), scale(coarse, 1.0 / count), ends],
            normal,
            length,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parallelograms_complete_a_lattice() {
        // A hexagonal ring and the six vertices outside its edges: every parallelogram meets the centre.
        let corner = |k: usize| {
            let angle = std::f64::consts::FRAC_PI_3 * k as f64;
            [10.0 * angle.cos() + 5.0, 10.0 * angle.sin() + 7.0, 2.0]
        };
        let ring: Vec<Vec3> = (0..6).map(corner).collect();
        let centre = [5.0, 7.0, 2.0];
        let tips = (0..6).map(|i| Tip::Fine(sub(add(ring[i], ring[(i + 1) % 6]), centre))).collect();
        let outlook = Neighbourhood { ring, tips }.outlook();
        let error = norm(sub(add(outlook.mean, outlook.features[0]), centre));
        assert!(error < 1e-12);
        assert!((outlook.length - 10.0).abs() < 1e-12);
        assert!(outlook.normal[2] > 0.0 && outlook.normal[0].abs() < 1e-9);
    }

    #[test]
    fn one_point_is_enough() {
        let outlook = Neighbourhood { ring: vec![[3.0, 4.0, 5.0]; 4], tips: vec![Tip::None; 4] }.outlook();
        assert_eq!(outlook.mean, [3.0, 4.0, 5.0]);
        assert_eq!(outlook.features, [[0.0; 3]; NUM_FEATURES]);
        assert_eq!(outlook.length, MIN_LENGTH);
    }
}
