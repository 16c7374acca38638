//! Attributes: what a stream declares, and the values that follow each pass (`format/SPEC.md`, sections 4.5,
//! 7.11 and 8.4).
//!
//! A [`Layer`] holds the rows of one attribute and which of them every vertex, corner or face of the present mesh
//! has. The corners at a vertex that share a row are a *wedge*; where the row changes, a seam runs.
//!
//! [`layer`] goes from element to element. [`wedges`] finds what a star inherits ([`inheritance`]) and where seams run
//! ([`seams`]), [`faces`] does so for faces. [`row_coder`] codes each row from the rows [`around`] it, a new one channel by
//! channel ([`forecast`]).

mod around;
pub(crate) mod declaration;
mod faces;
mod forecast;
mod inheritance;
mod layer;
pub(crate) mod octahedron;
mod row_coder;
mod rows;
mod seams;
mod star;
mod truth;
mod wedges;

pub(crate) use declaration::{Coding, Declaration, Declarations};
pub(crate) use layer::{Brought, Desk, Layer};
pub(crate) use rows::Rows;
#[cfg(feature = "encoder")]
pub(crate) use truth::Truth;
