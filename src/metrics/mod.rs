//! How far two surfaces are apart.
//!
//! [`compare`] measures from points of one surface to the nearest point of the other, in both directions.
//! The root mean square is over the area, taken at evenly spread samples (`sample.rs`); the maximum is over
//! the samples and the vertices (the one-sided Hausdorff distance, from below). The nearest point is exact:
//! any point of any triangle, found with a tree of boxes (`nearest.rs`). The method is that of Cignoni,
//! Rocchini and Scopigno, *Metro: measuring error on simplified surfaces* (1998), with samples spread by a
//! low-discrepancy sequence in place of random ones.
//!
//! The same meshes give the same bits, whatever the number of threads: samples are taken in blocks of fixed
//! size whose sums are added in order.

mod bounds;
mod crowd;
mod known;
mod nearest;
mod oriented;
mod sample;

use crate::mesh::TriMesh;
use crate::util::count::Count;
use crowd::{Crowd, Waiting};
use glam::DVec3;
use known::Known;
use nearest::NearestTriangle;
use rayon::prelude::*;
use sample::SurfaceSampler;
use thiserror::Error;

/// Points measured by one thread at a time, and summed before they are added to the rest.
const BLOCK_POINTS: usize = 4096;

/// Points whose distances are kept before they are summed; a multiple of the above.
const POINTS_AT_ONCE: usize = 1 << 20;

/// Nodes of the tree that may be visited for a point, on the mean of those before it in its block, and some more at
/// first. Hardly a point of scans and models takes as many.
const STEPS: usize = 512;
const FIRST_STEPS: usize = 1 << 13;

/// Fewest samples by default, so that small meshes are measured as well as large ones.
const MIN_DEFAULT_SAMPLES: usize = 100_000;

/// Distances below this, in units of the larger mesh's extent, are rounding noise and count as zero. So a
/// mesh has distance zero from itself, and from itself with other indices.
const NOISE: f64 = 1.0 / (1_u64 << 48) as f64;

/// Settings of [`compare`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct CompareOptions {
    /// Surface samples in each direction. Default: twice the number of vertices of the mesh sampled, at
    /// least 100,000. The cost is proportional to it; more than 2^32 are not taken.
    pub samples: Option<usize>,
}

impl CompareOptions {
    /// The defaults.
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes `samples` surface samples in each direction.
    pub fn samples(mut self, samples: usize) -> Self {
        self.samples = Some(samples);
        self
    }
}

/// Distance from one surface to another, in model units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Distance {
    /// Root mean square over the area of the first surface.
    pub rms: f64,
    /// Maximum over the samples and vertices of the first surface.
    pub max: f64,
}

/// What [`compare`] finds between `a` and `b`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Comparison {
    /// From points of `a` to the surface of `b`.
    pub forward: Distance,
    /// From points of `b` to the surface of `a`.
    pub backward: Distance,
    /// Diagonal of the bounding box of `a`, all its vertices included.
    pub diagonal: f64,
}

impl Comparison {
    /// The larger of the two root mean squares, in model units.
    pub fn rms(&self) -> f64 {
        self.forward.rms.max(self.backward.rms)
    }

    /// The larger of the two maxima, in model units: the Hausdorff distance.
    pub fn max(&self) -> f64 {
        self.forward.max.max(self.backward.max)
    }

    /// [`rms`](Self::rms) divided by the diagonal. 0 for equal surfaces, infinite if only the diagonal is 0.
    pub fn rms_relative(&self) -> f64 {
        if self.rms() == 0.0 { 0.0 } else { self.rms() / self.diagonal }
    }

    /// −20 log₁₀ of [`rms_relative`](Self::rms_relative); infinite for equal surfaces.
    pub fn psnr_db(&self) -> f64 {
        -20.0 * self.rms_relative().log10()
    }
}

/// Why two meshes cannot be compared.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum CompareError {
    /// A mesh without vertices is nowhere.
    #[error("the {} mesh has no vertices", if *.is_first { "first" } else { "second" })]
    Empty {
        /// Whether it is `a` that is empty.
        is_first: bool,
    },
}

/// Measures the distances between the surfaces of `a` and `b`, in both directions.
///
/// Vertices that no triangle uses are not part of the surface. A mesh without triangles is the set of its
/// vertices; where there is no area, because all triangles are degenerate or missing, the root mean square is
/// over the vertices.
///
/// # Errors
/// If a mesh has no vertices.
pub fn compare(a: &TriMesh, b: &TriMesh, options: &CompareOptions) -> Result<Comparison, CompareError> {
    compare_with_progress(a, b, options, &|_| ())
}

/// As [`compare`], calling `progress` with the share of the points measured, 0 to 1.
///
/// # Errors
/// As [`compare`].
pub fn compare_with_progress(
    a: &TriMesh,
    b: &TriMesh,
    options: &CompareOptions,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Comparison, CompareError> {
    let empty = |is_first| CompareError::Empty { is_first };
    let box_a = a.bounding_box().ok_or(empty(true))?;
    let box_b = b.bounding_box().ok_or(empty(false))?;
    let frame = Frame::around(box_a, box_b);
    let surface_a = Surface::new(a, &frame);
    let surface_b = Surface::new(b, &frame);
    let [forward, backward] =
        [&surface_a, &surface_b].map(|from| num_samples(options, from).saturating_add(from.num_points));
    let count = Count::new(forward.saturating_add(backward), progress);
    let one_sided = |from: &Surface, to: &Surface| {
        let Distance { rms, max } = from.distance_to(to, num_samples(options, from), &count);
        Distance { rms: frame.length_to_model(rms), max: frame.length_to_model(max) }
    };
    let (low, high) = box_a;
    let comparison = Comparison {
        forward: one_sided(&surface_a, &surface_b),
        backward: one_sided(&surface_b, &surface_a),
        diagonal: frame.length_to_model((frame.to_unit(high) - frame.to_unit(low)).length()),
    };
    count.finish();
    Ok(comparison)
}

/// Samples of the surface of a mesh.
fn num_samples(options: &CompareOptions, surface: &Surface) -> usize {
    options.samples.unwrap_or(MIN_DEFAULT_SAMPLES.max(2 * surface.num_points))
}

/// The coordinates that distances are measured in: the boxes of both meshes, moved to the origin and scaled
/// to about 1. Squares neither overflow nor vanish, and a far origin costs no digits.
struct Frame {
    origin: [f64; 3],
    /// A power of two, so that scaling is exact.
    scale: f64,
}

type Box3 = ([f64; 3], [f64; 3]);

impl Frame {
    fn around((low_a, high_a): Box3, (low_b, high_b): Box3) -> Self {
        let origin: [f64; 3] = std::array::from_fn(|k| low_a[k].min(low_b[k]));
        let half_extents = (0..3).map(|k| high_a[k].max(high_b[k]) / 2.0 - origin[k] / 2.0);
        let half_extent = half_extents.fold(0.0, f64::max);
        let exponent = if half_extent > 0.0 { half_extent.log2().floor() as i32 + 1 } else { 0 };
        // Within the range where the scale and its inverse are both normal numbers.
        let biased_exponent = 1023 - exponent.clamp(-1020, 1020);
        Self { origin, scale: f64::from_bits((biased_exponent as u64) << 52) }
    }

    fn to_unit(&self, position: [f64; 3]) -> DVec3 {
        // Halves, as the difference itself can overflow.
        let unit = |k: usize| (position[k] / 2.0 - self.origin[k] / 2.0) * self.scale;
        DVec3::new(unit(0), unit(1), unit(2))
    }

    fn length_to_model(&self, length: f64) -> f64 {
        length / self.scale * 2.0
    }
}

/// A mesh prepared for measuring, in the coordinates of a [`Frame`].
struct Surface {
    places: Vec<DVec3>,
    /// Vertices of triangles, or the same vertex three times if the mesh has none.
    corners: Vec<[u32; 3]>,
    triangles: Vec<[DVec3; 3]>,
    /// Vertices of triangles.
    num_points: usize,
}

impl Surface {
    fn new(mesh: &TriMesh, frame: &Frame) -> Self {
        let places: Vec<DVec3> = mesh.positions().iter().map(|&p| frame.to_unit(p)).collect();
        let corners = match mesh.triangles() {
            [] => (0..places.len() as u32).map(|v| [v; 3]).collect(),
            triangles => triangles.to_vec(),
        };
        let triangles = corners.iter().map(|t| t.map(|v| places[v as usize])).collect();
        let surface = Self { places, corners, triangles, num_points: 0 };
        Self { num_points: surface.points(|_| true).len(), ..surface }
    }

    /// The vertices of the triangles that `is_meant`.
    fn points(&self, is_meant: impl Fn(usize) -> bool) -> Vec<DVec3> {
        let mut is_used = vec![false; self.places.len()];
        for (_, corners) in self.corners.iter().enumerate().filter(|&(t, _)| is_meant(t)) {
            corners.iter().for_each(|&v| is_used[v as usize] = true);
        }
        self.places.iter().zip(is_used).filter_map(|(&p, used)| used.then_some(p)).collect()
    }

    fn distance_to(&self, other: &Self, num_samples: usize, count: &Count) -> Distance {
        let known = Known::new(&other.triangles);
        let is_common: Vec<bool> = self.triangles.par_iter().map(|t| known.contains(t)).collect();
        let tree = NearestTriangle::new(&known.distinct());
        drop(known);
        let apart = self.points(|t| !is_common[t]);
        let at_vertices =
            DistanceSum::over(&tree, count, apart.len(), |range| apart[range].iter().copied().map(Some));
        let samples = SurfaceSampler::new(&self.triangles, num_samples.min(u32::MAX as usize));
        let mut sum = match &samples {
            Some(samples) => DistanceSum::over(&tree, count, samples.len(), |range| {
                samples.points(range).map(|(t, point)| (!is_common[t]).then_some(point))
            }),
            None => DistanceSum { count: self.num_points, ..at_vertices },
        };
        sum.max_squared = sum.max_squared.max(at_vertices.max_squared);
        let rms = (sum.sum_of_squares / sum.count.max(1) as f64).sqrt();
        Distance { rms, max: sum.max_squared.sqrt() }
    }
}

/// Squared distances, gathered.
#[derive(Clone, Copy, Default)]
struct DistanceSum {
    count: usize,
    sum_of_squares: f64,
    max_squared: f64,
}

impl DistanceSum {
    /// Gathers the distances of `count` points, which `points` lists for any range of their indices: `None` for those at no
    /// distance.
    fn over<P: Iterator<Item = Option<DVec3>>>(
        tree: &NearestTriangle,
        told: &Count,
        count: usize,
        points: impl Fn(std::ops::Range<usize>) -> P + Sync,
    ) -> Self {
        let mut blocks = Vec::with_capacity(count.div_ceil(BLOCK_POINTS));
        for begin in (0..count).step_by(POINTS_AT_ONCE) {
            let end = count.min(begin + POINTS_AT_ONCE);
            let squared = squared_distances(tree, told, begin..end, &points);
            blocks.extend(squared.chunks(BLOCK_POINTS).map(Self::of));
        }
        blocks.iter().fold(Self::default(), |total, block| Self {
            count: total.count + block.count,
            sum_of_squares: total.sum_of_squares + block.sum_of_squares,
            max_squared: total.max_squared.max(block.max_squared),
        })
    }

    fn of(squared: &[f64]) -> Self {
        let mut sum = Self { count: squared.len(), ..Self::default() };
        for &squared in squared {
            let squared = if squared < NOISE * NOISE { 0.0 } else { squared };
            sum.sum_of_squares += squared;
            sum.max_squared = sum.max_squared.max(squared);
        }
        sum
    }
}

/// Squared distances of the points of a range, which `points` lists. Where the tree does not help, all that are left
/// are found together.
fn squared_distances<P: Iterator<Item = Option<DVec3>>>(
    tree: &NearestTriangle,
    count: &Count,
    range: std::ops::Range<usize>,
    points: &(impl Fn(std::ops::Range<usize>) -> P + Sync),
) -> Vec<f64> {
    let mut squared = vec![0.0; range.len()];
    let measure_block = |(block, squared): (usize, &mut [f64])| {
        let begin = range.start + block * BLOCK_POINTS;
        let mut waiting = Vec::new();
        let mut steps = 0;
        // Neighbours in a block are often neighbours in space: the last answer bounds the next search.
        let mut hint = 0;
        for (i, point) in points(begin..begin + squared.len()).enumerate() {
            steps += if i == 0 { FIRST_STEPS } else { STEPS };
            let Some(point) = point else { continue };
            // After the first one that takes too long the others are left, too.
            let helps = waiting.is_empty();
            match helps.then(|| tree.nearest(point, hint, NOISE * NOISE, &mut steps)).flatten() {
                Some(nearest) => (hint, squared[i]) = (nearest.triangle, nearest.squared),
                None => {
                    waiting.push(Waiting { point, index: block * BLOCK_POINTS + i, squared: 0.0 });
                }
            }
        }
        count.add(squared.len() - waiting.len());
        waiting
    };
    let blocks = squared.par_chunks_mut(BLOCK_POINTS).enumerate();
    let mut waiting: Vec<Waiting> = blocks.flat_map_iter(measure_block).collect();
    if !waiting.is_empty() {
        Crowd::new(tree.triangles()).find(&mut waiting, NOISE * NOISE);
        count.add(waiting.len());
        waiting.into_iter().for_each(|Waiting { index, squared: found, .. }| squared[index] = found);
    }
    squared
}
