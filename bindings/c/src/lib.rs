//! C interface: the decoder and the encoder behind plain pointers. `include/lwc.h` is made from this file.
//!
//! What is unsafe here is what C cannot promise by type: that a pointer is one that was handed out, that
//! it has not been freed, and that it has as many elements as it is said to have. Each function says what
//! it needs; null pointers are answered with a status and never followed. No panic crosses the border:
//! `guard` turns one into a status.

mod attributes;
mod error;
mod losses;
mod options;

pub use attributes::{
    Attribute, AttributeDomain, ComponentType, LWC_NO_ENTRY, Semantic, lwc_mesh_add_attribute,
    lwc_mesh_attribute, lwc_mesh_attribute_indices, lwc_mesh_attribute_name, lwc_mesh_attribute_values,
    lwc_mesh_find_attribute, lwc_mesh_num_attributes,
};
pub use error::{Status, lwc_last_error};
pub use losses::{
    Loss, LossKind, LossStage, lwc_encoded_loss, lwc_encoded_num_losses, lwc_mesh_loss, lwc_mesh_num_losses,
};
pub use options::{DecodeOptions, EncodeOptions, lwc_decode_options_default, lwc_encode_options_default};

use attributes::Texts;
use error::guard;
use losses::Listed;
use lwc::losses::Losses;
use lwc::mesh::Attributes;
use lwc::{PassKind, PositionUpdater, TriMesh};
use std::ffi::CString;
use std::slice;

/// A mesh with its attributes, that owns its arrays.
pub struct Mesh {
    mesh: TriMesh,
    attributes: Attributes,
    /// One for each attribute.
    texts: Vec<Texts>,
    /// What it lacks of its stream.
    losses: Listed,
    /// Keys and texts of the metadata.
    metadata: Vec<[CString; 2]>,
}

impl Mesh {
    /// As a pointer for C.
    fn hand_out(mesh: TriMesh, attributes: Attributes, losses: Losses) -> *mut Self {
        let texts = Texts::of(&attributes);
        let metadata = attributes::metadata_of(&attributes);
        let losses = Listed::new(losses);
        Box::into_raw(Box::new(Self { mesh, attributes, texts, losses, metadata }))
    }
}

/// A stream that owns its bytes.
pub struct Encoded {
    bytes: Vec<u8>,
    losses: Listed,
}

/// Decodes a stream as it arrives.
pub struct Decoder {
    decoder: lwc::Decoder,
    positions: Vec<[f64; 3]>,
    rewritten: Vec<[u32; 2]>,
}

/// A pass, and the mesh after it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pass {
    /// 0 base mesh, 1 split: vertices of one level, 2 refine: one more bit of precision.
    pub kind: u32,
    /// Level after the pass.
    pub level: u32,
    /// Bits per coordinate after the pass.
    pub quantization_bits: u32,
    /// Vertices after the pass.
    pub vertices: u32,
    /// Triangles after the pass.
    pub triangles: u32,
    /// Bytes of its chunk.
    pub bytes: u64,
    /// Bytes of the stream up to the end of the pass.
    pub end: u64,
}

/// What a pass changed. Indices of vertices and triangles never move.
#[repr(C)]
pub struct Changes {
    /// The pass.
    pub pass: Pass,
    /// Vertices from this one on are new or have moved.
    pub first_vertex: u32,
    /// Triangles from this one on are new.
    pub first_new_triangle: u32,
    /// Runs of older triangles with other vertices, each a first and an end; valid until the next call.
    pub rewritten: *const [u32; 2],
    /// Number of those runs.
    pub num_rewritten: usize,
}

/// The object behind a pointer from C.
///
/// # Safety
/// `pointer` is null, or was handed out for a `T`, has not been freed, and nobody else uses it now.
unsafe fn object<'a, T>(pointer: *mut T) -> Result<&'a mut T, Status> {
    // SAFETY: by the contract above; null becomes an error.
    unsafe { pointer.as_mut() }.ok_or(Status::NullPointer)
}

/// As many elements as C says there are. What no array can be, such as one of −1 elements, is refused.
///
/// # Safety
/// `pointer` has `length` elements that live as long as the caller's function; it may be null if there are
/// none.
unsafe fn elements<'a, T>(pointer: *const T, length: usize) -> Result<&'a [T], Status> {
    if length == 0 {
        return Ok(&[]);
    }
    check_array(pointer, length)?;
    // SAFETY: by the contract above, and not null, aligned and of a size that there is.
    Ok(unsafe { slice::from_raw_parts(pointer, length) })
}

/// Whether there can be an array of `length` elements at `pointer`.
fn check_array<T>(pointer: *const T, length: usize) -> Result<(), Status> {
    if pointer.is_null() {
        return Err(Status::NullPointer);
    }
    let (size, alignment) = (size_of::<T>(), align_of::<T>());
    let bad = |sentence: String| Err(error::tell(Status::Array, &sentence));
    if length.checked_mul(size).is_none_or(|bytes| bytes > isize::MAX as usize) {
        return bad(format!("an array of {length} elements of {size} bytes is larger than memory"));
    }
    if !pointer.is_aligned() {
        return bad(format!("an array is at {pointer:p}, which is not a multiple of {alignment}"));
    }
    Ok(())
}

/// Where a result goes.
///
/// # Safety
/// `pointer` is null or can be written to.
unsafe fn put<T>(pointer: *mut T, value: T) -> Result<(), Status> {
    check_array(pointer, 1)?;
    // SAFETY: by the contract above, and neither null nor out of line.
    unsafe { pointer.write(value) };
    Ok(())
}

/// Frees what `Box::into_raw` handed out.
///
/// # Safety
/// `pointer` is null, or was handed out for a `T` and has not been freed.
unsafe fn free<T>(pointer: *mut T) {
    if !pointer.is_null() {
        // SAFETY: by the contract above, and not null.
        drop(unsafe { Box::from_raw(pointer) });
    }
}

/// Makes a mesh of a copy of `positions` (num_vertices × 3, model units) and `triangles` (num_triangles × 3,
/// counter-clockwise).
///
/// # Safety
/// The arrays have that many elements; `mesh` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_mesh_new(
    positions: *const f64,
    num_vertices: usize,
    triangles: *const u32,
    num_triangles: usize,
    mesh: *mut *mut Mesh,
) -> Status {
    guard(|| {
        // SAFETY: the caller's promise; an array of three has the layout of three elements.
        let positions = unsafe { elements::<[f64; 3]>(positions.cast(), num_vertices) }?;
        // SAFETY: as above.
        let triangles = unsafe { elements::<[u32; 3]>(triangles.cast(), num_triangles) }?;
        let made = TriMesh::new(positions.to_vec(), triangles.to_vec()).map_err(error::mesh)?;
        // SAFETY: the caller's promise.
        unsafe { put(mesh, Mesh::hand_out(made, Attributes::default(), Losses::default())) }
    })
}

/// Frees a mesh; null is allowed.
///
/// # Safety
/// `mesh` was handed out by this library and is not used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_mesh_free(mesh: *mut Mesh) {
    // SAFETY: the caller's promise.
    unsafe { free(mesh) }
}

/// Number of vertices; 0 for null.
///
/// # Safety
/// `mesh` was handed out by this library and has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_mesh_num_vertices(mesh: *const Mesh) -> usize {
    // SAFETY: the caller's promise.
    unsafe { mesh.as_ref() }.map_or(0, |mesh| mesh.mesh.num_vertices())
}

/// Number of triangles; 0 for null.
///
/// # Safety
/// `mesh` was handed out by this library and has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_mesh_num_triangles(mesh: *const Mesh) -> usize {
    // SAFETY: the caller's promise.
    unsafe { mesh.as_ref() }.map_or(0, |mesh| mesh.mesh.num_triangles())
}

/// Positions, vertices × 3, valid until the mesh is freed; null for null.
///
/// # Safety
/// `mesh` was handed out by this library and has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_mesh_positions(mesh: *const Mesh) -> *const f64 {
    // SAFETY: the caller's promise.
    unsafe { mesh.as_ref() }.map_or(std::ptr::null(), |mesh| mesh.mesh.positions().as_ptr().cast())
}

/// Vertex indices of the triangles, triangles × 3, valid until the mesh is freed; null for null.
///
/// # Safety
/// `mesh` was handed out by this library and has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_mesh_triangles(mesh: *const Mesh) -> *const u32 {
    // SAFETY: the caller's promise.
    unsafe { mesh.as_ref() }.map_or(std::ptr::null(), |mesh| mesh.mesh.triangles().as_ptr().cast())
}

/// Encodes a mesh with its attributes. `options` may be null for the defaults.
///
/// # Safety
/// `mesh` was handed out by this library and has not been freed; `options` is null or can be read; `encoded`
/// can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_encode(
    mesh: *const Mesh,
    options: *const EncodeOptions,
    encoded: *mut *mut Encoded,
) -> Status {
    guard(|| {
        // SAFETY: the caller's promise.
        let mesh = unsafe { mesh.as_ref() }.ok_or(Status::NullPointer)?;
        // SAFETY: the caller's promise.
        let options =
            unsafe { options.as_ref() }.map_or(Ok(lwc::EncodeOptions::default()), options::encode)?;
        let made = lwc::encode_with_attributes(&mesh.mesh, &mesh.attributes, &options, &|_| {});
        let made = made.map_err(error::encode)?;
        let made = Encoded { bytes: made.bytes, losses: Listed::new(made.losses) };
        // SAFETY: the caller's promise.
        unsafe { put(encoded, Box::into_raw(Box::new(made))) }
    })
}

/// Frees a stream; null is allowed.
///
/// # Safety
/// `encoded` was handed out by this library and is not used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_encoded_free(encoded: *mut Encoded) {
    // SAFETY: the caller's promise.
    unsafe { free(encoded) }
}

/// The bytes of a stream, valid until it is freed; null for null.
///
/// # Safety
/// `encoded` was handed out by this library and has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_encoded_bytes(encoded: *const Encoded) -> *const u8 {
    // SAFETY: the caller's promise.
    unsafe { encoded.as_ref() }.map_or(std::ptr::null(), |encoded| encoded.bytes.as_ptr())
}

/// Number of bytes; 0 for null.
///
/// # Safety
/// `encoded` was handed out by this library and has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_encoded_num_bytes(encoded: *const Encoded) -> usize {
    // SAFETY: the caller's promise.
    unsafe { encoded.as_ref() }.map_or(0, |encoded| encoded.bytes.len())
}

/// Decodes a stream, or the beginning of one, with its attributes in one call. `options` may be null for the defaults.
///
/// # Safety
/// `bytes` has `num_bytes` elements; `options` is null or can be read; `mesh` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_decode(
    bytes: *const u8,
    num_bytes: usize,
    options: *const DecodeOptions,
    mesh: *mut *mut Mesh,
) -> Status {
    guard(|| {
        // SAFETY: the caller's promise.
        let bytes = unsafe { elements(bytes, num_bytes) }?;
        // SAFETY: the caller's promise.
        let options = options::decode(unsafe { options.as_ref() });
        let mut decoder = lwc::Decoder::with_options(options);
        decoder.push(bytes).map_err(error::decode)?;
        let (found, attributes) =
            decoder.preview_with_attributes().ok_or_else(|| error::decode(lwc::DecodeError::NoMesh))?;
        // SAFETY: the caller's promise.
        unsafe { put(mesh, Mesh::hand_out(found, attributes, decoder.losses())) }
    })
}

/// Makes a decoder. `options` may be null for the defaults. Null if that fails: lwc_last_error says why. Where memory is
/// short the program ends, as in all functions here.
///
/// # Safety
/// `options` is null or can be read.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_decoder_new(options: *const DecodeOptions) -> *mut Decoder {
    let mut made = std::ptr::null_mut();
    guard(|| {
        // SAFETY: the caller's promise.
        let options = options::decode(unsafe { options.as_ref() });
        let decoder = lwc::Decoder::with_options(options);
        made = Box::into_raw(Box::new(Decoder { decoder, positions: Vec::new(), rewritten: Vec::new() }));
        Ok(())
    });
    made
}

/// Frees a decoder; null is allowed.
///
/// # Safety
/// `decoder` was handed out by this library and is not used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_decoder_free(decoder: *mut Decoder) {
    // SAFETY: the caller's promise.
    unsafe { free(decoder) }
}

/// Takes the next bytes of the stream, however they are cut; lwc_decoder_step decodes them.
///
/// # Safety
/// `decoder` was handed out by this library, has not been freed and is used by this thread alone; `bytes`
/// has `num_bytes` elements.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_decoder_feed(
    decoder: *mut Decoder,
    bytes: *const u8,
    num_bytes: usize,
) -> Status {
    guard(|| {
        // SAFETY: the caller's promise.
        let (decoder, bytes) = unsafe { (object(decoder)?, elements(bytes, num_bytes)?) };
        decoder.decoder.feed(bytes).map_err(error::decode)
    })
}

/// Applies the next pass if all its bytes are there: LWC_STATUS_OK and `changes`, or
/// LWC_STATUS_NOTHING_TO_DO. After an error the mesh of the last pass is still there. `changes` may be null.
///
/// # Safety
/// `decoder` was handed out by this library, has not been freed and is used by this thread alone; `changes`
/// is null or can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_decoder_step(decoder: *mut Decoder, changes: *mut Changes) -> Status {
    guard(|| {
        // SAFETY: the caller's promise.
        let decoder = unsafe { object(decoder) }?;
        let Some(update) = decoder.decoder.step().map_err(error::decode)? else {
            return Err(Status::NothingToDo);
        };
        let found = decoder.apply(&update);
        if changes.is_null() {
            return Ok(());
        }
        // SAFETY: the caller's promise.
        unsafe { put(changes, found) }
    })
}

impl Decoder {
    fn apply(&mut self, update: &lwc::Update) -> Changes {
        let vertices = update.vertices.start as usize..update.vertices.end as usize;
        if let Some(mesh) = self.decoder.mesh() {
            self.positions.resize(mesh.num_vertices(), [0.0; 3]);
            let mut placing = PositionUpdater::new(&mesh);
            placing.advance(&mesh, usize::MAX);
            for v in vertices {
                self.positions[v] = placing.position(&mesh, v);
            }
        }
        self.rewritten.clear();
        self.rewritten.extend(update.rewritten_triangles.iter().map(|range| [range.start, range.end]));
        Changes {
            pass: pass(&update.pass),
            first_vertex: update.vertices.start,
            first_new_triangle: update.new_triangles.start,
            rewritten: self.rewritten.as_ptr(),
            num_rewritten: self.rewritten.len(),
        }
    }
}

fn pass(pass: &lwc::PassInfo) -> Pass {
    let kind = match pass.kind {
        PassKind::Base => 0,
        PassKind::Split => 1,
        _ => 2,
    };
    let lwc::PassInfo { level, quantization_bits, vertices, triangles, bytes, end, .. } = *pass;
    Pass { kind, level, quantization_bits, vertices, triangles, bytes, end }
}

/// Vertices of the mesh at hand; 0 before the base mesh.
///
/// # Safety
/// `decoder` was handed out by this library and has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_decoder_num_vertices(decoder: *const Decoder) -> usize {
    // SAFETY: the caller's promise.
    unsafe { decoder.as_ref() }.map_or(0, |decoder| decoder.positions.len())
}

/// Triangles of the mesh at hand; 0 before the base mesh.
///
/// # Safety
/// `decoder` was handed out by this library and has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_decoder_num_triangles(decoder: *const Decoder) -> usize {
    // SAFETY: the caller's promise.
    let mesh = unsafe { decoder.as_ref() }.and_then(|decoder| decoder.decoder.mesh());
    mesh.map_or(0, |mesh| mesh.num_triangles())
}

/// Positions of the mesh at hand, vertices × 3, model units; valid until the next call with this decoder.
///
/// # Safety
/// `decoder` was handed out by this library and has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_decoder_positions(decoder: *const Decoder) -> *const f64 {
    // SAFETY: the caller's promise.
    unsafe { decoder.as_ref() }.map_or(std::ptr::null(), |decoder| decoder.positions.as_ptr().cast())
}

/// Vertex indices of the mesh at hand, triangles × 3; valid until the next call with this decoder.
///
/// # Safety
/// `decoder` was handed out by this library and has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_decoder_triangles(decoder: *const Decoder) -> *const u32 {
    // SAFETY: the caller's promise.
    let mesh = unsafe { decoder.as_ref() }.and_then(|decoder| decoder.decoder.mesh());
    mesh.map_or(std::ptr::null(), |mesh| mesh.triangles().as_ptr().cast())
}

/// Checksum of the mesh at hand: equal on every platform (`format/SPEC.md`, section 9); 0 without a mesh.
///
/// # Safety
/// `decoder` was handed out by this library and has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_decoder_checksum(decoder: *const Decoder) -> u32 {
    // SAFETY: the caller's promise.
    let mesh = unsafe { decoder.as_ref() }.and_then(|decoder| decoder.decoder.mesh());
    mesh.map_or(0, |mesh| mesh.checksum())
}

/// A copy of the mesh at hand as it was encoded: vertices stitched where the surface was cut; after the last pass also
/// isolated vertices, degenerate faces, exact positions and the order of the file, if the stream has them; with the
/// attributes. It is to be freed by lwc_mesh_free. LWC_STATUS_NO_MESH before the base mesh.
///
/// # Safety
/// `decoder` was handed out by this library and has not been freed; `mesh` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_decoder_mesh(decoder: *const Decoder, mesh: *mut *mut Mesh) -> Status {
    guard(|| {
        // SAFETY: the caller's promise.
        let decoder = unsafe { decoder.as_ref() }.ok_or(Status::NullPointer)?;
        let found = decoder.decoder.to_tri_mesh_with_attributes();
        let (found, attributes) = found.ok_or_else(|| error::decode(lwc::DecodeError::NoMesh))?;
        // SAFETY: the caller's promise.
        unsafe { put(mesh, Mesh::hand_out(found, attributes, decoder.decoder.losses())) }
    })
}

/// Checksum of the values of all attributes so far (`format/SPEC.md`, section 9); 0 without any.
///
/// # Safety
/// `decoder` was handed out by this library and has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_decoder_attribute_checksum(decoder: *const Decoder) -> u32 {
    // SAFETY: the caller's promise.
    unsafe { decoder.as_ref() }.map_or(0, |decoder| decoder.decoder.attribute_checksum())
}

/// Number of passes of the stream; 0 before its table of passes has arrived.
///
/// # Safety
/// `decoder` was handed out by this library and has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_decoder_num_passes(decoder: *const Decoder) -> usize {
    // SAFETY: the caller's promise.
    let info = unsafe { decoder.as_ref() }.and_then(|decoder| decoder.decoder.info());
    info.map_or(0, |info| info.passes().len())
}

/// What the stream says of one of its passes.
///
/// # Safety
/// `decoder` was handed out by this library and has not been freed; `found` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_decoder_pass(decoder: *const Decoder, index: usize, found: *mut Pass) -> Status {
    guard(|| {
        // SAFETY: the caller's promise.
        let decoder = unsafe { decoder.as_ref() }.ok_or(Status::NullPointer)?;
        let info = decoder.decoder.info().and_then(|info| info.passes().get(index));
        // SAFETY: the caller's promise.
        unsafe { put(found, pass(info.ok_or(Status::NothingToDo)?)) }
    })
}

/// True once the last pass of the stream, or of the wanted level, has been applied.
///
/// # Safety
/// `decoder` was handed out by this library and has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_decoder_is_complete(decoder: *const Decoder) -> bool {
    // SAFETY: the caller's promise.
    unsafe { decoder.as_ref() }.is_some_and(|decoder| decoder.decoder.is_complete())
}
