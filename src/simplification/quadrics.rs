//! What a surface remembers about removed vertices: plane quadrics of the original faces, handed
//! on from each removed vertex to a neighbour (Garland and Heckbert; section 5.1 of the paper names
//! the property). So errors are measured against M^L, not against the level before.

use super::{Rings, Star};
use crate::mesh::Surface;
use crate::mesh::surface::{NO_CORNER, next, prev};
use glam::DVec3;
use rayon::prelude::*;

/// Squared distance from a set of planes, weighed by area, as a function of the way `d` from the
/// vertex it belongs to: dᵀ A d + 2 bᵀ d + c. A is symmetric: its columns down to the diagonal.
#[derive(Clone, Copy, Default)]
struct Quadric {
    a: [f64; 6],
    b: DVec3,
    c: f64,
}

impl Quadric {
    const ZERO: Self = Self { a: [0.0; 6], b: DVec3::ZERO, c: 0.0 };

    /// Of the plane through the vertex itself.
    fn plane(normal: DVec3, weight: f64) -> Self {
        let (n, w) = (normal, normal * weight);
        Self { a: [n.x * w.x, n.x * w.y, n.y * w.y, n.x * w.z, n.y * w.z, n.z * w.z], ..Self::ZERO }
    }

    /// A d.
    fn times(&self, d: DVec3) -> DVec3 {
        let [xx, xy, yy, xz, yz, zz] = self.a;
        DVec3::new(xx, xy, xz) * d.x + DVec3::new(xy, yy, yz) * d.y + DVec3::new(xz, yz, zz) * d.z
    }

    fn at(&self, d: DVec3) -> f64 {
        (d.dot(self.times(d)) + 2.0 * self.b.dot(d) + self.c).max(0.0)
    }

    /// The same function, counted from the place `d` away.
    fn moved(&self, d: DVec3) -> Self {
        Self { a: self.a, b: self.b + self.times(d), c: self.at(d) }
    }

    fn add(&mut self, other: &Self) {
        self.a.iter_mut().zip(other.a).for_each(|(a, other)| *a += other);
        self.b += other.b;
        self.c += other.c;
    }
}

/// The quadric of each vertex of the full surface.
pub(crate) struct ErrorMemory<'a> {
    positions: &'a [[f64; 3]],
    quadrics: Vec<Quadric>,
    /// Area of the full surface.
    area: f64,
}

impl<'a> ErrorMemory<'a> {
    /// Every face counts at each of its vertices with a third of its area; boundary edges add the
    /// plane through them across their face.
    pub(crate) fn new(surface: &Surface, positions: &'a [[f64; 3]]) -> Self {
        let at = |v: u32| DVec3::from(positions[v as usize]);
        let mut quadrics = vec![Quadric::ZERO; positions.len()];
        let mut area = 0.0;
        for (face, t) in surface.triangles.iter().enumerate() {
            let [a, b, c] = t.map(at);
            let cross = (b - a).cross(c - a);
            let Some(normal) = cross.try_normalize() else { continue };
            let face_area = 0.5 * cross.length();
            area += face_area;
            let plane = Quadric::plane(normal, face_area / 3.0);
            t.iter().for_each(|&v| quadrics[v as usize].add(&plane));
            for corner in (3 * face as u32..).take(3).filter(|&c| surface.across(c) == NO_CORNER) {
                let ends = [next(corner), prev(corner)].map(|c| surface.vertex(c));
                let edge = at(ends[1]) - at(ends[0]);
                let Some(across) = edge.cross(normal).try_normalize() else { continue };
                let plane = Quadric::plane(across, 0.5 * edge.length_squared());
                ends.iter().for_each(|&v| quadrics[v as usize].add(&plane));
            }
        }
        Self { positions, quadrics, area }
    }

    /// The neighbour into which the star's vertex collapses with the least error, the first among equals, and
    /// that error: area times squared distance. At a boundary only the ends of the ring count.
    pub(crate) fn least_error(&self, star: &Star) -> (f64, u32) {
        self.heir(star).0
    }

    /// The same, and whether there is just one such neighbour.
    pub(crate) fn heir(&self, star: &Star) -> ((f64, u32), bool) {
        let quadric = &self.quadrics[star.vertex as usize];
        let mut least = (f64::INFINITY, star.vertex);
        let mut is_sole = false;
        let step = if star.is_closed() { 1 } else { (star.degree() - 1).max(1) };
        for &u in star.ring.iter().step_by(step) {
            let error = quadric.at(self.way(star.vertex, u));
            if error < least.0 {
                (least, is_sole) = ((error, u), true);
            } else if error == least.0 {
                is_sole = false;
            }
        }
        (least, is_sole)
    }

    /// The error of [`least_error`](Self::least_error) at each of `vertices`, whose rings these are.
    pub(crate) fn errors(&self, rings: &Rings, vertices: &[u32]) -> Vec<f64> {
        const MIN_PARALLEL: usize = 2048;
        let error = |(&v, place): (&u32, u32)| {
            let quadric = &self.quadrics[v as usize];
            let errors = rings.targets(place).iter().map(|&u| quadric.at(self.way(v, vertices[u as usize])));
            errors.fold(f64::INFINITY, |least, error| if error < least { error } else { least })
        };
        let places = (0..vertices.len() as u32).into_par_iter();
        vertices.par_iter().zip(places).with_min_len(MIN_PARALLEL).map(error).collect()
    }

    /// The star's vertex goes: the neighbour where that costs least remembers it.
    pub(crate) fn hand_on(&mut self, star: &Star) {
        let (_, heir) = self.least_error(star);
        self.hand_on_to(star.vertex, heir);
    }

    /// A vertex goes: its `heir` remembers it.
    pub(crate) fn hand_on_to(&mut self, vertex: u32, heir: u32) {
        let moved = self.quadrics[vertex as usize].moved(self.way(vertex, heir));
        self.quadrics[heir as usize].add(&moved);
    }

    /// Mean squared distance of the full surface from the vertices that are left, estimated.
    pub(crate) fn mean_error(&self, vertices: &[u32]) -> f64 {
        let sum: f64 = vertices.iter().map(|&v| self.quadrics[v as usize].c).sum();
        if self.area > 0.0 { sum / self.area } else { 0.0 }
    }

    fn way(&self, from: u32, to: u32) -> DVec3 {
        DVec3::from(self.positions[to as usize]) - DVec3::from(self.positions[from as usize])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_those_of_the_original_planes() {
        // A pyramid without its base: apex 0, base corners 1 to 4.
        let positions =
            [[0.0, 0.0, 1.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0], [-1.0, -1.0, 0.0], [1.0, -1.0, 0.0]];
        let triangles = vec![[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]];
        let surface = Surface::from_triangles(triangles, 5).unwrap();
        let mut memory = ErrorMemory::new(&surface, &positions);
        let star = Star { vertex: 0, corners: vec![0, 3, 6, 9], ring: vec![1, 2, 3, 4] };
        assert_eq!(memory.mean_error(&[0, 1, 2, 3, 4]), 0.0);
        // Corner 1 lies on two of the four planes and √2 off the others, of area √2 / 3 each.
        let (error, heir) = memory.least_error(&star);
        assert!((error - 2.0 * 2.0 * 2.0_f64.sqrt() / 3.0).abs() < 1e-12, "{error}");
        assert_eq!(heir, 1);
        memory.hand_on(&star);
        let mean = memory.mean_error(&[1, 2, 3, 4]);
        assert!((mean - error / (4.0 * 2.0_f64.sqrt())).abs() < 1e-12, "{mean}");
    }
}
