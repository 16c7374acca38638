//! The index of trailing chunks: those that belong to passes or follow the last one (`format/SPEC.md`,
//! section 4.4).

use super::chunk::kind;
use super::header::MAX_PASSES;
use crate::util::bytes::Reader;
#[cfg(any(feature = "encoder", test))]
use crate::util::bytes::write_varint;

/// Most chunks after the last pass.
const MAX_TRAILING: usize = 16;

/// Chunks refer to those of earlier stages: first to isolated vertices and degenerate faces; the order refers
/// to all. Other chunks refer to none, and may be anywhere.
fn stage(kind: u8) -> Option<u8> {
    match kind {
        kind::LOOSE => Some(0),
        kind::EXACT | kind::VALUES => Some(1),
        kind::ORDER => Some(2),
        _ => None,
    }
}

/// Payloads of chunks to come.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct ChunkIndex {
    /// Passes that a stitching chunk follows, ascending, and the bytes of its payload.
    pub(crate) stitching: Vec<(u32, u32)>,
    /// Kinds of the chunks after the last pass, in order, and the bytes of their payloads.
    pub(crate) trailing: Vec<(u8, u32)>,
}

impl ChunkIndex {
    /// `None` if a rule is broken.
    pub(crate) fn read(payload: &[u8]) -> Option<Self> {
        let mut reader = Reader::new(payload);
        let mut announced = Self::default();
        let count = reader.varint().filter(|&count| count <= MAX_PASSES + 1)?;
        for _ in 0..count {
            let pass = reader.varint()?;
            if announced.stitching.last().is_some_and(|&(last, _)| pass <= last) {
                return None;
            }
            announced.stitching.push((pass, reader.varint()?));
        }
        while !reader.is_empty() {
            let (kind, bytes) = (reader.u8()?, reader.varint()?);
            let is_known_twice = announced.trailing.iter().any(|&(other, _)| other == kind);
            let may_trail = !kind::is_critical(kind) && !kind::is_known_elsewhere(kind);
            let is_before = |own| announced.trailing.iter().any(|&(other, _)| stage(other) > Some(own));
            let is_late = stage(kind).is_some_and(is_before);
            if is_known_twice || is_late || !may_trail || announced.trailing.len() == MAX_TRAILING {
                return None;
            }
            announced.trailing.push((kind, bytes));
        }
        Some(announced)
    }

    #[cfg(any(feature = "encoder", test))]
    pub(crate) fn write(&self) -> Vec<u8> {
        let mut payload = Vec::new();
        write_varint(&mut payload, self.stitching.len() as u32);
        for &(pass, bytes) in &self.stitching {
            write_varint(&mut payload, pass);
            write_varint(&mut payload, bytes);
        }
        for &(kind, bytes) in &self.trailing {
            payload.push(kind);
            write_varint(&mut payload, bytes);
        }
        payload
    }

    #[cfg(feature = "encoder")]
    pub(crate) fn is_empty(&self) -> bool {
        self.stitching.is_empty() && self.trailing.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chunks_that_refer_to_others_come_behind_them() {
        let read = |kinds: &[u8]| {
            ChunkIndex::read(&[&[0][..], &kinds.iter().flat_map(|&k| [k, 1]).collect::<Vec<_>>()].concat())
        };
        for sound in ["ixvo", "ivxo", "vx", "io", "mixo", "zimxvo", "o"] {
            assert!(read(sound.as_bytes()).is_some(), "{sound}");
        }
        for late in ["xi", "vi", "oi", "ox", "ov", "ixov", "xvi", "mox", "ozv"] {
            assert!(read(late.as_bytes()).is_none(), "{late}");
        }
    }

    #[test]
    fn announcements_return_and_lies_are_refused() {
        let announced = ChunkIndex {
            stitching: vec![(0, 300), (4, 1)],
            trailing: vec![(kind::LOOSE, 7), (kind::EXACT, 1 << 20), (b'z', 0)],
        };
        let payload = announced.write();
        assert_eq!(ChunkIndex::read(&payload), Some(announced.clone()));
        assert_eq!(ChunkIndex::read(&[0]), Some(ChunkIndex::default()));
        let complete = [5, 7, 11, 12, 14];
        for cut in (0..payload.len()).filter(|cut| !complete.contains(cut)) {
            let read = ChunkIndex::read(&payload[..cut]);
            assert!(read.is_none_or(|read| read.trailing.len() < 3), "{cut}");
        }
        for bad in
            [&[2, 1, 5, 1, 5][..], &[0, b'B', 1], &[0, b'x', 1, b'x', 1], &[0, b'g', 1], &[0x80, 0x80, 1]]
        {
            assert_eq!(ChunkIndex::read(bad), None, "{bad:?}");
        }
    }
}
