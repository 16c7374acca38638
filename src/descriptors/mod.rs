//! Seven scalar descriptors of geometric variability, one value per vertex (sections 3 to 5 of the paper).
//!
//! Each value is ≥ 0 and larger where the surface is more salient within a [`Window`]. Section and equation
//! numbers refer to *Lazy Wavelet Simplification using Scale-dependent Dense Geometric Variability
//! Descriptors*; the places marked *ours* are choices the paper leaves open.
//!
//! - **Units (ours).** Everything is evaluated in coordinates divided by l̄, the mean edge length of the
//!   *finest* mesh, so no value depends on the units of the model. If l̄ is 0 every value is 0.
//! - **Topology.** Faces with a repeated index are dropped. Two vertices are neighbours when a remaining face
//!   holds both, whatever the manifoldness. Vertices without neighbours have the value 0.
//! - **Determinism.** The same input gives the same bits, whatever the number of threads and the platform: what a
//!   platform's own library computes (exp, hypot) comes from `libm`.

use crate::mesh::TriMesh;

mod adjacency;
mod augmented;
mod casorati;
mod descriptor;
mod features;
mod harris3d;
mod locality;
mod nfv;
mod paraboloid;
mod pca;
mod pca_qem;
mod quadric;
mod readings;
mod scale;
mod shape_index;
mod sqem;
mod surface;
pub(crate) mod symmetric;
mod window;

pub use descriptor::{Descriptor, UnknownDescriptor};
pub use features::{FeatureChoice, Features, FeaturesError, MAX_FEATURES};
pub use readings::{NormalWeights, PcaQuadric, Readings};
pub use window::Window;

use surface::Surface;

/// Mean length of the undirected edges of `mesh`, each counted once, in model units.
///
/// Faces with a repeated index are dropped first. 0 without edges. Coordinates of any finite size are
/// fine; a mean beyond `f64::MAX` is returned as `f64::MAX`.
pub fn mean_edge_length(mesh: &TriMesh) -> f64 {
    surface::mean_edge_length(mesh)
}

/// Evaluates `descriptor` at every vertex of `mesh`, in the order of the vertices.
///
/// - `window`: rings and radius, the radius in units of `mean_edge`.
/// - `mean_edge`: [`mean_edge_length`] of the **finest** mesh, model units, also when `mesh` is a coarser
///   level of it. Unless it is positive and finite, all values are 0.
///
/// All values are finite and ≥ 0. Runs on the current rayon pool.
pub fn evaluate(descriptor: Descriptor, mesh: &TriMesh, window: &Window, mean_edge: f64) -> Vec<f64> {
    evaluate_with_progress(descriptor, mesh, window, mean_edge, &|_| ())
}

/// As [`evaluate`], telling `progress` after each block of vertices how many more are done.
///
/// The reported numbers add up to the number of vertices. Several threads may call at once.
pub fn evaluate_with_progress(
    descriptor: Descriptor,
    mesh: &TriMesh,
    window: &Window,
    mean_edge: f64,
    progress: &(dyn Fn(usize) + Sync),
) -> Vec<f64> {
    evaluate_reading(descriptor, mesh, window, mean_edge, Readings::default(), progress)
}

/// As [`evaluate_with_progress`], with another reading of the paper.
pub fn evaluate_reading(
    descriptor: Descriptor,
    mesh: &TriMesh,
    window: &Window,
    mean_edge: f64,
    readings: Readings,
    progress: &(dyn Fn(usize) + Sync),
) -> Vec<f64> {
    let surface = prepare(mesh, window, mean_edge, readings.normals, false);
    evaluate_prepared(mesh, surface.as_ref(), progress, |surface| {
        evaluate_surface(descriptor, surface, window, readings, progress)
    })
}

fn evaluate_surface(
    descriptor: Descriptor,
    surface: &Surface,
    window: &Window,
    readings: Readings,
    progress: &(dyn Fn(usize) + Sync),
) -> Vec<f64> {
    match descriptor {
        Descriptor::Pca => pca::evaluate(surface, window, progress),
        Descriptor::Nfv => nfv::evaluate(surface, window, progress),
        Descriptor::Casorati => casorati::evaluate(surface, window, progress),
        Descriptor::ShapeIndex => shape_index::evaluate(surface, window, progress),
        Descriptor::Harris3d => harris3d::evaluate(surface, window, progress),
        Descriptor::Sqem => sqem::evaluate(surface, window, progress),
        Descriptor::PcaQem => pca_qem::evaluate(surface, window, readings.pca_quadric, progress),
    }
}

/// A descriptor on a mesh, evaluated where it is asked.
pub(crate) struct Evaluation<'a> {
    descriptor: Descriptor,
    mesh: &'a TriMesh,
    features: Option<&'a Features>,
    window: Window,
    surface: Option<Surface>,
    /// All values, of a descriptor that needs something of each vertex first.
    values: Option<Vec<f64>>,
}

impl<'a> Evaluation<'a> {
    /// `features` count only if the descriptor knows attributes. Vertices `in_order` are near each other in memory if
    /// they are so in space.
    pub(crate) fn new(
        descriptor: Descriptor,
        mesh: &'a TriMesh,
        features: Option<&'a Features>,
        window: Window,
        mean_edge: f64,
        in_order: bool,
    ) -> Self {
        let surface = prepare(mesh, &window, mean_edge, NormalWeights::default(), in_order);
        let features = features.filter(|_| descriptor.knows_attributes());
        Self { descriptor, mesh, features, window, surface, values: None }
    }

    /// The values of all vertices, as [`evaluate`] and [`evaluate_with_features`] have them.
    pub(crate) fn everywhere(&mut self) -> Vec<f64> {
        let Self { descriptor, mesh, features, window, ref surface, .. } = *self;
        let none = &|_| ();
        evaluate_prepared(mesh, surface.as_ref(), none, |surface| match (features, descriptor) {
            (Some(features), Descriptor::Pca) => augmented::variation(surface, features, &window, none),
            (Some(features), _) => augmented::pca_qem(surface, features, &window, none),
            _ => evaluate_surface(descriptor, surface, &window, Readings::default(), none),
        })
    }

    /// The values at some places.
    pub(crate) fn at(&mut self, places: &[u32]) -> Vec<f64> {
        let needs_all =
            self.features.is_some() || matches!(self.descriptor, Descriptor::Nfv | Descriptor::PcaQem);
        if needs_all && self.values.is_none() {
            self.values = Some(self.everywhere());
        }
        if let Some(values) = &self.values {
            return places.iter().map(|&place| values[place as usize]).collect();
        }
        let Some(surface) = &mut self.surface else { return vec![0.0; places.len()] };
        surface.select(places);
        let mut values =
            evaluate_surface(self.descriptor, surface, &self.window, Readings::default(), &|_| ());
        values.iter_mut().for_each(tidy);
        surface.select_all();
        values
    }
}

/// As [`evaluate_with_progress`], of vertices with attributes: `features` has one row per vertex of `mesh`.
///
/// # Errors
/// If `descriptor` is neither [`Descriptor::Pca`] nor [`Descriptor::PcaQem`].
///
/// # Panics
/// If `features` was made for fewer vertices.
pub fn evaluate_with_features(
    descriptor: Descriptor,
    mesh: &TriMesh,
    features: &Features,
    window: &Window,
    mean_edge: f64,
    progress: &(dyn Fn(usize) + Sync),
) -> Result<Vec<f64>, FeaturesError> {
    let evaluate = match descriptor {
        Descriptor::Pca => augmented::variation,
        Descriptor::PcaQem => augmented::pca_qem,
        _ => return Err(FeaturesError::Descriptor { descriptor }),
    };
    let prepared = prepare(mesh, window, mean_edge, NormalWeights::default(), false);
    Ok(evaluate_prepared(mesh, prepared.as_ref(), progress, |surface| {
        evaluate(surface, features, window, progress)
    }))
}

/// `None` where every value is 0.
fn prepare(
    mesh: &TriMesh,
    window: &Window,
    mean_edge: f64,
    normals: NormalWeights,
    in_order: bool,
) -> Option<Surface> {
    let usable = window.radius > 0.0 && mean_edge > 0.0 && mean_edge.is_finite();
    usable.then(|| Surface::new(mesh, mean_edge, normals, in_order)).flatten()
}

fn evaluate_prepared(
    mesh: &TriMesh,
    surface: Option<&Surface>,
    progress: &(dyn Fn(usize) + Sync),
    evaluate: impl FnOnce(&Surface) -> Vec<f64>,
) -> Vec<f64> {
    let Some(surface) = surface else {
        progress(mesh.num_vertices());
        return vec![0.0; mesh.num_vertices()];
    };
    let mut values = surface.in_mesh_order(&evaluate(surface));
    values.iter_mut().for_each(tidy);
    values
}

/// Also turns −0 and NaN into +0: only windows far beyond any sensible radius could make a NaN.
fn tidy(value: &mut f64) {
    *value = if *value > 0.0 { value.min(f64::MAX) } else { 0.0 };
}

/// Mean number of vertices in a window, the centre included, over the vertices that have neighbours.
///
/// `window` and `mean_edge` as in [`evaluate`]; 0 where that gives zeros. Runs on the current rayon pool.
pub fn mean_window_size(mesh: &TriMesh, window: &Window, mean_edge: f64) -> f64 {
    let Some(surface) = prepare(mesh, window, mean_edge, NormalWeights::default(), false) else {
        return 0.0;
    };
    let sizes = window::map_windows(&surface, window, &|_| (), |local| local.len());
    let windows = sizes.iter().filter(|&&size| size > 0).count();
    sizes.iter().sum::<usize>() as f64 / windows.max(1) as f64
}
