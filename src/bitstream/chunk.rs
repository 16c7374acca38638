//! Framing (`format/SPEC.md`, section 3): kind, length, payload, checksum.

use super::bytes::Reader;

/// First bytes of every stream: a name and the version of the format.
pub(crate) const SIGNATURE: [u8; 3] = *b"LWC";
/// Version written, and the only one read.
pub(crate) const VERSION: u8 = 1;
/// Bytes of the checksum behind each payload.
pub(crate) const CHECKSUM_BYTES: usize = 4;

/// Kinds of chunks. Lower case: may be skipped by who does not know it.
pub(crate) mod kind {
    pub(crate) const HEADER: u8 = b'H';
    pub(crate) const PROVENANCE: u8 = b'p';
    pub(crate) const PASSES: u8 = b'L';
    pub(crate) const BASE: u8 = b'B';
    pub(crate) const SPLIT: u8 = b'S';
    pub(crate) const REFINE: u8 = b'R';
    /// Declarations of attributes, and their values behind each pass.
    pub(crate) const DECLARATIONS: u8 = b'd';
    pub(crate) const ATTRIBUTES: u8 = b'a';
    /// Announces the chunks below.
    pub(crate) const ANNOUNCED: u8 = b't';
    /// Vertices that were cut apart.
    pub(crate) const GLUE: u8 = b'g';
    /// Isolated vertices and degenerate faces.
    pub(crate) const LOOSE: u8 = b'i';
    /// Coordinates bit for bit.
    pub(crate) const EXACT: u8 = b'x';
    /// Order of the file.
    pub(crate) const ORDER: u8 = b'o';

    /// True if a known kind has its place in front of a pass or directly behind one.
    pub(crate) fn is_known_elsewhere(kind: u8) -> bool {
        matches!(kind, PROVENANCE | DECLARATIONS | ATTRIBUTES | ANNOUNCED | GLUE)
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
    /// A whole chunk; `intact` tells whether its checksum holds.
    Chunk { kind: u8, payload: &'a [u8], size: usize, intact: bool },
}

/// Looks at the chunk that `bytes` begin with.
pub(crate) fn parse(bytes: &[u8]) -> Frame<'_> {
    const LONGEST_HEAD: usize = 6;
    let head = &bytes[..bytes.len().min(LONGEST_HEAD)];
    let Some(&kind) = head.first() else {
        return Frame::Incomplete { needed: 1 };
    };
    let mut reader = Reader::new(&head[1..]);
    let Some(length) = reader.varint() else {
        let unfinished = head.len() < LONGEST_HEAD && head[1..].iter().all(|b| b & 0x80 != 0);
        return if unfinished { Frame::Incomplete { needed: head.len() + 1 } } else { Frame::BadLength };
    };
    let payload_start = 1 + varint_size(length);
    let payload_end = payload_start.saturating_add(length as usize);
    let size = payload_end.saturating_add(CHECKSUM_BYTES);
    if bytes.len() < size {
        return Frame::Incomplete { needed: size };
    }
    let checksum = crc32fast::hash(&bytes[..payload_end]).to_le_bytes();
    Frame::Chunk {
        kind,
        payload: &bytes[payload_start..payload_end],
        size,
        intact: bytes[payload_end..size] == checksum,
    }
}

/// Kind and payload so far of the incomplete chunk that `bytes` begin with.
pub(crate) fn parse_cut(bytes: &[u8]) -> Option<(u8, &[u8])> {
    let (&kind, rest) = bytes.split_first()?;
    let mut reader = Reader::new(rest);
    let length = reader.varint()? as usize;
    let payload = &bytes[1 + varint_size(length as u32)..];
    Some((kind, &payload[..payload.len().min(length)]))
}

pub(crate) fn varint_size(value: u32) -> usize {
    (32 - (value | 1).leading_zeros() as usize).div_ceil(7)
}

/// Appends a chunk. The payload must be shorter than 4 GiB.
#[cfg(any(feature = "encoder", test))]
pub(crate) fn write(bytes: &mut Vec<u8>, kind: u8, payload: &[u8]) {
    let start = bytes.len();
    bytes.push(kind);
    super::bytes::write_varint(bytes, payload.len() as u32);
    bytes.extend_from_slice(payload);
    let checksum = crc32fast::hash(&bytes[start..]);
    bytes.extend_from_slice(&checksum.to_le_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chunk_returns_from_any_number_of_bytes_or_asks_for_more() {
        for length in [0, 1, 127, 128, 20_000] {
            let payload = vec![7; length];
            let mut bytes = Vec::new();
            write(&mut bytes, kind::SPLIT, &payload);
            for cut in 0..bytes.len() {
                assert!(matches!(parse(&bytes[..cut]), Frame::Incomplete { needed } if needed > cut));
                let head = bytes.len() - CHECKSUM_BYTES - length;
                let so_far = &payload[..cut.saturating_sub(head).min(length)];
                assert_eq!(parse_cut(&bytes[..cut]), (cut >= head).then_some((kind::SPLIT, so_far)));
            }
            bytes.push(99);
            let Frame::Chunk { kind, payload: read, size, intact } = parse(&bytes) else { panic!() };
            assert_eq!((kind, read, size, intact), (kind::SPLIT, &payload[..], bytes.len() - 1, true));
            bytes[1] ^= 1;
            assert!(!matches!(parse(&bytes), Frame::Chunk { intact: true, .. }));
        }
    }
}
