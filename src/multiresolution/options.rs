//! What the caller may choose.

use crate::descriptors::{Descriptor, Window};
use crate::simplification::partition::Partition;

/// How the position of an odd vertex is guessed from its ring.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Prediction {
    /// A weighted mean of the ring.
    Flat,
    /// The same, bent towards the tangent planes at the ring.
    #[default]
    Curved,
}

/// How a mesh is decomposed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Options {
    /// What ranks the vertices. Default harris3d.
    pub descriptor: Descriptor,
    /// Its window on the finest level, the radius in mean edges. Default 4 rings, radius 3.
    pub window: Window,
    /// Factor of the radius from each level to the next coarser one. Default 1.5.
    pub growth: f64,
    /// Levels above the base mesh; `None`, the default, goes on until it is small.
    pub levels: Option<u32>,
    /// How odd vertices are chosen. Default Algorithm 1.
    pub partition: Partition,
    /// Default curved.
    pub prediction: Prediction,
    /// Whether even vertices are updated. Default no.
    pub update: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            descriptor: Descriptor::default(),
            window: Window::default(),
            growth: 1.5,
            levels: None,
            partition: Partition::Algorithm1,
            prediction: Prediction::default(),
            update: false,
        }
    }
}
