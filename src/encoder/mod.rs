//! From a mesh to a stream: down the levels first, then coarse to fine into the bytes.

mod analysis;
mod attribute_writer;
mod attributes;
mod options;
pub(crate) mod quantise;
mod schedule;
mod write;

pub use options::{EncodeOptions, Encoded, Progress};

use crate::mesh::Attributes;
use crate::mesh::repair::{Repaired, repair};
use crate::{EncodeError, Optimize, StreamInfo, TriMesh};

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
    encode_with_attributes(mesh, &Attributes::default(), options, progress)
}

/// Encodes a mesh with its attributes, each quantised to the bits that [`EncodeOptions`] has for its kind; see
/// [`encode`]. Vertices that are repeated to cut the mesh have the values of the one they repeat.
///
/// # Errors
/// As [`encode`], and if an attribute does not fit the mesh, or there are more than the format can hold.
pub fn encode_with_attributes(
    mesh: &TriMesh,
    attributes: &Attributes,
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
    let model = quantise::quantise(mesh, &source, options.quantization)?;
    let quantised = attributes::quantise(mesh, attributes, &source, options)?;
    drop(source);
    let seams = quantised.seams();
    let hierarchy = analysis::analyse(mesh, surface, &model, seams, options, progress);
    drop(model.positions);
    let write = |steps_per_edge| {
        let schedule = schedule::plan(&hierarchy, options.quantization, steps_per_edge);
        write::write(&hierarchy, &model.cells, &model.grid, &quantised, &schedule, options, progress)
    };
    let mut bytes = write(options.steps_per_edge);
    if options.optimize == Optimize::Size && options.steps_per_edge.is_none() {
        // Which surfaces are smaller with all bits at once only trying tells.
        let at_once = write(Some(f64::MAX));
        if at_once.len() < bytes.len() {
            bytes = at_once;
        }
    }
    // The encoder's own bytes always hold a header.
    let info = StreamInfo::read(&bytes).ok().flatten().ok_or(EncodeError::TooLarge(bytes.len()))?;
    Ok(Encoded { bytes, info, repair, values_dropped: quantised.values_dropped })
}
