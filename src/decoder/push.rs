//! The push decoder: bytes in, refined meshes out.

use super::attributes::AttributeDecoder;
use super::level_mesh::LevelMesh;
use super::losses;
use super::options::DecodeOptions;
use super::snapshot::Snapshot;
use super::stream::StreamingDecoder;
use super::stream_info::StreamInfo;
use super::update::{Step, Update};
use crate::error::DecodeError;
use crate::limits::Limits;
use crate::losses::Losses;
use crate::mesh::{Attributes, TriMesh};
use crate::passes::work_budget::WorkBudget;

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
    stream: StreamingDecoder,
}

impl Decoder {
    /// A decoder of all levels.
    pub fn new(limits: Limits) -> Self {
        Self::with_options(DecodeOptions::new().limits(limits))
    }

    /// A decoder that may stop at a level.
    pub fn with_options(options: DecodeOptions) -> Self {
        Self { stream: StreamingDecoder::new(options) }
    }

    /// Takes the next bytes of the stream, however they are cut, and applies every pass that is
    /// complete. The ranges of each update refer to the mesh after the call. Bytes after the end of the stream, or
    /// of the wanted level, are ignored.
    ///
    /// # Errors
    /// If the stream is damaged, not a stream, or beyond the limits, or if the floating-point environment of the
    /// thread is not the default one. The finest complete mesh stays
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
        self.stream.feed(bytes)
    }

    /// Applies the next pass if all its bytes are there: one pass at a time, for callers who want to
    /// see every mesh or to do something in between.
    ///
    /// Chunks that follow a pass, also the last one, are taken on the way and give no update;
    /// [`LevelMesh::to_tri_mesh`] and [`Decoder::is_complete`] tell of them.
    ///
    /// # Errors
    /// As [`Decoder::push`].
    pub fn step(&mut self) -> Result<Option<Update>, DecodeError> {
        match self.stream.step(&mut WorkBudget::unlimited())? {
            Step::Finished(update) => Ok(Some(update)),
            Step::Unfinished | Step::Waiting => Ok(None),
        }
    }

    /// As [`Decoder::step`], but does at most about `work` units of a pass (at least 1) and goes on with it in the
    /// next call: for threads that have other things to do in time. Until the pass is finished all that
    /// is seen of the mesh is that of the pass before.
    ///
    /// A unit is the work of an edge or a triangle, about a tenth of a microsecond. The last thing done in a
    /// call may be more than is left: a vertex with all its edges, a copy of an array, which
    /// counts one unit for 64 numbers, or a whole chunk of stitching or after the last pass. Only the links of a base mesh are
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
        self.stream.step(&mut WorkBudget::units(work.max(1)))
    }

    /// What the stream says of itself, once its table of passes has arrived.
    pub fn info(&self) -> Option<&StreamInfo> {
        self.stream.info.as_ref()
    }

    /// The finest complete mesh.
    pub fn mesh(&self) -> Option<LevelMesh<'_>> {
        Snapshot(&self.stream).mesh()
    }

    /// The mesh so far, with what has arrived of the next pass: vertices whose bytes are missing do not
    /// come, missing bits of coordinates are guessed. Nearly as good as if the stream were cut after every
    /// vertex, but made of bytes whose checksum has not come yet, and of a copy of the mesh.
    ///
    /// `None` before the base mesh is complete. Without such bytes, without the memory, or within a pass
    /// ([`Decoder::step_within`]) it is [`Decoder::mesh`].
    pub fn preview(&self) -> Option<TriMesh> {
        Snapshot(&self.stream).preview()
    }

    /// Attributes of the surface [`Decoder::mesh`], without gaps: values that have not come yet are guessed from those around.
    /// Empty before the base mesh is complete, and of a stream without attributes. Collected anew by each call.
    pub fn attributes(&self) -> Attributes {
        Snapshot(&self.stream).attributes()
    }

    /// Checksum of the values of all attributes that have come (`format/SPEC.md`, section 9): equal on every platform
    /// for the same prefix of a stream.
    pub fn attribute_checksum(&self) -> u32 {
        self.stream.attributes.as_ref().map_or(0, AttributeDecoder::checksum)
    }

    /// Bytes of payload that each attribute has taken so far, to a few bytes per pass.
    pub fn attribute_bytes(&self) -> &[u64] {
        self.stream.attributes.as_ref().map_or(&[], AttributeDecoder::bytes)
    }

    /// The mesh that was encoded, as far as what has come tells ([`LevelMesh::to_tri_mesh`]), with its attributes:
    /// once all of a lossless stream is there, bit for bit.
    pub fn to_tri_mesh_with_attributes(&self) -> Option<(TriMesh, Attributes)> {
        Snapshot(&self.stream).mesh_with_attributes()
    }

    /// [`Decoder::preview`] with its attributes.
    pub fn preview_with_attributes(&self) -> Option<(TriMesh, Attributes)> {
        Snapshot(&self.stream).preview_with_attributes()
    }

    /// Units of work done so far, see [`Decoder::step_within`]: the same for a stream however it is
    /// cut and sliced.
    pub fn work_done(&self) -> u64 {
        self.stream.work_done
    }

    /// Number of passes applied.
    pub fn passes_done(&self) -> usize {
        self.stream.done
    }

    /// What [`Decoder::mesh`] lacks of what the stream holds: levels, bits, and what follows the passes. Empty before the
    /// base mesh, and once all has come.
    pub fn losses(&self) -> Losses {
        losses::losses(&self.stream)
    }

    /// True once the last pass of the stream, or of the wanted level, has been applied, and what belongs to it.
    pub fn is_complete(&self) -> bool {
        self.stream.is_complete()
    }
}

/// Decodes a stream, or what there is of it, in one call.
///
/// A stream that ends early gives all that its bytes tell, see [`Decoder::preview`].
///
/// # Errors
/// If the stream is damaged, beyond the limits, or ends before its base mesh. A [`Decoder`] keeps the finest mesh before
/// the damage; this function gives only the error.
pub fn decode(bytes: &[u8], options: DecodeOptions) -> Result<TriMesh, DecodeError> {
    let mut decoder = Decoder::with_options(options);
    decoder.push(bytes)?;
    decoder.preview().ok_or(DecodeError::NoMesh)
}
