//! What the folder of an experiment holds: `results.json`, from which it can go on, and the same as
//! `results.csv`, one line per step.

use anyhow::Context;
use lwc::descriptors::Descriptor;
use lwc::experiment::{Noise, Settings, Step, Units};
use serde::{Deserialize, Serialize};
use std::io;
use std::path::{Path, PathBuf};

const JSON: &str = "results.json";
const CSV: &str = "results.csv";

/// All runs that were made with the same settings.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub struct Results {
    pub parameters: Parameters,
    pub runs: Vec<Run>,
}

/// Settings that all runs of a folder share.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Parameters {
    pub levels: u32,
    pub rings: u32,
    pub radius: f64,
    pub growth: f64,
    pub units: Units,
    pub normals: String,
    pub pca_quadric: String,
}

impl From<&Settings> for Parameters {
    fn from(settings: &Settings) -> Self {
        Self {
            levels: settings.levels,
            rings: settings.window.rings,
            radius: settings.window.radius,
            growth: settings.growth,
            units: settings.units,
            normals: settings.readings.normals.name().into(),
            pca_quadric: settings.readings.pca_quadric.name().into(),
        }
    }
}

/// What a run is about; no two runs of a folder have the same.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Subject {
    /// Name of the file without folder and endings.
    pub mesh: String,
    pub vertices: usize,
    pub faces: usize,
    /// CRC-32 of coordinates and indices, little-endian, so that another mesh of the same name is another.
    pub checksum: u32,
    /// Standard deviation of the noise in mean edges, and its seed.
    pub noise: Option<(f64, u64)>,
}

impl Subject {
    pub fn new(path: &Path, mesh: &lwc::TriMesh, noise: Option<Noise>) -> Self {
        let mut hash = crc32fast::Hasher::new();
        mesh.positions().iter().flatten().for_each(|x| hash.update(&x.to_le_bytes()));
        mesh.triangles().iter().flatten().for_each(|v| hash.update(&v.to_le_bytes()));
        let name = crate::cli::output::without_mesh_ending(path);
        Self {
            mesh: name.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            vertices: mesh.num_vertices(),
            faces: mesh.num_triangles(),
            checksum: hash.finalize(),
            noise: noise.map(|noise| (noise.deviation, noise.seed)),
        }
    }

    /// Name for people and files.
    pub fn title(&self) -> String {
        let Self { mesh, .. } = self;
        match self.noise {
            None => mesh.clone(),
            Some((deviation, seed)) => {
                let usual = Noise::default();
                let is_usual = (deviation, seed) == (usual.deviation, usual.seed);
                if is_usual { format!("{mesh}-noise") } else { format!("{mesh}-noise-{deviation}-{seed}") }
            }
        }
    }
}

/// One mesh with one descriptor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Run {
    #[serde(flatten)]
    pub subject: Subject,
    pub descriptor: String,
    pub steps: Vec<Step>,
}

impl Run {
    fn mean(&self, value: impl Fn(&Step) -> f64) -> f64 {
        self.steps.iter().map(value).sum::<f64>() / self.steps.len().max(1) as f64
    }

    /// Mean of the average plane distances of all steps.
    pub fn mean_apd(&self) -> f64 {
        self.mean(|step| step.apd)
    }

    /// Average plane distance at a number of vertices: between two steps along a straight line of
    /// logarithms, the nearest step outside.
    pub fn apd_at(&self, vertices: f64) -> f64 {
        let pairs = self.steps.iter().zip(self.steps.iter().skip(1));
        for (fine, coarse) in pairs {
            let [from, to] = [fine, coarse].map(|step| step.vertices as f64);
            if (to..=from).contains(&vertices) && fine.apd > 0.0 && coarse.apd > 0.0 {
                let share = (from / vertices).ln() / (from / to).ln();
                return fine.apd * (coarse.apd / fine.apd).powf(share);
            }
        }
        let distance = |step: &&Step| (step.vertices as f64 / vertices).ln().abs();
        let nearest = self.steps.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest.map_or(0.0, |step| step.apd)
    }

    pub fn mean_odd_share(&self) -> f64 {
        self.mean(|step| step.odd_share)
    }

    pub fn descriptor_seconds(&self) -> f64 {
        self.steps.iter().map(|step| step.descriptor_seconds).sum()
    }

    pub fn seconds(&self) -> f64 {
        let all = |step: &Step| step.descriptor_seconds + step.partition_seconds + step.removal_seconds;
        self.steps.iter().map(all).sum()
    }
}

impl Results {
    /// Reads what `folder` holds, or begins anew.
    ///
    /// # Errors
    /// If the folder cannot be made or read, or holds an experiment with other settings.
    pub fn open(folder: &Path, parameters: Parameters) -> anyhow::Result<Self> {
        std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
        let path = folder.join(JSON);
        let text = match std::fs::read(&path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                return Ok(Self { parameters, runs: Vec::new() });
            }
            text => text.with_context(|| path.display().to_string())?,
        };
        let results: Self = serde_json::from_slice(&text)
            .with_context(|| format!("{}: not the results of an experiment", path.display()))?;
        if results.parameters != parameters {
            let what = "it holds an experiment with other settings; choose another folder";
            let error = crate::cli::exit::Failure::Usage(what.into());
            return Err(error).with_context(|| folder.display().to_string());
        }
        Ok(results)
    }

    pub fn contains(&self, subject: &Subject, descriptor: Descriptor) -> bool {
        self.runs.iter().any(|run| run.subject == *subject && run.descriptor == descriptor.name())
    }

    /// Writes both files; each appears complete or not at all.
    ///
    /// # Errors
    /// If they cannot be written.
    pub fn save(&self, folder: &Path) -> anyhow::Result<()> {
        let write = |name: &str, text: Vec<u8>| {
            let path: PathBuf = folder.join(name);
            let written: io::Result<()> = lwc::io::write_atomic(&path, |out| out.write_all(&text));
            written.with_context(|| path.display().to_string())
        };
        write(JSON, serde_json::to_vec_pretty(self)?)?;
        write(CSV, self.to_csv()?)
    }

    fn to_csv(&self) -> anyhow::Result<Vec<u8>> {
        let mut table = Vec::from("mesh,noise_deviation,noise_seed,descriptor,step,vertices,odd,odd_share,");
        table.extend(b"mean_window,apd,descriptor_seconds,partition_seconds,removal_seconds\n");
        let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(table);
        for run in &self.runs {
            for step in &run.steps {
                let (noise, mesh) = (run.subject.noise, &run.subject.mesh);
                let values = (step.step, step.vertices, step.odd, step.odd_share, step.mean_window, step.apd);
                let seconds = (step.descriptor_seconds, step.partition_seconds, step.removal_seconds);
                let noise = (noise.map(|n| n.0), noise.map(|n| n.1));
                writer.serialize((mesh, noise, &run.descriptor, values, seconds))?;
            }
        }
        Ok(writer.into_inner()?)
    }

    /// Subjects in the order of their first runs, each with its runs.
    pub fn by_subject(&self) -> Vec<(&Subject, Vec<&Run>)> {
        let mut groups: Vec<(&Subject, Vec<&Run>)> = Vec::new();
        for run in &self.runs {
            match groups.iter_mut().find(|(subject, _)| **subject == run.subject) {
                Some((_, runs)) => runs.push(run),
                None => groups.push((&run.subject, vec![run])),
            }
        }
        for (_, runs) in &mut groups {
            let place = |run: &&Run| Descriptor::ALL.iter().position(|d| d.name() == run.descriptor);
            runs.sort_by_key(place);
        }
        groups
    }
}
