//! Takes streams apart and puts them together again with valid checksums, without the library
//! (`format/SPEC.md`, section 3).
#![allow(dead_code)]

pub const SIGNATURE: &[u8] = b"LWC\x01";

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chunk {
    pub kind: u8,
    pub payload: Vec<u8>,
}

impl Chunk {
    pub fn new(kind: u8, payload: &[u8]) -> Self {
        Self { kind, payload: payload.to_vec() }
    }

    /// True if it carries a pass.
    pub fn is_pass(&self) -> bool {
        matches!(self.kind, b'B' | b'S' | b'R')
    }

    pub fn bytes(&self) -> Vec<u8> {
        let mut bytes = vec![self.kind];
        bytes.extend(varint(self.payload.len() as u32));
        bytes.extend_from_slice(&self.payload);
        let checksum = crc32fast::hash(&bytes);
        bytes.extend(checksum.to_le_bytes());
        bytes
    }
}

/// A number as LEB128.
pub fn varint(mut value: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    while value >= 0x80 {
        bytes.push(value as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
    bytes
}

/// Takes a number off the front.
pub fn take_varint(bytes: &mut &[u8]) -> u32 {
    let (mut value, mut shift) = (0, 0);
    loop {
        let byte = bytes[0];
        *bytes = &bytes[1..];
        value |= u32::from(byte & 0x7f) << shift;
        shift += 7;
        if byte & 0x80 == 0 {
            return value;
        }
    }
}

/// The chunks of a stream that is whole.
pub fn split(stream: &[u8]) -> Vec<Chunk> {
    assert!(stream.starts_with(SIGNATURE));
    let mut rest = &stream[SIGNATURE.len()..];
    let mut chunks = Vec::new();
    while let Some((&kind, mut after)) = rest.split_first() {
        let length = take_varint(&mut after) as usize;
        let chunk = Chunk::new(kind, &after[..length]);
        let (bytes, next) = rest.split_at(chunk.bytes().len());
        assert_eq!(bytes, chunk.bytes(), "a chunk of other bytes");
        chunks.push(chunk);
        rest = next;
    }
    chunks
}

pub fn join(chunks: &[Chunk]) -> Vec<u8> {
    let mut stream = SIGNATURE.to_vec();
    chunks.iter().for_each(|chunk| stream.extend(chunk.bytes()));
    stream
}

/// One row of the table of passes, as numbers: for the base mesh precision, vertices, faces; for a
/// split vertices, vertices on the boundary; for a refinement 0. Then the bytes of the payload.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Row {
    pub head: Vec<u32>,
    pub size: u32,
}

pub fn read_table(mut payload: &[u8]) -> Vec<Row> {
    let count = take_varint(&mut payload);
    let rows = (0..=count)
        .map(|pass| {
            let first = take_varint(&mut payload);
            let mut head = vec![first];
            let more = if pass == 0 { 2 } else { u32::from(first > 0) };
            head.extend((0..more).map(|_| take_varint(&mut payload)));
            Row { head, size: take_varint(&mut payload) }
        })
        .collect();
    assert!(payload.is_empty());
    rows
}

pub fn write_table(rows: &[Row]) -> Vec<u8> {
    let mut payload = varint(rows.len() as u32 - 1);
    for row in rows {
        row.head.iter().chain([&row.size]).for_each(|&number| payload.extend(varint(number)));
    }
    payload
}

/// The stream with the table's sizes made those of the passes that are there.
pub fn join_resized(chunks: &[Chunk]) -> Vec<u8> {
    let mut chunks = chunks.to_vec();
    let sizes: Vec<u32> = chunks.iter().filter(|c| c.is_pass()).map(|c| c.payload.len() as u32).collect();
    for table in chunks.iter_mut().filter(|c| c.kind == b'L') {
        let mut rows = read_table(&table.payload);
        rows.iter_mut().zip(&sizes).for_each(|(row, &size)| row.size = size);
        table.payload = write_table(&rows);
    }
    join(&chunks)
}

/// A header chunk of the narrow form: `precision` bits over the unit cube.
pub fn header(precision: u8) -> Chunk {
    let mut payload = vec![0, precision];
    [0.0_f32, 0.0, 0.0, 1.0].iter().for_each(|x| payload.extend(x.to_le_bytes()));
    Chunk { kind: b'H', payload }
}
