//! Bodies of the fuzz target for symbols in tables.

use crate::entropy::ans::coder::SymbolCoder;
use crate::entropy::ans::models::{Group, Models};
use crate::entropy::ans::reader::PausedReader;
use crate::entropy::ans::token::NUM_TOKENS;
use crate::entropy::ans::writer::SymbolWriter;
use crate::entropy::range_coder::{RangeDecoder, RangeEncoder};
use crate::mesh::Surface;
use crate::passes::GridMesh;
use crate::passes::base_tables::pass::BaseInTables;
use crate::passes::work_budget::WorkBudget;
use crate::util::bytes::Reader;

const GROUPS: &[Group] = &[
    Group { alphabet: 256, attributes: &[3, 5], most_tables: 9 },
    Group { alphabet: NUM_TOKENS, attributes: &[4], most_tables: 4 },
];

/// Any symbols return; any bytes are symbols or none, and a base mesh in tables or none.
pub fn ans(data: &[u8]) {
    match data.split_first() {
        Some((0..=99, rest)) => symbols_return(rest),
        Some((100..=149, rest)) => read_symbols(rest),
        Some((_, rest)) => read_base(rest),
        None => {}
    }
}

fn code(coder: &mut impl SymbolCoder, data: &[u8], mut see: impl FnMut([u32; 3], [u32; 3])) {
    for entry in data.chunks_exact(8) {
        let context = usize::from(entry[0]);
        let number = u32::from_le_bytes([entry[2], entry[3], entry[4], entry[5]]) >> (entry[6] % 32);
        let count = u32::from(entry[7] % 33);
        let raw = (u64::from(number) & ((1 << count) - 1)) as u32;
        let read = [
            coder.symbol(0, context % 15, entry[1]).into(),
            coder.number(1, context % 4, number),
            coder.raw(raw, count),
        ];
        see([entry[1].into(), number, raw], read);
    }
}

fn open(payload: &[u8]) -> Option<PausedReader> {
    let mut reader = Reader::new(payload);
    let size = reader.varint()? as usize;
    let models = Models::read(&mut RangeDecoder::new(reader.take(size)?), GROUPS)?;
    PausedReader::new(payload, reader, models)
}

fn symbols_return(data: &[u8]) {
    let mut writer = SymbolWriter::new(GROUPS);
    code(&mut writer, data, |wanted, written| assert_eq!(wanted, written));
    let payload = writer.finish(RangeEncoder::new());
    let Some(mut reader) = open(&payload) else { panic!("a sound payload is refused") };
    let mut coder = reader.resume(&payload);
    code(&mut coder, data, |wanted, read| assert_eq!(wanted, read));
    assert!(coder.is_at_end());
}

fn read_symbols(payload: &[u8]) {
    if let Some(mut reader) = open(payload) {
        let mut coder = reader.resume(payload);
        code(&mut coder, &[0x55; 800], |_, _| ());
    }
}

fn read_base(data: &[u8]) {
    let Some(([vertices, triangles], payload)) = data.split_first_chunk() else { return };
    let (vertices, triangles) = (usize::from(*vertices), 2 * usize::from(*triangles));
    let Some(mut pass) = BaseInTables::new(payload, vertices, triangles, 9) else { return };
    if let Ok(Some(mesh)) = pass.advance(payload, &mut WorkBudget::unlimited()) {
        let GridMesh { surface: Surface { triangles, opposite, corner_of, valence }, positions, .. } = mesh;
        assert!(positions.iter().flatten().all(|c| (0..512).contains(c)));
        let again = Surface::from_triangles(triangles, vertices);
        let same =
            again.is_ok_and(|s| (s.opposite, s.corner_of, s.valence) == (opposite, corner_of, valence));
        assert!(same, "a base mesh that is no surface");
    }
}
