//! Odd and even: Algorithm 1 against a slow, literal transcription, and what holds of every partition.
#![cfg(feature = "encoder")]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

mod common;

use common::exact::{CellTriangle, canonical, cell_triangles};
use common::kinds::{beside, every_kind};
use common::*;
use lwc::descriptors::{Descriptor, Window, evaluate, mean_edge_length};
use lwc::{Decoder, EncodeOptions, Limits, Partition, PassKind, TriMesh, encode};
use std::collections::{BTreeMap, BTreeSet};

/// A mesh as sets, for the letter of the paper: no adjacency, no incremental anything.
#[derive(Clone)]
struct Literal {
    positions: Vec<[f64; 3]>,
    cells: Vec<[i64; 3]>,
    triangles: Vec<[u32; 3]>,
}

impl Literal {
    fn faces_at(&self, v: u32) -> Vec<[u32; 3]> {
        self.triangles.iter().copied().filter(|t| t.contains(&v)).collect()
    }

    fn one_ring(&self, v: u32) -> BTreeSet<u32> {
        self.faces_at(v).into_iter().flatten().filter(|&u| u != v).collect()
    }

    /// Corners opposite the edge in the faces that have it.
    fn far_corners(&self, v: u32, u: u32) -> Vec<u32> {
        let faces = self.faces_at(v).into_iter().filter(|t| t.contains(&u));
        faces.flatten().filter(|&a| a != v && a != u).collect()
    }

    fn is_boundary_edge(&self, a: u32, b: u32) -> bool {
        self.far_corners(a, b).len() == 1
    }

    fn is_boundary_vertex(&self, v: u32) -> bool {
        self.one_ring(v).iter().any(|&u| self.is_boundary_edge(v, u))
    }

    /// The faces at v, turned to start there, follow each other around it once.
    fn is_one_fan(&self, v: u32) -> bool {
        let turned = |t: [u32; 3]| {
            let i = t.iter().position(|&u| u == v).unwrap();
            (t[(i + 1) % 3], t[(i + 2) % 3])
        };
        let follows: BTreeMap<u32, u32> = self.faces_at(v).into_iter().map(turned).collect();
        let arrived: BTreeSet<u32> = follows.values().copied().collect();
        let start = follows.keys().copied().find(|u| !arrived.contains(u));
        let mut u = start.or(follows.keys().copied().next()).unwrap();
        let first = u;
        let mut count = 0;
        while let Some(&next) = follows.get(&u) {
            count += 1;
            u = next;
            if u == first {
                break;
            }
        }
        count == self.faces_at(v).len() && follows.len() == count && arrived.len() == count
    }

    fn cross(&self, t: [u32; 3]) -> [i128; 3] {
        let [a, b, c] = t.map(|v| self.cells[v as usize].map(i128::from));
        let d = |p: [i128; 3]| [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
        let (p, q) = (d(b), d(c));
        [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
    }

    /// The four rules of section 6, one after the other.
    fn is_legal(&self, v: u32, u: u32) -> bool {
        if !self.is_one_fan(v) {
            return false;
        }
        let far: BTreeSet<u32> = self.far_corners(v, u).into_iter().collect();
        let common: BTreeSet<u32> = self.one_ring(v).intersection(&self.one_ring(u)).copied().collect();
        if common != far {
            return false;
        }
        let sorted = |mut t: [u32; 3]| {
            t.sort_unstable();
            t
        };
        let changed: Vec<[u32; 3]> = self.faces_at(v).into_iter().filter(|t| !t.contains(&u)).collect();
        let moved = |t: [u32; 3]| t.map(|w| if w == v { u } else { w });
        let others: BTreeSet<[u32; 3]> =
            self.triangles.iter().filter(|t| !t.contains(&v)).map(|&t| sorted(t)).collect();
        if changed.iter().any(|&t| others.contains(&sorted(moved(t)))) {
            return false;
        }

        let on_boundary = self.is_boundary_edge(v, u);
        if self.is_boundary_vertex(v) && !on_boundary {
            return false;
        }
        if far.iter().any(|&a| self.is_boundary_edge(v, a) && self.is_boundary_edge(u, a)) {
            return false;
        }

        changed.iter().all(|&t| {
            let (before, after) = (self.cross(t), self.cross(moved(t)));
            let dot: i128 = (0..3).map(|i| before[i] * after[i]).sum();
            before == [0; 3] || dot > 0 && after != [0; 3]
        })
    }

    /// The nearest neighbour that `v` may collapse into.
    fn target(&self, v: u32) -> Option<u32> {
        let length = |u: u32| -> f64 {
            let (p, q) = (self.positions[v as usize], self.positions[u as usize]);
            (0..3).map(|i| (p[i] - q[i]) * (p[i] - q[i])).sum()
        };
        let mut ring: Vec<u32> = self.one_ring(v).into_iter().collect();
        ring.sort_by(|&a, &b| length(a).total_cmp(&length(b)).then(a.cmp(&b)));
        ring.into_iter().find(|&u| self.is_legal(v, u))
    }

    fn collapse(&mut self, v: u32, u: u32) {
        self.triangles.retain(|t| !(t.contains(&v) && t.contains(&u)));
        self.triangles.iter_mut().flatten().filter(|w| **w == v).for_each(|w| *w = u);
    }

    fn vertices(&self) -> Vec<u32> {
        let used: BTreeSet<u32> = self.triangles.iter().flatten().copied().collect();
        used.into_iter().collect()
    }

    fn scores(&self, descriptor: Descriptor, window: &Window, mean_edge: f64) -> Vec<f64> {
        let vertices = self.vertices();
        let name: BTreeMap<u32, u32> = vertices.iter().zip(0..).map(|(&v, i)| (v, i)).collect();
        let positions = vertices.iter().map(|&v| self.positions[v as usize]).collect();
        let mesh = build(positions, self.triangles.iter().map(|t| t.map(|v| name[&v])).collect());
        evaluate(descriptor, &mesh, window, mean_edge)
    }

    /// Algorithm 1. Returns the odd vertices, or `None` if the order of two vertices is up to rounding
    /// errors: neighbours whose windows hold the same vertices have the same value in theory.
    fn remove_level(
        &mut self,
        descriptor: Descriptor,
        window: &Window,
        mean_edge: f64,
    ) -> Option<BTreeSet<u32>> {
        let scores = self.scores(descriptor, window, mean_edge);
        let mut order: Vec<(f64, u32)> = scores.into_iter().zip(self.vertices()).collect();
        order.sort_by(|a, b| a.partial_cmp(b).unwrap());
        let is_close =
            |pair: &[(f64, u32)]| pair[0].0 < pair[1].0 && pair[1].0 - pair[0].0 < 1e-12 * pair[1].0;
        if order.windows(2).any(is_close) {
            return None;
        }
        let (mut odd, mut even) = (BTreeSet::new(), BTreeSet::new());
        for (_, v) in order {
            if even.contains(&v) {
                continue;
            }
            if let Some(u) = self.target(v) {
                odd.insert(v);
                even.extend(self.one_ring(v));
                self.collapse(v, u);
            }
        }
        Some(odd)
    }

    fn cell_triangles(&self) -> Vec<CellTriangle> {
        canonical(self.triangles.iter().map(|t| t.map(|v| self.cells[v as usize])))
    }
}

const PRECISION: u32 = 24;

/// All vertices on the grid of the codec: every one is used, and they are distinct.
fn literal(mesh: &TriMesh) -> Literal {
    let (low, high) = mesh.bounding_box().unwrap();
    let side = (0..3).map(|i| high[i] - low[i]).fold(0.0, f64::max);
    let steps = f64::from((1 << PRECISION) - 1);
    let cell = |p: &[f64; 3]| std::array::from_fn(|i| ((p[i] - low[i]) * steps / side + 0.5).floor() as i64);
    let cells: Vec<[i64; 3]> = mesh.positions().iter().map(cell).collect();
    let distinct: BTreeSet<_> = cells.iter().collect();
    assert_eq!(distinct.len(), cells.len(), "vertices share a cell");
    Literal { positions: mesh.positions().to_vec(), cells, triangles: mesh.triangles().to_vec() }
}

fn options(partition: Partition, descriptor: Descriptor, levels: u32) -> EncodeOptions {
    let mut options = EncodeOptions::default();
    options.partition = partition;
    options.descriptor = descriptor;
    options.levels = Some(levels);
    options.quantization_bits = PRECISION;
    // Every level at full precision, so that cells tell vertices apart.
    options.steps_per_edge = Some(1e9);
    options
}

/// Cells and triangles of a decoded mesh.
type Decoded = (Vec<[i64; 3]>, Vec<[u32; 3]>);

/// The decoded meshes, coarsest first.
fn levels(stream: &[u8]) -> Vec<Decoded> {
    let mut decoder = Decoder::new(Limits::default());
    decoder.feed(stream).unwrap();
    let mut levels = Vec::new();
    while let Some(update) = decoder.step().unwrap() {
        assert_ne!(update.pass.kind, PassKind::Refine, "full precision from the start");
        let mesh = decoder.mesh().unwrap();
        let cells = mesh.quantized_positions().iter().map(|c| c.map(i64::from)).collect();
        levels.push((cells, mesh.triangles().to_vec()));
    }
    levels
}

/// The mesh on the grid, vertices by the Morton code of their cells, triangles from their smallest vertex on
/// and ascending: what the encoder looks at. No two vertices may share a cell.
fn in_order_of_encoder(mesh: &TriMesh, quantization_bits: u32) -> TriMesh {
    let (low, high) = mesh.bounding_box().unwrap();
    let side = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max);
    let steps = 2f64.powi(quantization_bits as i32) - 1.0;
    let cell = |p: &[f64; 3]| -> [u64; 3] {
        std::array::from_fn(|axis| ((p[axis] - low[axis]) * steps / side + 0.5).floor() as u64)
    };
    let code = |cell: [u64; 3]| {
        (0..quantization_bits)
            .rev()
            .flat_map(|bit| cell.map(|c| c >> bit & 1))
            .fold(0_u128, |code, b| code << 1 | u128::from(b))
    };
    let mut order: Vec<(u128, [u64; 3], usize)> =
        mesh.positions().iter().map(cell).enumerate().map(|(v, cell)| (code(cell), cell, v)).collect();
    order.sort_unstable();
    assert!(order.windows(2).all(|pair| pair[0].0 < pair[1].0), "two vertices share a cell");
    let mut name = vec![0_u32; order.len()];
    order.iter().zip(0..).for_each(|(&(.., v), i)| name[v] = i);
    let turned = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| name[v as usize]);
        [a, b, c].min([b, c, a]).min([c, a, b])
    };
    let mut triangles: Vec<[u32; 3]> = mesh.triangles().iter().map(turned).collect();
    triangles.sort_unstable();
    let scale = 2f64.powi(quantization_bits as i32);
    build(order.iter().map(|&(_, cell, _)| cell.map(|c| c as f64 / scale)).collect(), triangles)
}

/// Follows the encoder down its levels with the transcription. Returns how many it could follow.
fn assert_follows_the_letter(what: &str, mesh: &TriMesh, options: &EncodeOptions) -> usize {
    let what = format!("{what}, {}", options.descriptor);
    let stream = encode(mesh, options).unwrap().bytes;
    let levels = levels(&stream);
    assert!(levels.len() > 2, "{what}: only {} levels", levels.len());
    let mesh = &in_order_of_encoder(mesh, options.quantization_bits);
    let mut slow = literal(mesh);
    let vertex_at: BTreeMap<[i64; 3], u32> = slow.cells.iter().zip(0..).map(|(&c, v)| (c, v)).collect();
    let mut window = options.window;
    for (depth, pair) in levels.windows(2).rev().enumerate() {
        let [coarse, fine] = pair else { unreachable!() };
        let odd = slow.remove_level(options.descriptor, &window, mean_edge_length(mesh));
        let Some(odd) = odd else { return depth };
        window.radius *= options.growth;
        let found: BTreeSet<u32> = fine.0[coarse.0.len()..].iter().map(|c| vertex_at[c]).collect();
        let (missing, extra): (Vec<_>, Vec<_>) =
            (odd.difference(&found).collect(), found.difference(&odd).collect());
        assert!(
            missing.is_empty() && extra.is_empty(),
            "{what}, step {depth}: {missing:?} even, {extra:?} odd"
        );
        let triangles = canonical(coarse.1.iter().map(|t| t.map(|v| coarse.0[v as usize])));
        assert!(triangles == slow.cell_triangles(), "{what}, step {depth}: other coarse triangles");
    }
    levels.len() - 1
}

fn bumpy(x: f64, y: f64) -> f64 {
    0.6 * (0.7 * x).sin() * (0.5 * y).cos()
}

/// The same mesh with its vertices in another order.
fn shuffled(mesh: &TriMesh, seed: u64) -> TriMesh {
    let mut random = Random(seed);
    let mut order: Vec<(u64, usize)> = (0..mesh.num_vertices()).map(|v| (random.next(), v)).collect();
    order.sort_unstable();
    let mut name = vec![0; order.len()];
    order.iter().zip(0..).for_each(|(&(_, v), i)| name[v] = i);
    let positions = order.iter().map(|&(_, v)| mesh.positions()[v]).collect();
    build(positions, mesh.triangles().iter().map(|t| t.map(|v| name[v as usize])).collect())
}

#[test]
fn algorithm_1_is_followed_on_noisy_meshes() {
    let mut total = 0;
    for (what, mesh) in [
        ("sphere", noisy(sphere(3), 1, 0.02)),
        ("torus", noisy(torus(18, 8), 2, 0.03)),
        ("open grid", noisy(grid(13, 11, bumpy), 3, 0.15)),
        ("strip", noisy(strip(60), 4, 0.05)),
        ("genus 3", noisy(genus3(), 5, 0.02)),
        ("cylinder", noisy(cylinder(9, 7), 6, 0.03)),
        ("components", beside(noisy(sphere(1), 7, 0.05), noisy(grid(6, 5, bumpy), 8, 0.1))),
    ] {
        for descriptor in Descriptor::ALL {
            let options = options(Partition::Algorithm1, descriptor, 6);
            total += assert_follows_the_letter(what, &mesh, &options);
        }
    }
    assert!(total > 180, "only {total} levels");
}

#[test]
fn algorithm_1_is_followed_with_other_windows() {
    let mesh = noisy(grid(12, 12, bumpy), 9, 0.2);
    for (rings, radius, growth) in [(1, 2.0, 1.0), (2, 50.0, 2.0), (6, 2.2, 1.2)] {
        let mut options = options(Partition::Algorithm1, Descriptor::Casorati, 5);
        options.window.rings = rings;
        options.window.radius = radius;
        options.growth = growth;
        assert!(assert_follows_the_letter("grid", &mesh, &options) >= 3);
    }
}

/// Where all values and many lengths are equal, the index in the encoder's order decides.
#[test]
fn ties_break_by_the_index_in_the_order_of_cells() {
    let flat = grid(11, 9, |_, _| 0.0);
    assert_follows_the_letter("flat grid", &flat, &options(Partition::Algorithm1, Descriptor::Harris3d, 4));
    for seed in 0..3 {
        let mesh = shuffled(&flat, seed);
        assert_follows_the_letter(
            "shuffled",
            &mesh,
            &options(Partition::Algorithm1, Descriptor::Harris3d, 4),
        );
    }
}

#[test]
fn no_untagged_vertex_could_still_be_removed() {
    for (what, mesh) in [
        ("sphere", noisy(sphere(3), 1, 0.03)),
        ("open grid", noisy(grid(20, 17, bumpy), 2, 0.2)),
        ("genus 3", noisy(genus3(), 3, 0.02)),
    ] {
        let stream = encode(&mesh, &options(Partition::Algorithm1, Descriptor::default(), 8)).unwrap().bytes;
        let levels = levels(&stream);
        let mut kept = 0;
        for pair in levels.windows(2) {
            let [coarse, fine] = pair else { unreachable!() };
            let num_even = coarse.0.len() as u32;
            let touched: BTreeSet<u32> =
                fine.1.iter().filter(|t| t.iter().any(|&v| v >= num_even)).flatten().copied().collect();
            let positions = coarse.0.iter().map(|c| c.map(|x| x as f64)).collect();
            let slow = Literal { positions, cells: coarse.0.clone(), triangles: coarse.1.clone() };
            for v in (0..num_even).filter(|v| !touched.contains(v)) {
                assert_eq!(slow.target(v), None, "{what}: vertex {v} of {num_even} could go");
                kept += 1;
            }
        }
        println!("{what}: {kept} vertices untouched over {} levels", levels.len() - 1);
    }
}

#[test]
fn no_two_odd_vertices_are_adjacent() {
    for (what, mesh) in every_kind() {
        for partition in Partition::ALL {
            for descriptor in [Descriptor::Harris3d, Descriptor::Sqem] {
                let stream = encode(&mesh, &options(partition, descriptor, 20)).unwrap().bytes;
                let levels = levels(&stream);
                for pair in levels.windows(2) {
                    let num_even = pair[0].0.len() as u32;
                    assert!(pair[1].0.len() as u32 > num_even, "{what}: a level without vertices");
                    for triangle in &pair[1].1 {
                        let odd = triangle.iter().filter(|&&v| v >= num_even).count();
                        assert!(odd <= 1, "{what}, {}: {triangle:?} of {num_even}", partition.name());
                    }
                }
            }
        }
    }
}

#[test]
fn a_quarter_is_odd() {
    let mesh = noisy(sphere(4), 1, 0.01);
    for descriptor in Descriptor::ALL {
        let mut options = options(Partition::Algorithm1, descriptor, 6);
        options.quantization_bits = 14;
        let info = encode(&mesh, &options).unwrap().info;
        for pair in info.passes().windows(2).filter(|pair| pair[0].vertices > 300) {
            let share = f64::from(pair[1].vertices - pair[0].vertices) / f64::from(pair[1].vertices);
            assert!((0.2..=0.3).contains(&share), "{descriptor}, level {}: {share:.3}", pair[1].level);
        }
    }
}

#[test]
fn descriptors_choose_differently() {
    let mesh = noisy(grid(24, 24, bumpy), 5, 0.1);
    let streams: BTreeSet<Vec<CellTriangle>> = Descriptor::ALL
        .into_iter()
        .map(|descriptor| {
            let stream = encode(&mesh, &options(Partition::Algorithm1, descriptor, 3)).unwrap().bytes;
            let mut decoder = Decoder::new(Limits::default());
            decoder.feed(&stream).unwrap();
            decoder.step().unwrap();
            cell_triangles(decoder.mesh().unwrap())
        })
        .collect();
    assert_eq!(streams.len(), Descriptor::ALL.len());
}
