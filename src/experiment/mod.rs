//! The experiment of the paper's section 6: Algorithm 1 again and again, and how far the vertices it
//! removes are from the planes of their neighbours.
//!
//! ```
//! use lwc::descriptors::Descriptor;
//! use lwc::experiment::{Experiment, Settings};
//!
//! # let positions = (0..400).map(|i| [f64::from(i % 20), f64::from(i / 20), f64::from(i * i % 7) * 0.1]);
//! # let cells = (0..380).filter(|i| i % 20 < 19);
//! # let triangles = cells.flat_map(|i| [[i, i + 1, i + 21], [i, i + 21, i + 20]]).collect();
//! # let mesh = lwc::TriMesh::new(positions.collect(), triangles)?;
//! let experiment = Experiment::new(&mesh, None)?;
//! for step in experiment.run(Descriptor::Harris3d, &Settings::default(), &|_| ()) {
//!     println!("{} of {} vertices removed, apd {}", step.odd, step.vertices, step.apd);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod average_plane_distance;
mod noise;

pub use noise::Noise;

use crate::descriptors::{self, Descriptor, Readings, Window};
use crate::encoder::quantize::{LEGALITY_BITS, quantize};
use crate::error::EncodeError;
use crate::mesh::repair::{RepairReport, Repaired, repair};
use crate::mesh::{Surface, TriMesh};
use crate::simplification::level::Level;
use crate::simplification::partition::{Geometry, by_score, remove_in_order};
use crate::simplification::{Seams, SurfaceEditor};
use average_plane_distance::average_plane_distance;
use serde::{Deserialize, Serialize};
use std::time::Instant;

/// How Algorithm 1 is repeated. The defaults are the paper's.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Settings {
    /// How often. Default 8.
    pub levels: u32,
    /// Window of the first step, its radius in mean edges of the input mesh. Default 4 rings, radius 3.
    pub window: Window,
    /// Factor of the radius from each step to the next. Default 1.5.
    pub growth: f64,
    /// What lengths are measured in. Default [`Units::MeanEdge`].
    pub units: Units,
    /// Answers to other questions that the paper leaves open.
    pub readings: Readings,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            levels: 8,
            window: Window::default(),
            growth: 1.5,
            units: Units::MeanEdge,
            readings: Readings::default(),
        }
    }
}

/// Unit of length inside the descriptors. The paper leaves it open; harris3d and pca-qem depend on it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Units {
    /// l̄ of the input mesh: no result depends on the units of the file.
    #[default]
    MeanEdge,
    /// The units of the file.
    Model,
}

/// One application of Algorithm 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Step {
    /// 1 is the first, which takes the input mesh.
    pub step: u32,
    /// Vertices before the step.
    pub vertices: usize,
    /// Vertices it removes.
    pub odd: usize,
    /// `odd` / `vertices`.
    pub odd_share: f64,
    /// Mean number of vertices in a descriptor's window, the centre included.
    pub mean_window: f64,
    /// Average plane distance (eq. 34), in mean edges of the input mesh.
    pub apd: f64,
    /// Seconds for the descriptor at every vertex, on all threads of the pool.
    pub descriptor_seconds: f64,
    /// Seconds for putting the vertices in order, on one thread.
    pub partition_seconds: f64,
    /// Seconds for tagging, tests of legality and collapses, on one thread.
    pub removal_seconds: f64,
}

/// A mesh made ready.
#[derive(Clone, Debug)]
pub struct Experiment {
    surface: Surface,
    /// Coordinates of the input.
    original: Vec<[f64; 3]>,
    /// Coordinates that drive the descriptors and the partition.
    driving: Vec<[f64; 3]>,
    cells: Vec<[i32; 3]>,
    mean_edge: f64,
    /// Model unit over that of the coordinates kept here.
    unit: f64,
    repair: RepairReport,
}

impl Experiment {
    /// Cuts `mesh` into an oriented surface and, with `noise`, perturbs what drives the partition; the
    /// distances stay those of the original coordinates, and so does l̄.
    ///
    /// # Errors
    /// If the mesh has no usable triangle, or spans more than a double can hold.
    pub fn new(mesh: &TriMesh, noise: Option<Noise>) -> Result<Self, EncodeError> {
        let Repaired { surface, source, report } = repair(mesh);
        if surface.triangles.is_empty() {
            return Err(EncodeError::NoTriangles);
        }
        let model = quantize(mesh, &source, LEGALITY_BITS)?;
        let mean_edge = descriptors::mean_edge_length(mesh);
        let mut experiment = Self {
            surface,
            driving: model.positions.clone(),
            original: model.positions,
            cells: model.cells,
            mean_edge: mean_edge * model.unit,
            unit: model.unit,
            repair: report,
        };
        if let Some(noise) = noise {
            let noisy = noise.perturb(mesh, mean_edge)?;
            let model = quantize(&noisy, &source, LEGALITY_BITS)?;
            experiment.cells = model.cells;
            let same_unit = experiment.unit / model.unit;
            experiment.driving = model.positions;
            experiment.driving.iter_mut().flatten().for_each(|x| *x *= same_unit);
        }
        Ok(experiment)
    }

    /// Vertices of the surface.
    pub fn num_vertices(&self) -> usize {
        self.original.len()
    }

    /// What had to be changed to make the mesh an oriented surface.
    pub fn repair(&self) -> RepairReport {
        self.repair
    }

    /// Runs Algorithm 1 `settings.levels` times, or until it removes nothing. Tells `progress` after
    /// each step which share of the vertices' work is done, 0 to 1.
    ///
    /// Apart from the times, the same input gives the same bits whatever the number of threads.
    pub fn run(&self, descriptor: Descriptor, settings: &Settings, progress: &dyn Fn(f64)) -> Vec<Step> {
        let geometry = Geometry { grid: &self.cells, positions: &self.driving };
        let unit_length = match settings.units {
            Units::MeanEdge => self.mean_edge,
            Units::Model => self.unit,
        };
        let mut window = settings.window;
        window.radius *= self.mean_edge / unit_length;
        let mut shrinking = SurfaceEditor::new(self.surface.clone());
        let mut steps = Vec::new();
        let (mut done, total) = (0.0, expected_work(self.num_vertices(), settings.levels));
        for step in 1..=settings.levels {
            let mut level = Level::collect(&shrinking);
            let (scores, mean_window, descriptor_seconds) = level.with_mesh(&self.driving, |mesh| {
                let start = Instant::now();
                let scores = descriptors::evaluate_reading(
                    descriptor,
                    mesh,
                    &window,
                    unit_length,
                    settings.readings,
                    &|_| (),
                );
                let seconds = start.elapsed().as_secs_f64();
                (scores, descriptors::mean_window_size(mesh, &window, unit_length), seconds)
            });

            let start = Instant::now();
            let order = by_score(&level.vertices, &scores);
            let partition_seconds = start.elapsed().as_secs_f64();
            let start = Instant::now();
            let record = remove_in_order(&mut shrinking, geometry, &order, None, &mut Seams::default());
            let removal_seconds = start.elapsed().as_secs_f64();
            if record.len() == 0 {
                break;
            }
            let (vertices, odd) = (level.vertices.len(), record.len());
            steps.push(Step {
                step,
                vertices,
                odd,
                odd_share: odd as f64 / vertices as f64,
                mean_window,
                apd: average_plane_distance(&record, &self.original) / self.mean_edge,
                descriptor_seconds,
                partition_seconds,
                removal_seconds,
            });
            window.radius *= settings.growth;
            done += vertices as f64;
            progress((done / total).min(1.0));
        }
        progress(1.0);
        steps
    }
}

/// Vertices of all steps together, if each removes a quarter.
fn expected_work(vertices: usize, levels: u32) -> f64 {
    (0..levels).map(|step| vertices as f64 * 0.75_f64.powi(step as i32)).sum::<f64>().max(1.0)
}
