//! Symbols in static tables (`format/SPEC.md`, section 6.7): asymmetric numeral systems over few tables, which a tree
//! of contexts chooses among. Encoders fit tree and tables to a payload and send them in front of it.

pub(crate) mod coder;
#[cfg(any(feature = "encoder", test))]
mod fit;
mod frequencies;
pub(crate) mod models;
mod raw;
pub(crate) mod reader;
mod states;
pub(crate) mod token;
mod tree;
#[cfg(any(feature = "encoder", test))]
pub(crate) mod writer;
