//! The points of LAS and LAZ files.

use super::{
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
}

/// The points of a file.
pub(super) struct Cloud {
    pub points: Vec<Point>,
    /// Units to a step, along each axis; finite and positive.
    pub scale: [f64; 3],
    /// Finite.
    pub offset: [f64; 3],
    pub has_colour: bool,
}

/// Reads all points.
pub(super) fn read(bytes: &[u8]) -> Result<Cloud, ReadError> {
    let header = read_header(bytes)?;
    let (colour_at, _) = layout(header.format).unwrap_or_default();
    let mut points = Vec::new();
    let mut take = |records: &[u8]| {
        let record = |record: &[u8]| point(record, header.format, colour_at);
        points.extend(records.chunks_exact(header.record_bytes).map(record));
    };
    if header.is_compressed {
        compressed::unpack(&header, bytes, take)?;
    } else {
        take(uncompressed(&header, bytes)?);
    }
    let Header { scale, offset, .. } = header;
    Ok(Cloud { points, scale, offset, has_colour: colour_at.is_some() })
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
