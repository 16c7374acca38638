//! What all readers do with vertices and faces once they have them.

use super::{MeshFile, ReadError, ReadReport};
use crate::mesh::TriMesh;

/// How many different names of ignored things a report lists: a damaged text has a new one on every line.
const MAX_IGNORED_NAMES: usize = 64;

/// A mesh and its report while they are read.
#[derive(Default)]
pub(super) struct MeshBuilder {
    pub positions: Vec<[f64; 3]>,
    pub triangles: Vec<[u32; 3]>,
    pub report: ReadReport,
}

impl MeshBuilder {
    /// Adds a face of any number of corners as the fan of its first one.
    pub fn push_polygon(&mut self, corners: &[u32]) {
        match *corners {
            [a, b, c] => self.triangles.push([a, b, c]),
            [first, ref rest @ ..] if rest.len() > 2 => {
                self.triangles.extend(rest.windows(2).map(|edge| [first, edge[0], edge[1]]));
                self.report.polygons_triangulated += 1;
            }
            _ => self.report.faces_skipped += 1,
        }
    }

    /// Adds a triangle strip. Every second triangle of a strip has the opposite winding.
    pub fn push_strip(&mut self, corners: &[u32]) {
        let turned =
            |(k, t): (usize, &[u32])| if k % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] };
        self.triangles.extend(corners.windows(3).enumerate().map(turned));
    }

    pub fn finish(self) -> Result<MeshFile, ReadError> {
        Ok(MeshFile { mesh: TriMesh::new(self.positions, self.triangles)?, report: self.report })
    }
}

impl ReadReport {
    /// Notes that something called `name` was left out.
    pub(super) fn ignore(&mut self, name: &str) {
        if self.ignored.len() < MAX_IGNORED_NAMES && !self.ignored.iter().any(|known| known == name) {
            self.ignored.push(name.to_owned());
        }
    }
}
