//! Framing (`format/SPEC.md`, section 3): kind, length, payload, checksum.

use crate::util::bytes::Reader;

/// First bytes of every stream: a name and the version of the format.
pub(crate) const SIGNATURE: [u8; 3] = *b"LWC";
/// Version written, and the only one read.
pub(crate) const VERSION: u8 = 1;
/// Payloads of at least this many bytes have the longer checksum.
const LONG_PAYLOAD: usize = 4000;

/// Bytes of the checksum after a payload.
fn checksum_bytes(payload: usize) -> usize {
    if payload < LONG_PAYLOAD { 2 } else { 4 }
}

/// The checksum of `bytes`, of which `payload` are the payload: CRC-16 as in X.25, or CRC-32. The first
/// finds all errors of three bits up to 4,093 bytes, and all within 16 neighbouring bits.
fn checksum(bytes: &[u8], payload: usize) -> u32 {
    if checksum_bytes(payload) == 4 {
        return crc32fast::hash(bytes);
    }
    let step = |crc: u16, _| if crc & 1 == 1 { crc >> 1 ^ 0x8408 } else { crc >> 1 };
    let crc = bytes.iter().fold(0xffff, |crc, &byte| (0..8).fold(crc ^ u16::from(byte), step));
    u32::from(!crc)
}

/// Kinds of chunks. Lower case: decoders that do not know it may skip it.
pub(crate) mod kind {
    pub(crate) const HEADER: u8 = b'H';
    pub(crate) const PROVENANCE: u8 = b'p';
    pub(crate) const PASSES: u8 = b'L';
    /// How coarse meshes are shown.
    pub(crate) const COMPENSATION: u8 = b'c';
    pub(crate) const BASE: u8 = b'B';
    pub(crate) const SPLIT: u8 = b'S';
    pub(crate) const REFINE: u8 = b'R';
    /// Declarations of attributes, and their values after each pass.
    pub(crate) const DECLARATIONS: u8 = b'd';
    pub(crate) const ATTRIBUTES: u8 = b'a';
    /// Announces the chunks below.
    pub(crate) const ANNOUNCED: u8 = b't';
    /// Vertices that were cut apart.
    pub(crate) const STITCHING: u8 = b'g';
    /// Isolated vertices and degenerate faces.
    pub(crate) const LOOSE: u8 = b'i';
    /// The meshes of a scene, and how materials look.
    pub(crate) const SCENE: u8 = b'n';
    pub(crate) const MATERIALS: u8 = b'm';
    /// What else is known of the whole.
    pub(crate) const METADATA: u8 = b'k';
    /// Coordinates bit for bit.
    pub(crate) const EXACT: u8 = b'x';
    /// Values of attributes bit for bit, and those of isolated vertices and degenerate faces.
    pub(crate) const VALUES: u8 = b'v';
    /// Order of the file.
    pub(crate) const ORDER: u8 = b'o';

    /// True if a known kind belongs directly before or after a pass.
    pub(crate) fn is_known_elsewhere(kind: u8) -> bool {
        matches!(
            kind,
            PROVENANCE | COMPENSATION | SCENE | METADATA | DECLARATIONS | ATTRIBUTES | ANNOUNCED | STITCHING
        )
    }

    /// True if the chunk is a pass: the table of passes knows its length.
    pub(crate) fn is_pass(kind: u8) -> bool {
        matches!(kind, BASE | SPLIT | REFINE)
    }

    /// True if a decoder must understand the chunk.
    pub(crate) fn is_critical(kind: u8) -> bool {
        kind.is_ascii_uppercase()
    }
}

/// The frame at the start of some bytes.
pub(crate) enum Frame<'a> {
    /// More bytes are needed, up to this many in all.
    Incomplete { needed: usize },
    /// A length that no encoder writes.
    BadLength,
    /// A pass that the table does not name next.
    OutOfPlace,
    /// A whole chunk; `intact` is whether its checksum is right.
    Chunk { kind: u8, payload: &'a [u8], size: usize, intact: bool },
}

/// Kind and payload length of the next pass, once the table of passes has been read.
pub(crate) type NextPass = Option<(u8, u32)>;

/// Looks at the chunk that `bytes` begin with.
pub(crate) fn parse(bytes: &[u8], next_pass: NextPass) -> Frame<'_> {
    let (kind, start, length) = match parse_head(bytes, next_pass) {
        Ok(head) => head,
        Err(frame) => return frame,
    };
    let payload_end = start.saturating_add(length);
    let size = payload_end.saturating_add(checksum_bytes(length));
    if bytes.len() < size {
        return Frame::Incomplete { needed: size };
    }
    let mut found = [0; 4];
    found[..size - payload_end].copy_from_slice(&bytes[payload_end..size]);
    let intact = u32::from_le_bytes(found) == checksum(&bytes[..payload_end], length);
    Frame::Chunk { kind, payload: &bytes[start..payload_end], size, intact }
}

/// Kind, start and length of the payload.
fn parse_head(bytes: &[u8], next_pass: NextPass) -> Result<(u8, usize, usize), Frame<'_>> {
    const LONGEST_HEAD: usize = 6;
    let head = &bytes[..bytes.len().min(LONGEST_HEAD)];
    let Some(&kind) = head.first() else {
        return Err(Frame::Incomplete { needed: 1 });
    };
    if kind::is_pass(kind) {
        let length = next_pass.filter(|&(next, _)| next == kind).map(|(_, length)| length as usize);
        return length.map(|length| (kind, 1, length)).ok_or(Frame::OutOfPlace);
    }
    let mut reader = Reader::new(&head[1..]);
    let Some(length) = reader.varint() else {
        let unfinished = head.len() < LONGEST_HEAD && head[1..].iter().all(|b| b & 0x80 != 0);
        let needed = head.len() + 1;
        return Err(if unfinished { Frame::Incomplete { needed } } else { Frame::BadLength });
    };
    Ok((kind, payload_start(kind, length as usize), length as usize))
}

/// Bytes before the payload of a chunk.
pub(crate) fn payload_start(kind: u8, length: usize) -> usize {
    if kind::is_pass(kind) { 1 } else { 1 + varint_size(length as u32) }
}

/// Kind and payload so far of the incomplete chunk that `bytes` begin with; of passes only of the next one.
pub(crate) fn parse_cut(bytes: &[u8], next_pass: NextPass) -> Option<(u8, &[u8])> {
    let (kind, start, length) = parse_head(bytes, next_pass).ok()?;
    let payload = bytes.get(start..)?;
    Some((kind, &payload[..payload.len().min(length)]))
}

/// Bytes of a pass with a payload of `length` bytes.
pub(crate) fn pass_size(length: u32) -> u64 {
    1 + u64::from(length) + checksum_bytes(length as usize) as u64
}

/// Bytes of a chunk that is not a pass, with a payload of `length` bytes.
pub(crate) fn other_size(length: u32) -> u64 {
    pass_size(length) + varint_size(length) as u64
}

fn varint_size(value: u32) -> usize {
    (32 - (value | 1).leading_zeros() as usize).div_ceil(7)
}

/// Appends a chunk. The payload must be shorter than 4 GiB.
#[cfg(any(feature = "encoder", test))]
pub(crate) fn write(bytes: &mut Vec<u8>, kind: u8, payload: &[u8]) {
    let start = bytes.len();
    bytes.push(kind);
    if !kind::is_pass(kind) {
        crate::util::bytes::write_varint(bytes, payload.len() as u32);
    }
    bytes.extend_from_slice(payload);
    let checksum = checksum(&bytes[start..], payload.len());
    bytes.extend_from_slice(&checksum.to_le_bytes()[..checksum_bytes(payload.len())]);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chunk_returns_from_any_number_of_bytes_or_asks_for_more() {
        for (kind, length) in
            [(kind::SPLIT, 0), (b'x', 1), (kind::BASE, 127), (b'x', 128), (kind::SPLIT, 20_000)]
        {
            let payload = vec![7; length];
            let is_pass = kind::is_pass(kind);
            let next = is_pass.then_some((kind, length as u32));
            let mut bytes = Vec::new();
            write(&mut bytes, kind, &payload);
            if is_pass {
                assert_eq!(bytes.len() as u64, pass_size(length as u32));
            }
            for cut in 0..bytes.len() {
                assert!(matches!(parse(&bytes[..cut], next), Frame::Incomplete { needed } if needed > cut));
                let head = payload_start(kind, length);
                let so_far = (kind, &payload[..cut.saturating_sub(head).min(length)]);
                assert_eq!(parse_cut(&bytes[..cut], next), (cut >= head).then_some(so_far));
            }
            bytes.push(99);
            let Frame::Chunk { kind: found, payload: read, size, intact } = parse(&bytes, next) else {
                panic!()
            };
            assert_eq!((found, read, size, intact), (kind, &payload[..], bytes.len() - 1, true));
            bytes[1] ^= 1;
            assert!(!matches!(parse(&bytes, next), Frame::Chunk { intact: true, .. }));
            if is_pass {
                assert!(matches!(parse(&bytes, None), Frame::OutOfPlace));
                assert!(matches!(parse(&bytes, Some((kind::REFINE, 0))), Frame::OutOfPlace));
            }
        }
    }

    #[test]
    fn checksums_are_the_usual_ones() {
        assert_eq!(checksum(b"123456789", 9), 0x906e);
        assert_eq!(checksum(b"123456789", LONG_PAYLOAD), 0xcbf4_3926);
    }
}
