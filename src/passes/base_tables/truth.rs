//! What an encoder knows of the triangles to come.

use super::front::Front;
use super::growth::{Tip, Truth};
use crate::mesh::Surface;
use crate::mesh::surface::{NO_CORNER, next, prev};

/// A surface whose triangles are coded one after the other.
pub(super) struct SurfaceTruth<'a> {
    surface: &'a Surface,
    /// Of each coded triangle the corner of the surface that is its first one.
    pub(super) corner_source: Vec<u32>,
    /// Coded triangle of each triangle of the surface.
    coded: Vec<u32>,
    /// Vertex of the surface of each coded one.
    pub(super) vertex_source: Vec<u32>,
    is_met: Vec<bool>,
    next_seed: u32,
    /// The corner beyond the gate.
    tip: u32,
}

impl<'a> SurfaceTruth<'a> {
    pub(super) fn new(surface: &'a Surface) -> Self {
        let coded = vec![NO_CORNER; surface.triangles.len()];
        let is_met = vec![false; surface.corner_of.len()];
        Self {
            surface,
            corner_source: Vec::new(),
            coded,
            vertex_source: Vec::new(),
            is_met,
            next_seed: 0,
            tip: 0,
        }
    }

    fn add(&mut self, vertex: u32) {
        self.is_met[vertex as usize] = true;
        self.vertex_source.push(vertex);
    }

    /// Notes that the triangle from this corner on is coded.
    fn note(&mut self, corner: u32) {
        self.coded[(corner / 3) as usize] = self.corner_source.len() as u32;
        self.corner_source.push(corner);
    }

    /// Whether there is a coded triangle across the edge that a corner faces.
    fn is_coded_across(&self, corner: u32) -> bool {
        let across = self.surface.across(corner);
        across != NO_CORNER && self.coded[(across / 3) as usize] != NO_CORNER
    }

    /// The coded corner that is this one of the surface, if its triangle is coded.
    fn coded_corner(&self, corner: u32) -> Option<u32> {
        let triangle = self.coded[(corner / 3) as usize];
        let first = self.corner_source.get(triangle as usize)?;
        Some(3 * triangle + (corner % 3 + 3 - first % 3) % 3)
    }

    /// The first coded corner at the same vertex one way around it.
    fn first_coded(&self, corner: u32, swing: impl Fn(u32) -> u32) -> Option<u32> {
        let mut corner = swing(corner);
        while corner != NO_CORNER {
            if let Some(coded) = self.coded_corner(corner) {
                return Some(coded);
            }
            corner = swing(corner);
        }
        None
    }
}

impl Truth for SurfaceTruth<'_> {
    fn seed(&mut self) {
        while self.coded.get(self.next_seed as usize).is_some_and(|&c| c != NO_CORNER) {
            self.next_seed += 1;
        }
        self.surface.triangles[self.next_seed as usize].iter().for_each(|&v| self.add(v));
        self.note(3 * self.next_seed);
    }

    fn beyond(&mut self, _: &Front, gate: u32) -> Tip {
        let first = self.corner_source[(gate / 3) as usize];
        let source = (0..gate % 3).fold(first, |corner, _| next(corner));
        let tip = self.surface.across(source);
        if tip == NO_CORNER {
            return Tip::Nothing;
        }
        self.tip = tip;
        let vertex = self.surface.vertex(tip);
        // The corner at the gate's end faces the edge from the pivot, and the other way round.
        let kind = if self.is_coded_across(next(tip)) {
            Tip::BesidePivot
        } else if self.is_coded_across(prev(tip)) {
            Tip::BesideEnd
        } else if !self.is_met[vertex as usize] {
            self.add(vertex);
            Tip::New
        } else {
            Tip::Far
        };
        if kind != Tip::Far {
            self.note(tip);
        }
        kind
    }

    fn far(&mut self, front: &Front) -> u32 {
        let tip = self.tip;
        // To the left a coded triangle begins with an edge from the tip, to the right it ends with one to it.
        let left = self.first_coded(tip, |c| self.surface.swing_left(c)).map(prev);
        let right = || self.first_coded(tip, |c| self.surface.swing_right(c)).map(next);
        let at = left.or_else(|| right().map(|corner| front.after(corner)));
        self.note(tip);
        at.unwrap_or(NO_CORNER)
    }
}
