//! What comes before the passes: header chunks in, [`StreamInfo`] out (`format/SPEC.md`, section 4).

use super::built_with::ASSETS;
use super::frame::{Chunk, FrameReader};
use super::refused::{malformed, out_of_order, skip};
use super::stream_info::{self, AttributeInfo, PassInfo, StreamInfo, TrailingInfo};
use super::{attributes, forecast};
use crate::bitstream::chunk::kind;
use crate::bitstream::chunk_index::ChunkIndex;
use crate::bitstream::header::{Header, Provenance};
use crate::bitstream::metadata;
use crate::bitstream::profile::Profile;
use crate::bitstream::scene;
use crate::error::DecodeError;
use crate::limits::Limits;
use crate::mesh::{GltfMaterials, SceneTable};
use crate::passes::attribute::Declarations;
use crate::util::budget::Budget;
use std::sync::Arc;

/// The header chunks received so far.
#[derive(Default)]
pub(super) struct Head {
    header: Option<Header>,
    provenance: Option<Provenance>,
    /// Payload of its chunk, until the number of passes is known.
    compensation: Option<Vec<u8>>,
    announced: Option<ChunkIndex>,
    scene: Option<SceneTable>,
    pub(super) materials: Option<GltfMaterials>,
    metadata: Option<Arc<[(String, String)]>>,
    /// Until the decoder of their values takes them.
    pub(super) declarations: Option<Declarations>,
    /// Bytes of memory that all of this takes.
    held: u64,
}

impl Head {
    /// Bytes of memory that are held.
    pub(super) fn memory(&self) -> u64 {
        self.held
    }

    /// Takes a chunk before the passes. The table of passes completes the information about the stream.
    pub(super) fn take(&mut self, source: Source) -> Result<Option<StreamInfo>, DecodeError> {
        let Source { chunk, .. } = source;
        match (chunk.kind, &self.header) {
            (kind::HEADER, None) => self.header = Some(read_header(source)?),
            (kind::PASSES, Some(header)) => return self.finish(*header, source).map(Some),
            (kind::COMPENSATION, _) if self.compensation.is_none() => {
                self.compensation = Some(self.read(source, "the compensation", copy)?);
            }
            (kind::HEADER | kind::PASSES | kind::COMPENSATION, _) => return Err(out_of_order(chunk)),
            (kind::PROVENANCE, _) => self.provenance = Provenance::read(source.payload()),
            _ if ASSETS => self.take_beside(source)?,
            _ => skip(chunk)?,
        }
        Ok(None)
    }

    /// Takes what a decoder of the surface alone skips.
    fn take_beside(&mut self, source: Source) -> Result<(), DecodeError> {
        let Source { chunk, .. } = source;
        match chunk.kind {
            kind::DECLARATIONS if self.declarations.is_none() => {
                let what = "declarations of attributes";
                self.declarations = Some(self.read(source, what, Declarations::read)?);
            }
            kind::SCENE if self.scene.is_none() => {
                self.scene = Some(self.read(source, "the scene", scene::read)?);
            }
            kind::METADATA if self.metadata.is_none() => {
                self.metadata = Some(self.read(source, "metadata", metadata::read)?.into());
            }
            kind::MATERIALS if self.materials.is_none() => self.take_materials(source)?,
            kind::ANNOUNCED if self.announced.is_none() => {
                let read = |payload: &[u8], _: &mut Budget| ChunkIndex::read(payload);
                self.announced = Some(self.read(source, "the announced chunks", read)?);
            }
            kind::DECLARATIONS | kind::SCENE | kind::MATERIALS | kind::METADATA | kind::ANNOUNCED => {
                return Err(out_of_order(chunk));
            }
            _ => skip(chunk)?,
        }
        Ok(())
    }

    /// Takes how materials look, from a chunk before or after the passes.
    pub(super) fn take_materials(&mut self, source: Source) -> Result<(), DecodeError> {
        self.materials = Some(self.read(source, "materials", scene::read_materials)?);
        Ok(())
    }

    /// Reads a payload within the limit of memory, and remembers what that took.
    fn read<T>(
        &mut self,
        source: Source,
        what: &'static str,
        read: impl FnOnce(&[u8], &mut Budget) -> Option<T>,
    ) -> Result<T, DecodeError> {
        let before = source.frames.memory() + source.used;
        let mut budget = Budget::new(before + self.held, source.limits.max_memory);
        let value = read(source.payload(), &mut budget);
        self.held = budget.taken() - before;
        value.ok_or_else(|| match budget.exceeded() {
            Some(needed) => beyond_memory(needed, source.limits),
            None => malformed(what, source.chunk),
        })
    }

    /// With the table of passes all is known that a stream says of itself.
    fn finish(&mut self, header: Header, source: Source) -> Result<StreamInfo, DecodeError> {
        let passes = self.list_passes(&header, source).map_err(|what| malformed(what, source.chunk))?;
        let (passes, trailing) = passes;
        let none = Declarations::default();
        let scene = self.scene.take();
        let metadata = self.metadata.take();
        let declared = self.declared().unwrap_or(&none);
        let info = StreamInfo {
            grid: header.grid,
            provenance: self.provenance.or(header.is_usual.then_some(Provenance::USUAL)),
            profile: profile_of(&header)?,
            passes,
            attributes: if ASSETS {
                declared.list.iter().map(AttributeInfo::of).collect()
            } else {
                Vec::new()
            },
            trailing,
            scene,
            metadata,
            work: 0,
        };
        let models = attributes::bytes_of_models(declared, info.profile.mixing());
        let held = source.frames.memory() + self.held;
        Limits::check("memory", held + models, source.limits.max_memory)?;
        let work = forecast::check(&info, declared, source.limits)?;
        Ok(StreamInfo { work, ..info })
    }

    /// The declarations, unless this decoder skips them.
    fn declared(&self) -> Option<&Declarations> {
        self.declarations.as_ref().filter(|_| ASSETS)
    }

    /// The passes with all that belongs to them, and what follows the last one.
    fn list_passes(
        &mut self,
        header: &Header,
        source: Source,
    ) -> Result<(Vec<PassInfo>, Vec<TrailingInfo>), &'static str> {
        let bytes = self.declared().map_or(&[][..], |declared| &declared.bytes);
        let start = source.frames.position();
        let passes = stream_info::list_passes(source.payload(), &header.grid, start, bytes);
        let mut passes = passes.map_err(|bad| bad.0)?;
        if let Some(declared) = self.declared() {
            attributes::check_density(declared, &passes)?;
        }
        if let Some(payload) = self.compensation.take() {
            stream_info::add_compensation(&mut passes, &payload).map_err(|bad| bad.0)?;
        }
        let announced = self.announced.take().filter(|_| ASSETS).unwrap_or_default();
        let trailing = stream_info::add_announced(&mut passes, &announced).map_err(|bad| bad.0)?;
        Ok((passes, trailing))
    }
}

/// A chunk, where its payload is, and the memory that is left for what it holds.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub(super) chunk: &'a Chunk,
    pub(super) frames: &'a FrameReader,
    pub(super) limits: &'a Limits,
    /// Bytes that others hold.
    pub(super) used: u64,
}

impl<'a> Source<'a> {
    fn payload(self) -> &'a [u8] {
        self.frames.payload(self.chunk)
    }
}

fn beyond_memory(needed: u64, limits: &Limits) -> DecodeError {
    DecodeError::Limit { what: "memory", needed, allowed: limits.max_memory }
}

fn copy(payload: &[u8], budget: &mut Budget) -> Option<Vec<u8>> {
    budget.take(payload.len(), 1)?;
    Some(payload.to_vec())
}

fn read_header(source: Source) -> Result<Header, DecodeError> {
    let header = Header::read(source.payload()).ok_or(malformed("the header", source.chunk))?;
    profile_of(&header)?;
    Ok(header)
}

fn profile_of(header: &Header) -> Result<Profile, DecodeError> {
    let profile = Profile::from_code(header.profile);
    profile.filter(|profile| profile.is_supported()).ok_or_else(|| {
        DecodeError::Unsupported(match profile {
            Some(profile) => {
                format!("profile {}, which this decoder was built without", profile.name())
            }
            None => format!("profile {}", header.profile),
        })
    })
}
