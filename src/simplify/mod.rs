//! Removal of odd vertices from a surface, and the record from which an encoder brings them back.

pub(crate) mod canonical;
pub(crate) mod collapse;
mod deviation;
pub(crate) mod geometry;
pub(crate) mod hole;
mod hubs;
pub(crate) mod memory;
pub(crate) mod outlook;
pub(crate) mod packing;
pub(crate) mod record;
pub(crate) mod rings;
pub(crate) mod seams;
pub(crate) mod shrinking;
pub(crate) mod triangulate;

pub(crate) use record::LevelRecord;
pub(crate) use rings::Rings;
pub(crate) use seams::Seams;
pub(crate) use shrinking::{ShrinkingSurface, Star};
