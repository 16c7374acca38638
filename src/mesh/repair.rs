//! From any index soup to a [`Surface`]: unusable faces dropped, non-manifold places cut into
//! sheets by repeating vertices.

use super::build::EdgeIndex;
use super::surface::{NO_CORNER, Surface, next, prev};
use super::tri_mesh::{TriMesh, has_three_vertices};

/// What had to be changed so that a mesh became an oriented surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RepairReport {
    /// Triangles dropped because they name a vertex twice.
    pub degenerate_triangles: usize,
    /// Vertices dropped because no triangle uses them.
    pub isolated_vertices: usize,
    /// Vertices repeated to cut the surface where more than two triangles meet at an edge, where
    /// neighbours run opposite ways round, or where several fans meet at a vertex.
    pub repeated_vertices: usize,
}

/// A mesh cut into an oriented surface.
pub(crate) struct Repaired {
    pub(crate) surface: Surface,
    /// For each vertex of `surface` the vertex of the mesh it stands for. Ascending, so that ties of
    /// Algorithm 1 break by the indices of the mesh.
    pub(crate) source: Vec<u32>,
    #[cfg_attr(not(any(feature = "experiment", test)), allow(dead_code))] // Only the experiment tells it.
    pub(crate) report: RepairReport,
}

/// Cuts `mesh` into sheets. Faces keep their order and their orientation.
pub(crate) fn repair(mesh: &TriMesh) -> Repaired {
    let triangles: Vec<[u32; 3]> =
        mesh.triangles().iter().filter(|t| has_three_vertices(t)).copied().collect();
    let degenerate_triangles = mesh.num_triangles() - triangles.len();

    let (surface, source) = cut(triangles, mesh.num_vertices());
    let mut used = vec![false; mesh.num_vertices()];
    source.iter().for_each(|&v| used[v as usize] = true);
    let used = used.iter().filter(|&&u| u).count();
    let report = RepairReport {
        degenerate_triangles,
        isolated_vertices: mesh.num_vertices() - used,
        repeated_vertices: source.len() - used,
    };
    Repaired { surface, source, report }
}

/// Cuts triangles of three different vertices each into sheets: the surface, whose faces keep their order and
/// rotation, and for each vertex of it the vertex it stands for, ascending.
pub(crate) fn cut(triangles: Vec<[u32; 3]>, num_vertices: usize) -> (Surface, Vec<u32>) {
    // Most meshes are a surface as they are.
    let triangles = match Surface::try_from_triangles(triangles, num_vertices) {
        Ok(surface) => return (surface, (0..num_vertices as u32).collect()),
        Err((triangles, _)) => triangles,
    };
    let mut opposite = pair_edges(&triangles, num_vertices);
    loop {
        let (cut, source) = name_fans(&triangles, &opposite);
        let clashing = clashing_faces(&cut, source.len());
        if clashing.is_empty() {
            // Fans are single and directed edges unique by now.
            if let Ok(surface) = Surface::from_triangles(cut, source.len()) {
                return (surface, source);
            }
            debug_assert!(false, "a cut mesh is an oriented surface");
            (0..triangles.len() as u32).for_each(|face| detach(&mut opposite, face));
            continue;
        }
        for face in clashing {
            detach(&mut opposite, face);
        }
    }
}

/// Matches every half-edge with one of opposite direction, in the order of the faces.
fn pair_edges(triangles: &[[u32; 3]], num_vertices: usize) -> Vec<u32> {
    let edges = EdgeIndex::new(triangles, num_vertices);
    let vertex = |corner: u32| triangles[(corner / 3) as usize][(corner % 3) as usize];
    let mut opposite = vec![NO_CORNER; 3 * triangles.len()];
    for corner in 0..opposite.len() as u32 {
        let (from, to) = (vertex(next(corner)), vertex(prev(corner)));
        if from > to {
            continue;
        }
        if edges.facing(from, to).next() != Some(corner) {
            continue;
        }
        for (a, b) in edges.facing(from, to).zip(edges.facing(to, from)) {
            opposite[a as usize] = b;
            opposite[b as usize] = a;
        }
    }
    opposite
}

/// Gives each fan of faces a vertex of its own, in the order of the vertices; fans at one vertex in
/// the order of their first faces.
fn name_fans(triangles: &[[u32; 3]], opposite: &[u32]) -> (Vec<[u32; 3]>, Vec<u32>) {
    let mut named = vec![[u32::MAX; 3]; triangles.len()];
    let mut source = Vec::new();
    for corner in 0..opposite.len() as u32 {
        let (f, i) = ((corner / 3) as usize, (corner % 3) as usize);
        if named[f][i] != u32::MAX {
            continue;
        }
        let name = source.len() as u32;
        source.push(triangles[f][i]);
        for step_over in [next as fn(u32) -> u32, prev] {
            let mut c = corner;
            loop {
                named[(c / 3) as usize][(c % 3) as usize] = name;
                let o = opposite[step_over(c) as usize];
                if o == NO_CORNER || step_over(o) == corner {
                    break;
                }
                c = step_over(o);
            }
        }
    }
    let mut order: Vec<u32> = (0..source.len() as u32).collect();
    order.sort_by_key(|&name| source[name as usize]);
    let mut place = vec![0; order.len()];
    order.iter().zip(0..).for_each(|(&name, i)| place[name as usize] = i);
    named.iter_mut().flatten().for_each(|name| *name = place[*name as usize]);
    source.sort_unstable();
    (named, source)
}

/// Faces with a directed edge that an earlier face has already.
fn clashing_faces(triangles: &[[u32; 3]], num_vertices: usize) -> Vec<u32> {
    let edges = EdgeIndex::new(triangles, num_vertices);
    let mut clashing: Vec<u32> = (0..3 * triangles.len() as u32)
        .filter(|&corner| {
            let t = triangles[(corner / 3) as usize];
            let (from, to) = (t[(next(corner) % 3) as usize], t[(prev(corner) % 3) as usize]);
            edges.facing(from, to).next() != Some(corner)
        })
        .map(|corner| corner / 3)
        .collect();
    clashing.dedup();
    clashing
}

/// Cuts the three edges of a face.
fn detach(opposite: &mut [u32], face: u32) {
    for corner in 3 * face..3 * face + 3 {
        let o = std::mem::replace(&mut opposite[corner as usize], NO_CORNER);
        if o != NO_CORNER {
            opposite[o as usize] = NO_CORNER;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh(num_vertices: usize, triangles: &[[u32; 3]]) -> TriMesh {
        let positions = (0..num_vertices).map(|i| [i as f64, (i * i) as f64, 1.0]).collect();
        TriMesh::new(positions, triangles.to_vec()).unwrap()
    }

    fn report(num_vertices: usize, triangles: &[[u32; 3]]) -> RepairReport {
        let mesh = mesh(num_vertices, triangles);
        let repaired = repair(&mesh);
        // The same oriented faces come out, in order, whatever was cut.
        let back = repaired.surface.triangles.iter().map(|t| t.map(|v| repaired.source[v as usize]));
        let kept = mesh.triangles().iter().filter(|t| has_three_vertices(t));
        assert!(back.eq(kept.copied()));
        assert!(repaired.source.is_sorted());
        repaired.report
    }

    #[test]
    fn a_clean_mesh_is_left_alone() {
        let tetrahedron = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
        assert_eq!(report(4, &tetrahedron), RepairReport::default());
    }

    #[test]
    fn unusable_things_are_counted() {
        let r = report(6, &[[0, 1, 2], [1, 1, 2], [3, 3, 3]]);
        assert_eq!((r.degenerate_triangles, r.isolated_vertices, r.repeated_vertices), (2, 3, 0));
    }

    #[test]
    fn a_third_face_at_an_edge_becomes_a_sheet() {
        assert_eq!(report(5, &[[0, 1, 2], [1, 0, 3], [0, 1, 4]]).repeated_vertices, 2);
    }

    #[test]
    fn two_fans_at_a_vertex_are_cut() {
        assert_eq!(report(5, &[[0, 1, 2], [0, 3, 4]]).repeated_vertices, 1);
    }

    #[test]
    fn repeated_and_flipped_faces_become_sheets() {
        assert_eq!(report(3, &[[0, 1, 2], [0, 1, 2]]).repeated_vertices, 3);
        assert_eq!(report(4, &[[0, 1, 2], [1, 2, 3]]).repeated_vertices, 2);
        // Both sides of one triangle are a closed surface.
        assert_eq!(report(3, &[[0, 1, 2], [0, 2, 1]]).repeated_vertices, 0);
    }

    #[test]
    fn a_moebius_strip_opens() {
        let n = 9;
        let strip: Vec<[u32; 3]> = (0..n)
            .flat_map(|i| {
                let (a, b) = (2 * i, 2 * i + 1);
                let (c, d) = if i + 1 == n { (1, 0) } else { (2 * i + 2, 2 * i + 3) };
                [[a, c, b], [b, c, d]]
            })
            .collect();
        assert!(report(2 * n as usize, &strip).repeated_vertices > 0);
    }
}
