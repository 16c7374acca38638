//! Colours of vertices: three numbers behind a position, or the blocks of ZBrush.
//!
//! A block is lines of `#MRGB` with eight hexadecimal digits for each vertex: mask, red, green, blue. It has the
//! colours of the vertices right above it, which is how Blender reads it.

use super::rows::Rows;
use crate::{
    io::{ReadReport, text::words},
    mesh::{Attribute, Domain, NO_ENTRY, Semantic, Values},
};

#[derive(Default)]
pub(super) struct Colours {
    num_vertices: usize,
    numbers: Vec<f64>,
    rows: Rows,
    /// Of vertices with four numbers behind the position: the row, and the first of the four.
    fours: Vec<(u32, f64)>,
    /// Red, green and blue of all blocks.
    blocks: Vec<u8>,
    block_rows: Rows,
    /// Colours of the current block.
    num_in_block: usize,
}

impl Colours {
    /// A vertex, which ends a block.
    pub fn vertex(&mut self, colour: Option<[f64; 3]>) {
        self.end_block();
        if let Some(colour) = colour {
            self.rows.set(self.num_vertices, (self.numbers.len() / 3) as u32);
            self.numbers.extend(colour);
        }
        self.num_vertices += 1;
    }

    /// A vertex with four numbers behind its position.
    pub fn four(&mut self, [first, colour @ ..]: [f64; 4]) {
        self.fours.push(((self.numbers.len() / 3) as u32, first));
        self.vertex(Some(colour));
    }

    /// Whether the four numbers are a colour with alpha, rather than a weight, which is 1, and a colour.
    fn has_alpha(&self) -> bool {
        let last = |&(row, _): &(u32, f64)| self.numbers[3 * row as usize + 2];
        let is_opaque = self.fours.iter().all(|four| last(four) == 1.0);
        !self.fours.is_empty() && (is_opaque || self.fours.iter().any(|&(_, first)| first != 1.0))
    }

    /// Red, green, blue and alpha, which is 1 where there is none.
    fn with_alpha(&self) -> Vec<f64> {
        let mut numbers: Vec<f64> =
            self.numbers.chunks_exact(3).flat_map(|colour| [colour[0], colour[1], colour[2], 1.0]).collect();
        for &(row, first) in &self.fours {
            let colour = &mut numbers[4 * row as usize..][..4];
            colour.rotate_right(1);
            colour[0] = first;
        }
        numbers
    }

    /// A line of a block; `text` follows the keyword.
    pub fn line(&mut self, text: &[u8], report: &mut ReadReport) {
        let digits = words(text).next().unwrap_or_default();
        for colour in digits.chunks(8) {
            let Some([_, red, green, blue]) = bytes(colour) else {
                report.ignore("#MRGB that is no colour");
                return;
            };
            self.blocks.extend([red, green, blue]);
            self.num_in_block += 1;
        }
    }

    fn end_block(&mut self) {
        let first_row = self.blocks.len() / 3 - self.num_in_block;
        let first_vertex = self.num_vertices.saturating_sub(self.num_in_block);
        for k in 0..self.num_in_block {
            // What is too many for 32 bits is refused with the vertices.
            let row = u32::try_from(first_row + k).unwrap_or(NO_ENTRY);
            self.block_rows.set(first_vertex + k, row);
        }
        self.num_in_block = 0;
    }

    pub fn into_attribute(mut self, report: &mut ReadReport) -> Option<Attribute> {
        self.end_block();
        let of = |values| Attribute::new("v.rgb", Semantic::Color(0), Domain::Vertex, 3, values);
        if self.numbers.is_empty() && self.blocks.is_empty() {
            return None;
        }
        if self.numbers.is_empty() {
            let colour = of(Values::U8(self.blocks));
            return Some(Attribute { indices: Some(self.block_rows.0), is_normalized: true, ..colour });
        }
        if !self.blocks.is_empty() {
            report.ignore("#MRGB beside other colours");
        }
        let numbers = if self.has_alpha() { self.with_alpha() } else { Vec::new() };
        let is_opaque = numbers.iter().skip(3).step_by(4).all(|&alpha| alpha == 1.0);
        let colour = match (numbers.is_empty(), is_opaque) {
            (true, _) => of(Values::F64(self.numbers)),
            // An alpha of 1 everywhere says nothing.
            (false, true) => {
                of(Values::F64(numbers.as_chunks::<4>().0.iter().flat_map(|c| [c[0], c[1], c[2]]).collect()))
            }
            (false, false) => {
                Attribute::new("v.rgba", Semantic::Color(0), Domain::Vertex, 4, Values::F64(numbers))
            }
        };
        Some(Attribute { indices: Some(self.rows.0), ..colour })
    }
}

/// Four bytes of eight hexadecimal digits.
fn bytes(digits: &[u8]) -> Option<[u8; 4]> {
    if digits.len() != 8 || !digits.iter().all(u8::is_ascii_hexdigit) {
        return None;
    }
    let digits = std::str::from_utf8(digits).ok()?;
    Some(u32::from_str_radix(digits, 16).ok()?.to_be_bytes())
}
