//! Which vertices share an edge, as one flat table.

/// Neighbours are stored in groups of this many: most rows are one group, so that the walk over the rings,
/// where the descriptors spend half of their time, has no unpredictable branch per vertex.
pub(super) const GROUP: usize = 8;

/// Vertices whose rows are gathered at once: all neighbours of a large mesh take too much memory.
const AT_ONCE: usize = 1 << 21;

/// Neighbours of every vertex over the undirected edges of the faces.
pub(super) struct Adjacency {
    /// Row v of `groups` is `offsets[v]..offsets[v + 1]`.
    offsets: Vec<u32>,
    groups: Vec<[u32; GROUP]>,
}

impl Adjacency {
    /// Counting sort of the face corners by vertex, then removal of the repeated entries of each row.
    /// `triangles` must not repeat an index within a face.
    pub(super) fn new(num_vertices: usize, triangles: &[[u32; 3]]) -> Self {
        let n = num_vertices;
        let mut begins = vec![0usize; n + 1];
        for t in triangles {
            for &v in t {
                begins[v as usize + 1] += 2;
            }
        }
        for v in 0..n {
            begins[v + 1] += begins[v];
        }
        // On a surface a vertex has at most one neighbour more than faces.
        let num_groups = |row: &[usize]| ((row[1] - row[0]) / 2 + 1).div_ceil(GROUP);
        let mut table = Self {
            offsets: Vec::with_capacity(n + 1),
            groups: Vec::with_capacity(begins.windows(2).map(num_groups).sum()),
        };
        let mut seen_from = vec![u32::MAX; n];
        for first in (0..n).step_by(AT_ONCE) {
            table.append(&begins[first..(first + AT_ONCE).min(n) + 1], first, triangles, &mut seen_from);
        }
        table.offsets.push(table.groups.len() as u32);
        table
    }

    /// Appends the rows of the vertices from `first` on, which begin in a list of all neighbours at these places.
    fn append(&mut self, begins: &[usize], first: usize, triangles: &[[u32; 3]], seen_from: &mut [u32]) {
        let Some((&start, &end)) = begins.first().zip(begins.last()) else { return };
        let mut named = vec![0u32; end - start];
        let mut places: Vec<usize> = begins.iter().map(|begin| begin - start).collect();
        for t in triangles {
            for (v, u, w) in [(t[0], t[1], t[2]), (t[1], t[2], t[0]), (t[2], t[0], t[1])] {
                let row = (v as usize).wrapping_sub(first);
                if row < begins.len() - 1 {
                    let at = places[row];
                    named[at] = u;
                    named[at + 1] = w;
                    places[row] = at + 2;
                }
            }
        }
        for (v, row) in (first as u32..).zip(begins.windows(2)) {
            self.offsets.push(self.groups.len() as u32);
            let (mut group, mut len) = ([v; GROUP], 0);
            for &u in &named[row[0] - start..row[1] - start] {
                if seen_from[u as usize] != v {
                    seen_from[u as usize] = v;
                    if len == GROUP {
                        self.groups.push(group);
                        (group, len) = ([v; GROUP], 0);
                    }
                    group[len] = u;
                    len += 1;
                }
            }
            if len > 0 {
                self.groups.push(group);
            }
        }
    }

    /// Distinct neighbours of `v`, in the order in which the faces name them, filled up with `v` itself.
    #[inline]
    pub(super) fn of(&self, v: usize) -> &[[u32; GROUP]] {
        &self.groups[self.offsets[v] as usize..self.offsets[v + 1] as usize]
    }
}
