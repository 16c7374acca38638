//! Losses: `lwc.Loss` of Python from those of the library.

use crate::attributes::class;
use lwc::losses::{Loss, Losses};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyList};

/// A list of `lwc.Loss`.
pub fn list<'py>(py: Python<'py>, losses: &Losses) -> PyResult<Bound<'py, PyList>> {
    let all: PyResult<Vec<_>> = losses.iter().map(|loss| one(py, loss)).collect();
    PyList::new(py, all?)
}

fn one<'py>(py: Python<'py>, loss: &Loss) -> PyResult<Bound<'py, PyAny>> {
    class(py, "Loss")?.call1((
        loss.stage.name(),
        loss.kind.name(),
        loss.subject.as_str(),
        loss.count,
        loss.total,
        loss.largest_error,
        loss.largest_error_in_edges,
        loss.remedy.as_str(),
        loss.to_string(),
    ))
}

/// A `lwc.Stream`: bytes that know what they lack.
pub fn stream<'py>(py: Python<'py>, bytes: &[u8], losses: &Losses) -> PyResult<Bound<'py, PyAny>> {
    class(py, "Stream")?.call1((PyBytes::new(py, bytes), list(py, losses)?))
}
