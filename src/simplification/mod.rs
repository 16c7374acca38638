//! From M^L down: which vertices of a level are removed, how their holes are closed, and the record from
//! which an encoder restores them. [`hierarchy`] goes from level to level, [`partition`] removes the odd
//! vertices of one.
//!
//! Three kinds of indices are `u32` here. A *vertex* is an index into the surface, which it keeps through all levels. A
//! *place* is an index into [`level::Level::vertices`]. A *slot* is an index into the triangles of the surface, some of
//! which are free.

pub(crate) mod bucket_queue;
pub(crate) mod canonical;
pub(crate) mod collapse;
pub(crate) mod collapse_cost;
mod deviation;
pub(crate) mod geometry;
pub(crate) mod hierarchy;
mod hubs;
pub(crate) mod level;
pub(crate) mod partition;
pub(crate) mod quadrics;
pub(crate) mod record;
pub(crate) mod retriangulate;
pub(crate) mod rings;
pub(crate) mod seams;
pub(crate) mod surface_editor;
pub(crate) mod triangulate;
pub(crate) mod vertex_selection;

pub(crate) use record::LevelRecord;
pub(crate) use rings::Rings;
pub(crate) use seams::Seams;
pub(crate) use surface_editor::{Star, SurfaceEditor};
