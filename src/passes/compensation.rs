//! Where coarse meshes are shown (`format/SPEC.md`, section 9.4). Vertices on a curved surface span triangles
//! inside it: the mesh shrinks, the more the coarser it is. A lifting scheme's update would move them; lazy
//! wavelets have none, so vertices keep their positions for ever, and the decoder moves what it shows, by
//! weights that the encoder fits.

use crate::bitstream::compensation::Compensation;

/// What the triangles around a vertex add up to: exactly for coordinates of up to 22 bits and up to 256 triangles.
#[derive(Clone, Copy, Default)]
struct Ring {
    /// Neighbours seen from the vertex, each twice.
    sum: [f64; 3],
    normal: [f64; 3],
    degree: u32,
    /// Neighbours that triangles begin with less those that they end with: 0 if the ring is closed.
    ends: u32,
}

impl Ring {
    /// Takes a triangle, as the neighbours that it begins and ends with, where these are seen from the vertex, and the
    /// triangle's normal.
    #[inline]
    fn take(&mut self, [next, last]: [u32; 2], seen: [f64; 3], normal: [f64; 3]) {
        self.sum = add(self.sum, seen);
        self.normal = add(self.normal, normal);
        self.degree += 1;
        self.ends = self.ends.wrapping_add(next).wrapping_sub(last);
    }

    /// The unit normal, zero if there is none, and how far the mean of the neighbours lies above the vertex along it:
    /// 0 on boundaries.
    fn settle(&self) -> Bend {
        let length = dot(self.normal, self.normal).sqrt();
        let normal = if length > 0.0 { self.normal.map(|n| n / length) } else { [0.0; 3] };
        let is_inside = self.ends == 0 && self.degree > 0;
        let height = if is_inside { dot(self.sum, normal) / f64::from(2 * self.degree) } else { 0.0 };
        Bend { height, normal }
    }
}

/// How much a surface bends at a vertex.
#[derive(Clone, Copy)]
pub(crate) struct Bend {
    pub(crate) height: f64,
    pub(crate) normal: [f64; 3],
}

/// The bend of a vertex from its triangles, each beginning with the vertex. What [`Mover`] computes for all.
#[cfg(feature = "encoder")]
pub(crate) fn bend(cells: &[[i32; 3]], triangles: impl Iterator<Item = [u32; 3]>) -> Bend {
    let mut ring = Ring::default();
    for [vertex, next, last] in triangles {
        let [a, b, c] = [vertex, next, last].map(|v| cells[v as usize].map(f64::from));
        let (ab, ac) = (sub(b, a), sub(c, a));
        ring.take([next, last], add(ab, ac), cross(ab, ac));
    }
    ring.settle()
}

/// Computes how far vertices are moved, in slices for callers that have other things to do in time.
pub(crate) struct Mover {
    rings: Vec<Ring>,
    bends: Vec<Bend>,
    /// Heights of the neighbours' bends, each twice.
    around: Vec<f64>,
    stage: Stage,
    /// Triangles or vertices of the stage that are done.
    done: usize,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Stage {
    Rings,
    Bends,
    Around,
    Over,
}

impl Mover {
    pub(crate) fn new(num_vertices: usize) -> Self {
        Self {
            rings: vec![Ring::default(); num_vertices],
            bends: Vec::with_capacity(num_vertices),
            around: vec![0.0; num_vertices],
            stage: Stage::Rings,
            done: 0,
        }
    }

    /// Goes on with at most `elements` vertices and triangles. Once all is done, returns how many of these are left;
    /// [`moved`](Self::moved) may then be called.
    pub(crate) fn advance(
        &mut self,
        cells: &[[i32; 3]],
        triangles: &[[u32; 3]],
        elements: usize,
    ) -> Option<usize> {
        let mut left = elements;
        while self.stage != Stage::Over {
            let (count, next) = match self.stage {
                Stage::Rings => (triangles.len(), Stage::Bends),
                Stage::Bends => (cells.len(), Stage::Around),
                Stage::Around | Stage::Over => (triangles.len(), Stage::Over),
            };
            let range = self.done..count.min(self.done.saturating_add(left));
            left -= range.len();
            self.done = range.end;
            match self.stage {
                Stage::Rings => triangles[range].iter().for_each(|t| self.see(cells, t)),
                Stage::Bends => self.bends.extend(self.rings[range].iter().map(Ring::settle)),
                Stage::Around | Stage::Over => triangles[range].iter().for_each(|t| self.look_around(t)),
            }
            if self.done < count {
                return None;
            }
            (self.stage, self.done) = (next, 0);
        }
        Some(left)
    }

    fn see(&mut self, cells: &[[i32; 3]], triangle: &[u32; 3]) {
        let place = |v: u32| cells[v as usize].map(f64::from);
        let [a, b, c] = triangle.map(place);
        let (ab, ac, bc) = (sub(b, a), sub(c, a), sub(c, b));
        let normal = cross(ab, ac);
        let sums = [add(ab, ac), sub(bc, ab), add(ac, bc).map(|x| -x)];
        for (k, seen) in sums.into_iter().enumerate() {
            let ends = [triangle[(k + 1) % 3], triangle[(k + 2) % 3]];
            self.rings[triangle[k] as usize].take(ends, seen, normal);
        }
    }

    fn look_around(&mut self, &[a, b, c]: &[u32; 3]) {
        let [a, b, c] = [a, b, c].map(|v| v as usize);
        let bends = [a, b, c].map(|v| self.bends[v].height);
        self.around[a] += bends[1] + bends[2];
        self.around[b] += bends[2] + bends[0];
        self.around[c] += bends[0] + bends[1];
    }

    /// How far a vertex is moved, in steps of the cells' grid.
    pub(crate) fn moved(&self, vertex: usize, weights: Compensation) -> [f64; 3] {
        let (ring, Bend { height, normal }) = (&self.rings[vertex], self.bends[vertex]);
        if ring.ends != 0 || ring.degree == 0 {
            return [0.0; 3];
        }
        let around = self.around[vertex] / f64::from(2 * ring.degree);
        let height =
            (f64::from(weights.own) * height + f64::from(weights.around) * around) / Compensation::UNIT;
        normal.map(|n| -height * n)
    }
}

fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    const WEIGHTS: Compensation = Compensation { own: 10, around: 6 };

    /// An octahedron, and one without its last face.
    fn octahedron() -> (Vec<[i32; 3]>, Vec<[u32; 3]>) {
        let cells = vec![[8, 0, 0], [0, 8, 0], [-8, 0, 0], [0, -8, 0], [0, 0, 8], [0, 0, -8]];
        let side = |a: u32| [[a, (a + 1) % 4, 4], [(a + 1) % 4, a, 5]];
        (cells, (0..4).flat_map(side).collect())
    }

    fn moves(triangles: &[[u32; 3]], slice: usize) -> Vec<[f64; 3]> {
        let (cells, _) = octahedron();
        let mut mover = Mover::new(cells.len());
        while mover.advance(&cells, triangles, slice).is_none() {}
        (0..cells.len()).map(|v| mover.moved(v, WEIGHTS)).collect()
    }

    #[test]
    fn corners_of_an_octahedron_move_out() {
        let (cells, triangles) = octahedron();
        // The neighbours' mean is the centre: all bends are −8, and the weights a quarter together.
        for (moved, cell) in moves(&triangles, usize::MAX).into_iter().zip(cells) {
            assert_eq!(moved, cell.map(|c| f64::from(c) * 0.25));
        }
    }

    #[test]
    fn slices_do_not_matter_and_boundaries_stay() {
        let (_, triangles) = octahedron();
        assert_eq!(moves(&triangles, 1), moves(&triangles, usize::MAX));
        let open = moves(&triangles[..7], 3);
        // The last face has the vertices 0, 3 and 5.
        for (v, moved) in open.into_iter().enumerate() {
            assert_eq!(moved == [0.0; 3], [0, 3, 5].contains(&v), "{v}: {moved:?}");
        }
    }

    #[cfg(feature = "encoder")]
    #[test]
    fn one_bend_is_that_of_all() {
        let (cells, triangles) = octahedron();
        let mut mover = Mover::new(cells.len());
        mover.advance(&cells, &triangles, usize::MAX);
        for v in 0..6 {
            let turned = triangles
                .iter()
                .filter_map(|&[a, b, c]| [[a, b, c], [b, c, a], [c, a, b]].into_iter().find(|t| t[0] == v));
            let found = bend(&cells, turned);
            let expected = mover.bends[v as usize];
            assert_eq!((found.height, found.normal), (expected.height, expected.normal));
        }
    }
}
