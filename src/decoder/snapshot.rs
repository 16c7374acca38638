//! The mesh and its attributes as they are now, after a pass or with the beginning of the next one.

use super::built_with::ASSETS;
use super::level_mesh::LevelMesh;
use super::stream::StreamingDecoder;
use super::stream_info::{PassInfo, PassKind};
use crate::bitstream::chunk::kind;
use crate::bitstream::profile::Profile;
use crate::mesh::{Attributes, TriMesh};
use crate::passes::GridMesh;
use crate::passes::patch::Patches;

/// What can be seen of a stream.
#[derive(Clone, Copy)]
pub(super) struct Snapshot<'a>(pub(super) &'a StreamingDecoder);

/// The mesh with the beginning of a pass.
struct CutMesh<'a> {
    pass: &'a PassInfo,
    mesh: GridMesh,
    patches: Patches,
}

impl CutMesh<'_> {
    /// Shown like `complete`, the mesh before the pass.
    fn shown_like<'b>(&'b self, complete: LevelMesh<'b>) -> LevelMesh<'b> {
        let (cells, triangles) = (&self.mesh.positions[..], &self.mesh.surface.triangles[..]);
        LevelMesh { cells, triangles, quantization_bits: self.pass.quantization_bits, ..complete }
    }
}

impl<'a> Snapshot<'a> {
    /// The finest complete mesh.
    pub(super) fn mesh(self) -> Option<LevelMesh<'a>> {
        let StreamingDecoder { options, info, passes, running, extras, .. } = self.0;
        let (info, pass) = (info.as_ref()?, self.0.last_pass()?);
        let mesh = &passes.mesh;
        let (cells, triangles) = match running {
            Some((running, _)) => running.mesh_before(mesh),
            None => (&mesh.positions[..], &mesh.surface.triangles[..]),
        };
        let compensation = options.compensation_after(pass);
        let (grid, quantization_bits, level) = (&info.grid, pass.quantization_bits, pass.level);
        Some(LevelMesh { cells, triangles, grid, quantization_bits, level, compensation, extras })
    }

    /// The mesh with what has arrived of the next pass.
    pub(super) fn preview(self) -> Option<TriMesh> {
        let complete = self.mesh()?;
        Some(match self.mesh_with_cut() {
            Some(cut) => cut.shown_like(complete).to_tri_mesh(),
            None => complete.to_tri_mesh(),
        })
    }

    /// Attributes of the finest complete surface, without gaps.
    pub(super) fn attributes(self) -> Attributes {
        let StreamingDecoder { frames, awaited, attributes, passes, done, .. } = self.0;
        let cut = frames.cut_chunk(None).filter(|(kind, _)| awaited.front() == Some(kind));
        let cut = cut.map_or(&[][..], |(_, payload)| payload);
        let known = attributes.as_ref().filter(|_| ASSETS && *done > 0);
        self.with_scene(known.map(|known| known.attributes(&passes.mesh, cut)).unwrap_or_default())
    }

    /// Attributes with what the stream has once for all of the mesh.
    fn with_scene(self, mut attributes: Attributes) -> Attributes {
        let StreamingDecoder { info, head, done, .. } = self.0;
        if *done > 0 {
            attributes.scene = info.as_ref().and_then(|info| info.scene.clone());
            attributes.metadata = info.as_ref().and_then(|info| info.metadata.clone()).unwrap_or_default();
            attributes.gltf_materials.clone_from(&head.materials);
        }
        attributes
    }

    /// The mesh that was encoded, as far as it is known, with its attributes.
    pub(super) fn mesh_with_attributes(self) -> Option<(TriMesh, Attributes)> {
        Some(self.assemble(self.mesh()?, self.attributes()))
    }

    /// [`preview`](Self::preview) with its attributes.
    pub(super) fn preview_with_attributes(self) -> Option<(TriMesh, Attributes)> {
        let complete = self.mesh()?;
        let Some(cut) = self.mesh_with_cut() else { return self.mesh_with_attributes() };
        let attributes = self.attributes_with_cut(&cut, complete.num_vertices());
        Some(self.assemble(cut.shown_like(complete), attributes))
    }

    /// Attributes of a mesh of which `first` vertices were there before the pass.
    fn attributes_with_cut(self, cut: &CutMesh, first: usize) -> Attributes {
        match &self.0.attributes {
            Some(attributes) if ASSETS && cut.pass.kind == PassKind::Split => {
                self.with_scene(attributes.with_cut(&cut.mesh, &cut.patches, first))
            }
            _ => self.attributes(),
        }
    }

    fn assemble(self, mesh: LevelMesh, attributes: Attributes) -> (TriMesh, Attributes) {
        let extras = &self.0.extras;
        let attributes = extras.assemble_attributes(mesh.num_vertices(), mesh.triangles(), attributes);
        (mesh.to_tri_mesh(), attributes)
    }

    /// `None` if nothing can be told of the next pass, or not within the limits.
    fn mesh_with_cut(self) -> Option<CutMesh<'a>> {
        let StreamingDecoder { options, frames, passes, running, has_failed, .. } = self.0;
        // Streams that are compressed begin to tell only when they are whole.
        let is_readable = running.is_none() && passes.profile != Profile::Fast;
        let pass = self.0.next_pass().filter(|_| is_readable)?;
        let (kind, payload) = frames.cut_chunk(Some(pass.frame()))?;
        // The coder reads four bytes ahead: fewer decide nothing.
        if *has_failed || !kind::is_pass(kind) || payload.len() < 5 {
            return None;
        }
        // Two copies that take as much again as the mesh itself.
        let held = self.0.held_memory() + 2 * passes.memory_for(pass);
        passes.check_limits(pass, &options.limits, held).ok()?;
        let (mesh, patches) = passes.mesh_with_cut(pass, payload)?;
        Some(CutMesh { pass, mesh, patches })
    }
}
