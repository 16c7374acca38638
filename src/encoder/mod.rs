//! From a mesh to a stream: down the levels first, then coarse to fine into the bytes.

mod analysis;
mod options;
pub(crate) mod quantise;
mod schedule;
mod write;

pub use options::{EncodeOptions, Encoded, Progress};

use crate::mesh::repair::{Repaired, repair};
use crate::{EncodeError, StreamInfo, TriMesh};

/// Encodes a mesh.
///
/// The stream holds the mesh quantised to a grid; its finest level gives every cell and every
/// oriented triangle back exactly. What was cut or dropped on the way is in the report.
///
/// # Errors
/// If the mesh has no usable triangle, spans more than a double can hold, or an option is out of
/// range.
pub fn encode(mesh: &TriMesh, options: &EncodeOptions) -> Result<Encoded, EncodeError> {
    encode_with_progress(mesh, options, &|_| {})
}

/// Encodes a mesh and tells how far it is, see [`encode`].
///
/// # Errors
/// As [`encode`].
pub fn encode_with_progress(
    mesh: &TriMesh,
    options: &EncodeOptions,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Encoded, EncodeError> {
    options.check()?;
    let Repaired { surface, source, report: repair } = repair(mesh);
    if surface.triangles.is_empty() {
        return Err(EncodeError::NoTriangles);
    }
    if surface.triangles.len().max(surface.corner_of.len()) >= (u32::MAX / 4) as usize {
        return Err(EncodeError::TooLarge(surface.triangles.len()));
    }
    let mut model = quantise::quantise(mesh, &source, options.quantization)?;
    drop(source);
    let others = options.other_valences();
    let attempts = std::iter::once(None).chain(others.iter().copied().map(Some));
    let mut surface = Some(surface);
    let mut bytes: Vec<u8> = Vec::new();
    for (i, max_valence) in attempts.enumerate() {
        let taken = if i == others.len() { surface.take() } else { surface.clone() };
        let hierarchy =
            analysis::analyse(mesh, taken.unwrap_or_default(), &model, options, max_valence, progress);
        if i == others.len() {
            model.positions = Vec::new();
        }
        let tried = if options.steps_per_edge.is_some() { &[None] } else { options.steps_tried() };
        for &steps in tried {
            let steps = options.steps_per_edge.or(steps);
            let schedule = schedule::plan(&hierarchy, options.quantization, steps);
            let new = write::write(&hierarchy, &model.cells, &model.grid, &schedule, options, progress);
            if bytes.is_empty() || new.len() < bytes.len() {
                bytes = new;
            }
        }
    }
    // The encoder's own bytes always hold a header.
    let info = StreamInfo::read(&bytes).ok().flatten().ok_or(EncodeError::TooLarge(bytes.len()))?;
    Ok(Encoded { bytes, info, repair })
}
