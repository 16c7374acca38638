//! Legal half-edge collapses (section 6 of the paper; the rules are those of the link condition,
//! of the boundary and of the sides of faces).

use super::geometry::{area_vector, is_same_side};
use super::surface_editor::{Star, SurfaceEditor};

/// Scratch space of the tests.
#[derive(Default)]
pub(crate) struct CollapseTest {
    by_length: Vec<(f64, u32, usize)>,
    ears: Vec<usize>,
}

impl CollapseTest {
    /// The collapse along the shortest legal edge: the ears that make the fan around its target.
    /// `grid` decides legality, `positions` the lengths.
    pub(crate) fn shortest_legal(
        &mut self,
        surface: &SurfaceEditor,
        star: &Star,
        grid: &[[i32; 3]],
        positions: &[[f64; 3]],
    ) -> Option<&[usize]> {
        if star.degree() < 2 + usize::from(star.is_closed()) {
            return None;
        }
        let candidates = if star.is_closed() { 0..star.degree() } else { 0..1 };
        self.by_length.clear();
        let mut consider = |i: usize| {
            let target = star.ring[i];
            let length = squared_distance(positions[star.vertex as usize], positions[target as usize]);
            self.by_length.push((length, target, i));
        };
        candidates.for_each(&mut consider);
        if !star.is_closed() {
            consider(star.degree() - 1);
        }
        self.by_length.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let target = self.by_length.iter().map(|&(_, _, i)| i).find(|&i| is_legal(surface, star, i, grid))?;
        self.ears.clear();
        let degree = star.degree();
        self.ears.extend((1..degree - 1).map(|i| (target + i) % degree));
        Some(&self.ears)
    }
}

/// Legality of the collapse of the star's vertex into `ring[target]`.
pub(crate) fn is_legal(surface: &SurfaceEditor, star: &Star, target: usize, grid: &[[i32; 3]]) -> bool {
    makes_new_edges(surface, star, target) && keeps_sides(star, target, grid)
}

/// Whether the collapse leaves a surface. Removals of other vertices change that.
pub(crate) fn makes_new_edges(surface: &SurfaceEditor, star: &Star, target: usize) -> bool {
    let degree = star.degree();
    let u = star.ring[target];
    let others = |offset: usize| star.ring[(target + offset) % degree];

    if star.is_closed() {
        // Three faces become one, which must not be there already on the other side.
        if degree == 3 && is_tetrahedral(surface, star) {
            return false;
        }
    } else if degree == 2 {
        // An ear: its base must belong to another face.
        return surface.surface.across(star.corners[0]) != crate::mesh::surface::NO_CORNER;
    }
    // Link condition: the fan's new edges must not exist. In an open star the far end becomes a
    // neighbour along the new boundary.
    let last_new = if star.is_closed() { degree - 2 } else { degree - 1 };
    let new_edges = if star.is_closed() || target == 0 { 2..last_new + 1 } else { 1..last_new };
    !new_edges.into_iter().any(|i| surface.has_edge(u, others(i)))
}

/// Whether every face that stays keeps its side. Only removals of neighbours change that.
pub(crate) fn keeps_sides(star: &Star, target: usize, grid: &[[i32; 3]]) -> bool {
    let degree = star.degree();
    let u = star.ring[target];
    let others = |offset: usize| star.ring[(target + offset) % degree];
    let cell = |v: u32| grid[v as usize];
    degree == 2
        || (1..degree - 1).all(|i| {
            let (a, b) = (others(i), others(i + 1));
            let before = area_vector(cell(star.vertex), cell(a), cell(b));
            before == [0; 3] || is_same_side(before, area_vector(cell(u), cell(a), cell(b)))
        })
}

/// True if a face outside the closed star of degree three has the same three vertices.
pub(crate) fn is_tetrahedral(surface: &SurfaceEditor, star: &Star) -> bool {
    let o = surface.surface.across(star.corners[0]);
    o != crate::mesh::surface::NO_CORNER && surface.surface.vertex(o) == star.ring[2]
}

fn squared_distance(p: [f64; 3], q: [f64; 3]) -> f64 {
    (0..3).map(|i| (p[i] - q[i]) * (p[i] - q[i])).sum()
}
