//! The neighbours of all vertices of a level in one flat table: cheaper to visit again and again than the corners.

use super::SurfaceEditor;
use rayon::prelude::*;

/// Vertices whose rings one thread reads.
const GROUP: usize = 1 << 10;

/// Rings by place among the vertices of a level, as places.
#[derive(Default)]
pub(crate) struct Rings {
    /// Where the ring of each vertex begins.
    first: Vec<u32>,
    places: Vec<u32>,
    /// Of an open ring the ends come first.
    is_open: Vec<bool>,
}

impl Rings {
    /// `vertices` are those of the level.
    pub(crate) fn new(surface: &SurfaceEditor, vertices: &[u32]) -> Self {
        let mut place_of = vec![0_u32; surface.surface.corner_of.len()];
        vertices.iter().zip(0..).for_each(|(&v, place)| place_of[v as usize] = place);
        let mut first = Vec::with_capacity(vertices.len() + 1);
        let mut end = 0;
        for &v in vertices {
            first.push(end);
            end += surface.surface.valence[v as usize];
        }
        first.push(end);
        let mut places = vec![0; end as usize];
        let mut is_open = vec![false; vertices.len()];
        let mut rest = &mut places[..];
        let mut groups = Vec::new();
        let starts = (0..vertices.len()).step_by(GROUP);
        for ((vertices, is_open), start) in vertices.chunks(GROUP).zip(is_open.chunks_mut(GROUP)).zip(starts)
        {
            let len = first[start + vertices.len()] - first[start];
            let (rings, after) = std::mem::take(&mut rest).split_at_mut(len as usize);
            groups.push((vertices, is_open, rings));
            rest = after;
        }
        groups.into_par_iter().for_each(|(vertices, is_open, mut rest)| {
            for (&v, is_open) in vertices.iter().zip(is_open) {
                let valence = surface.surface.valence[v as usize] as usize;
                let (ring, after) = std::mem::take(&mut rest).split_at_mut(valence);
                let (mut len, mut num_ends) = (0, 0);
                let is_closed = surface.for_each_neighbour(v, |u, is_end| {
                    ring[len] = place_of[u as usize];
                    if is_end {
                        ring.swap(num_ends, len);
                        num_ends += 1;
                    }
                    len += 1;
                });
                *is_open = !is_closed;
                rest = after;
            }
        });
        Self { first, places, is_open }
    }

    /// The neighbours of a vertex in any order.
    #[inline]
    pub(crate) fn of(&self, place: u32) -> &[u32] {
        &self.places[self.first[place as usize] as usize..self.first[place as usize + 1] as usize]
    }

    pub(crate) fn valence(&self, place: u32) -> usize {
        self.of(place).len()
    }

    /// Those into which a vertex may collapse: at a boundary the ends of the ring.
    #[inline]
    pub(crate) fn targets(&self, place: u32) -> &[u32] {
        let ring = self.of(place);
        if self.is_open[place as usize] { &ring[..2] } else { ring }
    }

    pub(crate) fn len(&self) -> usize {
        self.is_open.len()
    }
}
