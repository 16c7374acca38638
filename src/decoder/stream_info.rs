//! What a stream declares before its first pass.

use crate::bitstream::chunk;
use crate::bitstream::chunk_index::ChunkIndex;
use crate::bitstream::compensation::Compensation;
use crate::bitstream::grid::{Grid, Lattice, Spread};
use crate::bitstream::header::{Action, Pass, Provenance};
use crate::bitstream::pass_table::{self, BadTable};
use crate::bitstream::profile::Profile;
use crate::mesh::{ComponentType, Domain, SceneTable, Semantic};
use crate::passes::attribute::{Coding, Declaration};
use std::sync::Arc;

/// What a stream says about itself before its first pass.
#[derive(Clone, Debug)]
pub struct StreamInfo {
    pub(super) grid: Grid,
    pub(super) provenance: Option<Provenance>,
    pub(super) profile: Profile,
    pub(super) passes: Vec<PassInfo>,
    pub(super) attributes: Vec<AttributeInfo>,
    pub(super) trailing: Vec<TrailingInfo>,
    pub(super) scene: Option<SceneTable>,
    pub(super) metadata: Option<Arc<[(String, String)]>>,
    pub(super) work: u64,
}

/// What a stream says about one of its attributes.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct AttributeInfo {
    /// What the file called it.
    pub name: String,
    /// What the values mean.
    pub semantic: Semantic,
    /// What has a value.
    pub domain: Domain,
    /// Components of an entry.
    pub num_components: usize,
    /// Type of the values, `None` for names.
    pub component_type: Option<ComponentType>,
    /// Bits of each of the integers that are coded for an entry.
    pub bits: u32,
}

impl AttributeInfo {
    pub(super) fn of(declaration: &Declaration) -> Self {
        Self {
            name: declaration.name.clone(),
            semantic: declaration.semantic,
            domain: declaration.domain,
            num_components: declaration.num_components,
            component_type: declaration.scalar,
            bits: match declaration.coding {
                Coding::Uniform { bits, .. } | Coding::Octahedral { bits } => bits,
                Coding::Table { .. } => usize::BITS - (declaration.table_len() - 1).leading_zeros(),
            },
        }
    }
}

/// What a chunk after the last pass holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum TrailingKind {
    /// Vertices without triangles and triangles that name a vertex twice.
    Loose,
    /// The coordinates bit for bit.
    Exact,
    /// Values of attributes bit for bit, and those of isolated vertices and degenerate faces.
    Values,
    /// The order of vertices and triangles.
    Order,
    /// How materials look.
    Materials,
    /// Something that a newer encoder wrote.
    Unknown,
}

impl TrailingKind {
    pub(crate) fn new(kind: u8) -> Self {
        match kind {
            chunk::kind::LOOSE => Self::Loose,
            chunk::kind::EXACT => Self::Exact,
            chunk::kind::VALUES => Self::Values,
            chunk::kind::ORDER => Self::Order,
            chunk::kind::MATERIALS => Self::Materials,
            _ => Self::Unknown,
        }
    }

    /// Name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Loose => "isolated and degenerate",
            Self::Exact => "exact coordinates",
            Self::Values => "exact values",
            Self::Order => "order",
            Self::Materials => "materials",
            Self::Unknown => "unknown",
        }
    }
}

/// A chunk after the last pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TrailingInfo {
    /// What is in it.
    pub kind: TrailingKind,
    /// Its bytes: frame, payload and checksum.
    pub bytes: u64,
    /// Bytes of the stream up to its end.
    pub end: u64,
    pub(super) code: u8,
}

/// Kind of a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PassKind {
    /// The base mesh, level 0.
    Base,
    /// The odd vertices of one level.
    Split,
    /// One more bit of precision.
    Refine,
}

impl PassKind {
    /// Name in reports.
    pub fn name(self) -> &'static str {
        match self {
            PassKind::Base => "base",
            PassKind::Split => "split",
            PassKind::Refine => "refine",
        }
    }
}

/// One pass of a stream, and the mesh after it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PassInfo {
    /// What the pass does.
    pub kind: PassKind,
    /// Level after the pass.
    pub level: u32,
    /// Bits per coordinate after the pass.
    pub quantization_bits: u32,
    /// Vertices after the pass.
    pub vertices: u32,
    /// Triangles after the pass.
    pub triangles: u32,
    /// Bytes of its chunk: kind, payload and checksum.
    pub bytes: u64,
    /// Bytes of the chunk with the values of attributes that follows it, 0 without one.
    pub attribute_bytes: u64,
    /// Bytes of the stitching chunk that follows, which joins vertices again that were cut apart, 0 without
    /// one.
    pub stitching_bytes: u64,
    /// Bytes of the stream up to the end of the pass and of the chunks that belong to it.
    pub end: u64,
    pub(super) compensation: Compensation,
    pub(super) row: Pass,
}

impl PassInfo {
    /// How far vertices are shown off their places after the pass ([`LevelMesh::positions`](crate::LevelMesh::positions)):
    /// shares of the bend of a vertex, and of the mean bend of its neighbours.
    pub fn compensation(&self) -> [f64; 2] {
        let Compensation { own, around } = self.compensation;
        [own, around].map(|weight| f64::from(weight) / Compensation::UNIT)
    }

    /// What its chunk must be.
    pub(super) fn frame(&self) -> (u8, u32) {
        (self.row.action.kind(), self.row.bytes)
    }
}

impl StreamInfo {
    /// Bits per coordinate of the finest mesh.
    pub fn quantization_bits(&self) -> u32 {
        self.grid.quantization_bits
    }

    /// Smallest corner of the grid, model units.
    pub fn origin(&self) -> [f64; 3] {
        self.grid.origin()
    }

    /// Sides of a cell of the finest grid, model units: all equal unless the grid is on a [`lattice`](Self::lattice).
    pub fn step(&self) -> [f64; 3] {
        self.grid.step(self.grid.quantization_bits)
    }

    /// Longest side of the grid, model units: 2^quantization_bits − 1 of the largest steps.
    pub fn side(&self) -> f64 {
        self.grid.side()
    }

    /// The lattice whose points the vertices are, if the grid is on one and not in a cube.
    pub fn lattice(&self) -> Option<Lattice> {
        match self.grid.spread {
            Spread::Cube { .. } => None,
            Spread::Lattice { lattice, .. } => Some(lattice),
        }
    }

    /// The number of the point of the [`lattice`](Self::lattice) that cell (0, 0, 0) is, per axis: at most 2^51 off 0. All
    /// 0 without a lattice.
    pub fn lattice_offset(&self) -> [i64; 3] {
        match self.grid.spread {
            Spread::Cube { .. } => [0; 3],
            Spread::Lattice { offset, .. } => offset,
        }
    }

    /// Finest level.
    pub fn finest_level(&self) -> u32 {
        self.passes.last().map_or(0, |p| p.level)
    }

    /// How it is coded.
    pub fn profile(&self) -> Profile {
        self.profile
    }

    /// All passes in order.
    pub fn passes(&self) -> &[PassInfo] {
        &self.passes
    }

    /// The scene whose meshes these are, if it is one: see [`Attributes::scene`](crate::mesh::Attributes::scene).
    pub fn scene(&self) -> Option<&SceneTable> {
        self.scene.as_ref()
    }

    /// What else is known of the whole: see [`Attributes::metadata`](crate::mesh::Attributes::metadata).
    pub fn metadata(&self) -> &[(String, String)] {
        self.metadata.as_deref().unwrap_or_default()
    }

    /// What follows the last pass, in order.
    pub fn trailing(&self) -> &[TrailingInfo] {
        &self.trailing
    }

    /// Bytes of the whole stream, not counting skippable chunks between passes that the stream does not list.
    pub fn total_bytes(&self) -> u64 {
        let last_pass = self.passes.last().map(|p| p.end);
        self.trailing.last().map(|t| t.end).or(last_pass).unwrap_or(0)
    }

    /// Most units of work that decoding takes, as [`Decoder::work_done`](crate::Decoder::work_done) counts
    /// them, without isolated vertices and degenerate faces. See [`Limits::max_work`](crate::Limits::max_work).
    pub fn work(&self) -> u64 {
        self.work
    }

    /// The attributes, in the order of [`Decoder::attributes`](crate::Decoder::attributes).
    pub fn attributes(&self) -> &[AttributeInfo] {
        &self.attributes
    }

    /// Number of the descriptor that chose the odd vertices (`format/SPEC.md`, section 4.2).
    pub fn descriptor_code(&self) -> Option<u8> {
        self.provenance.map(|p| p.descriptor)
    }

    /// Number of the partition.
    pub fn partition_code(&self) -> Option<u8> {
        self.provenance.map(|p| p.partition)
    }

    /// Window of the descriptor: rings, radius in mean edges at the finest level, growth per level.
    pub fn window(&self) -> Option<(u32, f64, f64)> {
        self.provenance.map(|p| (p.rings, p.radius, p.growth))
    }
}

/// Notes how the mesh is shown after each pass but the last, after which nothing is missing.
pub(super) fn add_compensation(passes: &mut [PassInfo], payload: &[u8]) -> Result<(), BadTable> {
    let Some((_, coarser)) = passes.split_last_mut() else { return Ok(()) };
    let all = Compensation::read(payload, coarser.len()).ok_or(BadTable("the compensation"))?;
    coarser.iter_mut().zip(all).for_each(|(pass, compensation)| pass.compensation = compensation);
    Ok(())
}

/// Turns the table of passes into running totals. `start` is where the first pass begins, `attributes` the
/// payload of the attributes after each pass: as many rows, or none.
pub(super) fn list_passes(
    payload: &[u8],
    grid: &Grid,
    start: u64,
    attributes: &[u32],
) -> Result<Vec<PassInfo>, BadTable> {
    let rows = pass_table::read_passes(payload, grid)?;
    if !attributes.is_empty() && attributes.len() != rows.len() {
        return Err(BadTable("attributes are declared for other passes"));
    }
    let mut passes: Vec<PassInfo> = Vec::with_capacity(rows.len());
    for (i, row) in rows.into_iter().enumerate() {
        let bytes = chunk::pass_size(row.bytes);
        let attribute_bytes = attributes.get(i).filter(|&&b| b > 0).map_or(0, |&b| chunk::other_size(b));
        let with_companions = bytes + attribute_bytes;
        let next = match (row.action, passes.last()) {
            (Action::Base { quantization_bits }, _) => PassInfo {
                kind: PassKind::Base,
                level: 0,
                quantization_bits,
                vertices: row.vertices,
                triangles: row.triangles,
                bytes,
                attribute_bytes,
                stitching_bytes: 0,
                end: start + with_companions,
                compensation: Compensation::NONE,
                row,
            },
            (_, None) => return Err(BadTable("the first pass is no base mesh")),
            (action, Some(before)) => PassInfo {
                kind: if action == Action::Split { PassKind::Split } else { PassKind::Refine },
                level: before.level + u32::from(action == Action::Split),
                quantization_bits: before.quantization_bits + u32::from(action == Action::Refine),
                vertices: before.vertices + row.vertices,
                triangles: before.triangles + row.triangles,
                bytes,
                attribute_bytes,
                stitching_bytes: 0,
                end: before.end + with_companions,
                compensation: Compensation::NONE,
                row,
            },
        };
        passes.push(next);
    }
    Ok(passes)
}

/// Makes room for the trailing chunks: stitching after passes, and what follows the last pass.
pub(super) fn add_announced(
    passes: &mut [PassInfo],
    announced: &ChunkIndex,
) -> Result<Vec<TrailingInfo>, BadTable> {
    let mut shift = 0;
    let mut stitching = announced.stitching.iter().peekable();
    for (pass, i) in passes.iter_mut().zip(0..) {
        if let Some(&(_, bytes)) = stitching.next_if(|&&(pass, _)| pass == i) {
            pass.stitching_bytes = chunk::other_size(bytes);
            shift += pass.stitching_bytes;
        }
        pass.end += shift;
    }
    if stitching.peek().is_some() {
        return Err(BadTable("stitching is announced for a pass that is not there"));
    }
    let mut end = passes.last().map_or(0, |p| p.end);
    let place = |&(kind, payload): &(u8, u32)| {
        let bytes = chunk::other_size(payload);
        end += bytes;
        TrailingInfo { kind: TrailingKind::new(kind), bytes, end, code: kind }
    };
    Ok(announced.trailing.iter().map(place).collect())
}
