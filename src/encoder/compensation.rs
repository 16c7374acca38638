//! How far coarse meshes are best shown off their places (`format/SPEC.md`, section 9.4): points of the full surface, their
//! heights over each coarse one, and the weights that leave the least squares of them.

use crate::bitstream::compensation::Compensation;
use crate::mesh::Surface;
use crate::mesh::surface::{NO_CORNER, next, turns};
use crate::mesh::triangle::closest_shares;
use crate::passes::GridMesh;
use crate::passes::compensation::{Bend, bend};
use crate::simplification::LevelRecord;
use bitvec::vec::BitVec;
use glam::DVec3;
use rustc_hash::FxHashMap;

/// Points of the full surface.
const NUM_POINTS: usize = 512;
/// Steps to a neighbour in search of the triangle closest to a point.
const MAX_STEPS: usize = 4;
/// Triangles at one vertex that are looked at in that search: each point would see all those at a hub.
const MOST_CORNERS: usize = 256;
/// Shares of the squared error that weights must take off, and that weights may leave which stay as they are.
const LEAST_GAIN: f64 = 0.02;
const STAYS: f64 = 0.003;

/// A point of the full surface, in steps of the full grid, and a vertex of its triangle.
#[derive(Clone, Copy)]
pub(super) struct Point {
    at: DVec3,
    vertex: u32,
}

fn place(cells: &[[i32; 3]], vertex: u32) -> DVec3 {
    DVec3::from_array(cells[vertex as usize].map(f64::from))
}

/// Points evenly over the area of the surface.
pub(super) fn points(surface: &Surface, cells: &[[i32; 3]]) -> Vec<Point> {
    // Each area twice rather than an array of them: there may be many.
    let area = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| place(cells, v));
        (b - a).cross(c - a).length()
    };
    let total: f64 = surface.triangles.iter().map(area).sum();
    let share = total / NUM_POINTS as f64;
    let mut points = Vec::with_capacity(NUM_POINTS);
    let mut sum = 0.5 * share;
    for triangle in &surface.triangles {
        sum += area(triangle);
        while sum >= share && points.len() < NUM_POINTS {
            let [a, b, c] = triangle.map(|v| place(cells, v));
            points.push(Point { at: (a + b + c) / 3.0, vertex: triangle[points.len() % 3] });
            sum -= share;
        }
    }
    points
}

/// Fits the weights of one coarse mesh after the other.
pub(super) struct Fitter<'a> {
    points: &'a [Point],
    /// For each point the vertices near it, the one of the full surface first, each closest to the one before of those that
    /// are left where that goes.
    chains: Vec<Vec<u32>>,
    /// For each chain the first vertex that has been added.
    reached: Vec<usize>,
    /// The vertices of all chains, and the indices in the mesh of those that have been added.
    is_in_chain: BitVec,
    places: FxHashMap<u32, u32>,
    num_seen: usize,
    last: Compensation,
}

impl<'a> Fitter<'a> {
    /// `records` are what each level removed, finest first, `cells` those of the full surface.
    pub(super) fn new(points: &'a [Point], records: &[LevelRecord], cells: &[[i32; 3]]) -> Self {
        let mut is_in_chain = BitVec::repeat(false, cells.len());
        points.iter().for_each(|point| is_in_chain.set(point.vertex as usize, true));
        let mut parents = FxHashMap::default();
        for removed in records.iter().flat_map(LevelRecord::iter) {
            if !is_in_chain[removed.vertex as usize] {
                continue;
            }
            let distance = |&v: &u32| place(cells, v).distance_squared(place(cells, removed.vertex));
            let nearest = removed.ring.iter().copied().min_by(|a, b| distance(a).total_cmp(&distance(b)));
            let nearest = nearest.unwrap_or(removed.vertex);
            is_in_chain.set(nearest as usize, true);
            parents.insert(removed.vertex, nearest);
        }
        let chain = |point: &Point| {
            std::iter::successors(Some(point.vertex), |vertex| parents.get(vertex).copied()).collect()
        };
        let chains: Vec<Vec<u32>> = points.iter().map(chain).collect();
        let reached = chains.iter().map(|chain| chain.len() - 1).collect();
        let places = FxHashMap::default();
        Self { points, chains, reached, is_in_chain, places, num_seen: 0, last: Compensation::NONE }
    }

    /// The weights for a mesh that lacks `hidden` bits; `vertex_source` are its vertices in the full surface.
    pub(super) fn fit(&mut self, mesh: &GridMesh, vertex_source: &[u32], hidden: u32) -> Compensation {
        for (&source, place) in vertex_source.iter().zip(0..).skip(self.num_seen) {
            if self.is_in_chain[source as usize] {
                self.places.insert(source, place);
            }
        }
        self.num_seen = vertex_source.len();
        let mut bends =
            Bends { mesh, known: FxHashMap::default(), known_around: FxHashMap::default(), fan: Vec::new() };
        let mut squares = Squares::default();
        let scale = 1.0 / f64::from(1_u32 << hidden);
        for ((point, chain), reached) in self.points.iter().zip(&self.chains).zip(&mut self.reached) {
            while *reached > 0 && self.places.contains_key(&chain[*reached - 1]) {
                *reached -= 1;
            }
            let vertex = self.places[&chain[*reached]];
            let at = (point.at + 0.5) * scale - 0.5;
            let found = closest(mesh, vertex, at);
            let [mut own, mut around] = [0.0; 2];
            for (vertex, share) in found.triangle.into_iter().zip(found.shares) {
                let (bend, around_it) = bends.around(vertex);
                let share = share * DVec3::from_array(bend.normal).dot(found.normal);
                own -= share * bend.height;
                around -= share * around_it;
            }
            squares.add(own, around, found.normal.dot(at - found.closest));
        }
        self.last = squares.choose(self.last);
        self.last
    }
}

/// Bends of the vertices near points.
struct Bends<'a> {
    mesh: &'a GridMesh,
    known: FxHashMap<u32, Bend>,
    /// Mean heights of the neighbours' bends.
    known_around: FxHashMap<u32, f64>,
    fan: Vec<u32>,
}

impl Bends<'_> {
    /// The bend of a vertex and the mean height of its neighbours'; 0 on boundaries.
    fn around(&mut self, vertex: u32) -> (Bend, f64) {
        let own = self.of(vertex);
        if let Some(&known) = self.known_around.get(&vertex) {
            return (own, known);
        }
        let surface = &self.mesh.surface;
        let is_closed = surface.fan(surface.corner_of[vertex as usize], &mut self.fan);
        let ring: Vec<u32> = self.fan.iter().map(|&corner| surface.vertex(next(corner))).collect();
        let mut sum = |ring: &[u32]| ring.iter().map(|&v| self.of(v).height).sum::<f64>();
        let around = if is_closed { sum(&ring) / ring.len() as f64 } else { 0.0 };
        self.known_around.insert(vertex, around);
        (own, around)
    }

    fn of(&mut self, vertex: u32) -> Bend {
        let (surface, fan) = (&self.mesh.surface, &mut self.fan);
        *self.known.entry(vertex).or_insert_with(|| {
            surface.fan(surface.corner_of[vertex as usize], fan);
            let triangles = fan.iter().map(|&corner| turns(corner).map(|corner| surface.vertex(corner)));
            bend(&self.mesh.positions, triangles)
        })
    }
}

/// Sums of a least-squares fit with two unknowns.
#[derive(Default)]
struct Squares {
    own: f64,
    mixed: f64,
    around: f64,
    /// Products with the heights.
    target: [f64; 2],
    heights: f64,
}

impl Squares {
    fn add(&mut self, own: f64, around: f64, height: f64) {
        self.own += own * own;
        self.mixed += own * around;
        self.around += around * around;
        self.target[0] += own * height;
        self.target[1] += around * height;
        self.heights += height * height;
    }

    /// Sum of squared heights that is left.
    fn error(&self, weights: Compensation) -> f64 {
        let [x, y] = [weights.own, weights.around].map(|w| f64::from(w) / Compensation::UNIT);
        let fitted = x * x * self.own + 2.0 * x * y * self.mixed + y * y * self.around;
        self.heights - 2.0 * (x * self.target[0] + y * self.target[1]) + fitted
    }

    fn choose(&self, last: Compensation) -> Compensation {
        let whole = |x: f64| {
            let most = f64::from(Compensation::MAX);
            (x * Compensation::UNIT).round().clamp(-most, most) as i32
        };
        // A little more than singular: of weights that do the same the smaller ones.
        let ridge = 1e-3 * (self.own + self.around) + 1e-12;
        let (own, around) = (self.own + ridge, self.around + ridge);
        let determinant = own * around - self.mixed * self.mixed;
        let [s, t] = self.target;
        let both = [s * around - t * self.mixed, t * own - s * self.mixed].map(|x| whole(x / determinant));
        // Neighbours that count against a vertex sharpen creases.
        let [own, around] = if both[1] >= 0 { both } else { [whole(s / own), 0] };
        let best = Compensation { own, around };
        let enough = self.error(best) + STAYS * self.heights;
        if self.error(Compensation::NONE) <= self.error(best) + LEAST_GAIN * self.heights {
            return Compensation::NONE;
        }
        if self.error(last) <= enough { last } else { best }
    }
}

/// A point of a mesh.
struct Closest {
    triangle: [u32; 3],
    /// Barycentric coordinates.
    shares: [f64; 3],
    normal: DVec3,
    closest: DVec3,
    distance: f64,
}

/// The point of the triangles around `vertex` that is closest to `at`, or of those around the vertices to which it leads.
fn closest(mesh: &GridMesh, mut vertex: u32, at: DVec3) -> Closest {
    let (triangle, shares, normal) = ([vertex; 3], [0.0; 3], DVec3::ZERO);
    let mut best = Closest { triangle, shares, normal, closest: at, distance: f64::INFINITY };
    let mut fan = Vec::new();
    for _ in 0..MAX_STEPS {
        read_fan(&mesh.surface, vertex, &mut fan);
        for corner in &fan {
            let found = closest_of(mesh, mesh.surface.triangles[*corner as usize / 3], at);
            if found.distance < best.distance {
                best = found;
            }
        }
        let nearest = (0..3).max_by(|&i, &j| best.shares[i].total_cmp(&best.shares[j])).unwrap_or(0);
        if best.triangle[nearest] == vertex {
            break;
        }
        vertex = best.triangle[nearest];
    }
    best
}

/// The corners at a vertex; of too many those that follow one.
fn read_fan(surface: &Surface, vertex: u32, fan: &mut Vec<u32>) {
    let corner = surface.corner_of[vertex as usize];
    if surface.valence[vertex as usize] as usize <= MOST_CORNERS {
        surface.fan(corner, fan);
        return;
    }
    let left = |&corner: &u32| Some(surface.swing_left(corner)).filter(|&left| left != NO_CORNER);
    fan.clear();
    fan.extend(std::iter::successors(Some(corner), left).take(MOST_CORNERS));
}

fn closest_of(mesh: &GridMesh, triangle: [u32; 3], at: DVec3) -> Closest {
    let corners = triangle.map(|v| place(&mesh.positions, v));
    let shares = closest_shares(at, &corners);
    let [a, b, c] = corners;
    let closest = a * shares[0] + b * shares[1] + c * shares[2];
    let normal = (b - a).cross(c - a).normalize_or_zero();
    Closest { triangle, shares, normal, closest, distance: closest.distance_squared(at) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn squares(heights: impl Fn(f64, f64) -> f64) -> Squares {
        let mut squares = Squares::default();
        for i in 0..200 {
            let (own, around) = (1.0 + f64::from(i % 7), 1.0 + f64::from(i % 5));
            squares.add(own, around, heights(own, around));
        }
        squares
    }

    #[test]
    fn weights_that_explain_the_heights_are_found() {
        let weights = Compensation { own: 8, around: 16 };
        let explained = squares(|own, around| 0.125 * own + 0.25 * around);
        assert_eq!(explained.choose(Compensation::NONE), weights);
        let near = Compensation { own: 9, around: 15 };
        assert_eq!(squares(|own, around| 0.13 * own + 0.25 * around).choose(near), near, "near enough");
        assert_eq!(squares(|_, _| 0.0).choose(weights), Compensation::NONE);
        let sharpening = squares(|own, around| 0.5 * own - 0.25 * around).choose(Compensation::NONE);
        assert_eq!(sharpening.around, 0);
    }

    #[test]
    fn points_are_spread_by_area() {
        let cells = [[0, 0, 0], [30, 0, 0], [0, 10, 0], [30, 10, 0], [15, 40, 0]];
        let surface = Surface::from_triangles(vec![[0, 1, 2], [1, 3, 2], [2, 3, 4]], 5).unwrap_or_default();
        let points = points(&surface, &cells);
        assert_eq!(points.len(), NUM_POINTS);
        // Areas 150, 150 and 450.
        let far = points.iter().filter(|point| point.at.y > 10.0).count();
        assert!((far as f64 / NUM_POINTS as f64 - 0.6).abs() < 0.01, "{far}");
    }
}
