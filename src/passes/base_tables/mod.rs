//! A base mesh in tables (`format/SPEC.md`, section 7.13): the same triangles in the same order as in
//! [`base`](super::base), and positions predicted with weights that the encoder fits and sends.

mod arithmetic;
#[cfg(any(feature = "encoder", test))]
mod fit;
mod front;
mod growth;
mod head;
pub(crate) mod method;
mod order;
pub(crate) mod pass;
mod placing;
mod prediction;
mod surroundings;
mod symbols;
#[cfg(any(feature = "encoder", test))]
mod truth;
mod weights;
#[cfg(any(feature = "encoder", test))]
pub(crate) mod write;
