//! Some rows of a picture. Where a triangle is large, blocks of samples that hide it are left out, and of long thin
//! triangles only what they cover is looked at.

use super::projected::{Drawn, Projected};
use std::ops::Range;

/// Rows of a band.
pub(super) const BAND_ROWS: usize = BLOCK;

/// Samples of a block in each direction, and of the tiles in it.
const BLOCK: usize = 32;
const TILE: usize = 8;
/// A triangle whose box has fewer samples in a band is drawn at once.
const FEW_SAMPLES: usize = 128;

/// Weights of the corners may be less than zero by this.
const LEAST_WEIGHT: f64 = -1e-9;
/// Ends of what is covered along a row may be wrong by this part of a sample.
const COLUMN_SLACK: f64 = 1e-6;
/// Added before rounding down, this rounds up.
const ALMOST_ONE: f64 = 1.0 - f64::EPSILON;
/// Nearness, in samples, may be wrong by this part of the largest.
const NEARNESS_SLACK: f64 = 1e-5;
/// A triangle with less area, relative to the square of its coordinates, is too thin to tell where it is
/// hidden.
const THIN: f64 = 1e-6;

/// Rows of a picture that are drawn by one thread.
pub(super) struct Band<'a> {
    first_row: usize,
    width: usize,
    seen: &'a mut [u32],
    near: &'a mut [f32],
    /// The least nearness in each tile, tiles of a block together, and in each block; `None` if it may have grown.
    tiles: Vec<Option<f32>>,
    blocks: Vec<Option<f32>>,
}

/// The sides of a triangle, ready for the weights of its corners.
struct Sides {
    triangle: u32,
    nearness: [f64; 3],
    /// First column of its samples.
    first: usize,
    /// For each corner the side across: where it begins, and the way along it.
    begin: [[f64; 2]; 3],
    way: [[f64; 2]; 3],
    scale: f64,
    /// Weights that are less are less than zero however they were rounded.
    least: f64,
    /// Where along a row, counted from the first column, what is covered begins and ends.
    bounds: [Bound; 3],
}

/// One end of what is covered, which moves from row to row.
#[derive(Clone, Copy)]
struct Bound {
    is_begin: bool,
    /// In the row at 0, and how much more in each row after it.
    column: f64,
    per_row: f64,
}

impl Sides {
    /// `None` if the triangle has no area. Its samples begin at column `first`.
    fn new(projected: &Projected, triangle: u32, first: usize) -> Option<Self> {
        let [a, b, c] = projected.0;
        let ends = [[b, c], [c, a], [a, b]];
        let way = ends.map(|[p, q]| [q[0] - p[0], q[1] - p[1]]);
        let scale = 1.0 / projected.area();
        let size = 1.0 + projected.0.iter().flat_map(|p| &p[..2]).fold(first as f64, |s, c| s.max(c.abs()));
        let slack = 64.0 * f64::EPSILON * size * size * scale.abs();
        let sides = Self {
            triangle,
            nearness: projected.0.map(|corner| corner[2]),
            first,
            begin: ends.map(|[p, _]| [p[0], p[1]]),
            way,
            scale,
            least: LEAST_WEIGHT - slack,
            bounds: [Bound { is_begin: true, column: 0.0, per_row: 0.0 }; 3],
        };
        let bounds = std::array::from_fn(|i| sides.bound(i, size));
        scale.is_finite().then_some(Self { bounds, ..sides })
    }

    /// The bound that a side sets, moved outward by what rounding may do within coordinates up to `size`.
    fn bound(&self, side: usize, size: f64) -> Bound {
        let [across, down] = self.way[side];
        let step = -down * self.scale;
        let at_zero = self.weights(self.first as f64 + 0.5, 0.5)[side];
        let (column, per_row) = ((self.least - at_zero) / step, across / down);
        let is_begin = step > 0.0;
        let slack = COLUMN_SLACK + 64.0 * f64::EPSILON * (column.abs() + size * per_row.abs());
        let column = if is_begin { column - slack } else { column + slack };
        // A side along the rows sets none.
        if column.is_finite() && per_row.is_finite() {
            Bound { is_begin, column, per_row }
        } else {
            Bound { is_begin: true, column: 0.0, per_row: 0.0 }
        }
    }

    /// Weights of the corners at a place, as [`Projected::weights`] has them.
    fn weights(&self, x: f64, y: f64) -> [f64; 3] {
        std::array::from_fn(|i| {
            let ([across, down], [x0, y0]) = (self.way[i], self.begin[i]);
            (across * (y - y0) - down * (x - x0)) * self.scale
        })
    }

    /// Those of some columns of a row that may be covered.
    fn covered(&self, row: usize, columns: &Range<usize>) -> Range<usize> {
        let (mut low, mut high) = (0.0_f64, f64::INFINITY);
        for bound in &self.bounds {
            let column = bound.column + row as f64 * bound.per_row;
            if bound.is_begin {
                low = low.max(column);
            } else {
                high = high.min(column);
            }
        }
        if low > high {
            return 0..0;
        }
        // Casts saturate, and take what is not negative down to the whole number.
        let [start, end] = [low + ALMOST_ONE, high + 1.0].map(|x| self.first.saturating_add(x as usize));
        columns.start.max(start)..columns.end.min(end)
    }
}

/// Nearness of a triangle as a plane over the picture, for bounds.
struct Slope {
    /// A place, and the nearness there.
    here: [f64; 3],
    nearest: f64,
    across: f64,
    down: f64,
    slack: f64,
}

impl Slope {
    /// `None` if rounding may make more of it.
    fn new(triangle: &Projected) -> Option<Self> {
        let size = triangle.0.iter().flatten().fold(1.0_f64, |size, c| size.max(c.abs()));
        if triangle.area().abs() < THIN * size * size {
            return None;
        }
        let nearness = triangle.0.map(|corner| corner[2]);
        let at = |x: f64, y: f64| {
            let weights = triangle.weights(x, y)?;
            Some((0..3).map(|i| weights[i] * nearness[i]).sum::<f64>())
        };
        let [x, y, _] = triangle.0[0];
        let here = at(x, y)?;
        Some(Self {
            here: [x, y, here],
            nearest: triangle.range(2).1,
            across: at(x + 1.0, y)? - here,
            down: at(x, y + 1.0)? - here,
            slack: NEARNESS_SLACK * size,
        })
    }

    /// No sample in a square is nearer; its first column and row, and how many there are.
    fn most(&self, column: usize, row: usize, side: usize) -> f32 {
        let [x0, y0, here] = self.here;
        let half = 0.5 * side as f64;
        let (x, y) = (column as f64 + half - x0, row as f64 + half - y0);
        let most = here + x * self.across + y * self.down + half * (self.across.abs() + self.down.abs());
        (most.min(self.nearest) + self.slack) as f32
    }
}

/// Tiles across a block.
const TILES: usize = BLOCK / TILE;

/// Those of the columns of a triangle where it has some of the rows.
fn columns_between(triangle: &Projected, rows: &Range<usize>, columns: Range<usize>) -> Range<usize> {
    let (top, bottom) = (rows.start as f64, rows.end as f64);
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        let (p, q) = (triangle.0[i], triangle.0[j]);
        let at = |y: f64| p[0] + (q[0] - p[0]) * ((y - p[1]) / (q[1] - p[1])).clamp(0.0, 1.0);
        if p[1].max(q[1]) >= top && p[1].min(q[1]) <= bottom {
            let ends =
                if p[1] == q[1] { [p[0], q[0]] } else { [p[1], q[1]].map(|y| at(y.clamp(top, bottom))) };
            low = low.min(ends[0]).min(ends[1]);
            high = high.max(ends[0]).max(ends[1]);
        }
    }
    // A sample more at each end for rounding. Casts saturate.
    columns.start.max((low - 1.0) as usize)..columns.end.min((high + 2.0) as usize)
}

/// What a range has of the `count` numbers from `first` on.
fn part(range: &Range<usize>, first: usize, count: usize) -> Range<usize> {
    range.start.max(first)..range.end.min(first + count)
}

/// Whether no side has all of some samples outside, by the corners of their box.
fn may_cover(sides: &Sides, rows: &Range<usize>, columns: &Range<usize>) -> bool {
    let [left, right] = [columns.start, columns.end].map(|x| x as f64);
    let [top, bottom] = [rows.start, rows.end].map(|y| y as f64);
    let corners = [[left, top], [right, top], [left, bottom], [right, bottom]];
    let weights = corners.map(|[x, y]| sides.weights(x, y));
    (0..3).all(|i| weights.iter().any(|weights| weights[i] >= sides.least))
}

impl<'a> Band<'a> {
    /// `seen` and `near`: the rows from `first_row` on.
    pub(super) fn new(first_row: usize, width: usize, seen: &'a mut [u32], near: &'a mut [f32]) -> Self {
        let num_blocks = width.div_ceil(BLOCK);
        let tiles = vec![None; num_blocks * TILES * TILES];
        Self { first_row, width, seen, near, tiles, blocks: vec![None; num_blocks] }
    }

    /// Draws what of a triangle is in the band; of equally near ones the first is seen.
    pub(super) fn draw(&mut self, triangle: &Projected, drawn: &Drawn) {
        let end_row = self.first_row + self.seen.len() / self.width;
        let rows = self.first_row.max(drawn.begin as usize)..end_row.min(drawn.end as usize);
        if rows.is_empty() {
            return;
        }
        let columns = triangle.samples(0, self.width);
        let Some(sides) = Sides::new(triangle, drawn.triangle, columns.start) else { return };
        let columns = columns_between(triangle, &rows, columns);
        let is_large = rows.len() * columns.len() > FEW_SAMPLES;
        match Slope::new(triangle).filter(|_| is_large) {
            Some(slope) => self.draw_blocks(&sides, &rows, &columns, &slope),
            None => self.draw_rows(&sides, rows, &columns),
        }
    }

    /// Draws some rows and columns, but not the blocks and tiles where the triangle is hidden.
    fn draw_blocks(&mut self, sides: &Sides, rows: &Range<usize>, columns: &Range<usize>, slope: &Slope) {
        for block in columns.start / BLOCK..columns.end.div_ceil(BLOCK) {
            let of_block = part(columns, block * BLOCK, BLOCK);
            let is_hidden = slope.most(block * BLOCK, self.first_row, BLOCK) < self.least_of_block(block);
            if is_hidden || !may_cover(sides, rows, &of_block) {
                continue;
            }
            for tile in 0..TILES * TILES {
                let column = block * BLOCK + tile % TILES * TILE;
                let row = self.first_row + tile / TILES * TILE;
                let (rows, columns) = (part(rows, row, TILE), part(&of_block, column, TILE));
                let is_outside = rows.is_empty() || columns.is_empty();
                if !is_outside && slope.most(column, row, TILE) >= self.least_of_tile(block, tile) {
                    self.draw_rows(sides, rows, &columns);
                }
            }
        }
    }

    fn draw_rows(&mut self, sides: &Sides, rows: Range<usize>, columns: &Range<usize>) {
        for row in rows {
            let columns = sides.covered(row, columns);
            if !columns.is_empty() {
                self.draw_columns(sides, row, columns);
            }
        }
    }

    /// Draws some columns of a row.
    fn draw_columns(&mut self, sides: &Sides, row: usize, columns: Range<usize>) {
        let in_band = row - self.first_row;
        for tile in columns.start / TILE..columns.end.div_ceil(TILE) {
            self.tiles[tile / TILES * TILES * TILES + in_band / TILE * TILES + tile % TILES] = None;
            self.blocks[tile / TILES] = None;
        }
        // Weights are linear along a row.
        let [begin, after] = [0.5, 1.5].map(|x| sides.weights(sides.first as f64 + x, row as f64 + 0.5));
        let step: [f64; 3] = std::array::from_fn(|i| after[i] - begin[i]);
        for column in columns {
            let along = (column - sides.first) as f64;
            let weights: [f64; 3] = std::array::from_fn(|i| begin[i] + along * step[i]);
            if weights.iter().any(|&w| w < LEAST_WEIGHT) {
                continue;
            }
            let nearer = (0..3).map(|i| weights[i] * sides.nearness[i]).sum::<f64>() as f32;
            let sample = in_band * self.width + column;
            let (seen, near) = (&mut self.seen[sample], &mut self.near[sample]);
            if nearer > *near || nearer == *near && sides.triangle < *seen {
                (*near, *seen) = (nearer, sides.triangle);
            }
        }
    }

    fn least_of_block(&mut self, block: usize) -> f32 {
        if let Some(least) = self.blocks[block] {
            return least;
        }
        let tiles = (0..TILES * TILES).map(|tile| self.least_of_tile(block, tile));
        let least = tiles.fold(f32::INFINITY, f32::min);
        self.blocks[block] = Some(least);
        least
    }

    /// Tiles that are not on the picture hide everything.
    fn least_of_tile(&mut self, block: usize, tile: usize) -> f32 {
        let place = block * TILES * TILES + tile;
        if let Some(least) = self.tiles[place] {
            return least;
        }
        let column = (block * BLOCK + tile % TILES * TILE).min(self.width);
        let columns = column..(column + TILE).min(self.width);
        let row = tile / TILES * TILE;
        let rows = self.near.chunks(self.width).skip(row).take(TILE);
        let least = rows.flat_map(|near| &near[columns.clone()]).copied().fold(f32::INFINITY, f32::min);
        self.tiles[place] = Some(least);
        least
    }
}
