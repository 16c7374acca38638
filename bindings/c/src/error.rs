//! Statuses, and the message of the last one.

use lwc::{DecodeError, EncodeError, MeshError};
use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// How a call ended. The names are those of the errors of the Rust library.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// It did what was asked.
    Ok = 0,
    /// No pass is complete, or there are no more.
    NothingToDo = 1,
    /// The bytes do not begin a stream.
    NotAStream = 2,
    /// The stream needs a newer decoder.
    Unsupported = 3,
    /// The stream is damaged.
    Checksum = 4,
    /// The bytes follow no syntax that an encoder writes.
    Malformed = 5,
    /// The mesh is larger than the limits allow.
    Limit = 6,
    /// The decoder has failed before.
    Failed = 7,
    /// The stream ends before its base mesh is complete.
    NoMesh = 8,
    /// The mesh has no usable triangle.
    NoTriangles = 9,
    /// An option is out of range, or has no such name.
    Option = 10,
    /// The mesh is too large for the format.
    TooLarge = 11,
    /// The bounding box overflows double precision.
    BoundingBox = 12,
    /// A triangle names a vertex that does not exist.
    IndexOutOfRange = 13,
    /// A coordinate is NaN or infinite.
    NotFinite = 14,
    /// A pointer that must not be null is.
    NullPointer = 15,
    /// A mistake in the library.
    Internal = 16,
    /// An attribute does not fit its mesh, or a buffer its attribute.
    Attribute = 17,
    /// An array cannot be one: its address is not a multiple of its type's alignment, or it has more bytes than memory
    /// can.
    Array = 18,
    /// The calling thread rounds floating-point numbers another way than to nearest, or takes subnormal ones for zero:
    /// its mode must be the default one. Game engines, audio libraries and code built with fast arithmetic change it.
    FloatingPoint = 19,
}

thread_local! {
    static LAST: RefCell<CString> = RefCell::new(c"no error".to_owned());
}

/// Says more about the last call of this thread that failed; valid until the next one that does.
#[unsafe(no_mangle)]
pub extern "C" fn lwc_last_error() -> *const c_char {
    LAST.with_borrow(|last| last.as_ptr())
}

pub fn tell(status: Status, sentence: &str) -> Status {
    let text = CString::new(sentence).unwrap_or_else(|_| CStr::to_owned(c"unprintable"));
    LAST.with_borrow_mut(|last| *last = text);
    status
}

/// Runs the body of a function of the interface.
pub fn guard(body: impl FnOnce() -> Result<(), Status>) -> Status {
    // Whoever reuses an object after a panic finds what the panic left; memory stays sound, it is safe Rust.
    match catch_unwind(AssertUnwindSafe(body)) {
        Ok(Ok(())) => Status::Ok,
        Ok(Err(Status::NullPointer)) => tell(Status::NullPointer, "a pointer is null"),
        Ok(Err(status)) => status,
        Err(_) => tell(Status::Internal, "a mistake in the library"),
    }
}

pub fn decode(error: DecodeError) -> Status {
    let status = match error {
        DecodeError::NotAStream => Status::NotAStream,
        DecodeError::Unsupported(_) => Status::Unsupported,
        DecodeError::Checksum { .. } => Status::Checksum,
        DecodeError::Malformed { .. } => Status::Malformed,
        DecodeError::Limit { .. } => Status::Limit,
        DecodeError::FloatingPoint(_) => Status::FloatingPoint,
        DecodeError::Failed => Status::Failed,
        DecodeError::NoMesh => Status::NoMesh,
        _ => Status::Internal,
    };
    tell(status, &error.to_string())
}

pub fn encode(error: EncodeError) -> Status {
    let status = match error {
        EncodeError::NoTriangles => Status::NoTriangles,
        EncodeError::Option { .. } | EncodeError::StepTooSmall { .. } => Status::Option,
        EncodeError::TooLarge(_) => Status::TooLarge,
        EncodeError::BoundingBox => Status::BoundingBox,
        EncodeError::Attribute { .. } => Status::Attribute,
        EncodeError::FloatingPoint(_) => Status::FloatingPoint,
        _ => Status::Internal,
    };
    tell(status, &error.to_string())
}

pub fn mesh(error: MeshError) -> Status {
    let status = match error {
        MeshError::IndexOutOfRange { .. } => Status::IndexOutOfRange,
        MeshError::NotFinite { .. } => Status::NotFinite,
        MeshError::TooLarge { .. } => Status::TooLarge,
        _ => Status::Internal,
    };
    tell(status, &error.to_string())
}
