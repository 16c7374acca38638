//! One pass after the other, applied to the mesh.

use super::built_with::STREAMS;
use super::running::Running;
use super::state::PassDecoder;
use super::stream_info::{PassInfo, PassKind};
use crate::bitstream::header::Action;
use crate::bitstream::profile::Profile;
use crate::entropy::context_mixer::Mixing;
use crate::entropy::range_coder::RangeDecoder;
use crate::error::DecodeError;
use crate::limits::Limits;
use crate::mesh::Surface;
use crate::passes::base_tables::pass::MEMORY_OF_MODELS;
use crate::passes::patch::{Patches, StarBuilder};
use crate::passes::work_budget::WorkBudget;
use crate::passes::{GridMesh, Malformed};

/// Bytes of memory that a vertex and a face of the finest mesh may take, working space included.
const BYTES_PER_VERTEX: u64 = 64;
const BYTES_PER_TRIANGLE: u64 = 72;

/// Bytes of memory that the models may take.
const fn bytes_of_models(mixing: Mixing) -> u64 {
    match mixing {
        Mixing::Plain => 2 << 20,
        Mixing::Specialised => 32 << 20,
    }
}

/// The parts of the mesh a pass changed.
pub(super) struct Changes {
    /// First vertex whose position is new or different; all after it are.
    pub(super) first_vertex: u32,
    /// Old triangles that were rewritten, ascending and not touching each other.
    pub(super) rewritten_faces: Vec<std::ops::Range<u32>>,
    /// First triangle that is new.
    pub(super) first_new_face: u32,
}

impl PassDecoder {
    pub(super) fn new(profile: Profile) -> Self {
        Self { mesh: GridMesh::default(), models: None, profile }
    }

    /// Bytes of memory that a pass may take, the buffer of the stream not counted.
    pub(super) fn memory_for(&self, pass: &PassInfo) -> u64 {
        let tables = if STREAMS && self.profile == Profile::Fast { MEMORY_OF_MODELS } else { 0 };
        let base = match pass.row.action {
            Action::Base { .. } => 160 * u64::from(pass.triangles) + tables,
            _ => 0,
        };
        bytes_of_models(self.profile.mixing())
            + base
            + BYTES_PER_VERTEX * u64::from(pass.vertices)
            + BYTES_PER_TRIANGLE * u64::from(pass.triangles)
    }

    /// Checks a pass against the limits before anything is allocated for it. `held`: bytes that are held in
    /// addition.
    pub(super) fn check_limits(
        &self,
        pass: &PassInfo,
        limits: &Limits,
        held: u64,
    ) -> Result<(), DecodeError> {
        Limits::check("vertices", u64::from(pass.vertices), u64::from(limits.max_vertices))?;
        Limits::check("levels", u64::from(pass.level), u64::from(limits.max_levels))?;
        Limits::check("memory", self.memory_for(pass) + held, limits.max_memory)
    }

    /// Goes on with a pass; what it changed, and its patches, once it is over, `None` if the work is used up before.
    /// After an error the mesh is the one from before the pass.
    ///
    /// # Errors
    /// If the payload names something that no encoder writes.
    pub(super) fn advance(
        &mut self,
        running: &mut Running,
        pass: &PassInfo,
        payload: &[u8],
        work: &mut WorkBudget,
    ) -> Result<Option<(Changes, Patches)>, Malformed> {
        let result = running.advance(self, pass, payload, work).map(|patches| {
            let patches = patches?;
            work.sweep(pass.triangles as usize);
            Some((Changes::of(pass, &patches), patches))
        });
        if result.is_err() {
            self.roll_back(running);
        }
        result
    }

    /// Puts back the mesh from before a pass.
    fn roll_back(&mut self, running: &mut Running) {
        if let Some(positions) = running.old_positions.take() {
            self.mesh.positions = positions;
        }
        if let Some(triangles) = running.old_triangles.take() {
            let num_vertices = running.num_old_vertices;
            self.mesh.positions.truncate(num_vertices);
            self.mesh.roughness.truncate(num_vertices);
            self.mesh.surface = Surface::from_triangles(triangles, num_vertices).unwrap_or_default();
        }
    }

    /// The mesh with the beginning of a pass: a split restores the vertices whose coordinates are
    /// there, a refinement predicts the missing bits. `None` if the bytes decide nothing.
    pub(super) fn mesh_with_cut(&self, pass: &PassInfo, payload: &[u8]) -> Option<(GridMesh, Patches)> {
        if pass.kind == PassKind::Base {
            return None;
        }
        let mut coder = RangeDecoder::of_cut(payload);
        let mut ahead = self.clone();
        let mut running = Running::new(payload, pass, self.profile)?;
        let patches =
            running.advance_with(&mut ahead, pass, &mut coder, &mut WorkBudget::unlimited()).ok()??;
        if pass.kind == PassKind::Refine {
            return Some((ahead.mesh, patches));
        }
        // All of the connectivity is needed to read the coordinates, not to show them.
        let (first, count) = (self.mesh.positions.len(), ahead.mesh.positions.len());
        let mut mesh = self.mesh.clone();
        let mut builder = StarBuilder::new(first);
        for patch in 0..count - first {
            builder.restore(&mut mesh.surface, &patches, patch).ok()?;
        }
        mesh.positions.extend_from_slice(&ahead.mesh.positions[first..]);
        Some((mesh, patches))
    }
}

impl Changes {
    /// What a pass with these patches changed.
    fn of(pass: &PassInfo, patches: &Patches) -> Self {
        let (first_vertex, first_new_face) = match pass.kind {
            PassKind::Base => (0, 0),
            PassKind::Split => (pass.vertices - pass.row.vertices, pass.triangles - pass.row.triangles),
            PassKind::Refine => (0, pass.triangles),
        };
        Self {
            first_vertex,
            rewritten_faces: patches.rewritten_faces(first_new_face as usize),
            first_new_face,
        }
    }
}
