//! The coarse mesh while it is walked: which of its faces are kept and which are in a patch, and what that makes of its
//! vertices.

use crate::mesh::Surface;
use crate::mesh::ears::MAX_VALENCE;
use crate::mesh::surface::{NO_CORNER, next, prev};
use crate::passes::patch::Patches;
use crate::util::simd4::Cell;

/// What is known at a vertex so far.
#[derive(Clone, Copy)]
pub(super) struct Around {
    pub(super) cell: Cell,
    /// In the coarse mesh.
    pub(super) valence: u32,
    /// Faces that are not decided yet.
    pub(super) undecided: u32,
    /// What the patches so far will add to the valence.
    gained: i16,
    /// The valence as it will be then, as far as the rule tells it apart.
    pub(super) live: u8,
    /// Patches that touch the vertex.
    pub(super) touched: u8,
}

impl Around {
    pub(super) fn new(cell: [i32; 3], valence: u32) -> Self {
        let live = valence.min(MAX_VALENCE) as u8;
        Self { cell: Cell::new(cell), valence, undecided: 0, gained: 0, live, touched: 0 }
    }

    /// 0 if a patch touches the vertex; else 1 to 3, the fewer faces are left the higher: a maximal
    /// set of removed vertices leaves no vertex untouched. One face is left at least.
    #[inline(always)]
    pub(super) fn urgency(&self) -> usize {
        if self.touched > 0 { 0 } else { 4 - self.undecided.min(3) as usize }
    }

    fn gain(&mut self, gained: i16) {
        self.gained = self.gained.saturating_add(gained);
        self.live = (self.valence as i32 + i32::from(self.gained)).clamp(0, MAX_VALENCE as i32) as u8;
    }

    pub(super) fn touch(&mut self, gained: i16) {
        self.touched = self.touched.saturating_add(1);
        self.gain(gained);
    }
}

/// What is decided about a face.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Face {
    Undecided = 0,
    Kept = 1,
    InPatch = 2,
}

/// The state of all faces and vertices, and the patches.
pub(super) struct Regions<'a> {
    pub(super) surface: &'a Surface,
    /// The vertex at each corner, and the corner across from each, which the surface has as well: at hand.
    vertices: &'a [u32],
    pub(super) opposite: &'a [u32],
    pub(super) faces: Vec<Face>,
    pub(super) around: Vec<Around>,
    pub(super) patches: Patches,
}

impl<'a> Regions<'a> {
    pub(super) fn new(surface: &'a Surface, faces: Vec<Face>, around: Vec<Around>, patches: Patches) -> Self {
        let (vertices, opposite) = (surface.triangles.as_flattened(), &surface.opposite[..]);
        Self { surface, vertices, opposite, faces, around, patches }
    }

    #[inline(always)]
    pub(super) fn vertex(&self, corner: u32) -> u32 {
        self.vertices[corner as usize]
    }

    #[inline(always)]
    pub(super) fn across(&self, corner: u32) -> u32 {
        self.opposite[corner as usize]
    }

    /// What is known at the vertex of a corner.
    #[inline(always)]
    pub(super) fn at(&self, corner: u32) -> &Around {
        &self.around[self.vertex(corner) as usize]
    }

    /// Whether the face of a corner is undecided.
    pub(super) fn is_undecided(&self, corner: u32) -> bool {
        self.faces[(corner / 3) as usize] == Face::Undecided
    }

    /// The corner beyond the edge that `inside` faces, if a patch can grow over it.
    pub(super) fn undecided_across(&self, inside: u32) -> Option<u32> {
        let beyond = self.across(inside);
        (beyond != NO_CORNER && self.is_undecided(beyond)).then_some(beyond)
    }

    /// What is decided about the face across from a corner: a [`Face`], or 3 at the boundary.
    pub(super) fn state_across(&self, corner: u32) -> usize {
        match self.across(corner) {
            NO_CORNER => 3,
            o => self.faces[(o / 3) as usize] as usize,
        }
    }

    /// Decides that a face is in no patch.
    pub(super) fn keep(&mut self, face: u32) {
        self.faces[face as usize] = Face::Kept;
        for v in self.surface.triangles[face as usize] {
            self.around[v as usize].undecided -= 1;
        }
    }

    /// Takes a face into the patch that grows.
    pub(super) fn take(&mut self, face: u32) {
        self.faces[face as usize] = Face::InPatch;
        self.patches.push_face(face);
        for v in self.surface.triangles[face as usize] {
            let around = &mut self.around[v as usize];
            around.undecided -= 1;
            around.gain(-1);
        }
    }

    /// Where the walk of a component starts whose first vertex is at `corner`: at the edge to the
    /// vertex after it, if that is there.
    pub(super) fn seed_at(&self, corner: u32) -> u32 {
        let second = self.vertex(corner) + 1;
        let there = |c: u32| (c != NO_CORNER).then_some(c);
        let lefts = std::iter::successors(Some(corner), |&c| there(self.surface.swing_left(c)));
        let rights = std::iter::successors(Some(corner), |&c| there(self.surface.swing_right(c)));
        let turn = |(i, c): (usize, u32)| (i == 0 || c != corner).then_some(c);
        let mut around = lefts.enumerate().map_while(turn).chain(rights.enumerate().map_while(turn));
        prev(around.find(|&c| self.vertex(next(c)) == second).unwrap_or(corner))
    }
}
