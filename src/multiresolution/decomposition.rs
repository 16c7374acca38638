//! All levels of a mesh, down and up.

use super::hierarchy::{Hierarchy, MeshHierarchy};
use super::lift::Split;
use super::options::{Options, Prediction};
use crate::error::EncodeError;
use crate::mesh::TriMesh;
use glam::DVec3;

/// What of the time finding the levels takes; the rest are details.
const SHARE_OF_LEVELS: f64 = 0.8;

/// A mesh as base mesh and details.
///
/// Its vertices have an order of their own, coarse before fine: M^k has the first ones.
#[derive(Clone, Debug)]
pub struct Decomposition {
    pub(super) hierarchy: Hierarchy,
    /// `splits[k]` turns M^k into M^{k+1}.
    pub(super) splits: Vec<Split>,
    prediction: Prediction,
    /// Positions of M^0.
    pub(super) base: Vec<DVec3>,
    /// `details[k]` belong to `splits[k]`: along x, y, z of the frames.
    pub(super) details: Vec<Vec<DVec3>>,
    /// The mesh that was decomposed, and for each vertex here the one there.
    pub(super) input: TriMesh,
    pub(super) source: Vec<u32>,
    /// Positions and details are kept times this power of two, so that squares neither overflow nor vanish.
    pub(super) unit: f64,
}

impl Decomposition {
    /// Decomposes `mesh`. Where it is no oriented surface, vertices are repeated inside and put
    /// together again in the end.
    ///
    /// # Errors
    /// If the mesh has no usable triangle, or spans more than a double can hold.
    pub fn new(mesh: &TriMesh, options: &Options) -> Result<Self, EncodeError> {
        Self::new_with_progress(mesh, options, &|_| ())
    }

    /// As [`Decomposition::new`], telling `progress` after each level which share of the work is done, 0 to 1.
    ///
    /// # Errors
    /// As [`Decomposition::new`].
    pub fn new_with_progress(
        mesh: &TriMesh,
        options: &Options,
        progress: &dyn Fn(f64),
    ) -> Result<Self, EncodeError> {
        let of_levels = |done: f64| progress(done * SHARE_OF_LEVELS);
        let MeshHierarchy { hierarchy, source, unit } = Hierarchy::of_mesh(mesh, options, &of_levels)?;
        let place = |&v: &u32| DVec3::from_array(mesh.positions()[v as usize]) * unit;
        let positions = source.iter().map(place).collect();
        let of_details = |done: f64| progress(SHARE_OF_LEVELS + done * (1.0 - SHARE_OF_LEVELS));
        let Options { prediction, update, .. } = *options;
        let mut decomposition = Self::of_hierarchy(hierarchy, positions, prediction, update, &of_details);
        decomposition.input = mesh.clone();
        decomposition.source = source;
        decomposition.unit = unit;
        Ok(decomposition)
    }

    /// Analyses positions of the finest level; `input`, `source` and `unit` are left to the caller. Tells `progress`
    /// after each level which share is done.
    pub(super) fn of_hierarchy(
        hierarchy: Hierarchy,
        positions: Vec<DVec3>,
        prediction: Prediction,
        update: bool,
        progress: &dyn Fn(f64),
    ) -> Self {
        let num_vertices = positions.len().max(1) as f64;
        let mut positions = positions;
        let mut masses = vec![1.0; positions.len()];
        let (mut splits, mut details) = (Vec::new(), Vec::new());
        for k in (0..hierarchy.num_levels()).rev() {
            let mut split = Split::new(&hierarchy, k, &positions);
            if update {
                split.set_update(&mut masses);
            }
            details.push(split.analyse(hierarchy.triangles(k), prediction, &mut positions));
            splits.push(split);
            progress(1.0 - positions.len() as f64 / num_vertices);
        }
        progress(1.0);
        splits.reverse();
        details.reverse();
        let (input, source, unit) = (TriMesh::default(), Vec::new(), 1.0);
        Self { hierarchy, splits, prediction, base: positions, details, input, source, unit }
    }

    /// Number of levels above the base mesh.
    pub fn num_levels(&self) -> usize {
        self.splits.len()
    }

    /// Vertices of M^`level`.
    ///
    /// # Panics
    /// If there is no such level.
    pub fn num_vertices(&self, level: usize) -> usize {
        self.hierarchy.num_vertices(level)
    }

    /// Details that turn M^{level−1} into M^`level`, in model units: two components along the surface, then
    /// the one across it. `level`: 1 to [`num_levels`](Self::num_levels).
    ///
    /// # Panics
    /// If there is no such level.
    pub fn details(&self, level: usize) -> impl ExactSizeIterator<Item = [f64; 3]> {
        self.details[level - 1].iter().map(|d| (*d / self.unit).to_array())
    }

    /// Multiplies the details of a level: 0 removes its features, 2 exaggerates them.
    ///
    /// Components along the surface say where a vertex lies on it rather than what shape it has; they are
    /// never enlarged, as faces would fold over.
    ///
    /// # Panics
    /// If there is no such level.
    pub fn scale_details(&mut self, level: usize, factor: f64) {
        let along = factor.clamp(-1.0, 1.0);
        self.details[level - 1].iter_mut().for_each(|d| *d *= DVec3::new(along, along, factor));
    }

    /// Root mean square of the details of a level, model units.
    ///
    /// # Panics
    /// If there is no such level.
    pub fn rms(&self, level: usize) -> f64 {
        let details = &self.details[level - 1];
        let sum: f64 = details.iter().map(|d| d.length_squared()).sum();
        (sum / details.len().max(1) as f64).sqrt() / self.unit
    }

    /// Positions of M^`level` as the details make it.
    pub(super) fn positions(&self, level: usize) -> Vec<DVec3> {
        let mut positions = self.base.clone();
        for k in 0..level {
            self.splits[k].synthesise(
                self.hierarchy.triangles(k),
                self.prediction,
                &self.details[k],
                &mut positions,
            );
        }
        positions
    }

    /// A position as the caller knows it; what overflows there, by huge gains, ends at the last number.
    pub(super) fn model_position(&self, position: DVec3) -> [f64; 3] {
        (position / self.unit).to_array().map(|x| if x.is_nan() { 0.0 } else { x.clamp(-f64::MAX, f64::MAX) })
    }

    /// M^`level` as a mesh, its vertices in the order of the decomposition.
    ///
    /// # Panics
    /// If there is no such level.
    pub fn level_mesh(&self, level: usize) -> TriMesh {
        let positions = self.positions(level).iter().map(|&p| self.model_position(p)).collect();
        TriMesh::from_valid_parts(positions, self.hierarchy.triangles(level).to_vec())
    }

    /// The finest mesh as the details make it, with the vertices and faces of the mesh decomposed, in their
    /// order. Vertices without usable faces stay; one that had to be repeated is the mean of its copies.
    pub fn reconstruct(&self) -> TriMesh {
        let mut sums = vec![(DVec3::ZERO, 0.0); self.input.num_vertices()];
        for (&v, position) in self.source.iter().zip(self.positions(self.num_levels())) {
            let (sum, count) = &mut sums[v as usize];
            *sum += position;
            *count += 1.0;
        }
        let placed = sums.iter().zip(self.input.positions());
        let positions = placed
            .map(|(&(sum, count), &old)| if count > 0.0 { self.model_position(sum / count) } else { old });
        TriMesh::from_valid_parts(positions.collect(), self.input.triangles().to_vec())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_update_keeps_the_mean() {
        let n = 24_u32;
        let height = |i: u32| f64::from(i * i % 17) * 0.1;
        let positions = (0..n * n).map(|i| [f64::from(i % n), f64::from(i / n), height(i)]).collect();
        let cells = (0..n * (n - 1)).filter(|i| i % n + 1 < n);
        let triangles = cells.flat_map(|i| [[i, i + 1, i + n + 1], [i, i + n + 1, i + n]]).collect();
        let mesh = TriMesh::new(positions, triangles).unwrap();
        let options = Options { prediction: Prediction::Flat, update: true, ..Options::default() };
        let mut decomposition = Decomposition::new(&mesh, &options).unwrap();
        assert!(decomposition.num_levels() > 3);
        let mut masses = vec![1.0; mesh.num_vertices()];
        for split in decomposition.splits.iter_mut().rev() {
            split.set_update(&mut masses);
        }
        let base = decomposition.base.iter().map(|&p| p / decomposition.unit);
        let coarse: DVec3 = masses.iter().zip(base).map(|(&m, p)| p * m).sum();
        let fine: DVec3 = mesh.positions().iter().map(|&p| DVec3::from_array(p)).sum();
        assert!((coarse - fine).length() < 1e-10 * fine.length());
        assert!((masses.iter().sum::<f64>() - f64::from(n * n)).abs() < 1e-9);
        let sampled: DVec3 = masses
            .iter()
            .zip(&decomposition.source)
            .map(|(&m, &v)| DVec3::from_array(mesh.positions()[v as usize]) * m)
            .sum();
        assert!((sampled - fine).length() > 1e-6 * fine.length(), "without update it is another");
    }
}
