//! An order of vertices and triangles that does not depend on the file: encoding the same mesh in another
//! order, or what a decoder made of its stream, gives the same bytes.

use super::tie_break::Signatures;
use super::ties::Ties;
use crate::bitstream::grid::Grid;
use crate::mesh::{TriMesh, has_three_vertices};
use crate::util::morton::morton;
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

#[cfg(test)]
mod tests {
    use super::super::tie_break::mix;
    use super::*;

    /// Triangles in cells of each vertex and the order of equal cells: what the bytes depend on.
    fn ordered(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> (Vec<[i32; 3]>, Vec<[u32; 3]>) {
        let mesh = TriMesh::new(positions.to_vec(), triangles.to_vec()).unwrap();
        let grid = Grid::cube(4, [0.0; 3], 15.0);
        let (ordered, triangles) = order(&mesh, &grid, &|| None);
        for (t, &corner) in triangles.iter().zip(&ordered.corner_source) {
            let source = mesh.triangles()[(corner / 3) as usize];
            let turned = [0, 1, 2].map(|i| source[(corner as usize + i) % 3]);
            assert_eq!(t.map(|v| ordered.vertex_source[v as usize]), turned);
        }
        (ordered.cells, triangles)
    }

    /// The mesh with its vertices, its triangles and the corners of these in another order.
    fn shuffled(
        positions: &[[f64; 3]],
        triangles: &[[u32; 3]],
        seed: &mut u64,
    ) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
        let mut random = |n: usize| {
            *seed = mix(*seed);
            (*seed % n as u64) as usize
        };
        let mut name: Vec<u32> = (0..positions.len() as u32).collect();
        let mut shuffled = triangles.to_vec();
        (1..name.len()).for_each(|i| name.swap(i, random(i + 1)));
        (1..shuffled.len()).for_each(|i| shuffled.swap(i, random(i + 1)));
        shuffled.iter_mut().for_each(|t| t.rotate_left(random(3)));
        shuffled.iter_mut().flatten().for_each(|v| *v = name[*v as usize]);
        let mut moved = positions.to_vec();
        positions.iter().zip(name).for_each(|(&p, v)| moved[v as usize] = p);
        (moved, shuffled)
    }

    fn check_shuffled(positions: &[[f64; 3]], triangles: &[[u32; 3]], times: usize) {
        let wanted = ordered(positions, triangles);
        let mut seed = 1_u64;
        for _ in 0..times {
            let (positions, triangles) = shuffled(positions, triangles, &mut seed);
            assert!(ordered(&positions, &triangles) == wanted);
        }
    }

    const OCTAHEDRON: [[u32; 3]; 8] =
        [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1], [5, 2, 1], [5, 3, 2], [5, 4, 3], [5, 1, 4]];

    #[test]
    fn shuffling_changes_nothing_even_where_all_cells_are_equal() {
        // Two octahedra at one place, and a strip that goes over itself.
        let mut triangles: Vec<[u32; 3]> = OCTAHEDRON.to_vec();
        triangles.extend(OCTAHEDRON.map(|t| t.map(|v| v + 6)));
        triangles.extend([[12, 13, 14], [14, 13, 15], [14, 15, 16], [1, 1, 2]]);
        for place in [[3.0; 3], [0.0; 3]] {
            let positions = [place; 18];
            assert_eq!(ordered(&positions, &triangles).0.len(), 17);
            check_shuffled(&positions, &triangles, 50);
        }
    }

    #[test]
    fn shuffling_changes_nothing_where_many_pieces_are_equal() {
        let copies = |piece: &[[u32; 3]], n: u32| -> Vec<[u32; 3]> {
            (0..40).flat_map(|k| piece.iter().map(move |t| t.map(|v| v + k * n))).collect()
        };
        let corners = [[0.0; 3], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0], [0.0, 0.0, 9.0], [9.0; 3], [2.0; 3]];
        // At six places, and all at one.
        check_shuffled(&corners.repeat(40), &copies(&OCTAHEDRON, 6), 20);
        check_shuffled(&[[1.0; 3]; 240], &copies(&OCTAHEDRON, 6), 20);
        // Isolated triangles, some of them turned over; and leaves of a book, in pairs that nothing
        // distinguishes.
        let mut triangles = copies(&[[0, 1, 2]], 3);
        triangles[..9].iter_mut().for_each(|t| t.swap(0, 1));
        check_shuffled(&corners[..3].repeat(40), &triangles, 20);
        check_shuffled(&[[1.0; 3]; 120], &triangles, 20);
        let book: Vec<[u32; 3]> = (2..42).map(|v| [0, 1, v]).collect();
        let leaf = |v: usize| [f64::from(v as u32 / 2 % 16), 3.0, 3.0];
        check_shuffled(&(0..42).map(leaf).collect::<Vec<_>>(), &book, 20);
    }

    #[test]
    fn shuffling_changes_nothing_where_a_large_sheet_is_at_one_place() {
        let n = 80;
        let square = |i: u32| [[i, i + n, i + n + 1], [i, i + n + 1, i + 1]];
        let triangles: Vec<[u32; 3]> = (0..n * (n - 1)).filter(|i| i % n != n - 1).flat_map(square).collect();
        check_shuffled(&vec![[0.0; 3]; (n * n) as usize], &triangles, 3);
    }
}
