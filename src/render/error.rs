//! What goes wrong with pictures.

use thiserror::Error;

/// Why there is no picture.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RenderError {
    /// The picture would have no pixels, or too many.
    #[error("a picture of {width} by {height} pixels: each side must be 1 to 16384")]
    Size {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// There must be one value per vertex, or corner.
    #[error("the number of values is not that of the vertices or corners")]
    Values,
    /// A chart cannot be drawn.
    #[error("the chart cannot be drawn: {0}")]
    Chart(String),
}
