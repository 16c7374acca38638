//! meshoptimizer: vertex and index codec.

use crate::model::Model;
use crate::stream::fastest;

/// Cells and, as its vertices are a multiple of four bytes, two bytes more.
type Vertex = [u16; 4];

/// Buffers in one of the orders it has.
pub struct Buffers {
    pub vertices: Vec<Vertex>,
    pub indices: Vec<u32>,
}

/// For the vertex cache, or for strips: those compress better.
pub fn reordered(model: &Model, as_strips: bool) -> Buffers {
    let count = model.num_vertices();
    let order = if as_strips { meshopt::optimize_vertex_cache_strip } else { meshopt::optimize_vertex_cache };
    let mut indices = order(&model.indices(), count);
    let vertices: Vec<Vertex> = model.cells.iter().map(|&[x, y, z]| [x, y, z, 0]).collect();
    let vertices = meshopt::optimize_vertex_fetch(&mut indices, &vertices);
    Buffers { vertices, indices }
}

impl Buffers {
    /// As the codecs make it with their defaults, the two one after the other.
    pub fn encode(&self) -> anyhow::Result<[Vec<u8>; 2]> {
        Ok([
            meshopt::encode_vertex_buffer(&self.vertices)?,
            meshopt::encode_index_buffer(&self.indices, self.vertices.len())?,
        ])
    }

    /// As small as they get: for a general compressor behind them.
    pub fn encode_small(&self) -> anyhow::Result<[Vec<u8>; 2]> {
        Ok([
            meshopt::encode_vertex_buffer_level(&self.vertices, 3, None)?,
            meshopt::encode_index_buffer(&self.indices, self.vertices.len())?,
        ])
    }

    /// Vertices per second, one core.
    pub fn decode_speed(&self, encoded: &[Vec<u8>; 2], runs: u32) -> anyhow::Result<f64> {
        let seconds = fastest(runs, || {
            let vertices: Vec<Vertex> = meshopt::decode_vertex_buffer(&encoded[0], self.vertices.len())?;
            let indices: Vec<u32> = meshopt::decode_index_buffer(&encoded[1], self.indices.len())?;
            anyhow::ensure!(vertices.len() == self.vertices.len() && indices.len() == self.indices.len());
            Ok(())
        })?;
        Ok(self.vertices.len() as f64 / seconds)
    }
}
