//! What can go wrong, sorted by who can do something about it.

use thiserror::Error;

/// Why a stream does not decode.
///
/// A stream that ends early is not an error: it is a coarser mesh.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum DecodeError {
    /// The bytes do not begin an `lwc` stream.
    #[error("not an lwc stream: it does not begin with the signature \"LWC\"")]
    NotAStream,
    /// The stream needs a newer decoder.
    #[error("unsupported stream: {0}")]
    Unsupported(String),
    /// The bytes of a chunk are not those that were written.
    #[error("damaged stream: chunk '{kind}' at byte {offset} fails its checksum")]
    Checksum {
        /// Kind of the chunk.
        kind: char,
        /// Where it begins.
        offset: u64,
    },
    /// The bytes follow no syntax that an encoder writes.
    #[error("malformed stream: {what} (chunk at byte {offset})")]
    Malformed {
        /// What is wrong.
        what: &'static str,
        /// Where the chunk begins.
        offset: u64,
    },
    /// The mesh is larger than the caller allows.
    #[error("limit of {what} exceeded: {needed} needed, {allowed} allowed")]
    Limit {
        /// Which limit.
        what: &'static str,
        /// What the stream asks for.
        needed: u64,
        /// What [`Limits`](crate::Limits) allow.
        allowed: u64,
    },
    /// The thread computes in another way than the format asks for: the stream may be sound. Holds what is done
    /// otherwise.
    #[error("this thread's floating-point environment is not the default: {0}")]
    FloatingPoint(&'static str),
    /// The decoder has failed before and takes no more bytes.
    #[error("the decoder has failed already")]
    Failed,
    /// There were not even enough bytes for the base mesh.
    #[error("the stream ends before its base mesh is complete")]
    NoMesh,
}

/// Why a mesh cannot be encoded.
#[cfg(feature = "encoder")]
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum EncodeError {
    /// There is nothing to encode.
    #[error("the mesh has no usable triangle")]
    NoTriangles,
    /// An option is out of range.
    #[error("{option} is {value}, but must be {allowed}")]
    Option {
        /// Name of the option.
        option: &'static str,
        /// What was given.
        value: String,
        /// What is allowed.
        allowed: &'static str,
    },
    /// The grid is too fine for the extent of the mesh, or for its distance from the grid's origin.
    #[error(
        "a step of {step} along {axis} is too small for this mesh: 30 bits allow {smallest:.2e} at least"
    )]
    StepTooSmall {
        /// `x`, `y` or `z`.
        axis: char,
        /// What was asked for, model units.
        step: f64,
        /// The smallest step that does, model units.
        smallest: f64,
    },
    /// The mesh is too large for the format.
    #[error("the mesh has {0} vertices or faces, more than the format can hold")]
    TooLarge(usize),
    /// An attribute does not fit the mesh or the format.
    #[error("attribute {name}: {what}")]
    Attribute {
        /// Its name.
        name: String,
        /// What is wrong with it.
        what: String,
    },
    /// The descriptor cannot see the attributes.
    #[error("{0}")]
    DescriptorAttributes(String),
    /// The thread computes in another way than the format asks for, so a decoder elsewhere would not follow. Holds what is
    /// done otherwise.
    #[error("this thread's floating-point environment is not the default: {0}")]
    FloatingPoint(&'static str),
    /// The coordinates span more than double precision can hold.
    #[error("the bounding box of the mesh overflows double precision")]
    BoundingBox,
}
