//! Attributes: what a stream declares, and the values that follow each pass (`format/SPEC.md`, sections 4.5,
//! 7.11 and 8.4).
//!
//! A [`Layer`] holds the entries of one attribute and which of them every vertex, corner or face of the present mesh
//! has. The corners at a vertex that share an entry are a *wedge*; where the entry changes, a seam runs.
//!
//! [`layer`] goes from element to element. [`wedges`] finds what a star inherits ([`inheritance`]) and where seams run
//! ([`seams`]), [`faces`] does so for faces. [`entry_coder`] codes each entry from the entries [`around`] it, a new one channel by
//! channel ([`forecast`]).

mod around;
pub(crate) mod declaration;
mod entries;
mod entry_coder;
mod faces;
mod forecast;
mod inheritance;
mod layer;
pub(crate) mod octahedron;
mod seams;
mod star;
mod truth;
mod wedges;

pub(crate) use declaration::{Coding, Declaration, Declarations};
pub(crate) use entries::Entries;
pub(crate) use layer::{Brought, Desk, Layer};
#[cfg(feature = "encoder")]
pub(crate) use truth::Truth;
