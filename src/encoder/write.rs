//! Up the levels: the decoder's own steps, with the truth at hand.

use super::attribute_writer::AttributeWriter;
use super::attributes::Quantised;
use super::coarsen::{ANALYSIS_SHARE, Hierarchy};
use super::compensation::{Fitter, Point};
use super::earnings;
use super::options::Progress;
use super::patch_search::{Found, Names, PatchSearch};
use super::payload::{expect_sound, padded};
use super::schedule::{Schedule, Step};
use super::trailing::{Exact, Written};
use super::written_pass::WrittenPass;
use crate::bitstream::chunk::{self, kind};
use crate::bitstream::chunk_index::ChunkIndex;
use crate::bitstream::compensation::Compensation;
use crate::bitstream::header::{Action, Header, MAX_VERTICES_PER_BYTE, Pass, Provenance};
use crate::bitstream::pass_table;
use crate::bitstream::profile::Profile;
use crate::entropy::range_coder::RangeEncoder;
use crate::entropy::streams::StreamWriter;
use crate::passes::GridMesh;
use crate::passes::base::{self, BaseTarget};
use crate::passes::coordinates::{self, CoordinateModels};
use crate::passes::coordinates_fast::{self, Located};
use crate::passes::patch::{Patches, Star, StarBuilder};
use crate::passes::refine::{self, RefineModels};
use crate::passes::stitching::{self, GlueModels};
use crate::passes::work_budget::WorkBudget;
use crate::simplification::LevelRecord;
use bitvec::vec::BitVec;

/// Materials of at most this many bytes stand in front of the passes: the base mesh should not have to wait for
/// pictures.
const MOST_IN_FRONT: usize = 1 << 12;

/// Writes the stream. `cells` are those of the full surface at full precision.
pub(super) fn write(
    hierarchy: &Hierarchy,
    cells: &[[i32; 3]],
    attributes: &Quantised,
    exact: &Exact,
    points: &[Point],
    schedule: &Schedule,
    progress: &(dyn Fn(Progress) + Sync),
) -> Vec<u8> {
    let (mut writer, mut names) =
        PassWriter::new(hierarchy, cells, attributes, exact, points, schedule.base_bits);
    let mut scout = PatchSearch::new(hierarchy.num_faces, writer.profile.mixing());
    let is_split = |step: &&Step| matches!(step, Step::Split(_));
    let num_first = schedule.steps.iter().take_while(|step| !is_split(step)).count();
    let (first, rest) = schedule.steps.split_at(num_first);
    first.iter().for_each(|_| writer.refine(&names));
    // Each split with the refinements behind it.
    let mut groups = rest.chunk_by(|_, after| !is_split(&after)).peekable();
    let mut found = None;
    while let Some(group) = groups.next() {
        let fraction = writer.mesh.positions.len() as f64 / hierarchy.num_vertices as f64;
        progress(Progress { stage: "passes", fraction: ANALYSIS_SHARE + (1.0 - ANALYSIS_SHARE) * fraction });
        let record_of = |group: &[Step]| match group[0] {
            Step::Split(record) => Some(&hierarchy.records[record]),
            Step::Refine => None,
        };
        let Some(record) = record_of(group) else { continue };
        let num_refinements = group.len() - 1;
        if writer.profile == Profile::Fast {
            writer.split_in_streams(record, &mut names, &mut scout);
            (0..num_refinements).for_each(|_| writer.refine(&names));
            continue;
        }
        let found_now = found.take().unwrap_or_else(|| scout.find(&writer.mesh, &names, record));
        writer.restore(record, &found_now.patches, &found_now.odd, &mut names, |_, _, _, _| ());
        let after = groups.peek().and_then(|group| record_of(group));
        if after.is_some() {
            scout.follow(&writer.mesh.surface);
        }
        let hidden = writer.full_bits - writer.quantization_bits - num_refinements as u32;
        // Which vertices come next does not depend on how these are coded, only on where they are.
        let finish = || {
            writer.split(record, found_now, &names);
            (0..num_refinements).for_each(|_| writer.refine(&names));
        };
        let go_ahead = || after.map(|record| scout.find_ahead(cells, hidden, &names, record));
        ((), found) = rayon::join(finish, go_ahead);
    }
    debug_assert_eq!(writer.mesh.surface.triangles.len(), hierarchy.num_faces);
    let Names { vertex_source, face_source } = &names;
    let rows = writer.attributes.rows();
    let surface = Written { mesh: &writer.mesh, vertex_source, face_source, rows };
    let mut trailing = exact.trailing(&surface, writer.roots);
    let is_large = |payload: &&Vec<u8>| payload.len() > MOST_IN_FRONT;
    trailing.extend(attributes.materials.iter().filter(is_large).map(|m| (kind::MATERIALS, m.clone())));
    let values = writer.attributes.into_payloads();
    let declared = attributes.declare(&values);
    let loose = (exact.loose.len() + exact.loose_corners.len()) as u64;
    earnings::pad(&mut writer.passes, &values, &declared, &trailing, loose);
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
        &Header { grid: *grid, is_usual, profile: options.profile_used() as u8 }.write(),
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
    let announced = ChunkIndex {
        glue: glue.collect(),
        trailing: trailing.iter().map(|(kind, payload)| (*kind, payload.len() as u32)).collect(),
    };
    if !announced.is_empty() {
        chunk::write(&mut bytes, kind::ANNOUNCED, &announced.write());
    }
    let coarser = &passes[..passes.len() - 1];
    let compensation: Vec<Compensation> = coarser.iter().map(|pass| pass.compensation).collect();
    if compensation.iter().any(|&compensation| compensation != Compensation::NONE) {
        chunk::write(&mut bytes, kind::COMPENSATION, &Compensation::write(&compensation));
    }
    let rows: Vec<Pass> = passes.iter().map(|pass| pass.row).collect();
    chunk::write(&mut bytes, kind::PASSES, &pass_table::write_passes(&rows));
    for (i, WrittenPass { row, payload, glue, .. }) in passes.iter().enumerate() {
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

/// The decoder's state.
struct PassWriter<'a> {
    cells: &'a [[i32; 3]],
    profile: Profile,
    full_bits: u32,
    quantization_bits: u32,
    mesh: GridMesh,
    coordinates: CoordinateModels,
    refine: RefineModels,
    attributes: AttributeWriter<'a>,
    passes: Vec<WrittenPass>,
    /// Vertex of the joined surface for each vertex of the full one.
    source: &'a [u32],
    fitter: Fitter<'a>,
    num_faces: usize,
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
        points: &'a [Point],
        quantization_bits: u32,
    ) -> (Self, Names) {
        let full_bits = exact.grid.quantization_bits;
        let profile = exact.options.profile_used();
        let mixing = profile.mixing();
        let hidden = full_bits - quantization_bits;
        let positions: Vec<[i32; 3]> =
            hierarchy.base_vertices.iter().map(|&v| cells[v as usize].map(|c| c >> hidden)).collect();
        let target = BaseTarget { surface: &hierarchy.base, positions: &positions };
        let (num_vertices, num_faces) = (positions.len(), hierarchy.base.triangles.len());
        let mut coder = RangeEncoder::new();
        let coded = base::code(&mut coder, num_vertices, num_faces, quantization_bits, mixing, Some(&target));
        let coded = expect_sound(coded);
        let faces = coded.corner_source.iter().map(|&c| c / 3);
        let names = Names {
            vertex_source: coded.vertex_source.iter().map(|&v| hierarchy.base_vertices[v as usize]).collect(),
            face_source: faces.map(|face| hierarchy.base_faces[face as usize]).collect(),
        };
        let mut writer = Self {
            cells,
            profile,
            full_bits,
            quantization_bits,
            mesh: coded.mesh,
            coordinates: CoordinateModels::new(mixing),
            refine: RefineModels::new(mixing),
            attributes: AttributeWriter::new(attributes, mixing),
            passes: Vec::new(),
            source: exact.source,
            fitter: Fitter::new(points, &hierarchy.records, cells),
            num_faces: hierarchy.num_faces,
            glue: GlueModels::default(),
            roots: Vec::new(),
            num_seen: 0,
            has_come: BitVec::repeat(false, exact.ordered.cells.len()),
        };
        let more_vertices = hierarchy.num_vertices - num_vertices;
        writer.mesh.reserve(more_vertices, hierarchy.num_faces - num_faces);
        let row = Pass {
            action: Action::Base { quantization_bits },
            vertices: num_vertices as u32,
            triangles: num_faces as u32,
            bytes: 0,
        };
        writer.finish_pass(row, num_vertices.max(num_faces), coder.finish(), &names);
        writer.attributes.base(&writer.mesh, hierarchy, &names.vertex_source, &names.face_source);
        (writer, names)
    }

    fn finish_pass(&mut self, mut row: Pass, touched: usize, payload: Vec<u8>, names: &Names) {
        let payload = padded(payload, touched as u64, u64::from(MAX_VERTICES_PER_BYTE));
        row.bytes = payload.len() as u32;
        let glue = self.glue_of_new_vertices(&names.vertex_source);
        let hidden = self.full_bits - self.quantization_bits;
        let is_last = hidden == 0 && self.mesh.surface.triangles.len() == self.num_faces;
        let compensation = if is_last {
            Compensation::NONE
        } else {
            self.fitter.fit(&self.mesh, &names.vertex_source, hidden)
        };
        self.passes.push(WrittenPass { row, payload, glue, compensation });
    }

    /// Payload of the glue behind a pass, if one of its vertices is the same as one that is there.
    fn glue_of_new_vertices(&mut self, vertex_source: &[u32]) -> Option<Vec<u8>> {
        let num_old = self.num_seen;
        self.num_seen = vertex_source.len();
        let mut is_glued = false;
        for &v in &vertex_source[num_old..] {
            is_glued |= self.has_come.replace(self.source[v as usize] as usize, true);
        }
        if !is_glued {
            return None;
        }
        let names: Vec<u32> = vertex_source.iter().map(|&v| self.source[v as usize]).collect();
        let mut coder = RangeEncoder::new();
        expect_sound(stitching::code(&mut coder, &mut self.glue, &self.mesh, &mut self.roots, Some(&names)));
        Some(coder.finish())
    }

    fn refine(&mut self, names: &Names) {
        self.quantization_bits += 1;
        let hidden = self.full_bits - self.quantization_bits;
        let target: Vec<[i32; 3]> =
            names.vertex_source.iter().map(|&v| self.cells[v as usize].map(|c| c >> hidden)).collect();
        let payload = match self.profile {
            Profile::Max | Profile::Small => {
                let mut coder = RangeEncoder::new();
                refine::code(&mut coder, &mut self.refine, &mut self.mesh, Some(&target));
                coder.finish()
            }
            Profile::Fast => {
                let mut coder = StreamWriter::new(0);
                let positions = &mut self.mesh.positions;
                positions.iter_mut().flatten().for_each(|c| *c *= 2);
                coordinates_fast::refine_some(
                    &mut coder,
                    positions,
                    &mut 0,
                    Some(&target),
                    &mut WorkBudget::unlimited(),
                );
                coder.finish()
            }
        };
        debug_assert_eq!(self.mesh.positions, target);
        let row = Pass { action: Action::Refine, vertices: 0, triangles: 0, bytes: 0 };
        self.finish_pass(row, target.len(), payload, names);
        self.attributes.refine();
    }

    /// Codes where the vertices of `record` are, which have been brought back.
    fn split(&mut self, record: &LevelRecord, found: Found, names: &Names) {
        let Found { mut coder, patches, odd } = found;
        let (wanted, quantization_bits) = (self.wanted(record, &odd), self.quantization_bits);
        let (models, mesh) = (&mut self.coordinates, &mut self.mesh);
        expect_sound(coordinates::code(&mut coder, models, mesh, &patches, quantization_bits, Some(&wanted)));
        self.finish_split(&patches, coder.finish(), names);
    }

    fn split_in_streams(&mut self, record: &LevelRecord, names: &mut Names, scout: &mut PatchSearch) {
        let mut coder = StreamWriter::new(record.len() as u32);
        let (patches, odd) = scout.find_with(&mut coder, &self.mesh, names, record);
        let (wanted, limit) = (self.wanted(record, &odd), 1 << self.quantization_bits);
        self.restore(record, &patches, &odd, names, |mesh, patches, j, star| {
            let GridMesh { positions, roughness, .. } = mesh;
            let mut known = Located { positions, roughness };
            expect_sound(coordinates_fast::code_vertex(
                &mut coder, &mut known, patches, j, star, limit, wanted[j],
            ));
        });
        self.finish_split(&patches, coder.finish(), names);
    }

    /// Cells of the vertices that the patches bring back.
    fn wanted(&self, record: &LevelRecord, odd: &[u32]) -> Vec<[i32; 3]> {
        let hidden = self.full_bits - self.quantization_bits;
        let sources = odd.iter().map(|&o| record.get(o as usize).vertex);
        sources.map(|v| self.cells[v as usize].map(|c| c >> hidden)).collect()
    }

    /// Brings the vertices back, the entries `odd` of the record, and tells `see` of each star.
    fn restore(
        &mut self,
        record: &LevelRecord,
        patches: &Patches,
        odd: &[u32],
        names: &mut Names,
        mut see: impl FnMut(&mut GridMesh, &Patches, usize, &Star),
    ) {
        let mut builder = StarBuilder::new(self.mesh.surface.corner_of.len());
        for (j, &odd) in odd.iter().enumerate() {
            let star = expect_sound(builder.restore(&mut self.mesh.surface, patches, j));
            let removed = record.get(odd as usize);
            names.face_source.resize(self.mesh.surface.triangles.len(), 0);
            let shift = name_faces(star, &removed, &names.vertex_source, &mut names.face_source);
            self.attributes.restore(star, record, &removed, shift);
            see(&mut self.mesh, patches, j, star);
        }
        names.vertex_source.extend(odd.iter().map(|&o| record.get(o as usize).vertex));
    }

    fn finish_split(&mut self, patches: &Patches, payload: Vec<u8>, names: &Names) {
        let num_vertices = patches.len();
        let num_coarse = self.mesh.positions.len() - num_vertices;
        let row = Pass {
            action: Action::Split,
            vertices: num_vertices as u32,
            triangles: patches.num_new_faces() as u32,
            bytes: 0,
        };
        self.finish_pass(row, num_vertices, payload, names);
        self.attributes.split(&self.mesh, patches, num_coarse, &names.vertex_source);
    }
}

/// Notes which slots of the full surface the triangles of a star have. Returns which of the removed faces the first
/// one is.
fn name_faces(
    star: &Star,
    removed: &crate::simplification::record::Removed,
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
