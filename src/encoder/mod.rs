//! From a mesh to a stream: down the levels first, then coarse to fine into the bytes.

mod attribute_writer;
mod attributes;
mod canonical_order;
mod coarsen;
mod compensation;
mod earnings;
mod frame;
mod grid_surface;
mod isolated_and_degenerate;
mod number_format;
mod numbering;
mod options;
mod pass_writer;
mod patch_search;
pub(crate) mod quantise;
mod schedule;
mod stitching;
mod tie_break;
mod ties;
mod trailing;
mod values;
mod write;

use coarsen::Companions;
use grid_surface::GridSurface;
use options::Input;
use trailing::Original;

pub use options::{EncodeOptions, Encoded, Progress};

use crate::decoder::{StreamInfo, environment};
use crate::descriptors::Features;
use crate::error::EncodeError;
use crate::mesh::{Attributes, Surface, TriMesh};
use crate::passes::Malformed;

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
    environment::check().map_err(EncodeError::FloatingPoint)?;
    let input = Input { mesh, attributes, options };
    let (surface, on_grid) = GridSurface::of(input)?;
    let (quantised, features) = on_grid.quantise_attributes(input)?;
    let original = Original { input, on_grid: &on_grid, quantised: &quantised };
    let bytes = smallest_stream(surface, original, features.as_ref(), progress);
    // The encoder's own bytes always hold a header.
    let info = StreamInfo::read(&bytes).ok().flatten().ok_or(EncodeError::TooLarge(bytes.len()))?;
    Ok(Encoded { bytes, info, repair: on_grid.repair, values_dropped: quantised.values_dropped })
}

/// The smallest stream of all hierarchies and schedules that the options try.
fn smallest_stream(
    surface: Surface,
    original: Original,
    features: Option<&Features>,
    progress: &(dyn Fn(Progress) + Sync),
) -> Vec<u8> {
    let Original { input: Input { options, .. }, on_grid, quantised } = original;
    let points = compensation::points(&surface, &on_grid.cells);
    let glued = on_grid.glued();
    let attempts = options.hierarchies_tried();
    let mut surface = Some(surface);
    let mut smallest: Vec<u8> = Vec::new();
    for (i, &attempt) in attempts.iter().enumerate() {
        let is_last = i + 1 == attempts.len();
        let taken = if is_last { surface.take() } else { surface.clone() }.unwrap_or_default();
        let (glued, seams, features) = (glued.clone(), quantised.seams(), features.cloned());
        let companions = Companions { glued, seams, features };
        let hierarchy = coarsen::analyse(taken, &on_grid.cells, companions, options, attempt, progress);
        for schedule in schedule::tried(&hierarchy, options) {
            let bytes = write::write(&original, &points, &hierarchy, &schedule, progress);
            if smallest.is_empty() || bytes.len() < smallest.len() {
                smallest = bytes;
            }
        }
    }
    smallest
}

/// Pads a payload with zeros until a decoder believes that it holds so many things.
fn padded(mut payload: Vec<u8>, count: u64, most_per_byte: u64) -> Vec<u8> {
    let least = count.div_ceil(most_per_byte).saturating_sub(1);
    payload.resize(payload.len().max(least as usize), 0);
    payload
}

/// The codes fail on malformed payloads only, and an encoder reads none.
fn expect_sound<T>(result: Result<T, Malformed>) -> T {
    result.unwrap_or_else(|e| unreachable!("the encoder made a stream it refuses: {}", e.0))
}
