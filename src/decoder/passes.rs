//! One pass after the other, applied to the mesh.

use super::frame::{PassInfo, PassKind};
use crate::DecodeError;
use crate::bitstream::header::Action;
use crate::bitstream::range_coder::{BitCoder, RangeDecoder};
use crate::limits::Limits;
use crate::mesh::Surface;
use crate::passes::connectivity::{self, ConnectivityModels};
use crate::passes::coordinates::{self, CoordinateModels};
use crate::passes::patch::{Patches, StarBuilder};
use crate::passes::refine::{self, RefineModels};
use crate::passes::{EXHAUSTED, GridMesh, Malformed, base};

/// The mesh and all that is learnt about it.
#[derive(Clone)]
pub(super) struct PassDecoder {
    pub(super) mesh: GridMesh,
    connectivity: ConnectivityModels,
    coordinates: CoordinateModels,
    refine: RefineModels,
}

/// Bytes of memory that a vertex and a face of the finest mesh may take, working space included.
const BYTES_PER_VERTEX: u64 = 64;
const BYTES_PER_FACE: u64 = 72;
/// The models.
const FIXED_BYTES: u64 = 2 << 20;

/// Bytes of memory that decoding a pass may take, the buffer of the stream not counted.
pub(super) fn memory_for(pass: &PassInfo) -> u64 {
    let base = if let Action::Base { .. } = pass.row.action { 160 * u64::from(pass.faces) } else { 0 };
    FIXED_BYTES + base + BYTES_PER_VERTEX * u64::from(pass.vertices) + BYTES_PER_FACE * u64::from(pass.faces)
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
    pub(super) fn new() -> Self {
        Self {
            mesh: GridMesh::default(),
            connectivity: ConnectivityModels::new(),
            coordinates: CoordinateModels::new(),
            refine: RefineModels::new(),
        }
    }

    /// Applies one pass. After an error the mesh is the one from before.
    ///
    /// # Errors
    /// If the payload names something that no encoder writes.
    pub(super) fn apply(&mut self, pass: &PassInfo, payload: &[u8]) -> Result<Changes, Malformed> {
        let mut coder = RangeDecoder::new(payload);
        match pass.row.action {
            Action::Base { precision } => {
                let (vertices, faces) = (pass.vertices as usize, pass.faces as usize);
                let mesh = base::code(&mut coder, vertices, faces, precision, None)?.mesh;
                check_end(&coder)?;
                self.mesh = mesh;
                Ok(Changes { first_vertex: 0, rewritten_faces: Vec::new(), first_new_face: 0 })
            }
            Action::Split => self.split(&mut coder, pass),
            Action::Refine => {
                refine::code(&mut coder, &mut self.refine, &mut self.mesh, None);
                if let Err(error) = check_end(&coder) {
                    self.mesh.positions.iter_mut().flatten().for_each(|c| *c >>= 1);
                    return Err(error);
                }
                let first_new_face = self.mesh.surface.triangles.len() as u32;
                Ok(Changes { first_vertex: 0, rewritten_faces: Vec::new(), first_new_face })
            }
        }
    }

    /// The mesh with the beginning of a pass: a split brings back the vertices whose coordinates are
    /// there, a refinement guesses the bits that are missing. `None` if the bytes tell nothing.
    pub(super) fn mesh_with_cut(&self, pass: &PassInfo, payload: &[u8]) -> Option<GridMesh> {
        let mut coder = RangeDecoder::of_cut(payload);
        let mut ahead = self.clone();
        match pass.kind {
            PassKind::Base => None,
            PassKind::Refine => {
                refine::code(&mut coder, &mut ahead.refine, &mut ahead.mesh, None);
                Some(ahead.mesh)
            }
            PassKind::Split => {
                // All of the connectivity is needed to read the coordinates, not to show them.
                let patches = ahead.read_split(&mut coder, pass).ok()?;
                let (first, count) = (self.mesh.positions.len(), ahead.mesh.positions.len());
                let mut mesh = self.mesh.clone();
                let mut builder = StarBuilder::new(first);
                for patch in 0..count - first {
                    builder.restore(&mut mesh.surface, &patches, patch).ok()?;
                }
                mesh.positions.extend_from_slice(&ahead.mesh.positions[first..]);
                Some(mesh)
            }
        }
    }

    fn split(&mut self, coder: &mut RangeDecoder, pass: &PassInfo) -> Result<Changes, Malformed> {
        let before = self.mesh.surface.triangles.clone();
        let num_coarse = self.mesh.positions.len();
        let result = self.try_split(coder, pass);
        if result.is_err()
            && self.mesh.surface.triangles.len() + self.mesh.positions.len() != before.len() + num_coarse
        {
            self.mesh.positions.truncate(num_coarse);
            self.mesh.roughness.truncate(num_coarse);
            self.mesh.surface = Surface::from_triangles(before, num_coarse).unwrap_or_default();
        }
        result
    }

    fn try_split(&mut self, coder: &mut RangeDecoder, pass: &PassInfo) -> Result<Changes, Malformed> {
        let (first_vertex, first_face) = (self.mesh.positions.len(), self.mesh.surface.triangles.len());
        let patches = self.read_split(coder, pass)?;
        check_end(coder)?;
        Ok(Changes {
            first_vertex: first_vertex as u32,
            rewritten_faces: patches.rewritten_faces(),
            first_new_face: first_face as u32,
        })
    }

    /// Connectivity, stars, coordinates; of a cut payload as many coordinates as there are.
    fn read_split(&mut self, coder: &mut RangeDecoder, pass: &PassInfo) -> Result<Patches, Malformed> {
        let count = pass.row.vertices as usize;
        let mesh = &mut self.mesh;
        let patches = connectivity::code(coder, &mut self.connectivity, mesh, count, None)?;
        if patches.num_new_faces() != pass.row.faces as usize {
            return Err(Malformed("a level has other faces than announced"));
        }
        let mut builder = StarBuilder::new(mesh.positions.len());
        mesh.reserve(count, pass.row.faces as usize);
        for patch in 0..patches.len() {
            builder.restore(&mut mesh.surface, &patches, patch)?;
        }
        coordinates::code(coder, &mut self.coordinates, mesh, &patches, pass.precision, None)?;
        Ok(patches)
    }
}

fn check_end(coder: &RangeDecoder) -> Result<(), Malformed> {
    if coder.is_exhausted() { Err(Malformed(EXHAUSTED)) } else { Ok(()) }
}

/// Checks a pass against the limits before anything is allocated for it.
pub(super) fn check_limits(pass: &PassInfo, limits: &Limits, buffered: usize) -> Result<(), DecodeError> {
    Limits::check("vertices", u64::from(pass.vertices), u64::from(limits.max_vertices))?;
    Limits::check("levels", u64::from(pass.level), u64::from(limits.max_levels))?;
    Limits::check("memory", memory_for(pass) + buffered as u64, limits.max_memory)
}
