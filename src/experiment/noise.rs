//! Artificial noise (section 6 of the paper).

use crate::error::EncodeError;
use crate::mesh::TriMesh;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// Isotropic Gaussian noise on every coordinate.
///
/// The generator is ChaCha8, seeded with `ChaCha8Rng::seed_from_u64(seed)`; normal deviates are those of
/// `rand_distr::StandardNormal`, drawn x, y, z per vertex in the order of the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Standard deviation of each coordinate, in mean edges of the mesh. Default ⅓: one reading of the
    /// paper's "variance magnitude equal to one third of the average edge length".
    pub deviation: f64,
    /// Seed of the generator. Default 1.
    pub seed: u64,
}

impl Default for Noise {
    fn default() -> Self {
        Self { deviation: 1.0 / 3.0, seed: 1 }
    }
}

impl Noise {
    /// `mesh` with noise; `mean_edge` is its mean edge length, model units.
    ///
    /// # Errors
    /// If coordinates leave the range of a double.
    pub fn perturb(&self, mesh: &TriMesh, mean_edge: f64) -> Result<TriMesh, EncodeError> {
        let mut random = ChaCha8Rng::seed_from_u64(self.seed);
        let deviation = self.deviation * mean_edge;
        let positions = mesh.positions().iter().map(|p| {
            p.map(|x| {
                let normal: f64 = StandardNormal.sample(&mut random);
                x + deviation * normal
            })
        });
        TriMesh::new(positions.collect(), mesh.triangles().to_vec()).map_err(|_| EncodeError::BoundingBox)
    }
}
