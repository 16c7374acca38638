//! The nearest triangles of many points at once, for where boxes do not help: all triangles are about equally far, or
//! each box holds most of the others.
//!
//! For a ball of points, only the triangles count that are at most its diameter farther from its centre than
//! the nearest one. The points are halved, and each half looks at what is left, so that n triangles and m
//! points of a surface cost about n √m looks. Most looks are at two planes: a triangle lies in its own, and
//! beyond the one through its point nearest to any place and across the way there.

use super::bounds::bounds;
use crate::mesh::triangle::{nearest_point, squared_distance};
use glam::DVec3;

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

/// After this many halvings triangles may be looked at again.
const RENEWED: usize = 4;

/// Fewer points are not worth another thread.
const MIN_PARALLEL_POINTS: usize = 1024;

/// Distances may be wrong by this share of them, or of the unit of all coordinates.
const SLACK: f64 = 1e-9;

/// The triangles.
pub(super) struct Crowd<'a> {
    triangles: &'a [[DVec3; 3]],
}

/// A triangle, with what shows cheaply that it is far.
#[derive(Clone, Copy)]
struct Candidate {
    triangle: u32,
    plane: HalfSpace,
    /// The half-space beyond the point that was nearest to some place.
    support: HalfSpace,
}

/// Triangles as seen from the middle of a ball of points, some halvings ago.
struct Seen {
    candidates: Vec<Candidate>,
    depth: usize,
}

/// The points where normal · p ≤ offset; the normal is a unit vector, or zero if that is everywhere.
#[derive(Clone, Copy)]
struct HalfSpace {
    normal: DVec3,
    offset: f64,
}

impl HalfSpace {
    /// Bounded by the plane of a triangle.
    fn of([a, b, c]: &[DVec3; 3]) -> Self {
        let cross = (b - a).cross(c - a);
        // The normal of a sliver is noise.
        let is_sliver = cross.length_squared() <= 1e-12 * (b - a).length_squared() * (c - a).length_squared();
        let normal = if is_sliver { DVec3::ZERO } else { cross.normalize_or_zero() };
        Self { normal, offset: normal.dot(*a) }
    }

    /// The smallest that holds a triangle and ends across the way from it to a place.
    fn facing(place: DVec3, triangle: &[DVec3; 3]) -> Self {
        let normal = (place - nearest_point(place, triangle)).normalize_or_zero();
        Self { normal, offset: triangle.iter().map(|&p| normal.dot(p)).fold(f64::NEG_INFINITY, f64::max) }
    }

    /// How far outside a point is; negative within.
    fn height(&self, point: DVec3) -> f64 {
        self.normal.dot(point) - self.offset
    }
}

/// How far the points of a ball are from one place on the surface: the farther, the more they lie on the other side.
struct Reach {
    /// From the place to the middle.
    away: DVec3,
    radius: f64,
    /// The distance of the middle, with what the sphere around the place bends within the ball.
    most: f64,
}

impl Reach {
    fn new(centre: DVec3, radius: f64, place: DVec3) -> Self {
        let away = centre - place;
        let distance = away.length();
        Self { away: away.normalize_or_zero(), radius, most: distance + 0.5 * radius * radius / distance }
    }

    /// Whether a point of the ball may be as near to what a half-space holds as to the place: heights and distances are nearly
    /// linear, and only differ as their directions do.
    fn may_hold(&self, space: &HalfSpace, centre: DVec3) -> bool {
        let turn = (self.away - space.normal).length();
        space.height(centre) <= slackened(self.most + self.radius * turn) || !self.most.is_finite()
    }
}

impl Candidate {
    /// The distance of a point is at least this.
    fn least_distance(&self, point: DVec3) -> f64 {
        self.support.height(point).max(self.plane.height(point).abs())
    }
}

/// A distance, made larger by what rounding may have taken.
fn slackened(distance: f64) -> f64 {
    distance * (1.0 + SLACK) + SLACK
}

impl<'a> Crowd<'a> {
    pub fn new(triangles: &'a [[DVec3; 3]]) -> Self {
        Self { triangles }
    }

    /// Finds the distances of `points`, whose order changes. What is below `noise`, squared, need not be the least.
    pub fn find(&self, points: &mut [Waiting], noise: f64) {
        let nowhere = HalfSpace { normal: DVec3::ZERO, offset: 0.0 };
        let candidate =
            |(triangle, corners)| Candidate { triangle, plane: HalfSpace::of(corners), support: nowhere };
        let seen = Seen { candidates: (0..).zip(self.triangles).map(candidate).collect(), depth: 0 };
        let all: Vec<u32> = (0..self.triangles.len() as u32).collect();
        self.find_among(points, &seen, &all, RENEWED, noise);
    }

    /// `near`: those of the candidates that count.
    fn find_among(&self, points: &mut [Waiting], seen: &Seen, near: &[u32], depth: usize, noise: f64) {
        let (low, high) = bounds(points.iter().map(|p| p.point));
        let centre = 0.5 * (low + high);
        let radius = points.iter().map(|p| p.point.distance_squared(centre)).fold(0.0, f64::max).sqrt();
        let near = self.near(centre, radius, seen, near);
        if points.len() <= FEW_POINTS || near.len() <= FEW_TRIANGLES || radius == 0.0 {
            points.iter_mut().for_each(|p| p.squared = self.least(p.point, seen, &near, noise));
        } else if depth >= seen.depth + RENEWED {
            let (seen, near) = self.see_from(centre, radius, depth, seen, &near);
            self.halve(points, (low, high), |points| self.find_among(points, &seen, &near, depth + 1, noise));
        } else {
            self.halve(points, (low, high), |points| self.find_among(points, seen, &near, depth + 1, noise));
        }
    }

    /// Does the same with each half of some points, whose order changes.
    fn halve(
        &self,
        points: &mut [Waiting],
        (low, high): (DVec3, DVec3),
        find: impl Fn(&mut [Waiting]) + Sync,
    ) {
        let axis = (high - low).max_position();
        let middle = points.len() / 2;
        points.select_nth_unstable_by(middle, |p, q| p.point[axis].total_cmp(&q.point[axis]));
        let is_large = points.len() >= MIN_PARALLEL_POINTS;
        let (left, right) = points.split_at_mut(middle);
        if is_large {
            rayon::join(|| find(left), || find(right));
        } else {
            find(left);
            find(right);
        }
    }

    fn squared_distance(&self, point: DVec3, candidate: &Candidate) -> f64 {
        squared_distance(point, &self.triangles[candidate.triangle as usize])
    }

    /// Those that may be nearest to a point of a ball.
    fn near(&self, centre: DVec3, radius: f64, seen: &Seen, among: &[u32]) -> Vec<u32> {
        let mut least = f64::INFINITY;
        let mut nearest = 0;
        let mut near = Vec::with_capacity(among.len());
        for &i in among {
            let candidate = &seen.candidates[i as usize];
            let at_least = candidate.least_distance(centre);
            if at_least < least {
                let distance = self.squared_distance(centre, candidate).sqrt();
                (least, nearest) =
                    if distance < least { (distance, candidate.triangle) } else { (least, nearest) };
            }
            if at_least <= slackened(least + 2.0 * radius) {
                near.push((at_least, i));
            }
        }
        let reach = Reach::new(centre, radius, nearest_point(centre, &self.triangles[nearest as usize]));
        let bound = slackened(least + 2.0 * radius);
        let may_be_nearest = |&(at_least, i): &(f64, u32)| {
            at_least <= bound && reach.may_hold(&seen.candidates[i as usize].support, centre)
        };
        near.into_iter().filter(may_be_nearest).map(|(_, i)| i).collect()
    }

    /// The candidates again, with the half-spaces that show best what is far from points in a ball.
    fn see_from(
        &self,
        centre: DVec3,
        radius: f64,
        depth: usize,
        seen: &Seen,
        among: &[u32],
    ) -> (Seen, Vec<u32>) {
        let facing = |&i: &u32| {
            let candidate = seen.candidates[i as usize];
            let support = HalfSpace::facing(centre, &self.triangles[candidate.triangle as usize]);
            Candidate { support, ..candidate }
        };
        let seen = Seen { candidates: among.iter().map(facing).collect(), depth };
        let all: Vec<u32> = (0..seen.candidates.len() as u32).collect();
        let near = self.near(centre, radius, &seen, &all);
        (seen, near)
    }

    fn least(&self, point: DVec3, seen: &Seen, among: &[u32], noise: f64) -> f64 {
        let mut least = f64::INFINITY;
        for &i in among {
            let candidate = &seen.candidates[i as usize];
            let at_least = candidate.least_distance(point) * (1.0 - SLACK) - SLACK;
            if at_least < 0.0 || at_least * at_least < least {
                least = least.min(self.squared_distance(point, candidate));
                if least < noise {
                    break;
                }
            }
        }
        least
    }
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
