//! `lwc encode --verify`: the grid, computed a second time.

use lwc::{EncodeOptions, GridChoice, Lattice, StreamInfo};

pub type Cell = [i32; 3];

/// The grid that a stream should have.
pub struct ExpectedGrid {
    quantization_bits: u32,
    /// Where point 0 is.
    origin: [f64; 3],
    spread: Spread,
}

enum Spread {
    /// g = floor((x − min)·(2^q − 1)/s + ½) per axis: min per axis and s the longest side.
    Cube { side: f64 },
    /// g = floor((x − o)/s + ½) − k per axis: k is that of min.
    Lattice { step: [f64; 3], offset: [f64; 3] },
}

impl ExpectedGrid {
    /// That of points, which are those of triangles with three different vertices and what else is kept. Sides and steps
    /// that the encoder finds are taken from the stream if they differ by the rounding of coordinates only.
    pub fn new(points: &[[f64; 3]], options: &EncodeOptions, info: &StreamInfo) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for (axis, &x) in points.iter().flat_map(|p| p.iter().enumerate()) {
            low[axis] = low[axis].min(x);
            high[axis] = high[axis].max(x);
        }
        let bits = options.quantization_bits;
        match (options.grid, info.lattice()) {
            (GridChoice::Lattice(lattice), _) => Self::on_lattice(lattice, low, high),
            (GridChoice::Auto, Some(found)) if !options.lossless => Self::stretched(found, low, high, bits),
            _ => Self::cube(info.side(), low, high, bits),
        }
    }

    fn cube(found: f64, low: [f64; 3], high: [f64; 3], quantization_bits: u32) -> Self {
        let longest = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max);
        let magnitude = low.iter().chain(&high).fold(longest, |m, x| m.max(x.abs()));
        let is_close = (found - longest).abs() <= 8.0 * f64::EPSILON * magnitude;
        let side = if is_close { found } else { longest };
        Self { quantization_bits, origin: low, spread: Spread::Cube { side } }
    }

    fn stretched(found: Lattice, low: [f64; 3], high: [f64; 3], quantization_bits: u32) -> Self {
        let cells = f64::from((1_u32 << quantization_bits) - 1);
        let own = |axis: usize| (high[axis] - low[axis]) / cells;
        let largest = (0..3).map(own).fold(0.0, f64::max);
        let step = std::array::from_fn(|axis| {
            let wanted = if own(axis) > 0.0 { own(axis) } else { largest };
            let magnitude = low[axis].abs().max(high[axis].abs());
            let is_close = (found.step[axis] - wanted).abs() * cells <= 8.0 * f64::EPSILON * magnitude
                || high[axis] == low[axis];
            if is_close { found.step[axis] } else { wanted }
        });
        Self { quantization_bits, origin: low, spread: Spread::Lattice { step, offset: [0.0; 3] } }
    }

    fn on_lattice(Lattice { origin, step }: Lattice, low: [f64; 3], high: [f64; 3]) -> Self {
        let point = |axis: usize, x: f64| ((x - origin[axis]) / step[axis] + 0.5).floor();
        let offset: [f64; 3] = std::array::from_fn(|axis| point(axis, low[axis]));
        let most = (0..3).map(|axis| point(axis, high[axis]) - offset[axis]).fold(1.0, f64::max);
        let quantization_bits = (1..30).find(|&bits| 2_f64.powi(bits) > most).unwrap_or(30) as u32;
        Self { quantization_bits, origin, spread: Spread::Lattice { step, offset } }
    }

    pub fn is_that_of(&self, info: &StreamInfo) -> bool {
        let same = match self.spread {
            Spread::Cube { side } => {
                info.lattice().is_none() && info.side() == side && info.origin() == self.origin
            }
            Spread::Lattice { step, offset } => {
                info.lattice() == Some(Lattice { origin: self.origin, step })
                    && info.lattice_offset().map(|k| k as f64) == offset
            }
        };
        same && info.quantization_bits() == self.quantization_bits
    }

    pub fn cell(&self, position: [f64; 3]) -> Cell {
        let last = ((1_u64 << self.quantization_bits) - 1) as f64;
        std::array::from_fn(|axis| {
            let way = position[axis] - self.origin[axis];
            match self.spread {
                Spread::Cube { side: 0.0 } => 0,
                Spread::Cube { side } => {
                    let scaled = way * last / side;
                    // Near the largest double the product overflows where the quotient does not.
                    let scaled = if scaled.is_finite() { scaled } else { way / side * last };
                    (scaled + 0.5).floor() as i32
                }
                Spread::Lattice { step, offset } => {
                    ((way / step[axis] + 0.5).floor() - offset[axis]).clamp(0.0, last) as i32
                }
            }
        })
    }

    /// Where the grid is finer than doubles, places do not tell cells.
    pub fn is_told_by_places(&self) -> bool {
        let cells = ((1_u64 << self.quantization_bits) - 1) as f64;
        match self.spread {
            Spread::Cube { side } => {
                let magnitude = self.origin.iter().fold(side + f64::MIN_POSITIVE, |m, o| m.max(o.abs()));
                side / cells > 8.0 * f64::EPSILON * magnitude
            }
            Spread::Lattice { step, offset } => (0..3).all(|axis| {
                let farthest = (offset[axis].abs() + cells) * step[axis];
                let magnitude = self.origin[axis].abs().max(farthest) + f64::MIN_POSITIVE;
                step[axis] > 8.0 * f64::EPSILON * magnitude
            }),
        }
    }
}
