//! The header of LAS and LAZ files.
//!
//! The crate `las` believes the lengths in a header before it reads, and a file of a few hundred bytes then asks
//! for all memory there is. So the header is read here.

use crate::io::{Place, ReadError};

/// What the header of a file says.
pub(super) struct Header {
    pub header_bytes: usize,
    /// Where the points begin; within the file and not before the end of the header.
    pub data_offset: usize,
    /// The point format, one that [`layout`] knows.
    pub format: u8,
    pub is_compressed: bool,
    /// At least what [`layout`] says.
    pub record_bytes: usize,
    /// Not checked against the length of the file.
    pub num_points: u64,
    /// Units to a step, along each axis; finite and positive.
    pub scale: [f64; 3],
    /// Finite.
    pub offset: [f64; 3],
}

/// Numbers at fixed places, little-endian.
pub(super) struct Fields<'a>(pub &'a [u8]);

impl Fields<'_> {
    pub fn bytes<const N: usize>(&self, at: usize) -> Result<[u8; N], ReadError> {
        let bytes = at.checked_add(N).and_then(|end| self.0.get(at..end)?.try_into().ok());
        bytes.ok_or_else(|| ReadError::syntax(Place::Byte(self.0.len()), "the file ends in its header"))
    }

    pub fn u16(&self, at: usize) -> Result<u16, ReadError> {
        self.bytes(at).map(u16::from_le_bytes)
    }

    pub fn u32(&self, at: usize) -> Result<u32, ReadError> {
        self.bytes(at).map(u32::from_le_bytes)
    }

    pub fn f64s(&self, at: usize) -> Result<[f64; 3], ReadError> {
        let number = |k: usize| self.bytes(at + 8 * k).map(f64::from_le_bytes);
        Ok([number(0)?, number(1)?, number(2)?])
    }
}

/// One of the variable length records between header and points.
pub(super) struct VariableRecord<'a> {
    /// Place in the file.
    pub at: usize,
    /// Who defined it, padded with zeros.
    pub user: &'a [u8],
    pub id: u16,
    pub data: &'a [u8],
    /// Whether the file ends before the data do.
    pub is_cut: bool,
}

impl VariableRecord<'_> {
    pub fn is_of(&self, user: &[u8]) -> bool {
        self.user.starts_with(user)
    }

    /// Whether it is something that is read, or says how the file is packed.
    fn is_known(&self) -> bool {
        let is_description = self.is_of(b"LASF_Spec") && self.id == 4;
        is_description
            || [&b"LASF_Projection"[..], b"laszip encoded", b"copc"].iter().any(|user| self.is_of(user))
    }
}

/// Whether a file has records that nothing here reads.
pub(super) fn has_other_records(header: &Header, bytes: &[u8]) -> bool {
    all_records(header, bytes).any(|record| !record.is_known())
}

/// The records in front of the points and behind them; a last one may be cut.
pub(super) fn all_records<'a>(
    header: &Header,
    bytes: &'a [u8],
) -> impl Iterator<Item = VariableRecord<'a>> + use<'a> {
    records_before(header, bytes).chain(extended_records(header, bytes))
}

/// The variable length records in front of the points, up to the first one that does not fit.
pub(super) fn variable_records<'a>(
    header: &Header,
    bytes: &'a [u8],
) -> impl Iterator<Item = VariableRecord<'a>> + use<'a> {
    records_before(header, bytes).filter(|record| !record.is_cut)
}

/// The first one that does not fit is the last, and cut.
fn records_before<'a>(
    header: &Header,
    bytes: &'a [u8],
) -> impl Iterator<Item = VariableRecord<'a>> + use<'a> {
    const HEAD_BYTES: usize = 54;
    let (mut at, end) = (header.header_bytes, header.data_offset);
    std::iter::from_fn(move || {
        let head = bytes.get(at..end)?.get(..HEAD_BYTES)?;
        let u16_at = |place: usize| u16::from_le_bytes([head[place], head[place + 1]]);
        let rest = bytes.get(at + HEAD_BYTES..)?;
        let (data, is_cut) = start_of(rest, usize::from(u16_at(20)));
        let record = VariableRecord { at, user: &head[2..18], id: u16_at(18), data, is_cut };
        at = if is_cut { bytes.len() } else { at + HEAD_BYTES + data.len() };
        Some(record)
    })
}

/// As many bytes, and whether there are fewer.
fn start_of(bytes: &[u8], length: usize) -> (&[u8], bool) {
    bytes.get(..length).map_or((bytes, true), |start| (start, false))
}

/// The records behind the points; the first one that does not fit is the last, and cut. Version 1.4 has them.
fn extended_records<'a>(
    header: &Header,
    bytes: &'a [u8],
) -> impl Iterator<Item = VariableRecord<'a>> + use<'a> {
    const HEAD_BYTES: usize = 60;
    let fields = Fields(bytes);
    let is_new = fields.bytes(25).is_ok_and(|[minor]| minor == 4) && header.header_bytes >= 247;
    let start = fields.bytes(235).map(u64::from_le_bytes).ok().and_then(|start| usize::try_from(start).ok());
    let mut at = start.filter(|&start| is_new && start >= header.data_offset).unwrap_or(bytes.len());
    let mut num_left = fields.u32(243).unwrap_or(0);
    std::iter::from_fn(move || {
        num_left = num_left.checked_sub(1)?;
        let head = bytes.get(at..)?.get(..HEAD_BYTES)?;
        let length = u64::from_le_bytes(std::array::from_fn(|k| head[20 + k]));
        let rest = bytes.get(at + HEAD_BYTES..)?;
        let (data, is_cut) = start_of(rest, usize::try_from(length).unwrap_or(usize::MAX));
        let id = u16::from_le_bytes([head[18], head[19]]);
        let record = VariableRecord { at, user: &head[2..18], id, data, is_cut };
        at = if is_cut { bytes.len() } else { at + HEAD_BYTES + data.len() };
        Some(record)
    })
}

/// Where the record of a format has its colour, if it has one, and the least bytes of a record.
pub(super) fn layout(format: u8) -> Option<(Option<usize>, usize)> {
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

/// Reads the header.
pub(super) fn read_header(bytes: &[u8]) -> Result<Header, ReadError> {
    let fields = Fields(bytes);
    check_version(&fields)?;
    let (header_bytes, data_offset) = read_extent(&fields)?;
    let (format, is_compressed, record_bytes) = read_record_format(&fields)?;
    let (scale, offset) = read_grid(&fields)?;
    let num_points = read_num_points(&fields)?;
    Ok(Header { header_bytes, data_offset, format, is_compressed, record_bytes, num_points, scale, offset })
}

fn bad(at: usize, what: impl Into<String>) -> ReadError {
    ReadError::syntax(Place::Byte(at), what)
}

fn check_version(fields: &Fields) -> Result<(), ReadError> {
    if !fields.0.starts_with(b"LASF") {
        return Err(bad(0, "not a LAS file: it does not begin with `LASF`"));
    }
    let [major, minor] = fields.bytes(24)?;
    if major != 1 || minor > 4 {
        let message = format!("LAS version {major}.{minor}");
        return Err(ReadError::Unsupported { place: Place::Byte(24), message });
    }
    Ok(())
}

fn read_extent(fields: &Fields) -> Result<(usize, usize), ReadError> {
    let header_bytes = usize::from(fields.u16(94)?);
    let data_offset = fields.u32(96)? as usize;
    let num_bytes = fields.0.len();
    if data_offset > num_bytes || header_bytes > data_offset {
        return Err(bad(96, format!("points at byte {data_offset}, but the file has {num_bytes}")));
    }
    Ok((header_bytes, data_offset))
}

/// The point format, whether the points are compressed, and the bytes of a record.
fn read_record_format(fields: &Fields) -> Result<(u8, bool, usize), ReadError> {
    let [code] = fields.bytes(104)?;
    // The two highest bits say that the points are compressed.
    let (format, is_compressed) = (code & 0x3f, code & 0xc0 != 0);
    let record_bytes = usize::from(fields.u16(105)?);
    let Some((_, least_bytes)) = layout(format) else {
        let message = format!("point format {format}");
        return Err(ReadError::Unsupported { place: Place::Byte(104), message });
    };
    if record_bytes < least_bytes {
        let message = format!("points of {record_bytes} bytes, but format {format} has {least_bytes}");
        return Err(bad(105, message));
    }
    Ok((format, is_compressed, record_bytes))
}

/// Version 1.4 counts in 64 bits; its old field may be zero.
fn read_num_points(fields: &Fields) -> Result<u64, ReadError> {
    let [minor] = fields.bytes(25)?;
    if minor == 4 { fields.bytes(247).map(u64::from_le_bytes) } else { fields.u32(107).map(u64::from) }
}

fn read_grid(fields: &Fields) -> Result<([f64; 3], [f64; 3]), ReadError> {
    let (scale, offset) = (fields.f64s(131)?, fields.f64s(155)?);
    let is_scale = |&s: &f64| s > 0.0 && (s * f64::from(i32::MIN)).is_finite();
    if !scale.iter().all(is_scale) {
        return Err(bad(131, format!("a scale that is not a positive number: {scale:?}")));
    }
    if !offset.iter().all(|o| o.is_finite()) {
        return Err(bad(155, format!("an offset that is not finite: {offset:?}")));
    }
    Ok((scale, offset))
}
