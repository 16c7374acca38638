//! The entries of an attribute, and which of them an element has.

use crate::mesh::{Domain, NO_ENTRY, Surface};

/// Entries of integers, and the entry of each vertex, corner or face.
#[derive(Clone)]
pub(crate) struct Entries {
    pub(super) domain: Domain,
    pub(super) num_channels: usize,
    values: Vec<i32>,
    /// Per entry: base-2 logarithm of its residual, in eighths.
    roughness: Vec<i8>,
    /// The entry that was appended last.
    last: Vec<i32>,
    /// Per element; [`NO_ENTRY`] for none, or none yet.
    pub(crate) of: Vec<u32>,
}

impl Entries {
    pub(super) fn new(domain: Domain, num_channels: usize) -> Self {
        Self {
            domain,
            num_channels,
            values: Vec::new(),
            roughness: Vec::new(),
            last: Vec::new(),
            of: Vec::new(),
        }
    }

    pub(crate) fn get(&self, entry: u32) -> &[i32] {
        let first = entry as usize * self.num_channels;
        &self.values[first..first + self.num_channels]
    }

    pub(crate) fn len(&self) -> usize {
        self.roughness.len()
    }

    pub(super) fn roughness(&self, entry: u32) -> f32 {
        f32::from(self.roughness[entry as usize]) / 8.0
    }

    pub(super) fn push(&mut self, channels: &[i32], roughness: i8) -> u32 {
        self.values.extend_from_slice(channels);
        self.last.clear();
        self.last.extend_from_slice(channels);
        self.roughness.push(roughness);
        self.len() as u32 - 1
    }

    /// The entry that was appended last, if any was.
    pub(super) fn last(&self) -> Option<&[i32]> {
        (!self.last.is_empty()).then_some(&self.last)
    }

    /// Forgets entries that no element has any more, once they could be the most: splits replace entries of
    /// corners and faces.
    pub(super) fn compact(&mut self) {
        if self.domain == Domain::Vertex || self.len() <= self.of.len() {
            return;
        }
        let mut place = vec![NO_ENTRY; self.len()];
        let (mut values, mut roughness) = (Vec::new(), Vec::new());
        for entry in self.of.iter_mut().filter(|entry| **entry != NO_ENTRY) {
            let old = *entry as usize;
            if place[old] == NO_ENTRY {
                place[old] = roughness.len() as u32;
                values.extend_from_slice(&self.values[old * self.num_channels..][..self.num_channels]);
                roughness.push(self.roughness[old]);
            }
            *entry = place[old];
        }
        (self.values, self.roughness) = (values, roughness);
    }

    /// The entry at a corner.
    #[inline]
    pub(super) fn at(&self, surface: &Surface, corner: u32) -> u32 {
        let element = match self.domain {
            Domain::Vertex => surface.vertex(corner),
            Domain::Corner => corner,
            Domain::Triangle => corner / 3,
        };
        self.of.get(element as usize).copied().unwrap_or(NO_ENTRY)
    }

    /// Whether two entries say the same.
    pub(super) fn are_equal(&self, a: u32, b: u32) -> bool {
        a == b || a != NO_ENTRY && b != NO_ENTRY && self.get(a) == self.get(b)
    }

    /// Makes room for the elements of a mesh.
    pub(super) fn resize(&mut self, num_vertices: usize, num_faces: usize) {
        let count = match self.domain {
            Domain::Vertex => num_vertices,
            Domain::Corner => 3 * num_faces,
            Domain::Triangle => num_faces,
        };
        self.of.resize(count, NO_ENTRY);
    }
}
