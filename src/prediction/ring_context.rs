//! What surrounds a vertex that is to be predicted: its ring, and the vertices across the ring's
//! edges (`format/SPEC.md`, section 8.1).

use crate::util::simd4::Lanes;

/// Directions in which the ring mean may be corrected; see [`Outlook::features`].
pub(crate) const NUM_FEATURES: usize = 3;

/// Known points around an unknown vertex, relative to an origin close by.
#[derive(Default)]
pub(crate) struct Neighbourhood {
    /// Neighbours, counter-clockwise.
    pub(crate) ring: Vec<Lanes>,
    pub(crate) is_closed: bool,
    /// Over each ring edge whose outer vertex is known: the point that makes a parallelogram with it.
    pub(crate) parallelograms: Vec<Lanes>,
    /// Sum and number of such points over the other ring edges, with the vertex that stood outside
    /// in the coarse mesh.
    pub(crate) coarse: (Lanes, u32),
}

/// What else is known if only a part of the ring is known.
#[derive(Default)]
pub(crate) struct PartOfRing {
    /// Sum of the ring's misses: how far its vertices are from the means of their outlooks.
    pub(crate) misses: Lanes,
    /// The parallelogram over the edge that was known first.
    pub(crate) oldest: Lanes,
    /// Sum of the area vectors of the triangles across the ring edges.
    pub(crate) normal: Lanes,
    /// Length that an edge usually has.
    pub(crate) edge: f32,
}

/// What a neighbourhood says about the vertex inside.
#[derive(Clone, Copy)]
pub(crate) struct Outlook {
    /// Mean of the ring.
    pub(crate) mean: Lanes,
    /// Corrections of `mean` that a linear predictor may weigh: towards the parallelograms over
    /// true outer vertices, over coarse outer vertices, and towards the mean weighted by inverse
    /// distances (for an open ring: towards the middle of its ends).
    pub(crate) features: [Lanes; NUM_FEATURES],
    /// Area vector of the ring polygon.
    pub(crate) normal: Lanes,
    /// Mean distance of the ring from its mean, at least [`MIN_LENGTH`].
    pub(crate) length: f32,
}

/// Length that stands in for a collapsed ring, in grid steps.
const MIN_LENGTH: f32 = 0.25;

impl Neighbourhood {
    pub(crate) fn clear(&mut self) {
        self.ring.clear();
        self.parallelograms.clear();
        self.coarse = (Lanes::ZERO, 0);
    }

    /// Summarises the neighbourhood. The ring must not be empty.
    #[inline]
    pub(crate) fn outlook(&self) -> Outlook {
        let degree = self.ring.len();
        let share = 1.0 / degree as f32;
        let mut sum = Lanes::ZERO;
        for &p in &self.ring {
            sum += p;
        }
        let mean = sum * share;

        let mut total_distance = 0.0;
        let mut by_inverse = (Lanes::ZERO, 0.0);
        let mut normal = Lanes::ZERO;
        let mut before = self.ring[degree - 1] - mean;
        for &p in &self.ring {
            let d = p - mean;
            let distance = d.dot3(d).sqrt();
            total_distance += distance;
            let weight = 1.0 / (distance + MIN_LENGTH);
            by_inverse = (by_inverse.0 + d * weight, by_inverse.1 + weight);
            normal += before.cross(d);
            before = d;
        }

        let mut fine = Lanes::ZERO;
        for &p in &self.parallelograms {
            fine += p - mean;
        }
        let coarse = self.coarse.0 - mean * self.coarse.1 as f32;
        let ends = if self.is_closed {
            by_inverse.0 * (1.0 / by_inverse.1)
        } else {
            (self.ring[0] + self.ring[degree - 1]) * 0.5 - mean
        };
        Outlook {
            mean,
            features: [fine * share, coarse * share, ends],
            normal,
            length: (total_distance * share).max(MIN_LENGTH),
        }
    }

    /// The same of that part of the ring which is known. Here the mean is that of the parallelograms, if there are any, and
    /// corrections go along the misses of the ring, half way towards its mean, and towards the oldest parallelogram.
    pub(crate) fn outlook_of_part(&self, part: &PartOfRing) -> Outlook {
        let share = 1.0 / self.ring.len() as f32;
        let mut sum = Lanes::ZERO;
        for &p in &self.ring {
            sum += p;
        }
        let ring_mean = sum * share;
        let mut total_distance = 0.0;
        let mut polygon = Lanes::ZERO;
        let mut before = self.ring[self.ring.len() - 1] - ring_mean;
        for &p in &self.ring {
            let d = p - ring_mean;
            total_distance += d.dot3(d).sqrt();
            polygon += before.cross(d);
            before = d;
        }
        let length = if self.ring.len() > 1 { total_distance * share } else { part.edge * 0.5 };

        let mut mean = ring_mean;
        let mut features = [part.misses * share, Lanes::ZERO, Lanes::ZERO];
        if !self.parallelograms.is_empty() {
            let mut sum = Lanes::ZERO;
            for &p in &self.parallelograms {
                sum += p;
            }
            mean = sum * (1.0 / self.parallelograms.len() as f32);
            features[1] = (ring_mean - mean) * 0.5;
            features[2] = part.oldest - mean;
        }
        let is_flat = part.normal.dot3(part.normal) == 0.0;
        Outlook {
            mean,
            features,
            normal: if is_flat { polygon } else { part.normal },
            length: length.max(MIN_LENGTH),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parallelograms_complete_a_lattice() {
        // A hexagonal ring; every parallelogram over its edges meets the centre.
        let corner = |k: usize| {
            let angle = std::f32::consts::FRAC_PI_3 * k as f32;
            Lanes([10.0 * angle.cos() + 5.0, 10.0 * angle.sin() + 7.0, 2.0, 0.0])
        };
        let centre = Lanes([5.0, 7.0, 2.0, 0.0]);
        let neighbourhood = Neighbourhood {
            ring: (0..6).map(corner).collect(),
            is_closed: true,
            parallelograms: vec![centre; 6],
            ..Default::default()
        };
        let outlook = neighbourhood.outlook();
        let error = outlook.mean + outlook.features[0] - centre;
        assert!(error.dot3(error) < 1e-9);
        assert!((outlook.length - 10.0).abs() < 1e-5);
        assert!(outlook.normal.0[2] > 0.0 && outlook.normal.0[0].abs() < 1e-4);
    }

    #[test]
    fn one_point_is_enough() {
        let ring = vec![Lanes([3.0, 4.0, 5.0, 0.0]); 4];
        let outlook = Neighbourhood { ring: ring.clone(), is_closed: true, ..Default::default() }.outlook();
        assert_eq!(outlook.mean, ring[0]);
        assert_eq!(outlook.features, [Lanes::ZERO; NUM_FEATURES]);
        assert_eq!(outlook.length, MIN_LENGTH);
    }
}
