//! LAS and LAZ files: the points.
//!
//! The header is read here and LAZ is unpacked by the crate `laz`, which the crate `las` uses too. The latter
//! believes the lengths in a header before it reads, and a file of a few hundred bytes then asks for all
//! memory there is; what `laz` would believe is checked before it gets to see it.

use super::quiet::without_panic;
use crate::io::{Place, ReadError};
use laz::{LasZipDecompressor, LazItemType, LazVlr};
use std::{
    io::{Cursor, Seek, SeekFrom},
    ops::Range,
};

/// How many points there may be for each byte of a compressed file, and in any file. Scans have a quarter.
const MAX_POINTS_PER_BYTE: u64 = 4;
const MIN_MAX_POINTS: u64 = 1 << 20;
/// Bytes of points that are unpacked at a time.
const PIECE_BYTES: usize = 1 << 18;

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

/// What a header says.
struct Header {
    data_offset: usize,
    format: u8,
    record_bytes: usize,
    num_points: u64,
    scale: [f64; 3],
    offset: [f64; 3],
    laz: Option<Compression>,
}

/// How points are compressed.
struct Compression {
    /// [`POINT_WISE`], [`LAYERED`] or another.
    code: u16,
    record: LazVlr,
}

/// All points in one chunk, without a table of chunks: LASzip before 2011.
const POINT_WISE: u16 = 1;
/// Where the record has the points of a chunk, which mean nothing to [`POINT_WISE`].
const CHUNK_SIZE: Range<usize> = 12..16;
/// The fields of a chunk one after the other.
const LAYERED: u16 = 3;

/// Numbers at fixed places, little-endian.
struct Fields<'a>(&'a [u8]);

impl Fields<'_> {
    fn bytes<const N: usize>(&self, at: usize) -> Result<[u8; N], ReadError> {
        let bytes = at.checked_add(N).and_then(|end| self.0.get(at..end)?.try_into().ok());
        bytes.ok_or_else(|| ReadError::syntax(Place::Byte(self.0.len()), "the file ends in its header"))
    }

    fn u16(&self, at: usize) -> Result<u16, ReadError> {
        self.bytes(at).map(u16::from_le_bytes)
    }

    fn u32(&self, at: usize) -> Result<u32, ReadError> {
        self.bytes(at).map(u32::from_le_bytes)
    }

    fn f64s(&self, at: usize) -> Result<[f64; 3], ReadError> {
        let number = |k: usize| self.bytes(at + 8 * k).map(f64::from_le_bytes);
        Ok([number(0)?, number(1)?, number(2)?])
    }
}

/// Where the record of a format has its colour, if it has one, and the least bytes of a record.
fn layout(format: u8) -> Option<(Option<usize>, usize)> {
    Some(match format {
        0 => (None, 20),
        1 => (None, 28),
        2 => (Some(20), 26),
        3 => (Some(28), 34),
        4 => (None, 57),
        5 => (Some(28), 63),
        6 => (None, 30),
        7 => (Some(30), 36),
        8 => (Some(30), 38),
        9 => (None, 59),
        10 => (Some(30), 67),
        _ => return None,
    })
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
    match &header.laz {
        None => take(uncompressed(&header, bytes)?),
        Some(laz) => unpack(&header, laz, bytes, take)?,
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

fn read_header(bytes: &[u8]) -> Result<Header, ReadError> {
    let fields = Fields(bytes);
    let bad = |at: usize, what: String| ReadError::syntax(Place::Byte(at), what);
    if !bytes.starts_with(b"LASF") {
        return Err(bad(0, "not a LAS file: it does not begin with `LASF`".to_owned()));
    }
    let [major, minor] = fields.bytes(24)?;
    if major != 1 || minor > 4 {
        let message = format!("LAS version {major}.{minor}");
        return Err(ReadError::Unsupported { place: Place::Byte(24), message });
    }
    let header_bytes = usize::from(fields.u16(94)?);
    let data_offset = fields.u32(96)? as usize;
    if data_offset > bytes.len() || header_bytes > data_offset {
        return Err(bad(96, format!("points at byte {data_offset}, but the file has {}", bytes.len())));
    }
    let [code] = fields.bytes(104)?;
    // The two highest bits say that the points are compressed.
    let (format, is_compressed) = (code & 0x3f, code & 0xc0 != 0);
    let record_bytes = usize::from(fields.u16(105)?);
    let Some((_, least_bytes)) = layout(format) else {
        return Err(ReadError::Unsupported {
            place: Place::Byte(104),
            message: format!("point format {format}"),
        });
    };
    if record_bytes < least_bytes {
        return Err(bad(
            105,
            format!("points of {record_bytes} bytes, but format {format} has {least_bytes}"),
        ));
    }
    let legacy = u64::from(fields.u32(107)?);
    let num_points = if minor == 4 { u64::from_le_bytes(fields.bytes(247)?) } else { legacy };
    let (scale, offset) = (fields.f64s(131)?, fields.f64s(155)?);
    let is_scale = |&s: &f64| s > 0.0 && (s * f64::from(i32::MIN)).is_finite();
    if !scale.iter().all(is_scale) {
        return Err(bad(131, format!("a scale that is not a positive number: {scale:?}")));
    }
    if !offset.iter().all(|o| o.is_finite()) {
        return Err(bad(155, format!("an offset that is not finite: {offset:?}")));
    }
    let laz = if is_compressed {
        let records = laz_record(&fields, header_bytes, data_offset)?;
        Some(records.ok_or_else(|| bad(header_bytes, "compressed, but it does not say how".to_owned()))?)
    } else {
        None
    };
    Ok(Header { data_offset, format, record_bytes, num_points, scale, offset, laz })
}

/// Finds what `laz` needs to know among the variable length records between header and points.
fn laz_record(fields: &Fields, start: usize, end: usize) -> Result<Option<Compression>, ReadError> {
    const HEAD_BYTES: usize = 54;
    let mut at = start;
    while at + HEAD_BYTES <= end {
        let length = usize::from(fields.u16(at + 20)?);
        let data = fields.0.get(at + HEAD_BYTES..at + HEAD_BYTES + length);
        let is_ours =
            fields.bytes::<16>(at + 2)?.starts_with(b"laszip encoded") && fields.u16(at + 18)? == 22204;
        if let (Some(data), true) = (data, is_ours) {
            return compression(data).map(Some).map_err(|cause| damaged(at, &cause));
        }
        at += HEAD_BYTES + length;
    }
    Ok(None)
}

/// Reads the record of the compressor.
fn compression(data: &[u8]) -> Result<Compression, String> {
    let code = Fields(data).u16(0).map_err(|error| error.to_string())?;
    let mut data = data.to_vec();
    if let (POINT_WISE, Some(chunk_size)) = (code, data.get_mut(CHUNK_SIZE)) {
        // LASzip before 2011 leaves any number here. The crate takes 0 and the largest for chunks of several sizes,
        // and then panics for want of their table.
        chunk_size.copy_from_slice(&1u32.to_le_bytes());
    }
    let record = without_panic(|| LazVlr::from_buffer(&data).map_err(|error| error.to_string()))?;
    Ok(Compression { code, record })
}

fn damaged(at: usize, cause: &str) -> ReadError {
    ReadError::syntax(Place::Byte(at), format!("damaged LAZ data: {cause}"))
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

/// Unpacks piece by piece: the count in the header is not believed.
fn unpack(
    header: &Header,
    laz: &Compression,
    bytes: &[u8],
    mut take: impl FnMut(&[u8]),
) -> Result<(), ReadError> {
    check_laz(header, laz, bytes)?;
    let most = (bytes.len() as u64).saturating_mul(MAX_POINTS_PER_BYTE).max(MIN_MAX_POINTS);
    let num_points = usize::try_from(header.num_points).ok().filter(|_| header.num_points <= most);
    let too_large = || ReadError::TooLarge { message: format!("{} points", header.num_points) };
    let mut num_left = num_points.ok_or_else(too_large)?;
    let mut source = Cursor::new(bytes);
    source.seek(SeekFrom::Start(header.data_offset as u64))?;
    without_panic(|| {
        let mut unpacker =
            LasZipDecompressor::new(source, laz.record.clone()).map_err(|error| error.to_string())?;
        let mut piece = vec![0; (PIECE_BYTES / header.record_bytes).max(1) * header.record_bytes];
        while num_left > 0 {
            let num_bytes = piece.len().min(num_left.saturating_mul(header.record_bytes));
            let piece = &mut piece[..num_bytes];
            unpacker.decompress_many(piece).map_err(|error| error.to_string())?;
            take(piece);
            num_left -= num_bytes / header.record_bytes;
        }
        Ok(())
    })
    .map_err(|cause| damaged(header.data_offset, &cause))
}

/// Checks every length that `laz` would allocate for.
fn check_laz(header: &Header, laz: &Compression, bytes: &[u8]) -> Result<(), ReadError> {
    let start = header.data_offset;
    let item_bytes: usize = laz.record.items().iter().map(|item| usize::from(item.size())).sum();
    if item_bytes != header.record_bytes {
        let message = format!("points of {item_bytes} bytes in place of {}", header.record_bytes);
        return Err(damaged(start, &message));
    }
    if laz.code == POINT_WISE && num_layers(laz) == 0 {
        return Ok(());
    }
    // The place of the chunk table, or -1 and then at the end of the file.
    let place = |at: usize| Fields(bytes).bytes(at).map(i64::from_le_bytes);
    let mut table = place(start)?;
    if table <= start as i64 {
        table = place(bytes.len().saturating_sub(8))?;
    }
    let table = usize::try_from(table).unwrap_or(usize::MAX);
    if table > start
        && let Some(counts) = table.checked_add(4)
        && let Ok(num_chunks) = Fields(bytes).u32(counts)
        && num_chunks as usize > bytes.len()
    {
        return Err(damaged(table, &format!("{num_chunks} chunks")));
    }
    check_layers(header, laz, bytes, table.min(bytes.len()))
}

/// The layers of a chunk; 0 if its points come one after the other.
fn num_layers(laz: &Compression) -> usize {
    let layers = |item: LazItemType| match item {
        LazItemType::Point14 => 9,
        LazItemType::RGB14 | LazItemType::WavePacket14 => 1,
        LazItemType::RGBNIR14 => 2,
        LazItemType::Byte14(count) => usize::from(count),
        _ => 0,
    };
    laz.record.items().iter().map(|item| layers(item.item_type())).sum()
}

/// A layered chunk is a point as it is, a count, the lengths of the layers, the layers.
fn check_layers(header: &Header, laz: &Compression, bytes: &[u8], end: usize) -> Result<(), ReadError> {
    let num_layers = num_layers(laz);
    if (num_layers > 0) != (laz.code == LAYERED) {
        return Err(damaged(header.data_offset, "fields of another kind of compression"));
    }
    if num_layers == 0 {
        return Ok(());
    }
    let mut at = header.data_offset + 8;
    while at < end {
        let lengths_at = at + header.record_bytes + 4;
        let lengths = (0..num_layers).map(|k| Ok(u64::from(Fields(bytes).u32(lengths_at + 4 * k)?)));
        let total = lengths.sum::<Result<u64, ReadError>>()?;
        let first = lengths_at + 4 * num_layers;
        if total > (bytes.len() - first) as u64 {
            return Err(damaged(lengths_at, &format!("layers of {total} bytes are longer than the file")));
        }
        at = first + total as usize;
    }
    Ok(())
}
