//! Exceptions with the names of the errors of the Rust library.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

pyo3::create_exception!(lwc, DecodeError, PyValueError, "Why a stream does not decode.");
pyo3::create_exception!(lwc, EncodeError, PyValueError, "Why a mesh cannot be encoded.");

/// Hangs the name of the error on the exception.
fn with_kind(py: Python<'_>, error: PyErr, kind: &str) -> PyErr {
    match error.value(py).setattr("kind", kind) {
        Ok(()) => error,
        Err(other) => other,
    }
}

pub fn decode_error(py: Python<'_>, error: lwc::DecodeError) -> PyErr {
    use lwc::DecodeError as E;
    let kind = match error {
        E::NotAStream => "NotAStream",
        E::Unsupported(_) => "Unsupported",
        E::Checksum { .. } => "Checksum",
        E::Malformed { .. } => "Malformed",
        E::Limit { .. } => "Limit",
        E::FloatingPoint(_) => "FloatingPoint",
        E::Failed => "Failed",
        E::NoMesh => "NoMesh",
        _ => "Other",
    };
    with_kind(py, DecodeError::new_err(error.to_string()), kind)
}

pub fn encode_error(py: Python<'_>, error: lwc::EncodeError) -> PyErr {
    use lwc::EncodeError as E;
    let kind = match error {
        E::NoTriangles => "NoTriangles",
        E::Option { .. } => "Option",
        E::StepTooSmall { .. } => "StepTooSmall",
        E::TooLarge(_) => "TooLarge",
        E::BoundingBox => "BoundingBox",
        E::Attribute { .. } => "Attribute",
        E::FloatingPoint(_) => "FloatingPoint",
        _ => "Other",
    };
    with_kind(py, EncodeError::new_err(error.to_string()), kind)
}

/// What would be lost though nothing may be.
pub fn loss_error(py: Python<'_>, losses: &lwc::losses::Losses) -> PyErr {
    with_kind(py, EncodeError::new_err(format!("something would be lost: {losses}")), "Lossy")
}

pub fn mesh_error(py: Python<'_>, error: lwc::MeshError) -> PyErr {
    use lwc::MeshError as E;
    let kind = match error {
        E::IndexOutOfRange { .. } => "IndexOutOfRange",
        E::NotFinite { .. } => "NotFinite",
        E::TooLarge { .. } => "TooLarge",
        _ => "Other",
    };
    with_kind(py, EncodeError::new_err(error.to_string()), kind)
}

pub fn scene_error(py: Python<'_>, error: lwc::io::ReadError) -> PyErr {
    with_kind(py, DecodeError::new_err(error.to_string()), "Limit")
}

pub fn option_error(py: Python<'_>, option: &str, name: &str) -> PyErr {
    with_kind(py, EncodeError::new_err(format!("there is no {option} {name}")), "Option")
}
