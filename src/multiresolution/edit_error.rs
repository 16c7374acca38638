//! What goes wrong with a changed mesh.

use crate::error::DecodeError;
use thiserror::Error;

/// Why a changed mesh cannot get its details back.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum EditError {
    /// The stream does not decode.
    #[error(transparent)]
    Stream(#[from] DecodeError),
    /// The details at the end of the stream are missing.
    #[error("the stream is incomplete, so some of the details are missing")]
    Incomplete,
    /// No level has as many vertices.
    #[error("the changed mesh has {found} vertices, but the levels of the stream have {}", list(.levels))]
    Vertices {
        /// Vertices of the changed mesh.
        found: usize,
        /// Vertices of each level, coarsest first.
        levels: Vec<usize>,
    },
    /// The faces are not those of the level.
    #[error(
        "{differing} of the {expected} faces of level {level} are not in the changed mesh, which has {found}"
    )]
    Faces {
        /// The level with as many vertices.
        level: usize,
        /// Its faces.
        expected: usize,
        /// Faces of the changed mesh.
        found: usize,
        /// Faces of the level that the changed mesh lacks.
        differing: usize,
    },
}

fn list(counts: &[usize]) -> String {
    counts.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")
}
