//! The points of LAZ files, unpacked by the crate `laz`, which the crate `las` uses too.
//!
//! What `laz` would rely on is checked before `laz` sees it.

use super::{
    gps_time::GpsTimeSkipper,
    header::{Fields, Header, variable_records},
    quiet::without_panic,
};
use crate::io::{Place, ReadError};
use laz::{
    DecompressionSelection, LasZipDecompressor, LazItem, LazItemType, LazVlr,
    laszip::ChunkTable,
    record::{RecordDecompressor, SequentialPointRecordDecompressor},
};
use std::{io::Cursor, iter};

/// How many points there may be for each byte of a compressed file, and in any file. Scans have a quarter.
const MAX_POINTS_PER_BYTE: u64 = 4;
const MIN_MAX_POINTS: u64 = 1 << 20;
/// Bytes of points that are unpacked at a time.
const PIECE_BYTES: usize = 1 << 18;

/// How points are compressed.
struct Compression {
    /// [`POINT_WISE`], [`LAYERED`] or another.
    code: u16,
    record: LazVlr,
}

/// All points in one chunk, without a table of chunks: LASzip before 2011.
const POINT_WISE: u16 = 1;
/// The fields of a chunk one after the other.
const LAYERED: u16 = 3;

/// Unpacks all points and hands their records to `take`, some at a time: the count in the header is not believed.
pub(super) fn unpack(header: &Header, bytes: &[u8], take: impl FnMut(&[u8])) -> Result<(), ReadError> {
    let laz = find_record(header, bytes)?;
    check_items(header, &laz)?;
    let table = if laz.code == POINT_WISE { None } else { Some(chunk_table_place(header, bytes)?) };
    let num_points = check_num_points(header, bytes)?;
    let pieces = Pieces { record_bytes: header.record_bytes, num_points };
    if laz.code == LAYERED {
        check_layers(header, &laz, bytes, table.unwrap_or(usize::MAX).min(bytes.len()))?;
        without_panic(|| unpack_layers(header, &laz, bytes, pieces, take))
    } else {
        without_panic(|| unpack_point_wise(header, &laz, bytes, table, pieces, take))
    }
    .map_err(|cause| damaged(header.data_offset, &cause))
}

/// Finds what says how the points are compressed.
fn find_record(header: &Header, bytes: &[u8]) -> Result<Compression, ReadError> {
    let mut records = variable_records(header, bytes);
    let Some(record) = records.find(|r| r.user.starts_with(b"laszip encoded") && r.id == 22204) else {
        let place = Place::Byte(header.header_bytes);
        return Err(ReadError::syntax(place, "compressed, but it does not say how"));
    };
    read_record(record.data).map_err(|cause| damaged(record.at, &cause))
}

fn read_record(data: &[u8]) -> Result<Compression, String> {
    let code = Fields(data).u16(0).map_err(|error| error.to_string())?;
    let record = without_panic(|| LazVlr::from_buffer(data).map_err(|error| error.to_string()))?;
    Ok(Compression { code, record })
}

fn damaged(at: usize, cause: &str) -> ReadError {
    ReadError::syntax(Place::Byte(at), format!("damaged LAZ data: {cause}"))
}

/// The fields are those of the records, and of this kind of compression.
fn check_items(header: &Header, laz: &Compression) -> Result<(), ReadError> {
    let item_bytes: usize = laz.record.items().iter().map(|item| usize::from(item.size())).sum();
    if item_bytes != header.record_bytes {
        let message = format!("points of {item_bytes} bytes in place of {}", header.record_bytes);
        return Err(damaged(header.data_offset, &message));
    }
    let is_known = (POINT_WISE..=LAYERED).contains(&laz.code);
    if !is_known || (num_layers(laz) > 0) != (laz.code == LAYERED) {
        return Err(damaged(header.data_offset, "fields of another kind of compression"));
    }
    Ok(())
}

fn check_num_points(header: &Header, bytes: &[u8]) -> Result<usize, ReadError> {
    let most = (bytes.len() as u64).saturating_mul(MAX_POINTS_PER_BYTE).max(MIN_MAX_POINTS);
    let num_points = usize::try_from(header.num_points).ok().filter(|_| header.num_points <= most);
    num_points.ok_or_else(|| ReadError::TooLarge { message: format!("{} points", header.num_points) })
}

/// Where the table of chunks is, which has no more of them than the file has bytes.
fn chunk_table_place(header: &Header, bytes: &[u8]) -> Result<usize, ReadError> {
    let start = header.data_offset;
    let place = |at: usize| Fields(bytes).bytes(at).map(i64::from_le_bytes);
    let mut table = place(start)?;
    if table <= start as i64 {
        // Writers that could not go back to write it here wrote it at the end of the file.
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
    Ok(table)
}

/// The records of a file, in pieces that are no larger than [`PIECE_BYTES`], or one record.
struct Pieces {
    record_bytes: usize,
    num_points: usize,
}

impl Pieces {
    /// Lets `fill` write each piece, and `take` have it.
    fn each(
        self,
        mut fill: impl FnMut(&mut [u8]) -> Result<(), String>,
        mut take: impl FnMut(&[u8]),
    ) -> Result<(), String> {
        let most = (PIECE_BYTES / self.record_bytes).max(1);
        let mut piece = vec![0; most.min(self.num_points) * self.record_bytes];
        for start in (0..self.num_points).step_by(most) {
            let piece = &mut piece[..most.min(self.num_points - start) * self.record_bytes];
            fill(piece)?;
            take(piece);
        }
        Ok(())
    }
}

/// Unpacks what we keep of layered chunks. The layer of GPS times is left out: its decoder is not safe, see
/// [`GpsTimeSkipper`].
fn unpack_layers(
    header: &Header,
    laz: &Compression,
    bytes: &[u8],
    pieces: Pieces,
    take: impl FnMut(&[u8]),
) -> Result<(), String> {
    let mut source = Cursor::new(bytes);
    source.set_position(header.data_offset as u64);
    let kept = DecompressionSelection::xy_returns_channel()
        .decompress_z()
        .decompress_classification()
        .decompress_flags()
        .decompress_intensity()
        .decompress_rgb()
        .decompress_nir()
        .decompress_extra_bytes();
    let mut unpacker =
        LasZipDecompressor::selective(source, laz.record.clone(), kept).map_err(|error| error.to_string())?;
    pieces.each(|piece| unpacker.decompress_many(piece).map_err(|error| error.to_string()), take)
}

/// Unpacks chunks whose points come one after the other.
fn unpack_point_wise(
    header: &Header,
    laz: &Compression,
    bytes: &[u8],
    table: Option<usize>,
    pieces: Pieces,
    take: impl FnMut(&[u8]),
) -> Result<(), String> {
    let mut sizes = chunk_sizes(laz, bytes, table)?;
    let mut source = Cursor::new(bytes);
    source.set_position(
        (header.data_offset + if table.is_some() { ChunkTable::OFFSET_SIZE } else { 0 }) as u64,
    );
    let mut unpacker = SequentialPointRecordDecompressor::new(source);
    let mut num_left = 0;
    let fill = |piece: &mut [u8]| {
        for record in piece.chunks_exact_mut(header.record_bytes) {
            if num_left == 0 {
                // A table may have any number of empty chunks, and models take a while to make.
                num_left = sizes
                    .find(|&size| size > 0)
                    .ok_or("the chunks have fewer points than the header says")?;
                check_first_record(header, bytes, unpacker.get().position())?;
                unpacker.reset();
                add_fields(&mut unpacker, laz.record.items()).map_err(|error| error.to_string())?;
            }
            unpacker.decompress_next(record).map_err(|error| error.to_string())?;
            num_left -= 1;
        }
        Ok(())
    };
    pieces.each(fill, take)
}

/// A chunk begins with a point as it is. Without it no models are made, which take 2 kB for each byte of a point.
fn check_first_record(header: &Header, bytes: &[u8], at: u64) -> Result<(), String> {
    let num_left = (bytes.len() as u64).saturating_sub(at);
    if num_left < header.record_bytes as u64 {
        return Err(format!("the file ends in the first point of a chunk, at byte {at}"));
    }
    Ok(())
}

/// The numbers of points in the chunks.
fn chunk_sizes(
    laz: &Compression,
    bytes: &[u8],
    table: Option<usize>,
) -> Result<Box<dyn Iterator<Item = u64>>, String> {
    let Some(place) = table else { return Ok(Box::new(iter::once(u64::MAX))) };
    if !laz.record.uses_variable_size_chunks() {
        let size = u64::from(laz.record.chunk_size());
        return if size > 0 {
            Ok(Box::new(iter::repeat(size)))
        } else {
            Err("chunks of 0 points".to_owned())
        };
    }
    let mut source = Cursor::new(bytes);
    source.set_position(place as u64);
    let table = ChunkTable::read(&mut &mut source, true).map_err(|error| error.to_string())?;
    let sizes: Vec<u64> = (0..table.len()).map(|k| table[k].point_count).collect();
    Ok(Box::new(sizes.into_iter()))
}

fn add_fields<'a>(
    unpacker: &mut SequentialPointRecordDecompressor<'a, Cursor<&'a [u8]>>,
    items: &[LazItem],
) -> laz::Result<()> {
    for item in items {
        if (item.item_type(), item.version()) == (LazItemType::GpsTime, 2) {
            unpacker.add_field_decompressor(GpsTimeSkipper::default());
        } else {
            unpacker.set_fields_from(&vec![*item])?;
        }
    }
    Ok(())
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
