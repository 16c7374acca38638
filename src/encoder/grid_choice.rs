//! Which grid the caller asks for.

use crate::bitstream::grid::Lattice;
use crate::error::EncodeError;

/// Where the vertices of a stream may lie.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum GridChoice {
    /// The cube around the mesh, in 2^[`quantization_bits`](crate::EncodeOptions::quantization_bits) − 1 steps along each axis. If
    /// more than 1 % of the triangles collapse or turn over in it, and at most 1 % where each axis divides its own extent into
    /// as many steps, then that. With [`lossless`](crate::EncodeOptions::lossless) always the cube.
    #[default]
    Auto,
    /// The cube, whatever collapses.
    Cube,
    /// Points of this lattice. The bits follow from the extent of the mesh; those of the options are not looked at.
    /// Streams on one lattice share the borders of their meshes bit for bit.
    Lattice(Lattice),
}

impl GridChoice {
    /// Multiples of these steps, model units, above 0: the lattice through the origin of the coordinates.
    pub fn step(step: [f64; 3]) -> Self {
        Self::Lattice(Lattice { origin: [0.0; 3], step })
    }

    pub(super) fn check(self) -> Result<(), EncodeError> {
        match self {
            Self::Lattice(lattice) if !lattice.is_sound() => Err(EncodeError::Option {
                option: "grid",
                value: format!("at {:?} in steps of {:?}", lattice.origin, lattice.step),
                allowed: "at finite numbers, in finite steps above 0",
            }),
            _ => Ok(()),
        }
    }
}
