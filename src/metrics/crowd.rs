//! The nearest triangles of many points at once, for where boxes do not help: all triangles are about equally far, or
//! each box holds most of the others.
//!
//! Of a ball of points only the triangles count that are at most its diameter farther from its centre than the nearest
//! one. The points are halved, and each half looks at what is left, so that n triangles and m points of a surface
//! cost about n √m distances.

use crate::mesh::triangle::squared_distance;
use glam::DVec3;
use std::collections::HashSet;

/// A point, and the squared distance that is found.
#[derive(Clone, Copy)]
pub(super) struct Waiting {
    pub point: DVec3,
    /// Whatever the caller wants to know it by.
    pub index: usize,
    pub squared: f64,
}

/// So few points, or triangles, are looked at one by one.
const FEW_POINTS: usize = 2;
const FEW_TRIANGLES: usize = 16;

/// Fewer points are not worth another thread.
const MIN_PARALLEL_POINTS: usize = 1024;

/// Distances may be wrong by this share of them, or of the unit of all coordinates.
const SLACK: f64 = 1e-9;

/// Triangles, each with its plane.
pub(super) struct Crowd<'a> {
    triangles: &'a [[DVec3; 3]],
    planes: Vec<Plane>,
    /// The triangles that differ.
    all: Vec<u32>,
}

/// The points where normal · p = offset; the normal is a unit vector, or zero if there is no plane.
struct Plane {
    normal: DVec3,
    offset: f64,
}

impl Plane {
    fn new([a, b, c]: &[DVec3; 3]) -> Self {
        let cross = (b - a).cross(c - a);
        // The normal of a sliver is noise.
        let is_sliver = cross.length_squared() <= 1e-12 * (b - a).length_squared() * (c - a).length_squared();
        let normal = if is_sliver { DVec3::ZERO } else { cross.normalize_or_zero() };
        Self { normal, offset: normal.dot(*a) }
    }

    fn distance(&self, point: DVec3) -> f64 {
        (self.normal.dot(point) - self.offset).abs()
    }
}

impl<'a> Crowd<'a> {
    pub fn new(triangles: &'a [[DVec3; 3]]) -> Self {
        let mut seen = HashSet::new();
        let all = (0..).zip(triangles).filter(|(_, t)| seen.insert(key(t))).map(|(i, _)| i).collect();
        Self { triangles, planes: triangles.iter().map(Plane::new).collect(), all }
    }

    /// Finds the distances of `points`, whose order changes. What is below `noise`, squared, need not be the least.
    pub fn find(&self, points: &mut [Waiting], noise: f64) {
        self.find_among(points, &self.all, noise);
    }

    fn find_among(&self, points: &mut [Waiting], triangles: &[u32], noise: f64) {
        let Some((low, high)) = bounds(points) else { return };
        let centre = 0.5 * (low + high);
        let radius = points.iter().map(|p| p.point.distance_squared(centre)).fold(0.0, f64::max).sqrt();
        let near = self.near(centre, 2.0 * radius, triangles);
        if points.len() <= FEW_POINTS || near.len() <= FEW_TRIANGLES || radius == 0.0 {
            points.iter_mut().for_each(|p| p.squared = self.least(p.point, &near, noise));
            return;
        }
        let axis = (high - low).max_position();
        let middle = points.len() / 2;
        points.select_nth_unstable_by(middle, |p, q| p.point[axis].total_cmp(&q.point[axis]));
        let is_large = points.len() >= MIN_PARALLEL_POINTS;
        let (left, right) = points.split_at_mut(middle);
        let mut find_left = || self.find_among(left, &near, noise);
        let mut find_right = || self.find_among(right, &near, noise);
        if is_large {
            rayon::join(find_left, find_right);
        } else {
            find_left();
            find_right();
        }
    }

    /// Those of `triangles` that are at most `more` farther from a point than the nearest one.
    fn near(&self, point: DVec3, more: f64, triangles: &[u32]) -> Vec<u32> {
        let mut least = f64::INFINITY;
        let mut near = Vec::new();
        for &i in triangles {
            let bound = (least + more) * (1.0 + SLACK) + SLACK;
            if self.planes[i as usize].distance(point) <= bound {
                let distance = squared_distance(point, &self.triangles[i as usize]).sqrt();
                least = least.min(distance);
                if distance <= bound {
                    near.push((distance, i));
                }
            }
        }
        let bound = (least + more) * (1.0 + SLACK) + SLACK;
        near.into_iter().filter(|&(distance, _)| distance <= bound).map(|(_, i)| i).collect()
    }

    fn least(&self, point: DVec3, triangles: &[u32], noise: f64) -> f64 {
        let mut least = f64::INFINITY;
        for &i in triangles {
            least = least.min(squared_distance(point, &self.triangles[i as usize]));
            if least < noise {
                break;
            }
        }
        least
    }
}

/// The same for triangles with the same corners.
fn key(triangle: &[DVec3; 3]) -> [[u64; 3]; 3] {
    // Adding 0 makes −0 equal to 0.
    let mut key = triangle.map(|p| (p + DVec3::ZERO).to_array().map(f64::to_bits));
    key.sort_unstable();
    key
}

fn bounds(points: &[Waiting]) -> Option<(DVec3, DVec3)> {
    let first = points.first()?.point;
    Some(points.iter().fold((first, first), |(low, high), p| (low.min(p.point), high.max(p.point))))
}

#[cfg(test)]
mod tests {
    use super::super::nearest::tests::points;
    use super::*;

    #[test]
    fn a_crowd_finds_what_brute_force_finds() {
        for count in [1, 2, 40, 1000] {
            let corners = points(3 * count);
            // Some small, some large, some with one corner in common, some degenerate, some all the same.
            let shape = |(k, t): (usize, &[DVec3; 3])| match k % 6 {
                0 => t.map(|p| t[0] + 0.05 * p),
                1 => [t[0], t[0], t[1]],
                2 => [t[0]; 3],
                3 => [DVec3::ONE; 3],
                4 => [DVec3::ZERO, t[1], t[2]],
                _ => *t,
            };
            let triangles: Vec<_> = corners.as_chunks::<3>().0.iter().enumerate().map(shape).collect();
            let asked = points(500).into_iter().map(|p| 3.0 * p - DVec3::ONE).enumerate();
            let mut waiting: Vec<Waiting> =
                asked.map(|(index, point)| Waiting { point, index, squared: 0.0 }).collect();
            waiting.extend_from_within(..10);
            Crowd::new(&triangles).find(&mut waiting, 0.0);
            for Waiting { point, squared, .. } in waiting {
                let expected = triangles.iter().map(|t| squared_distance(point, t));
                assert_eq!(squared, expected.fold(f64::INFINITY, f64::min));
            }
        }
    }
}
