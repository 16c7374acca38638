//! The nearest point on a set of triangles, exactly.
//!
//! A binary tree of bounding boxes in one flat array, each node followed by its left subtree. The number of
//! triangles alone gives the shape of the tree, so both halves can be built at once. A search goes into the
//! nearer box first and leaves out boxes that are farther away than the best triangle so far. Where that helps, a box
//! is turned (`oriented.rs`).

use super::bounds::bounds;
use super::oriented::OrientedBox;
use crate::mesh::triangle::squared_distance;
use glam::DVec3;

/// Triangles in a leaf; only the last leaf has fewer.
const LEAF_TRIANGLES: usize = 4;

/// Fewer triangles than this are not worth another thread.
const MIN_PARALLEL_TRIANGLES: usize = 8192;

/// More than the depth of any tree over 2^32 triangles.
const MAX_DEPTH: usize = 40;

/// A search structure over triangles, degenerate ones included.
pub(super) struct NearestTriangle {
    nodes: Vec<Node>,
    /// In the order of the leaves.
    triangles: Vec<[DVec3; 3]>,
}

#[derive(Clone, Default)]
struct Node {
    low: DVec3,
    high: DVec3,
    turned: Option<Box<OrientedBox>>,
    /// Triangles below: `begin..begin + count`. A leaf has at most [`LEAF_TRIANGLES`].
    begin: u32,
    count: u32,
}

/// The answer to a search.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    /// Squared distance.
    pub squared: f64,
    /// The triangle, as a hint for the next search.
    pub triangle: usize,
}

impl NearestTriangle {
    /// `triangles` must not be empty.
    pub fn new(triangles: &[[DVec3; 3]]) -> Self {
        assert!(!triangles.is_empty(), "no triangle to be near to");
        let mut triangles = triangles.to_vec();
        let mut nodes = vec![Node::default(); num_nodes(triangles.len())];
        build(&mut triangles, &mut nodes, 0);
        Self { nodes, triangles }
    }

    /// In the order that [`Nearest`] names them by.
    pub fn triangles(&self) -> &[[DVec3; 3]] {
        &self.triangles
    }

    /// The triangle nearest to `point`. `hint` is any triangle; one that is near makes the search shorter. What is
    /// below `noise`, squared, need not be the nearest. Takes the nodes it visits off `steps`; `None` where they do
    /// not suffice.
    pub fn nearest(&self, point: DVec3, hint: usize, noise: f64, steps: &mut usize) -> Option<Nearest> {
        let mut best = Nearest { squared: squared_distance(point, &self.triangles[hint]), triangle: hint };
        let mut waiting = [(0, 0.0); MAX_DEPTH];
        let mut num_waiting = 1;
        while num_waiting > 0 && best.squared >= noise {
            *steps = steps.checked_sub(1)?;
            num_waiting -= 1;
            let (at, box_squared) = waiting[num_waiting];
            if box_squared >= best.squared {
                continue;
            }
            let node = &self.nodes[at];
            let begin = node.begin as usize;
            let count = node.count as usize;
            if count <= LEAF_TRIANGLES {
                for (k, triangle) in self.triangles[begin..begin + count].iter().enumerate() {
                    let squared = squared_distance(point, triangle);
                    if squared < best.squared {
                        best = Nearest { squared, triangle: begin + k };
                    }
                }
                continue;
            }
            let left = at + 1;
            let right = left + num_nodes(num_left(count));
            let children = [left, right].map(|child| (child, self.nodes[child].squared_distance(point)));
            let is_left_nearer = children[0].1 <= children[1].1;
            let (nearer, farther) =
                if is_left_nearer { (children[0], children[1]) } else { (children[1], children[0]) };
            waiting[num_waiting] = farther;
            waiting[num_waiting + 1] = nearer;
            num_waiting += 2;
        }
        Some(best)
    }
}

impl Node {
    fn squared_distance(&self, point: DVec3) -> f64 {
        let squared = (self.low - point).max(point - self.high).max(DVec3::ZERO).length_squared();
        self.turned.as_ref().map_or(squared, |turned| squared.max(turned.squared_distance(point)))
    }
}

/// Nodes of a tree over `count` triangles: every leaf but the last is full.
fn num_nodes(count: usize) -> usize {
    2 * count.div_ceil(LEAF_TRIANGLES) - 1
}

/// How many of `count` triangles go to the left: half of the leaves.
fn num_left(count: usize) -> usize {
    count.div_ceil(LEAF_TRIANGLES) / 2 * LEAF_TRIANGLES
}

/// Sorts `triangles`, which begin at `begin` of all, into the leaves of the tree in `nodes`.
fn build(triangles: &mut [[DVec3; 3]], nodes: &mut [Node], begin: usize) {
    let (low, high) = bounds(triangles.as_flattened().iter().copied());
    let count = triangles.len();
    nodes[0] = Node { low, high, turned: None, begin: begin as u32, count: count as u32 };
    if count <= LEAF_TRIANGLES {
        nodes[0].turned = OrientedBox::around(triangles, low, high).map(Box::new);
        return;
    }
    // Three times the centre of a triangle serves as well as the centre.
    let centre = |t: &[DVec3; 3]| t[0] + t[1] + t[2];
    let (first, last) = bounds(triangles.iter().map(centre));
    let axis = (last - first).max_position();
    let num_left = num_left(count);
    triangles.select_nth_unstable_by(num_left, |s, t| centre(s)[axis].total_cmp(&centre(t)[axis]));
    // The one in the middle is now typical of them.
    nodes[0].turned = OrientedBox::around(triangles, low, high).map(Box::new);
    let (left, right) = triangles.split_at_mut(num_left);
    let (left_nodes, right_nodes) = nodes[1..].split_at_mut(num_nodes(num_left));
    let mut build_left = || build(left, left_nodes, begin);
    let mut build_right = || build(right, right_nodes, begin + num_left);
    if count >= MIN_PARALLEL_TRIANGLES {
        rayon::join(build_left, build_right);
    } else {
        build_left();
        build_right();
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A fixed sequence of points in the unit cube.
    pub(in super::super) fn points(count: usize) -> Vec<DVec3> {
        let mut state = 1_u64;
        let mut unit = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..count).map(|_| DVec3::new(unit(), unit(), unit())).collect()
    }

    #[test]
    fn the_tree_finds_what_brute_force_finds() {
        for count in [1, 2, 4, 5, 8, 9, 31, 100, 1000, 20_000] {
            let corners = points(3 * count);
            // Some small, some large, some degenerate, some all the same.
            let shape = |(k, t): (usize, &[DVec3; 3])| match k % 6 {
                5 => [t[0], t[1], t[1] + 0.001 * t[2]],
                0 => t.map(|p| t[0] + 0.05 * p),
                1 => [t[0], t[0], t[1]],
                2 => [t[0]; 3],
                3 => [DVec3::ONE; 3],
                _ => *t,
            };
            let triangles: Vec<_> = corners.as_chunks::<3>().0.iter().enumerate().map(shape).collect();
            let tree = NearestTriangle::new(&triangles);
            for (k, point) in points(if count > 1000 { 10 } else { 200 }).into_iter().enumerate() {
                let point = 3.0 * point - DVec3::ONE;
                let expected =
                    triangles.iter().map(|t| squared_distance(point, t)).fold(f64::INFINITY, f64::min);
                let found = tree.nearest(point, k * 7919 % count, 0.0, &mut usize::MAX.clone()).unwrap();
                assert!((found.squared - expected).abs() <= 1e-15, "{count} triangles, point {k}");
                assert_eq!(found.squared, squared_distance(point, &tree.triangles[found.triangle]));
            }
        }
    }
}
