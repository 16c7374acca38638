//! The window of a vertex (section 2.1, eq. 1), gathered into flat arrays.

use glam::DVec3;
use rayon::prelude::*;

use super::adjacency::GROUP;
use super::surface::Surface;
use super::symmetric::Sym3;

/// The scale of a descriptor: W(v) = {u : at most `rings` edges from v, and ‖u − v‖ ≤ `radius`} (eq. 1).
///
/// A vertex counts even if the short path to it leaves the ball.
///
/// *Ours:* no path leads through a vertex with more than 256 neighbours, unless it is v itself, and a ring beyond the
/// first that has more than 256 n vertices is left out with all after it. Otherwise the window of each vertex around
/// a hub would be most of the mesh, and the time quadratic in the hub's neighbours. The scans and models that we
/// know have neither.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Topological radius n, in edges.
    pub rings: u32,
    /// Euclidean radius r, in units of the mean edge length of the finest mesh. Values outside 1e-30 ..
    /// 1e30 are moved to the nearer end; every descriptor is 0 unless it is positive.
    pub radius: f64,
}

impl Default for Window {
    /// n = 4 and r = 3, as in the paper.
    fn default() -> Self {
        Self { rings: 4, radius: 3.0 }
    }
}

impl Window {
    /// The radius, limited so that its powers stay in range.
    pub(super) fn r(&self) -> f64 {
        self.radius.clamp(1e-30, 1e30)
    }
}

/// Squares of distances may exceed r² by this part, so that rounding does not decide about ties.
const RADIUS_SLACK: f64 = 1e-9;

/// No path leads through a vertex with more groups of neighbours than this.
const MOST_GROUPS: usize = 256 / GROUP;

/// A ring of more vertices, times the rings of the window, is left out.
const MOST_IN_RING: usize = 256;

/// The arrays are padded with zeros to a multiple of this, for kernels that work on several vertices at once.
pub(super) const LANES: usize = 4;

/// Vertices handled between two reports of progress.
const BLOCK: usize = 512;

/// One window at a time, and the scratch to gather it. The centre comes first.
pub(super) struct LocalWindow<'a> {
    pub(super) surface: &'a Surface,
    rings: u32,
    largest_square: f64,
    minus_inverse_width: f64,
    /// Vertices within the rings, breadth first; the tail is scratch.
    queue: Vec<u32>,
    /// `stamps[u] == stamp` if u is in the queue. Gathers are fewer than vertices, so it cannot wrap.
    stamps: Vec<u32>,
    stamp: u32,
    len: usize,
    members: Vec<u32>,
    /// (u − v) / l̄ by component.
    dx: Vec<f64>,
    dy: Vec<f64>,
    dz: Vec<f64>,
}

/// Calls `value` with the window of every selected vertex that has one, and collects what it returns.
pub(super) fn map_windows<T: Clone + Default + Send>(
    surface: &Surface,
    window: &Window,
    progress: &(dyn Fn(usize) + Sync),
    value: impl Fn(&mut LocalWindow) -> T + Sync,
) -> Vec<T> {
    let mut values = vec![T::default(); surface.num_selected()];
    values.par_chunks_mut(BLOCK).enumerate().for_each_init(
        || LocalWindow::new(surface, window),
        |local, (block, values)| {
            for (i, slot) in values.iter_mut().enumerate() {
                let v = surface.selected(block * BLOCK + i);
                if !surface.adjacency.of(v).is_empty() {
                    local.gather(v);
                    *slot = value(local);
                }
            }
            progress(values.len());
        },
    );
    values
}

impl<'a> LocalWindow<'a> {
    fn new(surface: &'a Surface, window: &Window) -> Self {
        let square = window.r() * window.r();
        Self {
            surface,
            rings: window.rings,
            largest_square: square * (1.0 + RADIUS_SLACK),
            minus_inverse_width: -9.0 / square,
            queue: Vec::new(),
            stamps: vec![0; surface.num_vertices()],
            stamp: 0,
            len: 0,
            members: Vec::new(),
            dx: Vec::new(),
            dy: Vec::new(),
            dz: Vec::new(),
        }
    }

    fn gather(&mut self, v: usize) {
        let reached = self.walk_rings(v);
        self.keep_ball(v, reached);
    }

    /// Fills the queue with the vertices at most `rings` edges from `v` that a path leads to; returns how many
    /// there are.
    fn walk_rings(&mut self, v: usize) -> usize {
        self.stamp += 1;
        let stamp = self.stamp;
        if self.queue.is_empty() {
            self.queue.resize(256, 0);
        }
        self.queue[0] = v as u32;
        self.stamps[v] = stamp;
        let (mut begin, mut end) = (0, 1);
        let most_in_ring = MOST_IN_RING.saturating_mul(self.rings as usize);
        for ring in 0..self.rings {
            let most = if ring == 0 { usize::MAX } else { most_in_ring };
            let mut len = end;
            for i in begin..end {
                if len - end > most {
                    return end;
                }
                let row = self.surface.adjacency.of(self.queue[i] as usize);
                if row.len() > MOST_GROUPS && i > 0 {
                    continue;
                }
                for group in row {
                    if self.queue.len() < len + GROUP {
                        self.queue.resize(2 * (len + GROUP), 0);
                    }
                    // Written first and kept if new: whether it is new is a coin toss to branch prediction.
                    let room = &mut self.queue[len..len + GROUP];
                    let mut added = 0;
                    for &u in group {
                        room[added % GROUP] = u;
                        added += usize::from(self.stamps[u as usize] != stamp);
                        self.stamps[u as usize] = stamp;
                    }
                    len += added;
                }
            }
            if len == end || len - end > most {
                break;
            }
            (begin, end) = (end, len);
        }
        end
    }

    /// Keeps those of the first `reached` vertices of the queue that lie in the ball.
    fn keep_ball(&mut self, v: usize, reached: usize) {
        let padded = reached + LANES;
        if self.members.len() < padded {
            self.members.resize(padded, 0);
            for array in [&mut self.dx, &mut self.dy, &mut self.dz] {
                array.resize(padded, 0.0);
            }
        }
        let members = &mut self.members[..padded];
        let (dx, dy, dz) = (&mut self.dx[..padded], &mut self.dy[..padded], &mut self.dz[..padded]);
        let (vertices, unit) = (&self.surface.vertices, self.surface.unit);
        let centre = vertices[v].position;
        let mut len = 0;
        for &u in &self.queue[..reached] {
            let d = (vertices[u as usize].position - centre) * unit;
            members[len] = u;
            (dx[len], dy[len], dz[len]) = (d.x, d.y, d.z);
            len += usize::from(d.length_squared() <= self.largest_square);
        }
        for array in [dx, dy, dz] {
            array[len..len + LANES].fill(0.0);
        }
        self.len = len;
    }

    /// Number of vertices in the window, the centre included.
    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// n̂ of the centre.
    pub(super) fn normal(&self) -> DVec3 {
        self.surface.vertices[self.members[0] as usize].normal
    }

    /// Indices of the vertices, the centre first.
    pub(super) fn members(&self) -> &[u32] {
        &self.members[..self.len]
    }

    /// The three components of (u − v)/l̄, followed by zeros up to a multiple of [`LANES`].
    pub(super) fn offsets(&self) -> [&[f64]; 3] {
        let padded = self.len.next_multiple_of(LANES);
        [&self.dx[..padded], &self.dy[..padded], &self.dz[..padded]]
    }

    /// Each vertex with (u − v)/l̄ and its weight w(u) = exp(−‖u − v‖² / (r/3)²).
    pub(super) fn weighted(&self) -> impl Iterator<Item = (usize, DVec3, f64)> {
        (0..self.len).map(|i| {
            let d = DVec3::new(self.dx[i], self.dy[i], self.dz[i]);
            (self.members[i] as usize, d, libm::exp(d.length_squared() * self.minus_inverse_width))
        })
    }

    /// C = Σ (u − ū)(u − ū)ᵀ, not divided by the number of vertices (eq. 3).
    pub(super) fn covariance(&self) -> Sym3 {
        let [dx, dy, dz] = self.offsets();
        let mut sums = [[0.0; LANES]; 9];
        let chunks = dx.chunks_exact(LANES).zip(dy.chunks_exact(LANES)).zip(dz.chunks_exact(LANES));
        for ((x, y), z) in chunks {
            for lane in 0..LANES {
                let (x, y, z) = (x[lane], y[lane], z[lane]);
                for (sum, term) in sums.iter_mut().zip([x, y, z, x * x, x * y, x * z, y * y, y * z, z * z]) {
                    sum[lane] += term;
                }
            }
        }
        let [x, y, z, xx, xy, xz, yy, yz, zz] = sums.map(|lanes| lanes.iter().sum::<f64>());
        let mut covariance = Sym3 { xx, xy, xz, yy, yz, zz };
        covariance.add_outer(DVec3::new(x, y, z), -1.0 / self.len as f64);
        covariance
    }
}

#[cfg(test)]
mod tests {
    use super::super::readings::NormalWeights;
    use super::*;
    use crate::mesh::TriMesh;

    /// Vertices of the window of each vertex, which the radius does not limit.
    fn sizes(num_vertices: u32, triangles: Vec<[u32; 3]>, rings: u32) -> Vec<usize> {
        let place = |v: u32| [f64::from(v), f64::from(v * v % 7), 0.0];
        let mesh = TriMesh::new((0..num_vertices).map(place).collect(), triangles).unwrap();
        let surface = Surface::new(&mesh, 1.0, NormalWeights::Area, true).unwrap();
        map_windows(&surface, &Window { rings, radius: 1e9 }, &|_| (), |local| local.len())
    }

    fn fan(rim: u32) -> Vec<[u32; 3]> {
        (0..rim).map(|i| [0, 1 + i, 1 + (i + 1) % rim]).collect()
    }

    #[test]
    fn no_path_leads_through_a_hub() {
        // A vertex of the rim has four to each side, and the hub, which has all as ever.
        let sizes_of = |rim| sizes(rim + 1, fan(rim), 4);
        assert!(sizes_of(257).into_iter().eq([258].into_iter().chain([10; 257])));
        assert!(sizes_of(256).into_iter().all(|size| size == 257));
    }

    #[test]
    fn a_ring_of_too_many_vertices_is_left_out() {
        // Each of the three neighbours of 0 has 240 of its own: too many for two rings, and few enough for three.
        let rim = |hub: u32| (0..240).map(move |i| [hub, 240 * hub + i, 240 * hub + (i + 1) % 240]);
        let mut triangles = vec![[0, 1, 2], [0, 2, 3], [0, 3, 1]];
        triangles.extend((1..4).flat_map(rim));
        assert_eq!([1, 2, 3].map(|rings| sizes(960, triangles.clone(), rings)[0]), [4, 4, 4 + 720]);
    }
}
