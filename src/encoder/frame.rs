//! From payloads to a stream: headers, passes and what follows them, each framed as a chunk (`format/SPEC.md`,
//! section 4).

use super::attributes::Quantized;
use super::options::EncodeOptions;
use crate::bitstream::chunk::{self, kind};
use crate::bitstream::chunk_index::ChunkIndex;
use crate::bitstream::compensation::Compensation;
use crate::bitstream::grid::Grid;
use crate::bitstream::header::{Header, Pass, Provenance};
use crate::bitstream::pass_table;

/// Materials of at most this many bytes come before the passes: the base mesh should not have to wait for pictures.
const MOST_IN_FRONT: usize = 1 << 12;

/// Row of the table and payload of a pass, and the payload of the stitching chunk after it.
pub(super) struct WrittenPass {
    pub(super) row: Pass,
    pub(super) payload: Vec<u8>,
    pub(super) stitching: Option<Vec<u8>>,
    pub(super) compensation: Compensation,
}

impl WrittenPass {
    /// Makes the payload longer; returns by how much.
    pub(super) fn append_zeros(&mut self, count: u64) -> u64 {
        self.payload.resize(self.payload.len() + count as usize, 0);
        self.row.bytes = self.payload.len() as u32;
        count
    }
}

/// The payloads of a stream from the base mesh on.
pub(super) struct Payloads {
    pub(super) passes: Vec<WrittenPass>,
    /// The values of all attributes after each pass.
    pub(super) values: Vec<Vec<u8>>,
    /// Kinds and payloads of the chunks after the last pass.
    pub(super) trailing: Vec<(u8, Vec<u8>)>,
}

/// Materials, if they are small enough to come before the passes.
fn materials_in_front(quantized: &Quantized) -> Option<&Vec<u8>> {
    quantized.materials.as_ref().filter(|materials| materials.len() <= MOST_IN_FRONT)
}

/// The chunk of materials, if they are too large to come before the passes.
pub(super) fn trailing_materials(quantized: &Quantized) -> Option<(u8, Vec<u8>)> {
    let is_large = materials_in_front(quantized).is_none();
    quantized.materials.as_ref().filter(|_| is_large).map(|materials| (kind::MATERIALS, materials.clone()))
}

/// The stream.
pub(super) fn assemble(
    grid: &Grid,
    options: &EncodeOptions,
    quantized: &Quantized,
    payloads: &Payloads,
) -> Vec<u8> {
    let mut bytes = chunk::SIGNATURE.to_vec();
    bytes.push(chunk::VERSION);
    let has_levels = payloads.passes.len() > 1;
    write_header(&mut bytes, grid, options, has_levels);
    write_attributes(&mut bytes, quantized, &payloads.values);
    write_index(&mut bytes, payloads);
    write_table(&mut bytes, &payloads.passes);
    write_passes(&mut bytes, payloads);
    bytes
}

/// The header, and how the hierarchy came about if that is unusual.
fn write_header(bytes: &mut Vec<u8>, grid: &Grid, options: &EncodeOptions, has_levels: bool) {
    let provenance = Provenance {
        descriptor: options.descriptor as u8,
        partition: options.partition as u8,
        rings: options.window.rings,
        radius: options.window.radius,
        growth: options.growth,
    };
    let is_usual = has_levels && provenance == Provenance::USUAL;
    let header = Header { grid: *grid, is_usual, profile: options.profile_used() as u8 };
    chunk::write(bytes, kind::HEADER, &header.write());
    if has_levels && !is_usual {
        chunk::write(bytes, kind::PROVENANCE, &provenance.write());
    }
}

/// What there is to know of attributes before their values.
fn write_attributes(bytes: &mut Vec<u8>, quantized: &Quantized, values: &[Vec<u8>]) {
    if !quantized.is_empty() {
        chunk::write(bytes, kind::DECLARATIONS, &quantized.declare(values).write());
    }
    if let Some(scene) = &quantized.scene {
        chunk::write(bytes, kind::SCENE, scene);
    }
    if let Some(metadata) = &quantized.metadata {
        chunk::write(bytes, kind::METADATA, metadata);
    }
    if let Some(materials) = materials_in_front(quantized) {
        chunk::write(bytes, kind::MATERIALS, materials);
    }
}

/// The index of the chunks that follow passes.
fn write_index(bytes: &mut Vec<u8>, Payloads { passes, trailing, .. }: &Payloads) {
    let stitching =
        passes.iter().zip(0..).filter_map(|(pass, i)| Some((i, pass.stitching.as_ref()?.len() as u32)));
    let announced = ChunkIndex {
        stitching: stitching.collect(),
        trailing: trailing.iter().map(|(kind, payload)| (*kind, payload.len() as u32)).collect(),
    };
    if !announced.is_empty() {
        chunk::write(bytes, kind::ANNOUNCED, &announced.write());
    }
}

/// The table of passes, and how the mesh after each of them is best shown.
fn write_table(bytes: &mut Vec<u8>, passes: &[WrittenPass]) {
    let coarser = &passes[..passes.len() - 1];
    let compensation: Vec<Compensation> = coarser.iter().map(|pass| pass.compensation).collect();
    if compensation.iter().any(|&compensation| compensation != Compensation::NONE) {
        chunk::write(bytes, kind::COMPENSATION, &Compensation::write(&compensation));
    }
    let rows: Vec<Pass> = passes.iter().map(|pass| pass.row).collect();
    chunk::write(bytes, kind::PASSES, &pass_table::write_passes(&rows));
}

/// The passes, each followed by what belongs to it, then the rest.
fn write_passes(bytes: &mut Vec<u8>, Payloads { passes, values, trailing }: &Payloads) {
    for (i, WrittenPass { row, payload, stitching, .. }) in passes.iter().enumerate() {
        chunk::write(bytes, row.action.kind(), payload);
        if let Some(values) = values.get(i).filter(|values| !values.is_empty()) {
            chunk::write(bytes, kind::ATTRIBUTES, values);
        }
        if let Some(stitching) = stitching {
            chunk::write(bytes, kind::STITCHING, stitching);
        }
    }
    for (kind, payload) in trailing {
        chunk::write(bytes, *kind, payload);
    }
}
