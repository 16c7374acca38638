//! A walk over all half-edges of a decoded mesh, independent of the library's own.
#![allow(dead_code)]

use lwc::LevelMesh;
use std::collections::HashMap;

/// Panics unless the mesh is an oriented surface: indices in range, three different ones per
/// triangle, each directed edge once, one fan of triangles at each vertex, no vertex without one, and
/// every cell on the grid of its precision.
#[track_caller]
pub fn assert_valid(mesh: LevelMesh, what: &str) {
    let limit = 1_i64 << mesh.quantization_bits();
    let on_grid = |c: &i32| (0..limit).contains(&i64::from(*c));
    assert!(mesh.quantized_positions().iter().flatten().all(on_grid), "{what}: a cell off the grid");

    // The vertex that follows `to` around `from`: triangle (from, to, next).
    let mut around = HashMap::new();
    let mut num_corners = vec![0_usize; mesh.num_vertices()];
    let mut first = vec![None; mesh.num_vertices()];
    for &[a, b, c] in mesh.triangles() {
        assert!(a != b && b != c && c != a, "{what}: a degenerate triangle");
        for [from, to, next] in [[a, b, c], [b, c, a], [c, a, b]] {
            assert!((from as usize) < mesh.num_vertices(), "{what}: vertex {from} does not exist");
            assert_eq!(around.insert((from, to), next), None, "{what}: edge {from} to {to} twice");
            num_corners[from as usize] += 1;
            first[from as usize] = Some(to);
        }
    }
    let before: HashMap<(u32, u32), u32> =
        around.iter().map(|(&(from, to), &next)| ((from, next), to)).collect();
    for v in 0..mesh.num_vertices() as u32 {
        let start = first[v as usize].unwrap_or_else(|| panic!("{what}: vertex {v} is unused"));
        // Back to the boundary or all around, then forward again, counting.
        let mut begin = start;
        while let Some(&to) = before.get(&(v, begin)) {
            begin = to;
            if begin == start {
                break;
            }
        }
        let (mut to, mut count) = (begin, 0);
        while let Some(&next) = around.get(&(v, to)) {
            count += 1;
            to = next;
            if to == begin {
                break;
            }
        }
        assert_eq!(count, num_corners[v as usize], "{what}: vertex {v} has several fans");
    }
}
