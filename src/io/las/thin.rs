//! Which points to keep. The order of those that remain is that of the file.

use super::points::Point;
use std::collections::{HashMap, HashSet, hash_map::Entry};

/// Steps of the search for the size of a cell: enough for a factor of a million in the number of cells.
const SEARCH_STEPS: usize = 24;

/// Keeps the lowest of the points at one place in the plane; the first among equals.
pub(super) fn keep_lowest(points: &mut Vec<Point>) {
    keep_best(points, |point| ([point.grid[0], point.grid[1]], f64::from(point.grid[2])));
}

/// Keeps the one of the points in a cell that is nearest to its middle. `cell`: steps of the grid, positive.
pub(super) fn keep_one_per_cell(points: &mut Vec<Point>, cell: [f64; 2]) {
    keep_best(points, |point| {
        let place = [0, 1].map(|axis| f64::from(point.grid[axis]) / cell[axis]);
        let from_middle = [0, 1].map(|axis| (place[axis] - place[axis].floor() - 0.5) * cell[axis]);
        (cell_of(point, cell), from_middle[0] * from_middle[0] + from_middle[1] * from_middle[1])
    });
}

fn cell_of(point: &Point, cell: [f64; 2]) -> [i64; 2] {
    // A cast saturates: whatever the size of a cell, this is some cell.
    [0, 1].map(|axis| (f64::from(point.grid[axis]) / cell[axis]).floor() as i64)
}

/// Keeps at most `most` points, one in each cell of the smallest size that gives so few.
pub(super) fn keep_at_most(points: &mut Vec<Point>, most: usize, scale: [f64; 3]) {
    if points.len() <= most {
        return;
    }
    if most == 0 {
        points.clear();
        return;
    }
    let num_cells = |cell: [f64; 2]| points.iter().map(|p| cell_of(p, cell)).collect::<HashSet<_>>().len();
    let in_steps = |size: f64| [size / scale[0], size / scale[1]];
    // From sizes where every point has its cell to one where the four around the origin hold all.
    let finest = scale[0].min(scale[1]);
    let widest = 2.0 * scale[0].max(scale[1]) * f64::from(u32::MAX);
    let (mut low, mut high) = (libm::log(finest), libm::log(widest));
    for _ in 0..SEARCH_STEPS {
        let middle = 0.5 * (low + high);
        if num_cells(in_steps(libm::exp(middle))) > most { low = middle } else { high = middle }
    }
    keep_one_per_cell(points, in_steps(libm::exp(high)));
    // Fewer than four may be wanted.
    points.truncate(most);
}

/// Keeps, of all points with the same key, the one with the least value, the first among equals.
fn keep_best<K: std::hash::Hash + Eq>(points: &mut Vec<Point>, rank: impl Fn(&Point) -> (K, f64)) {
    let mut best: HashMap<K, (f64, usize)> = HashMap::with_capacity(points.len());
    for (k, point) in points.iter().enumerate() {
        let (key, value) = rank(point);
        match best.entry(key) {
            Entry::Vacant(new) => {
                new.insert((value, k));
            }
            Entry::Occupied(mut known) if value < known.get().0 => {
                known.insert((value, k));
            }
            Entry::Occupied(_) => {}
        }
    }
    let mut is_kept = vec![false; points.len()];
    best.into_values().for_each(|(_, k)| is_kept[k] = true);
    let mut is_kept = is_kept.into_iter();
    points.retain(|_| is_kept.next().unwrap_or(false));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(x: i32, y: i32, z: i32) -> Point {
        let colour = [0; 3];
        Point { grid: [x, y, z], intensity: 0, classification: 0, is_last_return: true, colour, index: 0 }
    }

    fn grids(points: &[Point]) -> Vec<[i32; 3]> {
        points.iter().map(|point| point.grid).collect()
    }

    #[test]
    fn the_lowest_of_points_above_each_other_remains() {
        let mut points =
            vec![point(1, 1, 5), point(2, 1, 9), point(1, 1, -3), point(1, 1, -3), point(2, 1, 10)];
        keep_lowest(&mut points);
        assert_eq!(grids(&points), [[2, 1, 9], [1, 1, -3]]);
    }

    #[test]
    fn cells_keep_the_point_nearest_to_their_middle() {
        let mut points =
            vec![point(0, 0, 0), point(4, 6, 0), point(9, 9, 0), point(-1, 5, 0), point(10, 0, 0)];
        keep_one_per_cell(&mut points, [10.0, 10.0]);
        assert_eq!(grids(&points), [[4, 6, 0], [-1, 5, 0], [10, 0, 0]]);
    }

    #[test]
    fn a_number_of_points_is_nearly_reached_and_never_exceeded() {
        let cloud: Vec<Point> = (0..10_000).map(|k| point(k % 100 * 7, k / 100 * 7 - 300, 0)).collect();
        for most in [0, 1, 3, 50, 900, 2500, 9_999, 10_000, 20_000] {
            let mut points = cloud.clone();
            keep_at_most(&mut points, most, [0.01; 3]);
            let least = if most >= 10_000 { 10_000 } else { most / 5 };
            assert!(points.len() <= most && points.len() >= least, "{} of {most}", points.len());
        }
        let extremes = [i32::MIN, i32::MAX].map(|x| [i32::MIN, i32::MAX].map(|y| point(x, y, 0)));
        let mut points = extremes.concat();
        keep_at_most(&mut points, 2, [1e300, 1e300, 1.0]);
        assert!(points.len() <= 2);
    }
}
