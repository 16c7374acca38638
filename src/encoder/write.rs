//! Up the levels: the decoder's own steps, with the truth at hand.

use super::analysis::{ANALYSIS_SHARE, Hierarchy};
use super::attribute_writer::AttributeWriter;
use super::attributes::Quantised;
use super::options::Progress;
use super::schedule::{Schedule, Step};
use super::trailing::{Exact, Written};
use super::{expect_sound, padded};
use crate::Profile;
use crate::bitstream::announced::Announced;
use crate::bitstream::chunk::{self, kind};
use crate::bitstream::header::{Action, Header, MAX_VERTICES_PER_BYTE, Pass, Provenance};
use crate::bitstream::pass_table;
use crate::bitstream::range_coder::{BitCoder, RangeEncoder};
use crate::bitstream::streams::StreamWriter;
use crate::mesh::surface::{NO_CORNER, next, prev};
use crate::passes::GridMesh;
use crate::passes::base::{self, BaseTarget};
use crate::passes::connectivity::{self, ConnectivityModels, ConnectivityTarget, NOT_IN_PATCH};
use crate::passes::coordinates::{self, CoordinateModels};
use crate::passes::glue::{self, GlueModels};
use crate::passes::patch::{Patches, Star, StarBuilder};
use crate::passes::plain::{self, Located};
use crate::passes::refine::{self, RefineModels};
use crate::passes::work::Work;
use crate::simplify::LevelRecord;
use bitvec::vec::BitVec;
use std::collections::HashMap;

/// Materials of at most this many bytes stand in front of the passes: the base mesh should not have to wait for
/// pictures.
const MOST_IN_FRONT: usize = 1 << 12;

/// Writes the stream. `cells` are those of the full surface at full precision.
pub(super) fn write(
    hierarchy: &Hierarchy,
    cells: &[[i32; 3]],
    attributes: &Quantised,
    exact: &Exact,
    schedule: &Schedule,
    progress: &(dyn Fn(Progress) + Sync),
) -> Vec<u8> {
    let mut writer = PassWriter::new(hierarchy, cells, attributes, exact, schedule.base_precision);
    for step in &schedule.steps {
        let fraction = writer.mesh.positions.len() as f64 / hierarchy.num_vertices as f64;
        progress(Progress { stage: "passes", fraction: ANALYSIS_SHARE + (1.0 - ANALYSIS_SHARE) * fraction });
        match *step {
            Step::Split(record) => writer.split(&hierarchy.records[record]),
            Step::Refine => writer.refine(),
        }
    }
    debug_assert_eq!(writer.mesh.surface.triangles.len(), hierarchy.num_faces);
    let surface = Written {
        mesh: &writer.mesh,
        vertex_source: &writer.vertex_source,
        face_source: &writer.face_source,
        rows: writer.attributes.rows(),
    };
    let mut trailing = exact.trailing(&surface, writer.roots);
    let is_large = |payload: &&Vec<u8>| payload.len() > MOST_IN_FRONT;
    trailing.extend(attributes.materials.iter().filter(is_large).map(|m| (kind::MATERIALS, m.clone())));
    let values = writer.attributes.into_payloads();
    assemble(exact, hierarchy, attributes, &writer.passes, &values, &trailing)
}

/// Frames headers and passes.
fn assemble(
    exact: &Exact,
    hierarchy: &Hierarchy,
    attributes: &Quantised,
    passes: &[WrittenPass],
    values: &[Vec<u8>],
    trailing: &[(u8, Vec<u8>)],
) -> Vec<u8> {
    let Exact { grid, options, .. } = *exact;
    let mut bytes = chunk::SIGNATURE.to_vec();
    bytes.push(chunk::VERSION);
    let provenance = Provenance {
        descriptor: options.descriptor as u8,
        partition: options.partition as u8,
        rings: options.window.rings,
        radius: options.window.radius,
        growth: options.growth,
    };
    let has_levels = !hierarchy.records.is_empty();
    let is_usual = has_levels && provenance == Provenance::USUAL;
    chunk::write(
        &mut bytes,
        kind::HEADER,
        &Header { grid: *grid, is_usual, profile: options.profile as u8 }.write(),
    );
    if has_levels && !is_usual {
        chunk::write(&mut bytes, kind::PROVENANCE, &provenance.write());
    }
    if !attributes.is_empty() {
        chunk::write(&mut bytes, kind::DECLARATIONS, &attributes.declare(values).write());
    }
    if let Some(scene) = &attributes.scene {
        chunk::write(&mut bytes, kind::SCENE, scene);
    }
    if let Some(materials) = attributes.materials.as_ref().filter(|m| m.len() <= MOST_IN_FRONT) {
        chunk::write(&mut bytes, kind::MATERIALS, materials);
    }
    let glue = passes.iter().zip(0..).filter_map(|(pass, i)| Some((i, pass.glue.as_ref()?.len() as u32)));
    let announced = Announced {
        glue: glue.collect(),
        trailing: trailing.iter().map(|(kind, payload)| (*kind, payload.len() as u32)).collect(),
    };
    if !announced.is_empty() {
        chunk::write(&mut bytes, kind::ANNOUNCED, &announced.write());
    }
    let rows: Vec<Pass> = passes.iter().map(|pass| pass.row).collect();
    chunk::write(&mut bytes, kind::PASSES, &pass_table::write_passes(&rows));
    for (i, WrittenPass { row, payload, glue }) in passes.iter().enumerate() {
        chunk::write(&mut bytes, row.action.kind(), payload);
        if let Some(values) = values.get(i).filter(|values| !values.is_empty()) {
            chunk::write(&mut bytes, kind::ATTRIBUTES, values);
        }
        if let Some(glue) = glue {
            chunk::write(&mut bytes, kind::GLUE, glue);
        }
    }
    for (kind, payload) in trailing {
        chunk::write(&mut bytes, *kind, payload);
    }
    bytes
}

/// Row and payload of a pass, and the glue behind it.
struct WrittenPass {
    row: Pass,
    payload: Vec<u8>,
    glue: Option<Vec<u8>>,
}

/// The decoder's state, and how its numbering maps to that of the full surface.
struct PassWriter<'a> {
    cells: &'a [[i32; 3]],
    profile: Profile,
    full_precision: u32,
    precision: u32,
    mesh: GridMesh,
    /// Vertex of the full surface that each vertex is.
    vertex_source: Vec<u32>,
    /// Slot of the full surface that each triangle has.
    face_source: Vec<u32>,
    connectivity: ConnectivityModels,
    coordinates: CoordinateModels,
    refine: RefineModels,
    attributes: AttributeWriter<'a>,
    /// Scratch: patch of each slot of the full surface.
    patch_of_slot: Vec<u32>,
    passes: Vec<WrittenPass>,
    /// Vertex of the joined surface for each vertex of the full one.
    source: &'a [u32],
    glue: GlueModels,
    roots: Vec<u32>,
    /// Vertices before the present pass.
    num_seen: usize,
    /// For each joined vertex whether it has come.
    has_come: BitVec,
}

impl<'a> PassWriter<'a> {
    fn new(
        hierarchy: &Hierarchy,
        cells: &'a [[i32; 3]],
        attributes: &'a Quantised,
        exact: &Exact<'a>,
        precision: u32,
    ) -> Self {
        let full_precision = exact.grid.precision;
        let profile = exact.options.profile;
        let hidden = full_precision - precision;
        let positions: Vec<[i32; 3]> =
            hierarchy.base_vertices.iter().map(|&v| cells[v as usize].map(|c| c >> hidden)).collect();
        let target = BaseTarget { surface: &hierarchy.base, positions: &positions };
        let (num_vertices, num_faces) = (positions.len(), hierarchy.base.triangles.len());
        let mut coder = RangeEncoder::new();
        let coded = base::code(&mut coder, num_vertices, num_faces, precision, Some(&target));
        let coded = expect_sound(coded);
        let mut writer = Self {
            cells,
            profile,
            full_precision,
            precision,
            mesh: coded.mesh,
            vertex_source: coded.vertex_source.iter().map(|&v| hierarchy.base_vertices[v as usize]).collect(),
            face_source: coded
                .corner_source
                .iter()
                .map(|&c| hierarchy.base_faces[(c / 3) as usize])
                .collect(),
            connectivity: ConnectivityModels::new(),
            coordinates: CoordinateModels::new(),
            refine: RefineModels::new(),
            attributes: AttributeWriter::new(attributes),
            patch_of_slot: vec![NOT_IN_PATCH; hierarchy.num_faces],
            passes: Vec::new(),
            source: exact.source,
            glue: GlueModels::default(),
            roots: Vec::new(),
            num_seen: 0,
            has_come: BitVec::repeat(false, exact.ordered.cells.len()),
        };
        let more_vertices = hierarchy.num_vertices - num_vertices;
        writer.mesh.reserve(more_vertices, hierarchy.num_faces - num_faces);
        let row = Pass {
            action: Action::Base { precision },
            vertices: num_vertices as u32,
            faces: num_faces as u32,
            bytes: 0,
        };
        writer.finish_pass(row, num_vertices.max(num_faces), coder.finish());
        let Self { mesh, vertex_source, face_source, attributes, .. } = &mut writer;
        attributes.base(mesh, hierarchy, vertex_source, face_source);
        writer
    }

    fn finish_pass(&mut self, mut row: Pass, touched: usize, payload: Vec<u8>) {
        let payload = padded(payload, touched as u64, u64::from(MAX_VERTICES_PER_BYTE));
        row.bytes = payload.len() as u32;
        let glue = self.glue_of_new_vertices();
        self.passes.push(WrittenPass { row, payload, glue });
    }

    /// Payload of the glue behind a pass, if one of its vertices is the same as one that is there.
    fn glue_of_new_vertices(&mut self) -> Option<Vec<u8>> {
        let num_old = self.num_seen;
        self.num_seen = self.vertex_source.len();
        let mut is_glued = false;
        for &v in &self.vertex_source[num_old..] {
            is_glued |= self.has_come.replace(self.source[v as usize] as usize, true);
        }
        if !is_glued {
            return None;
        }
        let names: Vec<u32> = self.vertex_source.iter().map(|&v| self.source[v as usize]).collect();
        let mut coder = RangeEncoder::new();
        expect_sound(glue::code(&mut coder, &mut self.glue, &self.mesh, &mut self.roots, Some(&names)));
        Some(coder.finish())
    }

    fn refine(&mut self) {
        self.precision += 1;
        let hidden = self.full_precision - self.precision;
        let target: Vec<[i32; 3]> =
            self.vertex_source.iter().map(|&v| self.cells[v as usize].map(|c| c >> hidden)).collect();
        let payload = match self.profile {
            Profile::Small => {
                let mut coder = RangeEncoder::new();
                refine::code(&mut coder, &mut self.refine, &mut self.mesh, Some(&target));
                coder.finish()
            }
            Profile::Fast => {
                let mut coder = StreamWriter::new(0);
                let positions = &mut self.mesh.positions;
                positions.iter_mut().flatten().for_each(|c| *c *= 2);
                plain::refine_some(&mut coder, positions, &mut 0, Some(&target), &mut Work::unlimited());
                coder.finish()
            }
        };
        debug_assert_eq!(self.mesh.positions, target);
        let row = Pass { action: Action::Refine, vertices: 0, faces: 0, bytes: 0 };
        self.finish_pass(row, target.len(), payload);
        self.attributes.refine();
    }

    fn split(&mut self, record: &LevelRecord) {
        let num_faces = self.mesh.surface.triangles.len();
        let num_coarse = self.mesh.positions.len();
        let (patches, payload) = match self.profile {
            Profile::Small => {
                let mut coder = RangeEncoder::new();
                (self.split_with(&mut coder, record), coder.finish())
            }
            Profile::Fast => {
                let mut coder = StreamWriter::new(record.len() as u32);
                (self.split_with(&mut coder, record), coder.finish())
            }
        };
        let row = Pass {
            action: Action::Split,
            vertices: record.len() as u32,
            faces: (self.mesh.surface.triangles.len() - num_faces) as u32,
            bytes: 0,
        };
        self.finish_pass(row, record.len(), payload);
        self.attributes.split(&self.mesh, &patches, num_coarse, &self.vertex_source);
    }

    fn split_with<B: BitCoder>(&mut self, coder: &mut B, record: &LevelRecord) -> Patches {
        let target = self.connectivity_target(record);
        let (models, mesh) = (&mut self.connectivity, &self.mesh);
        let patches = expect_sound(connectivity::code(coder, models, mesh, record.len(), Some(&target)));
        let odd: Vec<u32> = (0..patches.len()).map(|j| odd_of(&target, &patches, j)).collect();
        drop(target);

        let hidden = self.full_precision - self.precision;
        let sources = odd.iter().map(|&o| record.get(o as usize).vertex);
        let wanted: Vec<[i32; 3]> = sources.map(|v| self.cells[v as usize].map(|c| c >> hidden)).collect();
        let mut builder = StarBuilder::new(self.mesh.positions.len());
        for (j, &odd) in odd.iter().enumerate() {
            let star = expect_sound(builder.restore(&mut self.mesh.surface, &patches, j));
            let removed = record.get(odd as usize);
            self.face_source.resize(self.mesh.surface.triangles.len(), 0);
            let shift = name_faces(star, &removed, &self.vertex_source, &mut self.face_source);
            self.attributes.restore(star, record, &removed, shift);
            if B::HAS_STREAMS {
                let GridMesh { positions, roughness, .. } = &mut self.mesh;
                let (mut known, limit) = (Located { positions, roughness }, 1 << self.precision);
                expect_sound(plain::code_vertex(coder, &mut known, &patches, j, star, limit, wanted[j]));
            }
        }
        self.vertex_source.extend(odd.iter().map(|&o| record.get(o as usize).vertex));
        if !B::HAS_STREAMS {
            let (models, mesh) = (&mut self.coordinates, &mut self.mesh);
            expect_sound(coordinates::code(coder, models, mesh, &patches, self.precision, Some(&wanted)));
        }
        patches
    }

    /// Translates a record into the decoder's numbering.
    fn connectivity_target(&mut self, record: &LevelRecord) -> ConnectivityTarget {
        let mut open: HashMap<(u32, u32), u32> = HashMap::new();
        for (odd, removed) in record.iter().enumerate() {
            removed.patch().iter().for_each(|&slot| self.patch_of_slot[slot as usize] = odd as u32);
            if !removed.is_closed() {
                let last = removed.ring[removed.ring.len() - 1];
                open.insert((last, removed.ring[0]), odd as u32);
            }
        }
        let patch_of_face = self.face_source.iter().map(|&s| self.patch_of_slot[s as usize]).collect();
        record
            .iter()
            .for_each(|r| r.patch().iter().for_each(|&s| self.patch_of_slot[s as usize] = NOT_IN_PATCH));

        let mut target = ConnectivityTarget { patch_of_face, ..Default::default() };
        let surface = &self.mesh.surface;
        if !open.is_empty() {
            for corner in (0..surface.opposite.len() as u32).filter(|&c| surface.across(c) == NO_CORNER) {
                let [from, to] =
                    [next(corner), prev(corner)].map(|c| self.vertex_source[surface.vertex(c) as usize]);
                if let Some(&odd) = open.get(&(from, to)) {
                    let is_ear = record.get(odd as usize).patch().is_empty();
                    let map = if is_ear { &mut target.ear_at } else { &mut target.patch_open_at };
                    map.insert(corner, odd);
                }
            }
        }
        target
    }
}

/// The record entry that a patch stands for.
fn odd_of(target: &ConnectivityTarget, patches: &Patches, patch: usize) -> u32 {
    match patches.faces(patch).first() {
        Some(&face) => target.patch_of_face[face as usize],
        None => target.ear_at[&patches.edges(patch)[0]],
    }
}

/// Notes which slots of the full surface the triangles of a star have. Returns which of the removed faces the first
/// one is.
fn name_faces(
    star: &Star,
    removed: &crate::simplify::record::Removed,
    vertex_source: &[u32],
    face_source: &mut [u32],
) -> usize {
    let first = vertex_source[star.ring[0] as usize];
    let shift = removed.ring.iter().position(|&v| v == first).unwrap_or(0);
    for (i, &face) in star.faces.iter().enumerate() {
        face_source[face as usize] = removed.faces[(shift + i) % removed.faces.len()];
    }
    shift
}
