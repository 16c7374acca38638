//! Corners at exactly the same place become one vertex.

use crate::io::{Place, ReadError, builder::MeshBuilder};
use std::collections::{HashMap, hash_map::Entry};

/// Joins corners at the same place.
#[derive(Default)]
pub(super) struct Welder {
    pub builder: MeshBuilder,
    vertex_at: HashMap<[u64; 3], u32>,
}

impl Welder {
    /// The vertex at a place.
    ///
    /// # Errors
    /// If it is no place, or there are too many vertices.
    pub fn vertex(&mut self, position: [f64; 3], place: Place) -> Result<u32, ReadError> {
        if !position.iter().all(|c| c.is_finite()) {
            return Err(ReadError::syntax(place, "a corner has a coordinate that is not finite"));
        }
        // Adding zero turns -0 into 0, which is the same place.
        let key = position.map(|c| (c + 0.0).to_bits());
        match self.vertex_at.entry(key) {
            Entry::Occupied(known) => {
                self.builder.report.corners_welded += 1;
                Ok(*known.get())
            }
            Entry::Vacant(new) => {
                let Ok(vertex) = u32::try_from(self.builder.positions.len()) else {
                    return Err(ReadError::TooLarge { message: "more than 2^32 vertices".to_owned() });
                };
                self.builder.positions.push(position);
                Ok(*new.insert(vertex))
            }
        }
    }
}
