//! From M^L down: level by level the descriptor ranks the vertices and the partition removes the odd ones.

use super::canonical::Anchors;
use super::level::Level;
use super::partition::{Geometry, Partition, Ranked, Remover, is_coarse};
use super::quadrics::ErrorMemory;
use super::vertex_selection::{Optimize, Saliency, Thinning};
use super::{LevelRecord, Rings, Seams, SurfaceEditor};
use crate::descriptors::{Descriptor, Evaluation, Features, Window};
use crate::mesh::{Surface, TriMesh};
use bitvec::vec::BitVec;

/// Most levels, whatever the wish.
pub(crate) const MAX_LEVELS: u32 = 128;
/// Without a wish for levels, the base has at most this many vertices if it can.
const SMALL_BASE: usize = 40;
/// Without a wish, a level that removes a smaller share is the last.
const LEAST_SHARE: f64 = 0.02;

/// How to go down.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Settings {
    pub(crate) descriptor: Descriptor,
    /// For the next level.
    pub(crate) window: Window,
    /// Factor of the radius from each level to the next coarser one.
    pub(crate) growth: f64,
    /// `None` goes on until the base is small.
    pub(crate) levels: Option<u32>,
    pub(crate) partition: Partition,
    pub(crate) optimize: Optimize,
    /// The descriptor is left out where the partition can do without.
    pub(crate) is_hasty: bool,
    /// Whether vertices that are near each other in space follow each other.
    pub(crate) in_order: bool,
    /// Largest valence that goes, if not the usual one.
    pub(crate) max_valence: Option<u32>,
}

impl Settings {
    /// Of the usual speed and aim, in the order of the mesh.
    pub(crate) fn new(
        descriptor: Descriptor,
        window: Window,
        growth: f64,
        levels: Option<u32>,
        partition: Partition,
    ) -> Self {
        let optimize = Optimize::default();
        let (is_hasty, in_order, max_valence) = (false, false, None);
        Self { descriptor, window, growth, levels, partition, optimize, is_hasty, in_order, max_valence }
    }
}

/// A surface on its way down. Yields each level with what was removed from it, finest first; what stays
/// in the end is the base.
pub(crate) struct Descent<'a> {
    settings: Settings,
    geometry: Geometry<'a>,
    /// Of all vertices, if the descriptor is to see them.
    features: Option<Features>,
    /// l̄ of the finest level, in the units of the geometry.
    mean_edge: f64,
    shrinking: SurfaceEditor,
    memory: ErrorMemory<'a>,
    anchors: Anchors,
    seams: Seams,
    level: Level,
    depth: u32,
    is_over: bool,
}

impl<'a> Descent<'a> {
    /// Goes down from `surface`; the stitched vertices `stitched` always stay.
    pub(crate) fn new(
        surface: Surface,
        geometry: Geometry<'a>,
        settings: Settings,
        stitched: BitVec,
    ) -> Self {
        let memory = ErrorMemory::new(&surface, geometry.positions);
        let anchors = Anchors::new(&surface, stitched);
        let shrinking = SurfaceEditor::new(surface);
        let level = Level::collect(&shrinking);
        let (features, mean_edge, depth, is_over, seams) = (None, 0.0, 0, false, Seams::default());
        Self {
            settings,
            geometry,
            features,
            mean_edge,
            shrinking,
            memory,
            anchors,
            seams,
            level,
            depth,
            is_over,
        }
    }

    /// The same where the descriptor measures by l̄ of the finest level, in the units of the geometry. It must be told
    /// before the first level.
    pub(crate) fn with_mean_edge(self, mean_edge: f64) -> Self {
        Self { mean_edge, ..self }
    }

    /// The same with attributes that the descriptor sees, which must be one that can.
    pub(crate) fn with_features(self, features: Option<Features>) -> Self {
        Self { features, ..self }
    }

    /// Follows these seams, which know the attributes of the surface's corners and faces.
    pub(crate) fn with_seams(self, seams: Seams) -> Self {
        Self { seams, ..self }
    }

    /// What has not been removed yet.
    pub(crate) fn level(&self) -> &Level {
        &self.level
    }

    pub(crate) fn into_level(self) -> Level {
        self.level
    }

    /// What stays, the triangles at the anchors first, the anchor as their first edge, so that a decoder
    /// numbers its ends before all other vertices of its component. With the surface in whose slots it stands, and
    /// the seams there, if there are any.
    pub(crate) fn into_base(self) -> (Level, Surface, Seams) {
        let Self { shrinking, anchors, seams, mut level, .. } = self;
        let mut place_of_slot: Vec<u32> = vec![u32::MAX; shrinking.surface.triangles.len()];
        level.faces.iter().zip(0..).for_each(|(&slot, i)| place_of_slot[slot as usize] = i);
        for (i, corner) in anchors.corners(&shrinking.surface).enumerate() {
            // The corner faces the anchor, so the triangle is to start after it.
            let slot = corner / 3;
            let place = place_of_slot[slot as usize] as usize;
            level.triangles[place].rotate_left(((corner + 1) % 3) as usize);
            level.triangles.swap(i, place);
            level.faces.swap(i, place);
            place_of_slot[level.faces[place] as usize] = place as u32;
            place_of_slot[slot as usize] = i as u32;
        }
        let slots = if seams.is_empty() { Surface::default() } else { shrinking.surface };
        (level, slots, seams)
    }

    /// Mean squared distance of the original surface from the present level, by its quadrics.
    pub(crate) fn mean_error(&self) -> f64 {
        self.memory.mean_error(&self.level.vertices)
    }

    fn wants_level(&self) -> bool {
        match self.settings.levels {
            Some(levels) => self.depth < levels.min(MAX_LEVELS),
            None => !self.is_over && self.depth < MAX_LEVELS && self.level.vertices.len() > SMALL_BASE,
        }
    }

    /// What the partition goes by.
    fn ranked(&mut self) -> Ranked {
        let Settings { descriptor, window, partition, optimize, is_hasty, in_order, .. } = self.settings;
        let (mean_edge, positions) = (self.mean_edge, self.geometry.positions);
        let (shrinking, memory) = (&self.shrinking, &self.memory);
        let vertices = &self.level.vertices;
        let features = || self.features.as_ref().map(|features| features.of_vertices(vertices));
        if partition == Partition::Algorithm1 {
            let features = features();
            let evaluate = |mesh: &TriMesh| {
                Evaluation::new(descriptor, mesh, features.as_ref(), window, mean_edge, in_order).everywhere()
            };
            return Ranked::ByScore(self.level.with_mesh(positions, evaluate));
        }
        let thinning = Thinning::of_level(optimize, vertices.len(), shrinking);
        if !thinning.protects() {
            let saliency = Saliency::none(vertices.len());
            return Ranked::BySaliency { saliency, rings: Rings::new(shrinking, vertices) };
        }
        let errors = |vertices: &[u32]| {
            let rings = Rings::new(shrinking, vertices);
            (memory.errors(&rings, vertices), rings)
        };
        if is_hasty {
            let (errors, rings) = errors(vertices);
            return Ranked::BySaliency { saliency: Saliency::of_errors(thinning, errors), rings };
        }
        let (features, vertices, is_finest) = (features(), vertices.clone(), self.depth == 0);
        self.level.with_mesh(positions, |mesh| {
            let prepare =
                || Evaluation::new(descriptor, mesh, features.as_ref(), window, mean_edge, in_order);
            let errors = || errors(&vertices);
            // The finest level takes the most memory, and the descriptor most of it while it is prepared.
            let (mut evaluation, (errors, rings)) =
                if is_finest { (prepare(), errors()) } else { rayon::join(prepare, errors) };
            let saliency = Saliency::weighed(thinning, errors, |places| evaluation.at(places));
            Ranked::BySaliency { saliency, rings }
        })
    }
}

impl Iterator for Descent<'_> {
    type Item = (Level, LevelRecord);

    fn next(&mut self) -> Option<Self::Item> {
        if !self.wants_level() {
            return None;
        }
        let optimize = self.settings.optimize;
        let ranked = self.ranked();
        let mut remover = Remover {
            surface: &mut self.shrinking,
            geometry: self.geometry,
            memory: &mut self.memory,
            anchors: &self.anchors,
            seams: &mut self.seams,
        };
        let record = remover.remove(&self.level, ranked, optimize, self.settings.max_valence);
        if record.len() == 0 {
            let num_vertices = self.level.vertices.len();
            let may_loosen = self.seams.hold() && !is_coarse(optimize, num_vertices, &self.shrinking);
            if !may_loosen {
                return None;
            }
            self.seams.loosen();
            return self.next();
        }
        let coarser = self.level.coarser(&self.shrinking);
        let finer = std::mem::replace(&mut self.level, coarser);
        let is_little = (record.len() as f64) < LEAST_SHARE * finer.vertices.len() as f64;
        let num_vertices = self.level.vertices.len();
        if is_little && self.seams.hold() && !is_coarse(optimize, num_vertices, &self.shrinking) {
            self.seams.loosen();
        } else {
            self.is_over = is_little;
        }
        self.settings.window.radius *= self.settings.growth;
        self.depth += 1;
        Some((finer, record))
    }
}
