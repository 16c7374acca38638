//! A mesh as every codec gets it.

use anyhow::ensure;
use lwc::{EncodeOptions, GridChoice, Optimize, TriMesh};
use std::path::Path;

/// A mesh on the grid, cut into an oriented surface.
pub struct Model {
    pub name: String,
    pub bits: u32,
    /// As the file has it: what quality is measured against.
    pub original: TriMesh,
    /// Cells of the vertices, 0 to 2^bits − 1.
    pub cells: Vec<[u16; 3]>,
    pub triangles: Vec<[u32; 3]>,
    /// Where cell 0 is, and the length of a step.
    origin: [f64; 3],
    step: f64,
}

impl Model {
    pub fn read(path: &Path, bits: u32) -> anyhow::Result<Self> {
        let file_name = path.file_name().unwrap_or_default().to_string_lossy();
        let name = file_name.split('.').next().unwrap_or_default().to_owned();
        let original = lwc::io::read(path)?.mesh;
        // Through the codec and back: what it repairs is repaired for all.
        let mut options = EncodeOptions::default();
        options.quantization_bits = bits;
        options.optimize = Optimize::Size;
        // The same grid for all codecs.
        options.grid = GridChoice::Cube;
        let encoded = lwc::encode(&original, &options)?;
        let mesh = lwc::decode(&encoded.bytes, lwc::DecodeOptions::new())?;
        let (origin, step) = (encoded.info.origin(), encoded.info.side() / f64::from((1_u32 << bits) - 1));
        ensure!(step > 0.0, "all vertices are at one place");
        let cell = |p: &[f64; 3]| std::array::from_fn(|a| ((p[a] - origin[a]) / step).round() as u16);
        let cells = mesh.positions().iter().map(cell).collect();
        Ok(Self { name, bits, original, cells, triangles: mesh.triangles().to_vec(), origin, step })
    }

    pub fn num_vertices(&self) -> usize {
        self.cells.len()
    }

    pub fn bits_per_vertex(&self, bytes: usize) -> f64 {
        8.0 * bytes as f64 / self.num_vertices() as f64
    }

    pub fn indices(&self) -> Vec<u32> {
        self.triangles.as_flattened().to_vec()
    }

    /// The cells as coordinates: what a file for another program holds.
    pub fn grid_mesh(&self) -> TriMesh {
        let positions = self.cells.iter().map(|c| c.map(f64::from)).collect();
        TriMesh::new(positions, self.triangles.clone()).unwrap_or_default()
    }

    /// Brings a mesh in cells back to where the original is.
    pub fn place(&self, cells: &TriMesh) -> TriMesh {
        let place = |p: &[f64; 3]| std::array::from_fn(|a| self.origin[a] + p[a] * self.step);
        let positions = cells.positions().iter().map(place).collect();
        TriMesh::new(positions, cells.triangles().to_vec()).unwrap_or_default()
    }

    /// −20·log₁₀ of the root mean square distance of `mesh` from the original over the diagonal.
    pub fn quality(&self, mesh: &TriMesh) -> Option<f64> {
        let options = lwc::metrics::CompareOptions::new();
        lwc::metrics::compare(&self.original, mesh, &options).ok().map(|c| c.psnr_db())
    }
}
