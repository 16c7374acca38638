//! Which vertices share an edge, as one flat table.

/// Neighbours are stored in groups of this many: most rows are one group, so that the walk over the rings,
/// where the descriptors spend half of their time, has no unpredictable branch per vertex.
pub(super) const GROUP: usize = 8;

/// Neighbours of every vertex over the undirected edges of the faces.
pub(super) struct Adjacency {
    /// Row v of `groups` is `offsets[v]..offsets[v + 1]`.
    offsets: Vec<usize>,
    groups: Vec<[u32; GROUP]>,
}

impl Adjacency {
    /// Counting sort of the face corners by vertex, then removal of the repeated entries of each row.
    /// `triangles` must not repeat an index within a face.
    pub(super) fn new(num_vertices: usize, triangles: &[[u32; 3]]) -> Self {
        let n = num_vertices;
        // Counts are kept one place to the right, so that after filling `ends[v]` is the end of row v.
        let mut ends = vec![0usize; n + 1];
        for t in triangles {
            for &v in t {
                ends[v as usize + 1] += 2;
            }
        }
        for v in 0..n {
            ends[v + 1] += ends[v];
        }
        let mut named = vec![0u32; ends[n]];
        for t in triangles {
            for (v, u, w) in [(t[0], t[1], t[2]), (t[1], t[2], t[0]), (t[2], t[0], t[1])] {
                let at = ends[v as usize];
                named[at] = u;
                named[at + 1] = w;
                ends[v as usize] = at + 2;
            }
        }

        let mut offsets = Vec::with_capacity(n + 1);
        // On a surface a vertex has at most one neighbour more than faces; a vector that grows would take twice the room.
        let num_groups = |begin: usize, end: usize| ((end - begin) / 2 + 1).div_ceil(GROUP);
        let first = ends.first().map_or(0, |&end| num_groups(0, end));
        let others = ends[..n].windows(2).map(|row| num_groups(row[0], row[1]));
        let mut groups = Vec::with_capacity(first + others.sum::<usize>());
        let mut seen_from = vec![u32::MAX; n];
        let mut begin = 0;
        for (v, &end) in ends[..n].iter().enumerate() {
            offsets.push(groups.len());
            let v = v as u32;
            let (mut group, mut len) = ([v; GROUP], 0);
            for &u in &named[begin..end] {
                if seen_from[u as usize] != v {
                    seen_from[u as usize] = v;
                    if len == GROUP {
                        groups.push(group);
                        (group, len) = ([v; GROUP], 0);
                    }
                    group[len] = u;
                    len += 1;
                }
            }
            if len > 0 {
                groups.push(group);
            }
            begin = end;
        }
        offsets.push(groups.len());
        Self { offsets, groups }
    }

    /// Distinct neighbours of `v`, in the order in which the faces name them, filled up with `v` itself.
    #[inline]
    pub(super) fn of(&self, v: usize) -> &[[u32; GROUP]] {
        &self.groups[self.offsets[v]..self.offsets[v + 1]]
    }
}
