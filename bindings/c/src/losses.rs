//! What is lost on the way from a mesh to a stream, or from a stream to a mesh.

use crate::error::{Status, guard, tell};
use crate::{Encoded, Mesh, put};
use lwc::losses::{Loss as Lost, LossKind as LostKind, Losses, Stage};
use std::ffi::{CString, c_char};

/// Where something is lost.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)] // Each is what its name says.
pub enum LossStage {
    Reading = 0,
    Encoding = 1,
    Decoding = 2,
    Writing = 3,
}

/// What happens to what is lost.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LossKind {
    /// Left out: the subject says what.
    Dropped = 0,
    /// Positions are rounded: a distance in model units.
    PositionsRounded = 1,
    /// Triangles have no area any more.
    TrianglesCollapsed = 2,
    /// Triangles face the other way.
    TrianglesTurned = 3,
    /// Values of an attribute are rounded; of directions the error is an angle in radians.
    ValuesRounded = 4,
    /// Integers that name things differ.
    IdentifiersChanged = 5,
    /// Values are of another range or colour space.
    ValuesConverted = 6,
    /// Elements that had no value have one.
    ValuesFilled = 7,
    /// Names are written otherwise.
    NamesChanged = 8,
    /// Polygons are cut into triangles.
    PolygonsTriangulated = 9,
    /// Vertices at one place with equal values are one.
    VerticesJoined = 10,
    /// Vertices are repeated.
    VerticesSplit = 11,
    /// Vertices and triangles come in another order.
    Reordered = 12,
    /// The mesh is coarser than the finest one.
    Coarser = 13,
    /// Something that this header does not know; the message says what.
    Other = 14,
}

/// One thing that is lost.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Loss {
    /// An LwcLossStage.
    pub stage: u32,
    /// An LwcLossKind.
    pub kind: u32,
    /// Elements concerned; -1 if they were not counted.
    pub count: i64,
    /// Of how many; -1 if that is not known.
    pub total: i64,
    /// The largest error; NaN if there is none.
    pub largest_error: f64,
    /// Of positions: the largest error of a vertex divided by the mean length of its edges; else NaN.
    pub largest_error_in_edges: f64,
    /// What, UTF-8: the name of an attribute, or a few words; may be empty. Valid as long as its mesh or stream.
    pub subject: *const c_char,
    /// A sentence, UTF-8. Valid as long as its mesh or stream.
    pub message: *const c_char,
}

/// Losses with their texts as C wants them.
pub struct Listed {
    losses: Losses,
    texts: Vec<[CString; 2]>,
}

impl Listed {
    pub fn new(losses: Losses) -> Self {
        let text = |text: &str| CString::new(text.replace('\0', " ")).unwrap_or_default();
        let texts = losses.iter().map(|loss| [text(&loss.subject), text(&loss.to_string())]).collect();
        Self { losses, texts }
    }

    fn len(&self) -> usize {
        self.texts.len()
    }

    fn get(&self, index: usize) -> Option<Loss> {
        let (loss, [subject, message]) = (self.losses.iter().nth(index)?, self.texts.get(index)?);
        let number = |count: Option<u64>| count.and_then(|count| i64::try_from(count).ok()).unwrap_or(-1);
        Some(Loss {
            stage: stage(loss) as u32,
            kind: kind(loss) as u32,
            count: number(loss.count),
            total: number(loss.total),
            largest_error: loss.largest_error.unwrap_or(f64::NAN),
            largest_error_in_edges: loss.largest_error_in_edges.unwrap_or(f64::NAN),
            subject: subject.as_ptr(),
            message: message.as_ptr(),
        })
    }
}

fn stage(loss: &Lost) -> LossStage {
    match loss.stage {
        Stage::Reading => LossStage::Reading,
        Stage::Encoding => LossStage::Encoding,
        Stage::Decoding => LossStage::Decoding,
        Stage::Writing => LossStage::Writing,
    }
}

fn kind(loss: &Lost) -> LossKind {
    match loss.kind {
        LostKind::Dropped => LossKind::Dropped,
        LostKind::PositionsRounded => LossKind::PositionsRounded,
        LostKind::TrianglesCollapsed => LossKind::TrianglesCollapsed,
        LostKind::TrianglesTurned => LossKind::TrianglesTurned,
        LostKind::ValuesRounded => LossKind::ValuesRounded,
        LostKind::IdentifiersChanged => LossKind::IdentifiersChanged,
        LostKind::ValuesConverted => LossKind::ValuesConverted,
        LostKind::ValuesFilled => LossKind::ValuesFilled,
        LostKind::NamesChanged => LossKind::NamesChanged,
        LostKind::PolygonsTriangulated => LossKind::PolygonsTriangulated,
        LostKind::VerticesJoined => LossKind::VerticesJoined,
        LostKind::VerticesSplit => LossKind::VerticesSplit,
        LostKind::Reordered => LossKind::Reordered,
        LostKind::Coarser => LossKind::Coarser,
        _ => LossKind::Other,
    }
}

/// Puts loss `index` where the caller wants it.
///
/// # Safety
/// `loss` is null or can be written to.
unsafe fn put_one(losses: Option<&Listed>, index: usize, loss: *mut Loss) -> Status {
    guard(|| {
        let losses = losses.ok_or(Status::NullPointer)?;
        let missing = || tell(Status::Option, &format!("there is no loss {index} of {}", losses.len()));
        // SAFETY: by the contract above.
        unsafe { put(loss, losses.get(index).ok_or_else(missing)?) }
    })
}

/// Number of things that a stream does not give back of its mesh; 0 for null.
///
/// # Safety
/// `encoded` was handed out by this library and has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_encoded_num_losses(encoded: *const Encoded) -> usize {
    // SAFETY: the caller's promise.
    unsafe { encoded.as_ref() }.map_or(0, |encoded| encoded.losses.len())
}

/// Loss `index` of a stream, counted from 0.
///
/// # Safety
/// `encoded` was handed out by this library and has not been freed; `loss` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_encoded_loss(encoded: *const Encoded, index: usize, loss: *mut Loss) -> Status {
    // SAFETY: the caller's promise.
    unsafe { put_one(encoded.as_ref().map(|encoded| &encoded.losses), index, loss) }
}

/// Number of things that a decoded mesh lacks of its stream; 0 for null, and for a mesh that was not decoded.
///
/// # Safety
/// `mesh` was handed out by this library and has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_mesh_num_losses(mesh: *const Mesh) -> usize {
    // SAFETY: the caller's promise.
    unsafe { mesh.as_ref() }.map_or(0, |mesh| mesh.losses.len())
}

/// Loss `index` of a decoded mesh, counted from 0.
///
/// # Safety
/// `mesh` was handed out by this library and has not been freed; `loss` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_mesh_loss(mesh: *const Mesh, index: usize, loss: *mut Loss) -> Status {
    // SAFETY: the caller's promise.
    unsafe { put_one(mesh.as_ref().map(|mesh| &mesh.losses), index, loss) }
}
