//! The points of LAS and LAZ files.

use super::{
    columns::{Column, columns},
    compressed,
    header::{Header, layout, read_header},
};
use crate::io::{Place, ReadError};

/// What we keep of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Point {
    /// In steps of [`Cloud::scale`].
    pub grid: [i32; 3],
    pub intensity: u16,
    pub classification: u8,
    pub is_last_return: bool,
    pub colour: [u16; 3],
    /// Place in the columns of the cloud.
    pub index: u32,
}

/// The points of a file.
pub(super) struct Cloud {
    pub points: Vec<Point>,
    /// Units to a step, along each axis; finite and positive.
    pub scale: [f64; 3],
    /// Finite.
    pub offset: [f64; 3],
    pub has_colour: bool,
    pub columns: Vec<Column>,
    /// What else the points have: extra bytes that are in no column.
    pub other_bytes: Vec<String>,
    /// Points that the file declares deleted, which are not among `points`.
    pub num_withheld: usize,
}

/// Reads all points but those withheld, which count as deleted (LAS 1.4, table 8).
pub(super) fn read(bytes: &[u8]) -> Result<Cloud, ReadError> {
    let header = read_header(bytes)?;
    let (colour_at, _) = layout(header.format).unwrap_or_default();
    let (mut columns, other_bytes) = columns(&header, bytes);
    let (mut points, mut num_withheld) = (Vec::new(), 0);
    let mut take = |records: &[u8]| {
        for record in records.chunks_exact(header.record_bytes) {
            if is_withheld(record, header.format) {
                num_withheld += 1;
                continue;
            }
            columns.iter_mut().for_each(|column| column.push(record));
            let index = points.len() as u32;
            points.push(Point { index, ..point(record, header.format, colour_at) });
        }
    };
    if header.is_compressed {
        compressed::unpack(&header, bytes, take)?;
    } else {
        take(uncompressed(&header, bytes)?);
    }
    let Header { scale, offset, .. } = header;
    let has_colour = colour_at.is_some();
    Ok(Cloud { points, scale, offset, has_colour, columns, other_bytes, num_withheld })
}

fn is_withheld(record: &[u8], format: u8) -> bool {
    if format <= 5 { record[15] & 0x80 != 0 } else { record[15] & 0x04 != 0 }
}

fn point(record: &[u8], format: u8, colour_at: Option<usize>) -> Point {
    let u16_at = |at: usize| u16::from_le_bytes([record[at], record[at + 1]]);
    let (returns, is_old) = (record[14], format <= 5);
    let (number, of) = if is_old { (returns & 7, returns >> 3 & 7) } else { (returns & 15, returns >> 4) };
    Point {
        grid: [0, 4, 8].map(|at| i32::from_le_bytes([0, 1, 2, 3].map(|k| record[at + k]))),
        intensity: u16_at(12),
        classification: if is_old { record[15] & 31 } else { record[16] },
        is_last_return: number >= of,
        colour: colour_at.map_or([0; 3], |at| [0, 2, 4].map(|k| u16_at(at + k))),
        index: 0,
    }
}

fn uncompressed<'a>(header: &Header, bytes: &'a [u8]) -> Result<&'a [u8], ReadError> {
    let num_left = bytes.len() - header.data_offset;
    let fits = (num_left / header.record_bytes) as u64;
    if header.num_points > fits {
        let message = format!("the file ends in point {} of {}", fits + 1, header.num_points);
        return Err(ReadError::syntax(Place::Byte(bytes.len()), message));
    }
    Ok(&bytes[header.data_offset..][..header.num_points as usize * header.record_bytes])
}
