//! The push decoder: bytes in, refined meshes out.

use super::assemble::{Beside, Extras};
use super::attributes::{self, AttributeDecoder};
use super::built_with::ASSETS;
use super::frame::{Chunk, FrameReader, PassInfo, PassKind, StreamInfo};
use super::head::{Head, Source};
use super::level_mesh::LevelMesh;
use super::refused::{malformed, out_of_order, skip};
use super::running::Running;
use super::state::PassDecoder;
use super::{environment, forecast};
use crate::bitstream::chunk::{self, kind};
use crate::bitstream::compensation::Compensation;
use crate::bitstream::profile::Profile;
use crate::error::DecodeError;
use crate::limits::Limits;
use crate::mesh::{Attributes, TriMesh};
use crate::passes::GridMesh;
use crate::passes::patch::Patches;
use crate::passes::work_budget::WorkBudget;
use std::collections::VecDeque;
use std::ops::Range;

/// What one finished pass changed.
///
/// Vertices and triangles keep their indices for ever: new ones are appended, triangles of a split
/// are rewritten in place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Update {
    /// The pass, and counts, level and precision after it.
    pub pass: PassInfo,
    /// Vertices with a new or different position.
    pub vertices: Range<u32>,
    /// Triangles that are new.
    pub new_triangles: Range<u32>,
    /// Older triangles with different vertices: ascending, disjoint ranges.
    pub rewritten_triangles: Vec<Range<u32>>,
}

/// What [`Decoder::step_within`] came to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Step {
    /// A pass is finished: the mesh has changed.
    Finished(Update),
    /// The work is used up amid a pass: the mesh is still that of the pass before.
    Unfinished,
    /// Bytes are missing, or nothing is left to do.
    Waiting,
}

/// Decodes a stream as it arrives.
///
/// ```
/// # fn run(network: impl Iterator<Item = Vec<u8>>) -> Result<(), lwc::DecodeError> {
/// let mut decoder = lwc::Decoder::new(lwc::Limits::default());
/// for bytes in network {
///     for update in decoder.push(&bytes)? {
///         println!("level {}: {} vertices", update.pass.level, update.pass.vertices);
///     }
///     if let Some(mesh) = decoder.mesh() {
///         println!("{} triangles to draw", mesh.num_triangles());
///     }
/// }
/// # Ok(()) }
/// ```
pub struct Decoder {
    limits: Limits,
    last_level: u32,
    compensate: bool,
    frames: FrameReader,
    head: Head,
    info: Option<StreamInfo>,
    /// Passes done.
    done: usize,
    passes: PassDecoder,
    /// The pass that is half done, and its chunk.
    running: Option<(Running, Chunk)>,
    /// Kinds of the chunks that must come before the next pass, or behind the last: what belongs to the
    /// passes that are done.
    awaited: VecDeque<u8>,
    attributes: Option<AttributeDecoder>,
    /// A chunk of attributes that is half done.
    running_attributes: Option<Chunk>,
    extras: Extras,
    work_done: u64,
    failed: bool,
}

impl Decoder {
    /// A decoder of all levels.
    pub fn new(limits: Limits) -> Self {
        Self::with_options(DecodeOptions::new().limits(limits))
    }

    /// A decoder that may stop at a level.
    pub fn with_options(options: DecodeOptions) -> Self {
        Self {
            limits: options.limits,
            last_level: options.level.unwrap_or(u32::MAX),
            compensate: !options.no_shrinkage_compensation,
            frames: FrameReader::new(),
            head: Head::default(),
            info: None,
            done: 0,
            passes: PassDecoder::new(Profile::default()),
            running: None,
            awaited: VecDeque::new(),
            attributes: None,
            running_attributes: None,
            extras: Extras::default(),
            work_done: 0,
            failed: false,
        }
    }

    /// Takes the next bytes of the stream, however they are cut, and applies every pass that is
    /// complete. The ranges of each update refer to the mesh after the call.
    ///
    /// # Errors
    /// If the stream is damaged, not a stream, or beyond the limits. The finest complete mesh stays
    /// available; the decoder takes no more bytes. Passes finished in the same call are then not
    /// reported, see [`Decoder::passes_done`].
    pub fn push(&mut self, bytes: &[u8]) -> Result<Vec<Update>, DecodeError> {
        self.feed(bytes)?;
        let mut updates = Vec::new();
        while let Some(update) = self.step()? {
            updates.push(update);
        }
        Ok(updates)
    }

    /// Takes bytes without decoding them; [`Decoder::step`] does.
    ///
    /// # Errors
    /// If the decoder has failed before, or holds too many bytes.
    pub fn feed(&mut self, bytes: &[u8]) -> Result<(), DecodeError> {
        if self.failed {
            return Err(DecodeError::Failed);
        }
        if self.is_complete() {
            return Ok(());
        }
        let needed = self.memory_besides() - self.frames.memory() + self.frames.memory_with(bytes.len());
        Limits::check("memory", needed, self.limits.max_memory).inspect_err(|_| self.failed = true)?;
        // The payload of a chunk that is half done must stay where it is.
        self.frames.feed(bytes, self.running.is_none() && self.running_attributes.is_none());
        Ok(())
    }

    /// Applies the next pass if all its bytes are there: one pass at a time, for callers who want to
    /// see every mesh or to do something in between.
    ///
    /// Chunks beside the passes, those behind the last one among them, are taken on the way and give no update;
    /// [`LevelMesh::to_tri_mesh`] and [`Decoder::is_complete`] tell of them.
    ///
    /// # Errors
    /// As [`Decoder::push`].
    pub fn step(&mut self) -> Result<Option<Update>, DecodeError> {
        match self.step_with(&mut WorkBudget::unlimited())? {
            Step::Finished(update) => Ok(Some(update)),
            Step::Unfinished | Step::Waiting => Ok(None),
        }
    }

    /// As [`Decoder::step`], but does at most about `work` units of a pass and goes on with it in the
    /// next call: for threads that have other things to do in time. Until the pass is finished all that
    /// is seen of the mesh is that of the pass before.
    ///
    /// A unit is the work of an edge or a triangle, a fraction of a microsecond. The last thing done in a
    /// call may be more than is left: a vertex with all its edges, a copy of an array, which
    /// counts one unit for 64 numbers, or a whole chunk of glue or after the last pass. Only the links of a base mesh are
    /// not counted.
    ///
    /// ```
    /// # fn run(mut decoder: lwc::Decoder, time_is_left: impl Fn() -> bool) -> Result<(), lwc::DecodeError> {
    /// while time_is_left() {
    ///     match decoder.step_within(1000)? {
    ///         lwc::Step::Finished(update) => println!("{} vertices", update.pass.vertices),
    ///         lwc::Step::Unfinished => {}
    ///         lwc::Step::Waiting => break,
    ///     }
    /// }
    /// # Ok(()) }
    /// ```
    ///
    /// # Errors
    /// As [`Decoder::push`].
    pub fn step_within(&mut self, work: u32) -> Result<Step, DecodeError> {
        self.step_with(&mut WorkBudget::units(work.max(1)))
    }

    fn step_with(&mut self, work: &mut WorkBudget) -> Result<Step, DecodeError> {
        if self.failed {
            return Err(DecodeError::Failed);
        }
        self.step_within_limits(work).inspect_err(|_| self.failed = true)
    }

    /// Goes on in slices that the work limit allows: each byte that is read earns more of it.
    fn step_within_limits(&mut self, work: &mut WorkBudget) -> Result<Step, DecodeError> {
        environment::check().map_err(DecodeError::FloatingPoint)?;
        loop {
            let mut slice = work.at_most(self.work_left());
            let step = self.try_step(&mut slice);
            self.work_done += slice.done();
            work.spend(slice.done());
            if step != Ok(Step::Unfinished) || !work.is_left() {
                return step;
            }
            let allowed = forecast::allowed(&self.limits, self.frames.position());
            Limits::check("work", self.work_done.saturating_add(1), allowed)?;
        }
    }

    /// Units of work that the bytes read so far have earned and not spent.
    fn work_left(&self) -> u64 {
        forecast::allowed(&self.limits, self.frames.position()).saturating_sub(self.work_done)
    }

    fn try_step(&mut self, work: &mut WorkBudget) -> Result<Step, DecodeError> {
        if let Some((running, chunk)) = self.running.take() {
            return self.advance(running, chunk, work);
        }
        if ASSETS
            && let Some(chunk) = self.running_attributes.take()
            && !self.advance_attributes(chunk, work)?
        {
            return Ok(Step::Unfinished);
        }
        self.read_info()?;
        while self.info.is_some() && !self.is_complete() {
            let next = self.next_pass().map(PassInfo::frame);
            let Some(chunk) = self.frames.next_chunk(&self.limits, next)? else {
                return Ok(Step::Waiting);
            };
            match chunk.kind {
                kind if self.awaited.front() == Some(&kind) => {
                    if !self.begin_companion(chunk, work)? {
                        return Ok(Step::Unfinished);
                    }
                }
                kind::BASE | kind::SPLIT | kind::REFINE if self.awaited.is_empty() => {
                    return self.begin(chunk, work);
                }
                kind::BASE | kind::SPLIT | kind::REFINE | kind::HEADER | kind::PASSES => {
                    return Err(out_of_order(&chunk));
                }
                _ => skip(&chunk)?,
            }
        }
        Ok(Step::Waiting)
    }

    /// Reads chunks up to the table of passes.
    pub(super) fn read_info(&mut self) -> Result<(), DecodeError> {
        while self.info.is_none() {
            let Some(chunk) = self.frames.next_chunk(&self.limits, None)? else {
                return Ok(());
            };
            let source = Source { chunk: &chunk, frames: &self.frames, limits: &self.limits, used: 0 };
            self.info = self.head.take(source)?;
        }
        let Some(info) = &self.info else { return Ok(()) };
        if info.profile != self.passes.profile {
            self.passes = PassDecoder::new(info.profile);
        }
        if ASSETS && let Some(declarations) = self.head.declarations.take() {
            self.attributes = Some(AttributeDecoder::new(declarations, info.profile.mixing()));
        }
        Ok(())
    }

    /// Bytes of memory that are held besides the mesh and its attributes.
    fn memory_besides(&self) -> u64 {
        let extras = if ASSETS { self.extras.memory() } else { 0 };
        self.frames.memory() + self.head.memory() + extras
    }

    fn begin(&mut self, chunk: Chunk, work: &mut WorkBudget) -> Result<Step, DecodeError> {
        let pass = self.next_pass().ok_or(malformed("a pass that was not announced", &chunk))?;
        let held = self.memory_besides() + self.memory_of_attributes(pass);
        self.passes.check_limits(pass, &self.limits, held)?;
        let running = Running::new(self.frames.payload(&chunk), pass, self.passes.profile);
        self.advance(running.ok_or(malformed("a pass of other streams", &chunk))?, chunk, work)
    }

    /// Bytes of memory that attributes may take once a pass is done.
    fn memory_of_attributes(&self, pass: &PassInfo) -> u64 {
        let mixing = self.passes.profile.mixing();
        self.attributes.as_ref().map_or(0, |a| attributes::memory_for(&a.declarations, pass, mixing))
    }

    /// Goes on with the next pass.
    fn advance(
        &mut self,
        mut running: Running,
        chunk: Chunk,
        work: &mut WorkBudget,
    ) -> Result<Step, DecodeError> {
        let pass = self.next_pass().copied().ok_or(malformed("a pass that was not announced", &chunk))?;
        let payload = self.frames.payload(&chunk);
        let changes = self.passes.advance(&mut running, &pass, payload, work);
        let changes = changes.map_err(|e| malformed(e.0, &chunk))?;
        let Some((changes, patches)) = changes else {
            self.running = Some((running, chunk));
            return Ok(Step::Unfinished);
        };
        let before = self.last_pass().map_or(Compensation::NONE, |last| self.compensation_after(last));
        let compensations = [before, self.compensation_after(&pass)];
        let is_shown_elsewhere = compensations.iter().any(|&compensation| compensation != Compensation::NONE);
        self.done += 1;
        self.await_companions(&pass, patches, changes.first_vertex as usize);
        let first_vertex = if is_shown_elsewhere { 0 } else { changes.first_vertex };
        Ok(Step::Finished(Update {
            pass,
            vertices: first_vertex..pass.vertices,
            new_triangles: changes.first_new_face..pass.triangles,
            rewritten_triangles: changes.rewritten_faces,
        }))
    }

    /// Notes which chunks belong to the pass that has just been done, and, if it was the last one of the stream,
    /// which follow that.
    fn await_companions(&mut self, pass: &PassInfo, patches: Patches, first: usize) {
        if ASSETS
            && pass.attribute_bytes > 0
            && let Some(attributes) = &mut self.attributes
        {
            attributes.expect((pass.kind == PassKind::Split).then_some(patches), first);
            self.awaited.push_back(kind::ATTRIBUTES);
        }
        if pass.glue_bytes > 0 {
            self.awaited.push_back(kind::GLUE);
        }
        if let Some(info) = self.info.as_ref().filter(|info| info.passes.len() == self.done) {
            self.awaited.extend(info.trailing.iter().map(|trailing| trailing.code));
        }
    }

    /// Takes a chunk that was awaited; false if it is half done.
    fn begin_companion(&mut self, chunk: Chunk, work: &mut WorkBudget) -> Result<bool, DecodeError> {
        if !ASSETS {
            return Err(out_of_order(&chunk));
        }
        if chunk.kind != kind::ATTRIBUTES {
            self.read_extra(&chunk, work)?;
            self.awaited.pop_front();
            return Ok(true);
        }
        let expected = self
            .done
            .checked_sub(1)
            .and_then(|last| self.attributes.as_ref()?.declarations.bytes.get(last).copied());
        if expected != Some(self.frames.payload(&chunk).len() as u32) {
            return Err(malformed("values of attributes differ from their declaration", &chunk));
        }
        self.advance_attributes(chunk, work)
    }

    /// Goes on with the values of the last pass; false if the work is used up before they are all there.
    fn advance_attributes(&mut self, chunk: Chunk, work: &mut WorkBudget) -> Result<bool, DecodeError> {
        let Some(attributes) = &mut self.attributes else { return Err(out_of_order(&chunk)) };
        let payload = self.frames.payload(&chunk);
        let is_done = attributes.advance(&self.passes.mesh, payload, work);
        let is_done = is_done.map_err(|e| malformed(e.0, &chunk))?;
        if is_done {
            self.awaited.pop_front();
        } else {
            self.running_attributes = Some(chunk);
        }
        Ok(is_done)
    }

    /// Takes glue, or a chunk that follows the last pass.
    fn read_extra(&mut self, chunk: &Chunk, work: &mut WorkBudget) -> Result<(), DecodeError> {
        let (Some(info), Some(pass)) = (&self.info, self.last_pass()) else {
            return Err(out_of_order(chunk));
        };
        let payload = self.frames.payload(chunk);
        let announced = match chunk.kind {
            kind::GLUE => pass.glue_bytes,
            kind => info.trailing.iter().find(|t| t.code == kind).map_or(0, |t| t.bytes),
        };
        if chunk::other_size(payload.len() as u32) != announced {
            return Err(malformed("a chunk differs from its announcement", chunk));
        }
        let memory_of_mesh = self.passes.memory_for(pass) + self.memory_of_attributes(pass);
        if chunk.kind == kind::MATERIALS {
            let (frames, limits) = (&self.frames, &self.limits);
            let used = memory_of_mesh + self.extras.memory();
            return self.head.take_materials(Source { chunk, frames, limits, used });
        }
        let used = self.memory_besides() + memory_of_mesh;
        let left = self.work_left().saturating_sub(work.done());
        let mesh = &self.passes.mesh;
        let beside = Beside { payload, mesh, grid: &info.grid, limits: &self.limits, used, work: left };
        let units = self.extras.read(chunk.kind, beside, self.attributes.as_ref());
        work.spend(units.map_err(|e| e.at(chunk))?);
        Ok(())
    }

    fn compensation_after(&self, pass: &PassInfo) -> Compensation {
        if self.compensate { pass.compensation } else { Compensation::NONE }
    }

    /// The pass that was done last.
    fn last_pass(&self) -> Option<&PassInfo> {
        self.info.as_ref()?.passes.get(self.done.checked_sub(1)?)
    }

    /// The pass that is decoded next, unless the stream or the wanted level is complete.
    fn next_pass(&self) -> Option<&PassInfo> {
        let pass = self.info.as_ref()?.passes.get(self.done)?;
        let beyond = pass.level > self.last_level && pass.kind == PassKind::Split;
        (!beyond).then_some(pass)
    }

    /// What the stream says of itself, once its table of passes has arrived.
    pub fn info(&self) -> Option<&StreamInfo> {
        self.info.as_ref()
    }

    /// The finest complete mesh.
    pub fn mesh(&self) -> Option<LevelMesh<'_>> {
        let info = self.info.as_ref()?;
        let pass = info.passes.get(self.done.checked_sub(1)?)?;
        let mesh = &self.passes.mesh;
        let (cells, triangles) = match &self.running {
            Some((running, _)) => running.mesh_before(mesh),
            None => (&mesh.positions[..], &mesh.surface.triangles[..]),
        };
        let compensation = self.compensation_after(pass);
        let (quantization_bits, level) = (pass.quantization_bits, pass.level);
        let (grid, extras) = (&info.grid, &self.extras);
        Some(LevelMesh { cells, triangles, grid, quantization_bits, level, compensation, extras })
    }

    /// The mesh so far, with what has arrived of the next pass: vertices whose bytes are missing stay
    /// away, missing bits of coordinates are guessed. Nearly as good as if the stream were cut behind every
    /// vertex, but made of bytes whose checksum has not come yet, and of a copy of the mesh.
    ///
    /// `None` before the base mesh is complete. Without such bytes, without the memory, or amid a pass
    /// ([`Decoder::step_within`]) it is [`Decoder::mesh`].
    pub fn preview(&self) -> Option<TriMesh> {
        let complete = self.mesh()?;
        let Some((pass, mesh, _)) = self.mesh_with_cut() else {
            return Some(complete.to_tri_mesh());
        };
        let (cells, triangles) = (&mesh.positions[..], &mesh.surface.triangles[..]);
        Some(
            LevelMesh { cells, triangles, quantization_bits: pass.quantization_bits, ..complete }
                .to_tri_mesh(),
        )
    }

    /// Attributes of the surface [`Decoder::mesh`], without gaps: values that have not come yet are guessed from those around.
    /// Empty before the base mesh is complete, and of a stream without attributes. Collected anew by each call.
    pub fn attributes(&self) -> Attributes {
        let cut = self.frames.cut_chunk(None).filter(|(kind, _)| self.awaited.front() == Some(kind));
        let cut = cut.map_or(&[][..], |(_, payload)| payload);
        let known = self.attributes.as_ref().filter(|_| ASSETS && self.done > 0);
        self.with_scene(known.map(|known| known.attributes(&self.passes.mesh, cut)).unwrap_or_default())
    }

    /// Attributes with what the stream has once for all of the mesh.
    fn with_scene(&self, mut attributes: Attributes) -> Attributes {
        if self.done > 0 {
            attributes.scene = self.info.as_ref().and_then(|info| info.scene.clone());
            attributes.gltf_materials.clone_from(&self.head.materials);
        }
        attributes
    }

    /// Checksum of the values of all attributes that have come (`format/SPEC.md`, section 9): equal on every platform
    /// for the same prefix of a stream.
    pub fn attribute_checksum(&self) -> u32 {
        self.attributes.as_ref().map_or(0, AttributeDecoder::checksum)
    }

    /// Bytes of payload that each attribute has taken so far, to a few bytes per pass.
    pub fn attribute_bytes(&self) -> &[u64] {
        self.attributes.as_ref().map_or(&[], AttributeDecoder::bytes)
    }

    /// The mesh that was encoded, as far as what has come tells ([`LevelMesh::to_tri_mesh`]), with its attributes:
    /// once all of a lossless stream is there, bit for bit.
    pub fn to_tri_mesh_with_attributes(&self) -> Option<(TriMesh, Attributes)> {
        Some(self.assemble(self.mesh()?, self.attributes()))
    }

    /// [`Decoder::preview`] with its attributes.
    pub fn preview_with_attributes(&self) -> Option<(TriMesh, Attributes)> {
        let complete = self.mesh()?;
        let Some((pass, mesh, patches)) = self.mesh_with_cut() else {
            return self.to_tri_mesh_with_attributes();
        };
        let (cells, triangles) = (&mesh.positions[..], &mesh.surface.triangles[..]);
        let cut = LevelMesh { cells, triangles, quantization_bits: pass.quantization_bits, ..complete };
        let first = complete.num_vertices();
        let attributes = match &self.attributes {
            Some(attributes) if ASSETS && pass.kind == PassKind::Split => {
                self.with_scene(attributes.with_cut(&mesh, &patches, first))
            }
            _ => self.attributes(),
        };
        Some(self.assemble(cut, attributes))
    }

    fn assemble(&self, mesh: LevelMesh, attributes: Attributes) -> (TriMesh, Attributes) {
        let attributes = self.extras.assemble_attributes(mesh.num_vertices(), mesh.triangles(), attributes);
        (mesh.to_tri_mesh(), attributes)
    }

    fn mesh_with_cut(&self) -> Option<(&PassInfo, GridMesh, Patches)> {
        // Streams that are compressed begin to tell only when they are whole.
        let is_readable = self.running.is_none() && self.passes.profile != Profile::Fast;
        let pass = self.next_pass().filter(|_| is_readable)?;
        let (kind, payload) = self.frames.cut_chunk(Some(pass.frame()))?;
        // The coder reads four bytes ahead: fewer decide nothing.
        if self.failed || !kind::is_pass(kind) || payload.len() < 5 {
            return None;
        }
        // Two copies that take as much again as the mesh itself.
        let held = self.memory_besides() + 2 * self.passes.memory_for(pass);
        self.passes.check_limits(pass, &self.limits, held).ok()?;
        let (mesh, patches) = self.passes.mesh_with_cut(pass, payload)?;
        Some((pass, mesh, patches))
    }

    /// Units of work done so far, see [`Decoder::step_within`]: the same for a stream however it is
    /// cut and sliced.
    pub fn work_done(&self) -> u64 {
        self.work_done
    }

    /// Number of passes applied.
    pub fn passes_done(&self) -> usize {
        self.done
    }

    /// True once the last pass of the stream, or of the wanted level, has been applied, and what belongs to it.
    pub fn is_complete(&self) -> bool {
        self.info.is_some() && self.next_pass().is_none() && self.awaited.is_empty()
    }
}

/// How to decode.
#[derive(Clone, Copy, Debug, Default)]
pub struct DecodeOptions {
    level: Option<u32>,
    no_shrinkage_compensation: bool,
    limits: Limits,
}

impl DecodeOptions {
    /// All levels, default limits.
    pub fn new() -> Self {
        Self::default()
    }

    /// Stops at M^`level`, with the precision it has when the next split begins. 0 is the base mesh; a
    /// level beyond the finest is the finest.
    pub fn level(mut self, level: u32) -> Self {
        self.level = Some(level);
        self
    }

    /// Whether coarse meshes are shown with their vertices a little off their places, so that they shrink less. Default
    /// true: closer to the surface by half a dB to one and a half on scans. Without it the vertices of each level are
    /// some of those of the finest.
    pub fn shrinkage_compensation(mut self, is_wanted: bool) -> Self {
        self.no_shrinkage_compensation = !is_wanted;
        self
    }

    /// Sets the limits.
    pub fn limits(mut self, limits: Limits) -> Self {
        self.limits = limits;
        self
    }
}

/// Decodes a stream, or what there is of it, in one call.
///
/// A stream that ends early gives all that its bytes tell, see [`Decoder::preview`].
///
/// # Errors
/// If the stream is damaged, beyond the limits, or ends before its base mesh.
pub fn decode(bytes: &[u8], options: DecodeOptions) -> Result<TriMesh, DecodeError> {
    let mut decoder = Decoder::with_options(options);
    decoder.push(bytes)?;
    decoder.preview().ok_or(DecodeError::NoMesh)
}
