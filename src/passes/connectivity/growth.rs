//! The patch that grows now, and whether it fits the rule of ears.

use super::polygon::{Fit, Polygon, Triangle};
use super::regions::Regions;
use crate::mesh::surface::{NO_CORNER, next, prev};
use crate::util::simd4::Cell;

/// Whether a patch would fit the rule if it grew over the edge that the corner `inside` faces.
#[derive(Clone, Copy)]
struct Growth {
    inside: u32,
    /// [`Fit::Unknown`] if it cannot grow there.
    fit: Fit,
}

impl Growth {
    /// Over no edge.
    const NONE: Self = Self { inside: NO_CORNER, fit: Fit::Unknown };
}

/// How a patch would fit the rule if it grew over each of the two edges beyond its gate.
#[derive(Clone, Copy)]
pub(super) struct FirstGrowths([Growth; 2]);

impl FirstGrowths {
    /// Of a seed, which has no gate.
    pub(super) const NONE: Self = Self([Growth::NONE; 2]);

    /// Of a patch that begins with the face of `corner`, which faces the gate.
    #[inline(always)]
    pub(super) fn of(regions: &Regions, start: &Triangle, corner: u32) -> Self {
        Self([Self::over(regions, start, next(corner), 1), Self::over(regions, start, prev(corner), 2)])
    }

    /// What growing over edge `edge` of the first triangle would make of a patch.
    #[inline(always)]
    fn over(regions: &Regions, start: &Triangle, inside: u32, edge: usize) -> Growth {
        let Some(beyond) = regions.undecided_across(inside) else { return Growth::NONE };
        let tip = regions.at(beyond);
        Growth { inside, fit: start.fit_grown(edge, tip.cell, tip.live) }
    }

    pub(super) fn fits(&self) -> [Fit; 2] {
        self.0.map(|growth| growth.fit)
    }
}

/// A patch that grows.
pub(super) struct GrowingPatch {
    /// Edges still to look at.
    pub(super) frontier: Vec<u32>,
    polygon: Polygon,
    /// Whether the polygon fits the rule.
    pub(super) fit: Fit,
    /// What is known of the edges that may be looked at next: those of the face at the gate, until the
    /// patch grows.
    growths: FirstGrowths,
}

impl Default for GrowingPatch {
    fn default() -> Self {
        let (frontier, polygon) = (Vec::new(), Polygon::default());
        Self { frontier, polygon, fit: Fit::Is, growths: FirstGrowths::NONE }
    }
}

impl GrowingPatch {
    /// Begins with a triangle; its edges before corner `cursor` stay.
    #[inline(always)]
    pub(super) fn begin(&mut self, start: &Triangle, cursor: usize, growths: FirstGrowths) {
        self.polygon.begin(start, cursor);
        self.fit = Fit::Is;
        self.growths = growths;
    }

    /// Whether the patch would fit if it grew over the edge that `inside` faces to this tip.
    #[inline(always)]
    pub(super) fn fit_grown(&mut self, inside: u32, tip: Cell, valence: u8) -> Fit {
        self.known_fit(inside).unwrap_or_else(|| self.polygon.fit_grown(tip, valence))
    }

    /// What is known of growing over the edge that is looked at after this one.
    #[inline(always)]
    pub(super) fn fit_after(&self) -> Fit {
        self.frontier.last().and_then(|&after| self.known_fit(after)).unwrap_or(Fit::Unknown)
    }

    /// What is known of growing over the edge that `inside` faces.
    #[inline(always)]
    fn known_fit(&self, inside: u32) -> Option<Fit> {
        self.growths.0.iter().find(|growth| growth.inside == inside).map(|growth| growth.fit)
    }

    /// Grows over the edge that is looked at.
    #[inline(always)]
    pub(super) fn grow(&mut self, tip: Cell, valence: u8, fit: Fit) {
        self.polygon.grow(tip, valence);
        self.fit = fit;
        self.growths = FirstGrowths::NONE;
    }

    /// The edge that is looked at stays.
    #[inline(always)]
    pub(super) fn pass(&mut self) {
        self.polygon.pass();
    }
}
