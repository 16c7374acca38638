//! Reads chunk after chunk: which one is allowed next, and what it changes. The order of a stream:
//!
//! ```text
//! H and any of p d n m c t | L | B, S or R, then a if the pass has values, then g if t lists it | … | i x v o m if t lists them
//! ```

use super::assemble::{Extras, NewChunk};
use super::attributes::{self, AttributeDecoder};
use super::built_with::ASSETS;
use super::frame::{Chunk, FrameReader};
use super::head::{Head, Source};
use super::options::DecodeOptions;
use super::refused::{malformed, out_of_order, skip};
use super::running::Running;
use super::state::PassDecoder;
use super::stream_info::{PassInfo, PassKind, StreamInfo};
use super::update::{Step, Update};
use super::{environment, forecast};
use crate::bitstream::chunk::{self, kind};
use crate::bitstream::compensation::Compensation;
use crate::bitstream::profile::Profile;
use crate::error::DecodeError;
use crate::limits::Limits;
use crate::passes::patch::Patches;
use crate::passes::work_budget::WorkBudget;
use std::collections::VecDeque;

/// The state of a decoder.
pub(super) struct StreamingDecoder {
    pub(super) options: DecodeOptions,
    pub(super) frames: FrameReader,
    pub(super) head: Head,
    pub(super) info: Option<StreamInfo>,
    /// Passes done.
    pub(super) done: usize,
    pub(super) passes: PassDecoder,
    /// The pass that is half done, and its chunk.
    pub(super) running: Option<(Running, Chunk)>,
    /// Kinds of the chunks that must precede the next pass, or after the last: what belongs to the
    /// passes that are done.
    pub(super) awaited: VecDeque<u8>,
    pub(super) attributes: Option<AttributeDecoder>,
    /// A chunk of attributes that is half done.
    running_attributes: Option<Chunk>,
    pub(super) extras: Extras,
    /// Units of work done so far.
    pub(super) work_done: u64,
    pub(super) has_failed: bool,
}

impl StreamingDecoder {
    pub(super) fn new(options: DecodeOptions) -> Self {
        Self {
            options,
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
            has_failed: false,
        }
    }

    /// Takes bytes without decoding them.
    pub(super) fn feed(&mut self, bytes: &[u8]) -> Result<(), DecodeError> {
        if self.has_failed {
            return Err(DecodeError::Failed);
        }
        if self.is_complete() {
            return Ok(());
        }
        let needed = self.held_memory() - self.frames.memory() + self.frames.memory_with(bytes.len());
        let checked = Limits::check("memory", needed, self.options.limits.max_memory);
        checked.inspect_err(|_| self.has_failed = true)?;
        // The payload of a chunk that is half done must stay where it is.
        self.frames.feed(bytes, self.running.is_none() && self.running_attributes.is_none());
        Ok(())
    }

    /// Goes on until a pass is finished, the work is used up, or bytes are missing.
    pub(super) fn step(&mut self, work: &mut WorkBudget) -> Result<Step, DecodeError> {
        if self.has_failed {
            return Err(DecodeError::Failed);
        }
        self.step_within_limits(work).inspect_err(|_| self.has_failed = true)
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
            let allowed = forecast::allowed(&self.options.limits, self.frames.position());
            Limits::check("work", self.work_done.saturating_add(1), allowed)?;
        }
    }

    /// Units of work that the bytes read so far have earned and not spent.
    fn work_left(&self) -> u64 {
        forecast::allowed(&self.options.limits, self.frames.position()).saturating_sub(self.work_done)
    }

    /// Goes on with what is half done, then takes chunk after chunk.
    fn try_step(&mut self, work: &mut WorkBudget) -> Result<Step, DecodeError> {
        if let Some((running, chunk)) = self.running.take() {
            return self.advance_pass(running, chunk, work);
        }
        if !self.resume_attributes(work)? {
            return Ok(Step::Unfinished);
        }
        self.read_info()?;
        while self.info.is_some() && !self.is_complete() {
            let next = self.next_pass().map(PassInfo::frame);
            let Some(chunk) = self.frames.next_chunk(&self.options.limits, next)? else {
                return Ok(Step::Waiting);
            };
            match chunk.kind {
                kind if self.awaited.front() == Some(&kind) => {
                    if !self.begin_companion(chunk, work)? {
                        return Ok(Step::Unfinished);
                    }
                }
                kind::BASE | kind::SPLIT | kind::REFINE if self.awaited.is_empty() => {
                    return self.begin_pass(chunk, work);
                }
                kind::BASE | kind::SPLIT | kind::REFINE | kind::HEADER | kind::PASSES => {
                    return Err(out_of_order(&chunk));
                }
                _ => skip(&chunk)?,
            }
        }
        Ok(Step::Waiting)
    }

    /// Goes on with attributes that are half done, if there are any; false if they are not finished yet.
    fn resume_attributes(&mut self, work: &mut WorkBudget) -> Result<bool, DecodeError> {
        match self.running_attributes.take().filter(|_| ASSETS) {
            Some(chunk) => self.advance_attributes(chunk, work),
            None => Ok(true),
        }
    }

    /// Reads chunks up to the table of passes.
    fn read_info(&mut self) -> Result<(), DecodeError> {
        while self.info.is_none() {
            let limits = &self.options.limits;
            let Some(chunk) = self.frames.next_chunk(limits, None)? else {
                return Ok(());
            };
            let source = Source { chunk: &chunk, frames: &self.frames, limits, used: 0 };
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

    /// Bytes of memory that are held, without the mesh and its attributes.
    pub(super) fn held_memory(&self) -> u64 {
        let extras = if ASSETS { self.extras.memory() } else { 0 };
        self.frames.memory() + self.head.memory() + extras
    }

    /// Begins the next pass.
    fn begin_pass(&mut self, chunk: Chunk, work: &mut WorkBudget) -> Result<Step, DecodeError> {
        let pass = self.next_pass().ok_or(malformed("a pass that was not announced", &chunk))?;
        let held = self.held_memory() + self.memory_of_attributes(pass);
        self.passes.check_limits(pass, &self.options.limits, held)?;
        let running = Running::new(self.frames.payload(&chunk), pass, self.passes.profile);
        self.advance_pass(running.ok_or(malformed("a pass of other streams", &chunk))?, chunk, work)
    }

    /// Bytes of memory that attributes may take once a pass is done.
    fn memory_of_attributes(&self, pass: &PassInfo) -> u64 {
        let mixing = self.passes.profile.mixing();
        self.attributes.as_ref().map_or(0, |a| attributes::memory_for(&a.declarations, pass, mixing))
    }

    /// Goes on with the next pass.
    fn advance_pass(
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
        let is_shown_elsewhere =
            self.last_pass().into_iter().chain([&pass]).any(|pass| self.has_shrinkage_compensation(pass));
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

    /// Whether vertices are shown off their places after a pass.
    fn has_shrinkage_compensation(&self, pass: &PassInfo) -> bool {
        self.options.compensation_after(pass) != Compensation::NONE
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
        if pass.stitching_bytes > 0 {
            self.awaited.push_back(kind::STITCHING);
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

    /// Takes stitching, or a chunk that follows the last pass.
    fn read_extra(&mut self, chunk: &Chunk, work: &mut WorkBudget) -> Result<(), DecodeError> {
        let (Some(info), Some(pass)) = (&self.info, self.last_pass()) else {
            return Err(out_of_order(chunk));
        };
        let (payload, limits) = (self.frames.payload(chunk), &self.options.limits);
        let announced = match chunk.kind {
            kind::STITCHING => pass.stitching_bytes,
            kind => info.trailing.iter().find(|t| t.code == kind).map_or(0, |t| t.bytes),
        };
        if chunk::other_size(payload.len() as u32) != announced {
            return Err(malformed("a chunk differs from its announcement", chunk));
        }
        let memory_of_mesh = self.passes.memory_for(pass) + self.memory_of_attributes(pass);
        if chunk.kind == kind::MATERIALS {
            let used = memory_of_mesh + self.extras.memory();
            return self.head.take_materials(Source { chunk, frames: &self.frames, limits, used });
        }
        let used = self.held_memory() + memory_of_mesh;
        let left = self.work_left().saturating_sub(work.done());
        let (mesh, grid) = (&self.passes.mesh, &info.grid);
        let new = NewChunk { payload, mesh, grid, limits, used, work: left };
        let units = self.extras.read(chunk.kind, new, self.attributes.as_ref());
        work.spend(units.map_err(|e| e.at(chunk))?);
        Ok(())
    }

    /// The pass that was done last.
    pub(super) fn last_pass(&self) -> Option<&PassInfo> {
        self.info.as_ref()?.passes.get(self.done.checked_sub(1)?)
    }

    /// The pass that is decoded next, unless the stream or the wanted level is complete.
    pub(super) fn next_pass(&self) -> Option<&PassInfo> {
        self.info.as_ref()?.passes.get(self.done).filter(|pass| !self.options.is_beyond(pass))
    }

    /// True once the last pass of the stream, or of the wanted level, has been applied, and what belongs to it.
    pub(super) fn is_complete(&self) -> bool {
        self.info.is_some() && self.next_pass().is_none() && self.awaited.is_empty()
    }
}

impl StreamInfo {
    /// Reads what a stream, or its beginning, says of itself; `None` if the table of passes has not
    /// come yet. Nothing is decoded.
    ///
    /// # Errors
    /// If the bytes are no stream, or damaged before the table ends.
    pub fn read(bytes: &[u8]) -> Result<Option<Self>, DecodeError> {
        let limits = Limits { max_work: Some(u64::MAX), ..Limits::default() };
        let mut decoder = StreamingDecoder::new(DecodeOptions::new().limits(limits));
        decoder.feed(bytes)?;
        decoder.read_info()?;
        Ok(decoder.info)
    }
}
