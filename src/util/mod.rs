//! What every room may use: numbers in bytes, counted memory, lanes, threads. Knows neither meshes nor
//! streams.

pub(crate) mod budget;
pub(crate) mod bytes;
#[cfg(any(feature = "metrics", feature = "render"))]
pub(crate) mod count;
#[cfg(feature = "encoder")]
pub(crate) mod morton;
pub(crate) mod parallel;
pub(crate) mod simd4;
