//! From a mesh to a stream: down the levels first, then coarse to fine into the bytes.

mod attribute_writer;
mod attributes;
mod canonical_order;
mod coarsen;
mod compensation;
mod earnings;
mod number_format;
mod options;
mod patch_search;
mod payload;
pub(crate) mod quantise;
mod schedule;
mod tie_break;
mod ties;
mod trailing;
mod tries;
mod values;
mod write;
mod written_pass;

use attributes::Elements;
use tie_break::Signatures;
use trailing::Exact;
use tries::Tries;
use values::ExactValues;

pub use options::{EncodeOptions, Encoded, Progress};

use crate::decoder::{StreamInfo, environment};
use crate::descriptors::{Features, FeaturesError};
use crate::error::EncodeError;
use crate::mesh::repair::{RepairReport, cut};
use crate::mesh::{Attributes, TriMesh, has_three_vertices};
use std::cell::OnceCell;

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
    let usable = || mesh.triangles().iter().filter(|t| has_three_vertices(t));
    let num_usable = usable().count();
    if num_usable == 0 {
        return Err(EncodeError::NoTriangles);
    }
    if num_usable.max(mesh.num_vertices()) >= (u32::MAX / 4) as usize {
        return Err(EncodeError::TooLarge(num_usable));
    }
    let mut loose = trailing::loose_vertices(mesh, options);
    let points = usable().flatten().chain(&loose).map(|&v| mesh.positions()[v as usize]);
    let grid = quantise::grid_around(points, options.quantization_bits)?;
    let mut loose_corners = trailing::loose_corners(mesh, options);
    let once = OnceCell::new();
    let make_signatures = || {
        let (vertices, corners) = surface_elements(mesh);
        let surface = Elements { vertices: &vertices, corners: &corners };
        Signatures::new(
            mesh,
            attributes,
            surface,
            Elements { vertices: &loose, corners: &loose_corners },
            options,
        )
    };
    let signatures = || once.get_or_init(make_signatures).as_ref();
    let (ordered, triangles) = canonical_order::order(mesh, &grid, &signatures);
    if !loose.is_empty() || !loose_corners.is_empty() {
        let signatures: Option<&Signatures> = signatures();
        trailing::sort_loose(&mut loose, mesh, &grid, signatures);
        trailing::sort_loose_corners(&mut loose_corners, mesh, &grid, signatures);
    }
    let (surface, source) = cut(triangles, ordered.cells.len());
    if surface.corner_of.len() >= (u32::MAX / 4) as usize {
        return Err(EncodeError::TooLarge(surface.corner_of.len()));
    }
    let repair = RepairReport {
        degenerate_triangles: if options.keep_degenerate { 0 } else { mesh.num_triangles() - num_usable },
        isolated_vertices: mesh.num_vertices() - ordered.cells.len() - loose.len(),
        repeated_vertices: source.len() - ordered.cells.len(),
    };
    let cells: Vec<[i32; 3]> = source.iter().map(|&v| ordered.cells[v as usize]).collect();
    let vertices: Vec<u32> = source.iter().map(|&v| ordered.vertex_source[v as usize]).collect();
    let elements = Elements { vertices: &vertices, corners: &ordered.corner_source };
    let beside = Elements { vertices: &loose, corners: &loose_corners };
    let quantised = attributes::quantise(mesh, attributes, elements, beside, options)?;
    let features = features(mesh, attributes, &vertices, options)
        .map_err(|error| EncodeError::DescriptorAttributes(error.to_string()))?;
    drop(vertices);
    let glued = trailing::kept(&source);
    let values = ExactValues { attributes, quantised: &quantised, is_lossless: options.lossless };
    let (ordered, source, loose) = (&ordered, &source[..], &loose[..]);
    let loose_corners = &loose_corners[..];
    let exact = Exact { mesh, grid: &grid, ordered, source, loose, loose_corners, values, options };
    let points = compensation::points(&surface, &cells);
    let attempts = options.hierarchies_tried();
    let mut surface = Some(surface);
    let mut bytes: Vec<u8> = Vec::new();
    let num_schedules = if options.steps_per_edge.is_some() { 1 } else { options.steps_tried().len() };
    let tries = Tries::new(&attempts, num_schedules, progress);
    for (i, &attempt) in attempts.iter().enumerate() {
        let is_last = i + 1 == attempts.len();
        let taken = if is_last { surface.take() } else { surface.clone() }.unwrap_or_default();
        let (glued, seams, features) = (glued.clone(), quantised.seams(), features.clone());
        let companions = coarsen::Companions { glued, seams, features };
        let hierarchy =
            coarsen::analyse(taken, &cells, companions, options, attempt, &|now| tries.tell(i, 0, now));
        let is_one_schedule = options.steps_per_edge.is_some() || hierarchy.records.is_empty();
        let tried = if is_one_schedule { &[None] } else { options.steps_tried() };
        for (k, &steps) in tried.iter().enumerate() {
            let steps = options.steps_per_edge.or(steps);
            let schedule = schedule::plan(&hierarchy, options.quantization_bits, steps);
            let progress = |now: Progress| tries.tell(i, k, now);
            let new = write::write(&hierarchy, &cells, &quantised, &exact, &points, &schedule, &progress);
            if bytes.is_empty() || new.len() < bytes.len() {
                bytes = new;
            }
        }
    }
    tries.finish();
    // The encoder's own bytes always hold a header.
    let info = StreamInfo::read(&bytes).ok().flatten().ok_or(EncodeError::TooLarge(bytes.len()))?;
    Ok(Encoded { bytes, info, repair, values_dropped: quantised.values_dropped })
}

/// The vertices that usable triangles have, and the first corner of each of these.
fn surface_elements(mesh: &TriMesh) -> (Vec<u32>, Vec<u32>) {
    let usable = || (0..).zip(mesh.triangles()).filter(|(_, t)| has_three_vertices(t));
    let mut is_used = vec![false; mesh.num_vertices()];
    usable().for_each(|(_, t): (u32, _)| t.iter().for_each(|&v| is_used[v as usize] = true));
    let vertices = (0..).zip(is_used).filter_map(|(v, is_used)| is_used.then_some(v)).collect();
    (vertices, usable().map(|(face, _)| 3 * face).collect())
}

/// The attributes that the descriptor is to see at the `vertices` of the mesh.
fn features(
    mesh: &TriMesh,
    attributes: &Attributes,
    vertices: &[u32],
    options: &EncodeOptions,
) -> Result<Option<Features>, FeaturesError> {
    if options.descriptor_attributes.is_empty() {
        return Ok(None);
    }
    let descriptor = options.descriptor;
    if !descriptor.knows_attributes() {
        return Err(FeaturesError::Descriptor { descriptor });
    }
    let features = Features::choose(mesh, attributes, &options.descriptor_attributes)?;
    Ok(Some(features.of_vertices(vertices)))
}
