//! Streams taken apart into chunks, changed, and put together so that what a reader checks first is right.

use crate::bitstream::chunk::{self, Frame, kind};
use crate::bitstream::chunk_index::ChunkIndex;
use crate::bitstream::header::{Header, Pass};
use crate::bitstream::pass_table;
use crate::passes::attribute::Declarations;
use crate::util::budget::Budget;

/// A chunk; of a pass with its row of the table.
#[derive(Clone)]
struct Chunk {
    kind: u8,
    payload: Vec<u8>,
    row: Option<Pass>,
}

/// The chunks of a stream.
pub(super) struct Stream {
    chunks: Vec<Chunk>,
}

/// What a chunk may become.
const KINDS: &[u8] = b"HLBSRpdnmctgaixvoz";

impl Stream {
    /// Whatever can be read as chunks; the rest becomes the payload of a last one.
    pub(super) fn read(data: &[u8]) -> Self {
        let mut rest = data.get(chunk::SIGNATURE.len() + 1..).unwrap_or_default();
        let mut grid = None;
        let mut table = Vec::new().into_iter();
        let mut next = None;
        let mut chunks: Vec<Chunk> = Vec::new();
        while let Some((&kind, after)) = rest.split_first() {
            if next.is_none() && kind::is_pass(kind) {
                next = table.next();
            }
            let payload = match chunk::parse(rest, next.map(|row: Pass| (kind, row.bytes))) {
                Frame::Chunk { payload, size, .. } => {
                    rest = &rest[size..];
                    payload
                }
                Frame::Incomplete { .. } | Frame::BadLength | Frame::OutOfPlace => {
                    rest = &[];
                    after
                }
            };
            match (kind, grid) {
                (kind::HEADER, None) => grid = Header::read(payload).map(|header| header.grid),
                (kind::PASSES, Some(grid)) => {
                    table = pass_table::read_passes(payload, &grid).unwrap_or_default().into_iter();
                }
                _ => {}
            }
            let row = if kind::is_pass(kind) { next.take() } else { None };
            chunks.push(Chunk { kind, payload: payload.to_vec(), row });
        }
        Self { chunks }
    }

    /// Makes one change; its bytes say which, and at which chunks.
    pub(super) fn change(&mut self, [what, first, second]: [u8; 3]) {
        let count = self.chunks.len();
        if count == 0 {
            return;
        }
        let (from, to) = (usize::from(first) % count, usize::from(second) % count);
        match what % 6 {
            0 => {
                let chunk = self.chunks.remove(from);
                self.chunks.insert(to, chunk);
            }
            1 => self.chunks.insert(to, self.chunks[from].clone()),
            2 => drop(self.chunks.remove(from)),
            3 => self.chunks.swap(from, to),
            4 => self.chunks[from].kind = KINDS[usize::from(second) % KINDS.len()],
            _ => {
                let payload = &mut self.chunks[from].payload;
                let place = usize::from(second) % payload.len().max(1);
                payload.iter_mut().skip(place).take(1).for_each(|byte| *byte ^= what / 6);
            }
        }
    }

    /// Sets the sizes in all tables to those of the chunks that are there. `order`: the index lists trailing
    /// chunks in the order in which they are.
    pub(super) fn mend(&mut self, order: bool) {
        let announced = if order { Some(self.announced()) } else { None };
        let sizes: Vec<(u8, u32)> = self.chunks.iter().map(|c| (c.kind, c.payload.len() as u32)).collect();
        for chunk in self.chunks.iter_mut().filter(|chunk| chunk.kind == kind::ANNOUNCED) {
            let mended = match &announced {
                Some(announced) => Some(announced.write()),
                None => resized(&chunk.payload, &sizes),
            };
            chunk.payload = mended.unwrap_or(std::mem::take(&mut chunk.payload));
        }
    }

    /// Stitching and other trailing chunks as they are.
    fn announced(&self) -> ChunkIndex {
        let mut announced = ChunkIndex::default();
        let mut num_passes = 0;
        for Chunk { kind, payload, .. } in &self.chunks {
            let bytes = payload.len() as u32;
            match *kind {
                kind if kind::is_pass(kind) => num_passes += 1,
                kind::STITCHING if num_passes > 0 => announced.stitching.push((num_passes - 1, bytes)),
                _ => {}
            }
        }
        announced.stitching.dedup_by_key(|stitching| stitching.0);
        let last = self.chunks.iter().rposition(|chunk| kind::is_pass(chunk.kind));
        for Chunk { kind, payload, .. } in self.chunks.iter().skip(last.map_or(0, |last| last + 1)) {
            let may_trail = !kind::is_critical(*kind) && !kind::is_known_elsewhere(*kind);
            if may_trail && announced.trailing.iter().all(|&(other, _)| other != *kind) {
                announced.trailing.push((*kind, payload.len() as u32));
            }
        }
        announced
    }

    /// Signature, lengths, checksums, and the sizes in the tables of passes and of values.
    pub(super) fn write(&self) -> Vec<u8> {
        let with_size = |chunk: &Chunk| Some(Pass { bytes: chunk.payload.len() as u32, ..chunk.row? });
        let table: Vec<Pass> = self.chunks.iter().filter_map(with_size).collect();
        let mut bytes = chunk::SIGNATURE.to_vec();
        bytes.push(chunk::VERSION);
        for Chunk { kind, payload, .. } in &self.chunks {
            let mended = match *kind {
                kind::PASSES if !table.is_empty() => Some(pass_table::write_passes(&table)),
                kind::DECLARATIONS => self.with_sizes_of_values(payload),
                _ => None,
            };
            chunk::write(&mut bytes, *kind, mended.as_ref().unwrap_or(payload));
        }
        bytes
    }

    /// Declarations with the bytes of the values that follow each pass.
    fn with_sizes_of_values(&self, payload: &[u8]) -> Option<Vec<u8>> {
        let declared = Declarations::read(payload, &mut Budget::new(0, u64::MAX))?;
        let mut bytes: Vec<u32> = Vec::new();
        for Chunk { kind, payload, .. } in &self.chunks {
            match *kind {
                kind if kind::is_pass(kind) => bytes.push(0),
                kind::ATTRIBUTES => {
                    bytes.iter_mut().last().into_iter().for_each(|b| *b = payload.len() as u32)
                }
                _ => {}
            }
        }
        Some(Declarations { bytes, ..declared }.write())
    }
}

/// The index of trailing chunks with the sizes of those that are there; `None` if it makes no sense.
fn resized(payload: &[u8], chunks: &[(u8, u32)]) -> Option<Vec<u8>> {
    let mut announced = ChunkIndex::read(payload)?;
    let sizes = |kind: u8| chunks.iter().filter(move |chunk| chunk.0 == kind).map(|chunk| chunk.1);
    announced
        .stitching
        .iter_mut()
        .zip(sizes(kind::STITCHING))
        .for_each(|(stitching, size)| stitching.1 = size);
    for (kind, bytes) in &mut announced.trailing {
        *bytes = sizes(*kind).next().unwrap_or(*bytes);
    }
    Some(announced.write())
}
