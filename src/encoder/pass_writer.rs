//! Codes pass after pass with the decoder's own steps, the truth at hand.

use super::attribute_writer::AttributeWriter;
use super::coarsen::Hierarchy;
use super::compensation::{Fitter, Point};
use super::frame::{self, Payloads, WrittenPass};
use super::numbering::Numbering;
use super::patch_search::{Found, PatchSearch};
use super::payload::{expect_sound, padded};
use super::stitching::StitchingWriter;
use super::trailing::{Original, Written};
use crate::bitstream::compensation::Compensation;
use crate::bitstream::header::{Action, MAX_VERTICES_PER_BYTE, Pass};
use crate::bitstream::profile::Profile;
use crate::entropy::context_mixer::Mixing;
use crate::entropy::range_coder::RangeEncoder;
use crate::entropy::streams::StreamWriter;
use crate::passes::GridMesh;
use crate::passes::base::{self, BaseTarget};
use crate::passes::base_positions::Base;
use crate::passes::base_tables::method::BaseMethod;
use crate::passes::base_tables::write::write as write_base_in_tables;
use crate::passes::coordinates::{self, CoordinateModels};
use crate::passes::coordinates_fast::{self, Located};
use crate::passes::patch::{Patches, Star, StarBuilder};
use crate::passes::refine::{self, RefineModels};
use crate::passes::work_budget::WorkBudget;
use crate::simplification::LevelRecord;

/// Vertices of a base mesh in the profile fast that may be mixed: that takes a few milliseconds.
const MOST_MIXED: usize = 2000;

/// The decoder's state, and the passes so far.
pub(super) struct PassWriter<'a> {
    /// Those of the full surface at full precision.
    cells: &'a [[i32; 3]],
    num_faces: usize,
    full_bits: u32,
    pub(super) profile: Profile,
    quantization_bits: u32,
    pub(super) mesh: GridMesh,
    coordinates: CoordinateModels,
    refine: RefineModels,
    attributes: AttributeWriter<'a>,
    stitching: StitchingWriter<'a>,
    fitter: Fitter<'a>,
    passes: Vec<WrittenPass>,
}

impl<'a> PassWriter<'a> {
    /// Codes the base mesh.
    pub(super) fn begin(
        original: &Original<'a>,
        points: &'a [Point],
        hierarchy: &Hierarchy,
        quantization_bits: u32,
    ) -> (Self, Numbering) {
        let Original { input, on_grid, quantized } = *original;
        let (profile, cells) = (input.options.profile_used(), &on_grid.cells[..]);
        let (mixing, full_bits) = (profile.mixing(), on_grid.grid.quantization_bits);
        let (coded, payload) = code_base(hierarchy, cells, [full_bits, quantization_bits], profile);
        let numbering = Numbering::of_base(&coded, hierarchy);
        let mut writer = Self {
            cells,
            num_faces: hierarchy.num_faces,
            full_bits,
            profile,
            quantization_bits,
            mesh: coded.mesh,
            coordinates: CoordinateModels::new(mixing),
            refine: RefineModels::new(mixing),
            attributes: AttributeWriter::new(quantized, mixing),
            stitching: StitchingWriter::new(&on_grid.source, on_grid.ordered.cells.len()),
            fitter: Fitter::new(points, &hierarchy.records, cells),
            passes: Vec::new(),
        };
        writer.finish_base(payload, hierarchy, &numbering);
        (writer, numbering)
    }

    fn finish_base(&mut self, payload: Vec<u8>, hierarchy: &Hierarchy, numbering: &Numbering) {
        let (num_vertices, num_faces) = (self.mesh.positions.len(), self.mesh.surface.triangles.len());
        self.mesh.reserve(hierarchy.num_vertices - num_vertices, hierarchy.num_faces - num_faces);
        let action = Action::Base { quantization_bits: self.quantization_bits };
        let row = Pass { action, vertices: num_vertices as u32, triangles: num_faces as u32, bytes: 0 };
        self.finish_pass(row, num_vertices.max(num_faces), payload, numbering);
        self.attributes.base(&self.mesh, hierarchy, &numbering.vertex_source, &numbering.face_source);
    }

    /// Keeps the payload of a pass that touched `touched` elements, with the stitching chunk after it.
    fn finish_pass(&mut self, mut row: Pass, touched: usize, payload: Vec<u8>, numbering: &Numbering) {
        let payload = padded(payload, touched as u64, u64::from(MAX_VERTICES_PER_BYTE));
        row.bytes = payload.len() as u32;
        let stitching = self.stitching.code(&self.mesh, &numbering.vertex_source);
        let hidden = self.hidden_bits();
        let is_last = hidden == 0 && self.mesh.surface.triangles.len() == self.num_faces;
        let compensation = if is_last {
            Compensation::NONE
        } else {
            self.fitter.fit(&self.mesh, &numbering.vertex_source, hidden)
        };
        self.passes.push(WrittenPass { row, payload, stitching, compensation });
    }

    /// Bits of the coordinates that have not been coded yet.
    pub(super) fn hidden_bits(&self) -> u32 {
        self.full_bits - self.quantization_bits
    }

    /// Codes `count` refinements.
    pub(super) fn refine_times(&mut self, count: u32, numbering: &Numbering) {
        (0..count).for_each(|_| self.refine(numbering));
    }

    /// Codes one more bit of all coordinates.
    fn refine(&mut self, numbering: &Numbering) {
        self.quantization_bits += 1;
        let target = self.cells_now(numbering.vertex_source.iter().copied());
        let payload = match self.profile {
            Profile::Max | Profile::Small => self.code_refinement(&target),
            Profile::Fast => self.code_refinement_in_streams(&target),
        };
        debug_assert_eq!(self.mesh.positions, target);
        let row = Pass { action: Action::Refine, vertices: 0, triangles: 0, bytes: 0 };
        self.finish_pass(row, target.len(), payload, numbering);
        self.attributes.refine();
    }

    fn code_refinement(&mut self, target: &[[i32; 3]]) -> Vec<u8> {
        let mut coder = RangeEncoder::new();
        refine::code(&mut coder, &mut self.refine, &mut self.mesh, Some(target));
        coder.finish()
    }

    fn code_refinement_in_streams(&mut self, target: &[[i32; 3]]) -> Vec<u8> {
        let mut coder = StreamWriter::new(0);
        let positions = &mut self.mesh.positions;
        positions.iter_mut().flatten().for_each(|c| *c *= 2);
        let work = &mut WorkBudget::unlimited();
        coordinates_fast::refine_some(&mut coder, positions, &mut 0, Some(target), work);
        coder.finish()
    }

    /// Codes where the vertices of `record` are, which have been brought back.
    pub(super) fn split(&mut self, record: &LevelRecord, found: Found, numbering: &Numbering) {
        let Found { mut coder, patches, odd } = found;
        let (wanted, quantization_bits) = (self.cells_of(record, &odd), self.quantization_bits);
        let (models, mesh) = (&mut self.coordinates, &mut self.mesh);
        expect_sound(coordinates::code(&mut coder, models, mesh, &patches, quantization_bits, Some(&wanted)));
        self.finish_split(&patches, coder.finish(), numbering);
    }

    /// Finds the patches of `record`, brings its vertices back and codes where they are, one vertex after the other.
    pub(super) fn split_in_streams(
        &mut self,
        record: &LevelRecord,
        numbering: &mut Numbering,
        search: &mut PatchSearch,
    ) {
        let mut coder = StreamWriter::new(record.len() as u32);
        let (patches, odd) = search.find_with(&mut coder, &self.mesh, numbering, record);
        let (wanted, limit) = (self.cells_of(record, &odd), 1 << self.quantization_bits);
        self.restore(record, &patches, &odd, numbering, |mesh, patches, j, star| {
            let GridMesh { positions, roughness, .. } = mesh;
            let mut known = Located { positions, roughness };
            expect_sound(coordinates_fast::code_vertex(
                &mut coder, &mut known, patches, j, star, limit, wanted[j],
            ));
        });
        self.finish_split(&patches, coder.finish(), numbering);
    }

    /// Cells of vertices of the full surface at the present precision.
    fn cells_now(&self, vertices: impl Iterator<Item = u32>) -> Vec<[i32; 3]> {
        let hidden = self.hidden_bits();
        vertices.map(|v| self.cells[v as usize].map(|c| c >> hidden)).collect()
    }

    /// Cells of the vertices that the patches bring back, the entries `odd` of the record.
    fn cells_of(&self, record: &LevelRecord, odd: &[u32]) -> Vec<[i32; 3]> {
        self.cells_now(odd.iter().map(|&o| record.get(o as usize).vertex))
    }

    /// Brings the vertices back, the entries `odd` of the record, and tells `see` of each star.
    pub(super) fn restore(
        &mut self,
        record: &LevelRecord,
        patches: &Patches,
        odd: &[u32],
        numbering: &mut Numbering,
        mut see: impl FnMut(&mut GridMesh, &Patches, usize, &Star),
    ) {
        let mut builder = StarBuilder::new(self.mesh.surface.corner_of.len());
        for (j, &odd) in odd.iter().enumerate() {
            let star = expect_sound(builder.restore(&mut self.mesh.surface, patches, j));
            let removed = record.get(odd as usize);
            let shift = numbering.note_star(star, &removed, self.mesh.surface.triangles.len());
            self.attributes.restore(star, record, &removed, shift);
            see(&mut self.mesh, patches, j, star);
        }
        numbering.extend(record, odd);
    }

    fn finish_split(&mut self, patches: &Patches, payload: Vec<u8>, numbering: &Numbering) {
        let num_vertices = patches.len();
        let num_coarse = self.mesh.positions.len() - num_vertices;
        let (vertices, faces) = (num_vertices as u32, patches.num_new_faces() as u32);
        let row = Pass { action: Action::Split, vertices, triangles: faces, bytes: 0 };
        self.finish_pass(row, num_vertices, payload, numbering);
        self.attributes.split(&self.mesh, patches, num_coarse, &numbering.vertex_source);
    }

    /// The payloads of all passes, and of the chunks after the last one.
    pub(super) fn finish(self, original: &Original, numbering: &Numbering) -> Payloads {
        debug_assert_eq!(self.mesh.surface.triangles.len(), self.num_faces);
        let Numbering { vertex_source, face_source } = numbering;
        let surface =
            Written { mesh: &self.mesh, vertex_source, face_source, entries: self.attributes.entries() };
        let mut trailing = original.trailing(&surface, self.stitching.into_roots());
        trailing.extend(frame::trailing_materials(original.quantized));
        Payloads { passes: self.passes, values: self.attributes.into_payloads(), trailing }
    }
}

/// Codes the base mesh at the second of these precisions, where `cells` have the first.
fn code_base(
    hierarchy: &Hierarchy,
    cells: &[[i32; 3]],
    [full_bits, quantization_bits]: [u32; 2],
    profile: Profile,
) -> (Base, Vec<u8>) {
    let hidden = full_bits - quantization_bits;
    let positions: Vec<[i32; 3]> =
        hierarchy.base_vertices.iter().map(|&v| cells[v as usize].map(|c| c >> hidden)).collect();
    let target = BaseTarget { surface: &hierarchy.base, positions: &positions };
    if profile == Profile::Fast {
        return code_base_fast(&target, quantization_bits);
    }
    mix_base(&target, quantization_bits, profile.mixing())
}

fn mix_base(target: &BaseTarget, quantization_bits: u32, mixing: Mixing) -> (Base, Vec<u8>) {
    let (num_vertices, num_faces) = (target.positions.len(), target.surface.triangles.len());
    let mut coder = RangeEncoder::new();
    let coded = base::code(&mut coder, num_vertices, num_faces, quantization_bits, mixing, Some(target));
    (expect_sound(coded), coder.finish())
}

/// Codes the base mesh in tables, or by mixing if it is small and smaller so: the tables cost more than they gain then.
fn code_base_fast(target: &BaseTarget, quantization_bits: u32) -> (Base, Vec<u8>) {
    let with_method = |method: BaseMethod, mut payload: Vec<u8>| {
        payload.insert(0, method as u8);
        payload
    };
    let (base, tables) = expect_sound(write_base_in_tables(target, quantization_bits));
    if target.positions.len() <= MOST_MIXED {
        let (base, mixed) = mix_base(target, quantization_bits, Profile::Fast.mixing());
        if mixed.len() < tables.len() {
            return (base, with_method(BaseMethod::Mixed, mixed));
        }
    }
    (base, with_method(BaseMethod::Tables, tables))
}
