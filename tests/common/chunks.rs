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
        if !self.is_pass() {
            bytes.extend(varint(self.payload.len() as u32));
        }
        bytes.extend_from_slice(&self.payload);
        if self.payload.len() < 4000 {
            bytes.extend(crc16(&bytes).to_le_bytes());
        } else {
            bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
        }
        bytes
    }
}

/// The checksum of X.25.
fn crc16(bytes: &[u8]) -> u16 {
    let mut crc = 0xffff_u16;
    for &byte in bytes {
        crc ^= u16::from(byte);
        for _ in 0..8 {
            let carry = crc & 1;
            crc >>= 1;
            if carry == 1 {
                crc ^= 0x8408;
            }
        }
    }
    !crc
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
    let mut sizes = Vec::new().into_iter();
    while let Some((&kind, mut after)) = rest.split_first() {
        let is_pass = Chunk::new(kind, &[]).is_pass();
        let length =
            if is_pass { sizes.next().expect("the table comes first") } else { take_varint(&mut after) };
        let chunk = Chunk::new(kind, &after[..length as usize]);
        if kind == b'L' {
            let rows = read_table(&chunk.payload);
            sizes = rows.iter().map(|row| row.size).collect::<Vec<_>>().into_iter();
        }
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

/// The bits of a payload, read or written: both sides of the table in one.
struct Bits {
    bits: Vec<bool>,
    next: usize,
    is_reading: bool,
}

impl Bits {
    fn bit(&mut self, bit: bool) -> bool {
        if !self.is_reading {
            self.bits.push(bit);
        }
        self.next += 1;
        self.bits[self.next - 1]
    }

    fn into_bytes(self) -> Vec<u8> {
        let byte = |bits: &[bool]| bits.iter().zip((0..8).rev()).map(|(&bit, i)| u8::from(bit) << i).sum();
        self.bits.chunks(8).map(byte).collect()
    }

    fn number(&mut self, fixed: u32, value: u64) -> u64 {
        let mut prefix = 0_u32;
        while self.bit(value >= ((2_u64 << prefix) - 1) << fixed) {
            prefix += 1;
        }
        let first = ((1_u64 << prefix) - 1) << fixed;
        let rest = value.saturating_sub(first);
        let bits = (0..prefix + fixed).rev();
        first + bits.fold(0, |read, i| read << 1 | u64::from(self.bit(rest >> i & 1 == 1)))
    }

    fn near(&mut self, expected: u64, value: u32) -> u32 {
        let expected = expected.min(u64::from(u32::MAX)) as i64;
        let fixed = (64 - expected.leading_zeros()).saturating_sub(4);
        let change = i64::from(value) - expected;
        let folded = if change < 0 { -2 * change - 1 } else { 2 * change } as u64;
        let folded = self.number(fixed, folded) as i64;
        (expected + if folded % 2 == 0 { folded / 2 } else { -(folded + 1) / 2 }) as u32
    }
}

/// Goes through a table; without rows it reads them.
fn table(bits: &mut Bits, wanted: &[Row]) -> Vec<Row> {
    let count = bits.number(4, (wanted.len() as u64).saturating_sub(1)) as usize;
    let mut rows: Vec<Row> = Vec::new();
    let zeros = Row { head: vec![0; 3], size: 0 };
    // Numerator and denominator of what is expected: see section 4.3.
    let (mut odd, mut boundary, mut split, mut refine) = ((3, 8), (0, 1), (3, 1), (1, 2));
    let mut there = 0_u64;
    let of = |(a, b): (u64, u64), n: u64| n * a / b.max(1);
    for pass in 0..=count {
        let row = wanted.get(pass).unwrap_or(&zeros);
        let head = &row.head;
        if pass == 0 {
            let quantization_bits = bits.number(2, head[0].into()) as u32;
            let vertices = bits.near(36, head[1]);
            let v = u64::from(vertices);
            let faces = bits.near((2 * v).min(u64::from(u32::MAX)).saturating_sub(4), head[2]);
            let size = bits.near(2 * v, row.size);
            rows.push(Row { head: vec![quantization_bits, vertices, faces], size });
            there = v;
        } else if bits.bit(*head == [0]) {
            let size = bits.near(of(refine, there), row.size);
            refine = (size.into(), there);
            rows.push(Row { head: vec![0], size });
        } else {
            let vertices = bits.near(of(odd, there), head[0]);
            let v = u64::from(vertices);
            let on_boundary = bits.near(of(boundary, v), head[1]);
            let size = bits.near(of(split, v), row.size);
            (odd, boundary, split) = ((v, there), (on_boundary.into(), v), (size.into(), v));
            there += v;
            rows.push(Row { head: vec![vertices, on_boundary], size });
        }
    }
    rows
}

pub fn read_table(payload: &[u8]) -> Vec<Row> {
    let bits = payload.iter().flat_map(|byte| (0..8).rev().map(move |i| byte >> i & 1 == 1)).collect();
    let mut bits = Bits { bits, next: 0, is_reading: true };
    let rows = table(&mut bits, &[]);
    assert_eq!(bits.next.div_ceil(8), payload.len());
    rows
}

/// A table that says how many passes there are and nothing else.
pub fn write_count(passes: u64) -> Vec<u8> {
    let mut bits = Bits { bits: Vec::new(), next: 0, is_reading: false };
    bits.number(4, passes);
    bits.into_bytes()
}

pub fn write_table(rows: &[Row]) -> Vec<u8> {
    let mut bits = Bits { bits: Vec::new(), next: 0, is_reading: false };
    table(&mut bits, rows);
    bits.into_bytes()
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

/// The stream whose announcements are those of the chunks behind the last pass, as they stand.
pub fn join_announced(chunks: &[Chunk]) -> Vec<u8> {
    let last = chunks.iter().rposition(Chunk::is_pass).expect("a pass");
    let trailing: Vec<&Chunk> = chunks[last..].iter().filter(|c| !b"BSRag".contains(&c.kind)).collect();
    let mut chunks = chunks.to_vec();
    for announced in chunks.iter_mut().filter(|c| c.kind == b't') {
        let mut rest = &announced.payload[..];
        let mut payload = Vec::new();
        let num_stitched = take_varint(&mut rest);
        payload.extend(varint(num_stitched));
        (0..2 * num_stitched).for_each(|_| payload.extend(varint(take_varint(&mut rest))));
        for chunk in &trailing {
            payload.push(chunk.kind);
            payload.extend(varint(chunk.payload.len() as u32));
        }
        announced.payload = payload;
    }
    join(&chunks)
}

/// A header chunk of the narrow form: `precision` bits over the unit cube.
pub fn header(quantization_bits: u8) -> Chunk {
    let mut payload = vec![0, quantization_bits];
    [0.0_f32, 0.0, 0.0, 1.0].iter().for_each(|x| payload.extend(x.to_le_bytes()));
    Chunk { kind: b'H', payload }
}
