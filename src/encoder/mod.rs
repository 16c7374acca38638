//! From a mesh to a stream: down the levels first, then coarse to fine into the bytes.

mod attribute_coding;
mod attribute_writer;
mod attributes;
mod canonical_order;
mod choose_grid;
mod coarsen;
mod compensation;
mod earnings;
mod frame;
mod grid_choice;
mod grid_error;
mod grid_surface;
mod isolated_and_degenerate;
mod losses;
mod number_format;
mod numbering;
mod options;
mod pass_writer;
mod patch_search;
mod payload;
pub(crate) mod quantize;
mod rounding;
mod schedule;
mod stitching;
mod tie_break;
mod ties;
mod trailing;
mod tries;
mod values;
mod write;

use coarsen::Companions;
use grid_surface::GridSurface;
use options::Input;
use trailing::Original;
use tries::Tries;

pub use grid_choice::GridChoice;
pub use grid_error::{GridError, Remedy};
pub use options::{EncodeOptions, Encoded, Progress};

use crate::decoder::{StreamInfo, environment};
use crate::descriptors::Features;
use crate::error::EncodeError;
use crate::mesh::{Attributes, Surface, TriMesh};

/// Encodes a mesh.
///
/// The stream holds the mesh quantized to a grid; its finest level gives every cell and every
/// oriented triangle back exactly. What was cut or dropped on the way is in the report.
///
/// # Errors
/// If the mesh has no usable triangle, spans more than a double or a lattice can hold, or an option is out of
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

/// Encodes a mesh with its attributes, each quantized to the bits that [`EncodeOptions`] has for its kind; see
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
    let (quantized, features) = on_grid.quantize_attributes(input)?;
    let original = Original { input, on_grid: &on_grid, quantized: &quantized };
    let bytes = smallest_stream(surface, original, features.as_ref(), progress);
    // The encoder's own bytes always hold a header.
    let info = StreamInfo::read(&bytes).ok().flatten().ok_or(EncodeError::TooLarge(mesh.num_vertices()))?;
    let GridSurface { repair, grid_error, .. } = on_grid;
    let mut losses = losses::of_positions(&grid_error);
    losses.append(losses::beside_positions(&repair, &quantized, options));
    Ok(Encoded { bytes, info, repair, grid_error, losses })
}

/// The smallest stream of all hierarchies and schedules that the options try.
fn smallest_stream(
    surface: Surface,
    original: Original,
    features: Option<&Features>,
    progress: &(dyn Fn(Progress) + Sync),
) -> Vec<u8> {
    let Original { input: Input { options, .. }, on_grid, quantized } = original;
    let points = compensation::points(&surface, &on_grid.cells);
    let stitched = on_grid.stitched();
    let attempts = options.hierarchies_tried();
    let mut surface = Some(surface);
    let mut smallest: Vec<u8> = Vec::new();
    let tries = Tries::new(&attempts, options.steps_tried().len(), progress);
    for (i, &attempt) in attempts.iter().enumerate() {
        let is_last = i + 1 == attempts.len();
        let taken = if is_last { surface.take() } else { surface.clone() }.unwrap_or_default();
        let (stitched, seams, features) = (stitched.clone(), quantized.seams(), features.cloned());
        let companions = Companions { stitched, seams, features };
        let hierarchy = coarsen::analyse(taken, on_grid.placed(), companions, options, attempt, &|now| {
            tries.tell(i, 0, now)
        });
        for (k, schedule) in schedule::tried(&hierarchy, options, on_grid.grid.quantization_bits).enumerate()
        {
            let progress = |now: Progress| tries.tell(i, k, now);
            let bytes = write::write(&original, &points, &hierarchy, &schedule, &progress);
            if smallest.is_empty() || bytes.len() < smallest.len() {
                smallest = bytes;
            }
        }
    }
    tries.finish();
    smallest
}
