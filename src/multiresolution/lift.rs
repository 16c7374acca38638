//! One level up or down: prediction, frames and update (derived in the module's documentation).

use super::hierarchy::Hierarchy;
use super::options::Prediction;
use super::weights::{closed_ring, open_ring};
use glam::DVec3;
use rayon::prelude::*;

/// Rings and weights of the odd vertices of one level; they stay when positions change.
#[derive(Clone, Debug)]
pub(super) struct Split {
    num_even: usize,
    ends: Vec<u32>,
    /// Closed rings begin with the vertex that was farthest from the mean.
    rings: Vec<u32>,
    is_closed: Vec<bool>,
    weights: Vec<f64>,
    /// u of each ring vertex; empty without update.
    update: Vec<f64>,
}

/// What an odd vertex sees.
#[derive(Clone, Copy)]
struct Ring<'a> {
    vertices: &'a [u32],
    weights: &'a [f64],
    is_closed: bool,
}

impl Split {
    /// The odd vertices of M^{level+1}, whose positions are given.
    pub(super) fn new(hierarchy: &Hierarchy, level: usize, positions: &[DVec3]) -> Self {
        let mut split = Self {
            num_even: hierarchy.num_vertices(level),
            ends: Vec::new(),
            rings: Vec::new(),
            is_closed: Vec::new(),
            weights: Vec::new(),
            update: Vec::new(),
        };
        let (mut places, mut weights) = (Vec::new(), Vec::new());
        hierarchy.rings(level, |vertex, ring, is_closed| {
            places.clear();
            places.extend(ring.iter().map(|&v| positions[v as usize]));
            let place = positions[vertex as usize];
            let mut first = 0;
            if is_closed {
                closed_ring(place, &places, &mut weights);
                let mean: DVec3 = places.iter().zip(&weights).map(|(&p, &w)| p * w).sum();
                let distance = |i: &usize| places[*i].distance_squared(mean);
                first = (0..ring.len()).max_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0);
            } else {
                open_ring(place, &places, &mut weights);
            }
            split.rings.extend_from_slice(&ring[first..]);
            split.rings.extend_from_slice(&ring[..first]);
            split.weights.extend_from_slice(&weights[first..]);
            split.weights.extend_from_slice(&weights[..first]);
            split.ends.push(split.rings.len() as u32);
            split.is_closed.push(is_closed);
        });
        split
    }

    fn num_odd(&self) -> usize {
        self.ends.len()
    }

    fn range(&self, odd: usize) -> std::ops::Range<usize> {
        let begin = if odd == 0 { 0 } else { self.ends[odd - 1] };
        begin as usize..self.ends[odd] as usize
    }

    fn ring(&self, odd: usize) -> Ring<'_> {
        let range = self.range(odd);
        Ring {
            vertices: &self.rings[range.clone()],
            weights: &self.weights[range],
            is_closed: self.is_closed[odd],
        }
    }

    /// Moves the masses of the odd vertices to the even ones, and sets the weights of the update.
    pub(super) fn set_update(&mut self, masses: &mut Vec<f64>) {
        let odd_masses = masses.split_off(self.num_even);
        for (odd, mass) in odd_masses.iter().enumerate() {
            let ring = self.ring(odd);
            ring.vertices.iter().zip(ring.weights).for_each(|(&v, w)| masses[v as usize] += w * mass);
        }
        let mut update = vec![0.0; self.rings.len()];
        for (odd, mass) in odd_masses.iter().enumerate() {
            let range = self.range(odd);
            let at = |v: u32| masses[v as usize];
            let squares: f64 = self.rings[range.clone()].iter().map(|&v| at(v) * at(v)).sum();
            let ring = update[range.clone()].iter_mut().zip(&self.rings[range]);
            ring.for_each(|(u, &v)| *u = if squares > 0.0 { mass * at(v) / squares } else { 0.0 });
        }
        self.update = update;
    }

    /// From M^{k+1} to M^k: takes the odd positions off, updates the even ones, returns the details.
    pub(super) fn analyse(
        &self,
        coarse_triangles: &[[u32; 3]],
        prediction: Prediction,
        positions: &mut Vec<DVec3>,
    ) -> Vec<DVec3> {
        let odd_positions = positions.split_off(self.num_even);
        let mut normals = vertex_normals(coarse_triangles, positions);
        let mut details: Vec<DVec3> = self.predict(prediction, positions, &normals);
        details.iter_mut().zip(&odd_positions).for_each(|(d, &p)| *d = p - *d);
        if !self.update.is_empty() {
            self.move_evens(positions, &details, 1.0);
            normals = vertex_normals(coarse_triangles, positions);
        }
        self.turn(&mut details, positions, &normals, |axes, d| {
            DVec3::from_array(axes.map(|axis| axis.dot(d)))
        });
        details
    }

    /// From M^k to M^{k+1}, the inverse of [`Split::analyse`].
    pub(super) fn synthesise(
        &self,
        coarse_triangles: &[[u32; 3]],
        prediction: Prediction,
        details: &[DVec3],
        positions: &mut Vec<DVec3>,
    ) {
        let mut normals = vertex_normals(coarse_triangles, positions);
        let mut turned = details.to_vec();
        self.turn(&mut turned, positions, &normals, |[x, y, z], d| x * d.x + y * d.y + z * d.z);
        if !self.update.is_empty() {
            self.move_evens(positions, &turned, -1.0);
            normals = vertex_normals(coarse_triangles, positions);
        }
        let predicted = self.predict(prediction, positions, &normals);
        positions.extend(predicted.iter().zip(&turned).map(|(&p, &d)| p + d));
    }

    fn predict(&self, prediction: Prediction, positions: &[DVec3], normals: &[DVec3]) -> Vec<DVec3> {
        let predict = |odd: usize| {
            let ring = self.ring(odd);
            let mean = ring.mean(positions);
            match prediction {
                Prediction::Flat => mean,
                Prediction::Curved => {
                    let lift = |(&v, &w): (&u32, &f64)| {
                        let normal = normals[v as usize];
                        normal * (w * (positions[v as usize] - mean).dot(normal))
                    };
                    mean + 0.5 * ring.vertices.iter().zip(ring.weights).map(lift).sum::<DVec3>()
                }
            }
        };
        (0..self.num_odd()).into_par_iter().map(predict).collect()
    }

    /// Turns each detail between model axes and those of its frame.
    fn turn(
        &self,
        details: &mut [DVec3],
        positions: &[DVec3],
        normals: &[DVec3],
        turn: impl Fn([DVec3; 3], DVec3) -> DVec3 + Sync,
    ) {
        details.par_iter_mut().enumerate().for_each(|(odd, detail)| {
            *detail = turn(self.ring(odd).frame(positions, normals), *detail);
        });
    }

    fn move_evens(&self, positions: &mut [DVec3], details: &[DVec3], sign: f64) {
        for (odd, &detail) in details.iter().enumerate() {
            for i in self.range(odd) {
                positions[self.rings[i] as usize] += detail * (sign * self.update[i]);
            }
        }
    }

    /// The same steps for one number per vertex, with the flat prediction.
    pub(super) fn analyse_scalars(&self, values: &mut Vec<f64>) -> Vec<f64> {
        let mut details = values.split_off(self.num_even);
        for (odd, detail) in details.iter_mut().enumerate() {
            let ring = self.ring(odd);
            let mean: f64 =
                ring.vertices.iter().zip(ring.weights).map(|(&v, w)| values[v as usize] * w).sum();
            *detail -= mean;
        }
        if !self.update.is_empty() {
            for (odd, detail) in details.iter().enumerate() {
                self.range(odd).for_each(|i| values[self.rings[i] as usize] += detail * self.update[i]);
            }
        }
        details
    }
}

impl Ring<'_> {
    fn mean(&self, positions: &[DVec3]) -> DVec3 {
        // Differences first, so that far origins cost no digits.
        let first = positions[self.vertices[0] as usize];
        let offset = |(&v, &w): (&u32, &f64)| (positions[v as usize] - first) * w;
        first + self.vertices.iter().zip(self.weights).map(offset).sum::<DVec3>()
    }

    /// x, y, z: orthonormal, z across the surface. Where normals cancel or an edge stands upright, which
    /// would blow rounding errors up, two edges make it; only without these it has the axes of the model.
    fn frame(&self, positions: &[DVec3], normals: &[DVec3]) -> [DVec3; 3] {
        let place = |v: u32| positions[v as usize];
        let count = self.vertices.len();
        let mean = self.mean(positions);
        let edges = if self.is_closed {
            [place(self.vertices[0]) - mean, place(self.vertices[1]) - mean]
        } else {
            let first = place(self.vertices[0]);
            [place(self.vertices[count - 1]) - first, place(self.vertices[1]) - first]
        };
        let normal = |(&v, &w): (&u32, &f64)| normals[v as usize] * w;
        let sum: DVec3 = self.vertices.iter().zip(self.weights).map(normal).sum();
        if sum.length() > LEAST_NORMAL {
            let z = sum.normalize();
            let x =
                edges.iter().find_map(|&edge| beside(edge, z)).unwrap_or_else(|| z.any_orthonormal_vector());
            return [x, z.cross(x), z];
        }
        match edges[0].try_normalize() {
            Some(x) => {
                let y = beside(edges[1], x).unwrap_or_else(|| x.any_orthonormal_vector());
                [x, y, x.cross(y)]
            }
            None => [DVec3::X, DVec3::Y, DVec3::Z],
        }
    }
}

/// Unit normals that cancel to less than this are no direction.
const LEAST_NORMAL: f64 = 0.05;
/// Nor is the rest of an edge that stands this upright (sine of the angle).
const LEAST_SINE: f64 = 0.02;
/// Nor a sum of area vectors that is this part of their lengths.
const LEAST_AREA: f64 = 1e-3;

/// The direction of `edge` across the unit vector `axis`.
fn beside(edge: DVec3, axis: DVec3) -> Option<DVec3> {
    let flat = edge - axis * axis.dot(edge);
    let is_upright = flat.length_squared() <= LEAST_SINE * LEAST_SINE * edge.length_squared();
    let direction = if is_upright { None } else { flat.try_normalize() }?;
    // Once more, for the digits that the first difference has lost.
    (direction - axis * axis.dot(direction)).try_normalize()
}

/// Normalised sums of the area vectors of the faces at each vertex, zero where they cancel.
pub(super) fn vertex_normals(triangles: &[[u32; 3]], positions: &[DVec3]) -> Vec<DVec3> {
    let mut sums = vec![(DVec3::ZERO, 0.0); positions.len()];
    for t in triangles {
        let [a, b, c] = t.map(|v| positions[v as usize]);
        let area = (b - a).cross(c - a);
        let size = area.length();
        for &v in t {
            let (sum, sizes) = &mut sums[v as usize];
            *sum += area;
            *sizes += size;
        }
    }
    let normal = |&(sum, sizes): &(DVec3, f64)| {
        if sum.length() > LEAST_AREA * sizes { sum.normalize_or_zero() } else { DVec3::ZERO }
    };
    sums.par_iter().map(normal).collect()
}
