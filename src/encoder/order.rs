//! An order of vertices and triangles that does not depend on the file: encoding the same mesh in another
//! order, or what a decoder made of its stream, gives the same bytes.

use super::signatures::{Signatures, mix};
use crate::TriMesh;
use crate::bitstream::header::Grid;
use crate::mesh::{CornersAt, has_three_vertices};
use crate::morton::morton;
use rayon::prelude::*;

/// The usable part of a mesh on the grid, in its own order.
pub(super) struct Ordered {
    /// Of each vertex that a triangle has: by Morton code, ties by the cells around.
    pub(super) cells: Vec<[i32; 3]>,
    /// Vertex of the mesh for each vertex.
    pub(super) vertex_source: Vec<u32>,
    /// For each triangle three times that of the mesh, and the place there of its first vertex.
    pub(super) corner_source: Vec<u32>,
}

/// Puts the usable triangles of `mesh` and their vertices in order: triangles from their smallest vertex on,
/// ascending. There are fewer than 2³⁰ of them. `signatures` are asked for where places do not tell all apart.
pub(super) fn order<'a>(
    mesh: &TriMesh,
    grid: &Grid,
    signatures: &dyn Fn() -> Option<&'a Signatures>,
) -> (Ordered, Vec<[u32; 3]>) {
    let mut usable: Vec<(u32, [u32; 3])> =
        (0..).zip(mesh.triangles().iter().copied()).filter(|(_, t)| has_three_vertices(t)).collect();
    let mut is_used = vec![false; mesh.num_vertices()];
    usable.iter().flat_map(|(_, t)| t).for_each(|&v| is_used[v as usize] = true);

    // A code of at most 90 bits, then the index.
    let code = |v: u32| morton(grid.cell(mesh.positions()[v as usize])) << 32 | u128::from(v);
    let used: Vec<u32> = (0..mesh.num_vertices() as u32).filter(|&v| is_used[v as usize]).collect();
    let mut keys: Vec<u128> = used.par_iter().map(|&v| code(v)).collect();
    drop(used);
    keys.par_sort_unstable();
    let mut vertex_source: Vec<u32> = keys.iter().map(|&key| key as u32).collect();
    let mut place = vec![0_u32; mesh.num_vertices()];
    vertex_source.iter().zip(0..).for_each(|(&v, i)| place[v as usize] = i);
    usable.par_iter_mut().for_each(|(_, t)| *t = t.map(|v| place[v as usize]));
    if keys.windows(2).any(|pair| pair[0] >> 32 == pair[1] >> 32) {
        let triangles: Vec<[u32; 3]> = usable.iter().map(|&(_, t)| t).collect();
        let codes: Vec<u128> = keys.iter().map(|key| key >> 32).collect();
        let mut ties = Ties::new(codes, &triangles);
        if let Some(signatures) = signatures() {
            let corners =
                usable.iter().flat_map(|&(face, t)| (0..3).map(move |k| (t[k], 3 * face + k as u32)));
            vertex_source
                .iter()
                .zip(&mut ties.hash)
                .for_each(|(&v, hash)| *hash ^= signatures.vertices[v as usize]);
            corners.for_each(|(v, corner)| {
                let hash = &mut ties.hash[v as usize];
                *hash = hash.wrapping_add(signatures.corner(corner));
            });
        }
        let sorted = ties.resolve();
        vertex_source = sorted.iter().map(|&i| vertex_source[i as usize]).collect();
        let mut place = vec![0_u32; sorted.len()];
        sorted.iter().zip(0..).for_each(|(&old, new)| place[old as usize] = new);
        usable.iter_mut().for_each(|(_, t)| *t = t.map(|v| place[v as usize]));
    }
    let mut turned = sorted(usable, vertex_source.len());
    let has_repeated = turned.windows(2).any(|pair| pair[0].0 == pair[1].0);
    if has_repeated && let Some(signatures) = signatures() {
        turned.sort_by_cached_key(|&(t, corner)| (t, signatures.triangle(corner), corner));
    }
    let ordered = Ordered {
        cells: vertex_source.par_iter().map(|&v| grid.cell(mesh.positions()[v as usize])).collect(),
        vertex_source,
        corner_source: turned.iter().map(|&(_, corner)| corner).collect(),
    };
    // Collected in place they would keep the room of the corners.
    let mut triangles = Vec::with_capacity(turned.len());
    triangles.extend(turned.into_iter().map(|(t, _)| t));
    (ordered, triangles)
}

/// Triangles from their smallest vertex on, ascending, each with the corner there.
fn sorted(usable: Vec<(u32, [u32; 3])>, num_vertices: usize) -> Vec<([u32; 3], u32)> {
    // Few share their first vertex: they are counted out by it, and each group is put in order.
    let turned: Vec<([u32; 3], u32)> = usable.par_iter().map(|&(face, t)| turned(t, face)).collect();
    drop(usable);
    let mut ends = vec![0_u32; num_vertices + 1];
    turned.iter().for_each(|&([v, ..], _)| ends[v as usize + 1] += 1);
    (0..num_vertices).for_each(|v| ends[v + 1] += ends[v]);
    let mut sorted = vec![([0; 3], 0); turned.len()];
    for triangle in turned {
        let end = &mut ends[triangle.0[0] as usize];
        sorted[*end as usize] = triangle;
        *end += 1;
    }
    sorted.chunk_by_mut(|(t, _), (u, _)| t[0] == u[0]).for_each(<[_]>::sort_unstable);
    sorted
}

/// A triangle from its smallest vertex on, and which corner that is.
fn turned(t: [u32; 3], face: u32) -> ([u32; 3], u32) {
    let first = (0..3).min_by_key(|&i| t[i]).unwrap_or(0);
    ([t[first], t[(first + 1) % 3], t[(first + 2) % 3]], 3 * face + first as u32)
}

/// Vertices of equal cells, told apart by what is around them.
struct Ties<'a> {
    triangles: &'a [[u32; 3]],
    codes: Vec<u128>,
    hash: Vec<u64>,
    /// Vertices by code, then hash, then index.
    order: Vec<u32>,
}

/// Rounds in which all vertices look at their neighbours, before it is seen whether that tells more apart;
/// a multiple of them at most.
const ROUNDS: usize = 4;
const MOST_ROUNDS: usize = 16 * ROUNDS;
/// Vertices that may be looked at to tell the rest apart, times the vertices there are.
const BUDGET: usize = 100;
/// Triangles and vertices that may be looked at in any case.
const SMALL_WORK: usize = 1 << 25;

impl<'a> Ties<'a> {
    /// `codes` ascend.
    fn new(codes: Vec<u128>, triangles: &'a [[u32; 3]]) -> Self {
        let hash = codes.iter().map(|&code| mix((code >> 64) as u64 ^ mix(code as u64))).collect();
        let order = (0..codes.len() as u32).collect();
        Self { triangles, codes, hash, order }
    }

    fn resolve(mut self) -> Vec<u32> {
        let mut num_kinds = 0;
        for round in 1..=MOST_ROUNDS.max(SMALL_WORK / self.triangles.len()) {
            let mut sum = vec![0_u64; self.hash.len()];
            for &[a, b, c] in self.triangles {
                for [v, n, p] in [[a, b, c], [b, c, a], [c, a, b]] {
                    let sum = &mut sum[v as usize];
                    *sum = sum.wrapping_add(self.corner(n, p));
                }
            }
            self.hash.iter_mut().zip(sum).for_each(|(hash, sum)| *hash = mix(*hash ^ mix(sum)));
            if round % ROUNDS == 0 {
                self.sort();
                let before = std::mem::replace(&mut num_kinds, self.num_kinds());
                if num_kinds == self.order.len() || num_kinds == before {
                    break;
                }
            }
        }
        if self.first_tie(0).is_some() {
            self.tell_apart();
        }
        self.order
    }

    /// What a corner tells the vertex at it: its two other vertices, in their order.
    fn corner(&self, n: u32, p: u32) -> u64 {
        mix(self.hash[n as usize].rotate_left(20).wrapping_add(mix(self.hash[p as usize])))
    }

    /// Vertices that look different, once they are sorted.
    fn num_kinds(&self) -> usize {
        let look = |v: u32| (self.codes[v as usize], self.hash[v as usize]);
        1 + self.order.windows(2).filter(|pair| look(pair[0]) != look(pair[1])).count()
    }

    fn key(&self, v: u32) -> (u128, u64, u32) {
        (self.codes[v as usize], self.hash[v as usize], v)
    }

    fn sort(&mut self) {
        let mut order = std::mem::take(&mut self.order);
        order.sort_unstable_by_key(|&v| self.key(v));
        self.order = order;
    }

    /// The first place from `start` on whose vertex looks like the next one.
    fn first_tie(&self, start: usize) -> Option<usize> {
        let look = |i: usize| (self.codes[self.order[i] as usize], self.hash[self.order[i] as usize]);
        (start..self.order.len().saturating_sub(1)).find(|&i| look(i) == look(i + 1))
    }

    /// Marks the first vertex of a tie, and lets all vertices that are connected with it know how they lie
    /// to it, until there is no tie. Of vertices that a symmetry of the mesh maps to each other any may be
    /// the first.
    fn tell_apart(&mut self) {
        let corners = CornersAt::new(self.triangles, self.hash.len());
        let mut budget = (BUDGET * self.hash.len()).max(SMALL_WORK);
        let mut seen = vec![0_u32; self.hash.len()];
        let mut start = 0;
        for stamp in 1.. {
            let Some(tie) = self.first_tie(start) else { return };
            let marked = self.order[tie];
            self.hash[marked as usize] = mix(!self.hash[marked as usize]);
            seen[marked as usize] = stamp;
            let mut changed = vec![marked];
            let mut rings = Vec::new();
            let mut ring = 0..1;
            while !ring.is_empty() {
                for i in ring.clone() {
                    for &corner in corners.at(changed[i]) {
                        for &v in &self.triangles[(corner / 3) as usize] {
                            if seen[v as usize] != stamp {
                                seen[v as usize] = stamp;
                                changed.push(v);
                            }
                        }
                    }
                }
                ring = ring.end..changed.len();
                self.look_around(&changed[ring.clone()], &corners);
                rings.push(ring.clone());
            }
            // Again from near to far, as long as that tells more apart.
            let mut num_kinds = 0;
            loop {
                rings.iter().for_each(|ring| self.look_around(&changed[ring.clone()], &corners));
                let mut kinds: Vec<u64> = changed.iter().map(|&v| self.hash[v as usize]).collect();
                kinds.sort_unstable();
                kinds.dedup();
                let before = std::mem::replace(&mut num_kinds, kinds.len());
                let Some(left) = budget.checked_sub(changed.len()) else { return };
                budget = left;
                if num_kinds == changed.len() || num_kinds == before {
                    break;
                }
            }
            start = self.sort_some(&changed).min(tie);
        }
    }

    /// All of some vertices at once, so that their order does not matter.
    fn look_around(&mut self, vertices: &[u32], corners: &CornersAt) {
        let hashes: Vec<u64> = vertices.iter().map(|&v| self.around(v, corners)).collect();
        vertices.iter().zip(hashes).for_each(|(&v, hash)| self.hash[v as usize] = hash);
    }

    fn around(&self, v: u32, corners: &CornersAt) -> u64 {
        let tell = |&corner: &u32| {
            let (t, i) = (self.triangles[(corner / 3) as usize], (corner % 3) as usize);
            self.corner(t[(i + 1) % 3], t[(i + 2) % 3])
        };
        let sum = corners.at(v).iter().map(tell).fold(0_u64, u64::wrapping_add);
        mix(self.hash[v as usize] ^ mix(sum))
    }

    /// Sorts the runs of equal codes anew that have one of `changed`; the first place of the first of them.
    fn sort_some(&mut self, changed: &[u32]) -> usize {
        let mut codes: Vec<u128> = changed.iter().map(|&v| self.codes[v as usize]).collect();
        codes.sort_unstable();
        codes.dedup();
        let first_run = codes.first().map_or(0, |&code| self.codes.partition_point(|&c| c < code));
        let mut order = std::mem::take(&mut self.order);
        for code in codes {
            // Vertices were numbered by code, so that a run keeps its places.
            let first = self.codes.partition_point(|&c| c < code);
            let end = self.codes.partition_point(|&c| c <= code);
            order[first..end].sort_unstable_by_key(|&v| self.key(v));
        }
        self.order = order;
        first_run
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Triangles in cells of each vertex and the order of equal cells: what the bytes depend on.
    fn ordered(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> (Vec<[i32; 3]>, Vec<[u32; 3]>) {
        let mesh = TriMesh::new(positions.to_vec(), triangles.to_vec()).unwrap();
        let grid = Grid { precision: 4, origin: [0.0; 3], side: 15.0 };
        let (ordered, triangles) = order(&mesh, &grid, &|| None);
        for (t, &corner) in triangles.iter().zip(&ordered.corner_source) {
            let source = mesh.triangles()[(corner / 3) as usize];
            let turned = [0, 1, 2].map(|i| source[(corner as usize + i) % 3]);
            assert_eq!(t.map(|v| ordered.vertex_source[v as usize]), turned);
        }
        (ordered.cells, triangles)
    }

    #[test]
    fn shuffling_changes_nothing_even_where_all_cells_are_equal() {
        // Two octahedra at one place, and a strip that goes over itself.
        let octahedron =
            [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1], [5, 2, 1], [5, 3, 2], [5, 4, 3], [5, 1, 4]];
        let mut triangles: Vec<[u32; 3]> = octahedron.to_vec();
        triangles.extend(octahedron.map(|t| t.map(|v| v + 6)));
        triangles.extend([[12, 13, 14], [14, 13, 15], [14, 15, 16], [1, 1, 2]]);
        for place in [[3.0; 3], [0.0; 3]] {
            let positions = [place; 18];
            let wanted = ordered(&positions, &triangles);
            assert_eq!(wanted.0.len(), 17);
            let mut seed = 1_u64;
            for _ in 0..50 {
                let mut name: Vec<u32> = (0..18).collect();
                let mut shuffled = triangles.clone();
                let mut random = |n: usize| {
                    seed = mix(seed);
                    (seed % n as u64) as usize
                };
                (1..18).for_each(|i| name.swap(i, random(i + 1)));
                (1..shuffled.len()).for_each(|i| shuffled.swap(i, random(i + 1)));
                shuffled.iter_mut().for_each(|t| t.rotate_left(random(3)));
                shuffled.iter_mut().flatten().for_each(|v| *v = name[*v as usize]);
                assert_eq!(ordered(&positions, &shuffled), wanted);
            }
        }
    }
}
