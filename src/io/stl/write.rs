//! Writing STL, in binary.

use super::binary::{HEADER_BYTES, TRIANGLE_BYTES};
use crate::{
    io::{
        WriteError,
        convert::{check_float32, loss_of, rounding},
    },
    losses::{Loss, LossKind, Losses, Stage},
    mesh::{Attributes, TriMesh},
};
use std::io::{self, Write};

/// A file that can be written: triangles, each with its own corners as float32.
pub(in crate::io) struct Plan<'a> {
    mesh: &'a TriMesh,
}

impl<'a> Plan<'a> {
    /// Says what is lost.
    ///
    /// # Errors
    /// If a coordinate or the number of triangles is too large.
    pub fn new(mesh: &'a TriMesh, attributes: &Attributes, losses: &mut Losses) -> Result<Self, WriteError> {
        check_float32(mesh, "STL")?;
        let loss = |kind, subject: &str| Loss::new(Stage::Writing, kind, subject);
        let names = attributes.list.iter().map(|attribute| attribute.name.as_str());
        let libraries = attributes.material_libraries.first().map(|_| "mtllib");
        let dropped = names.chain(libraries).map(|name| loss(LossKind::Dropped, name));
        dropped.for_each(|loss| losses.push(loss.remedy("STL has triangles only")));
        let remedy = "PLY and OBJ keep them, GLB around an origin of its own";
        losses.append(rounding(mesh, [0.0; 3]).map(|r| loss_of(r, mesh, remedy)).into_iter().collect());
        let (num_used, num_corners) = (num_used(mesh), 3 * mesh.num_triangles());
        if num_used < mesh.num_vertices() {
            let isolated = loss(LossKind::Dropped, "isolated vertices");
            losses.push(isolated.count(mesh.num_vertices() - num_used));
        }
        if num_corners > num_used {
            losses.push(loss(LossKind::VerticesSplit, "").count(num_corners - num_used));
        }
        Ok(Self { mesh })
    }

    /// Writes the file.
    ///
    /// # Errors
    /// If `out` fails.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        // Must not begin with `solid`, the mark of a text.
        let mut header = [b' '; HEADER_BYTES];
        header[..10].copy_from_slice(b"binary STL");
        header[80..].copy_from_slice(&(self.mesh.num_triangles() as u32).to_le_bytes());
        out.write_all(&header)?;
        for triangle in self.mesh.triangles() {
            let corners = triangle.map(|index| self.mesh.positions()[index as usize]);
            let vectors = [unit_normal(corners), corners[0], corners[1], corners[2]];
            let mut record = [0; TRIANGLE_BYTES];
            let floats = vectors.as_flattened().iter().flat_map(|&c| (c as f32).to_le_bytes());
            for (byte, value) in record.iter_mut().zip(floats) {
                *byte = value;
            }
            out.write_all(&record)?;
        }
        Ok(())
    }
}

/// Vertices of triangles.
fn num_used(mesh: &TriMesh) -> usize {
    let mut is_used = vec![false; mesh.num_vertices()];
    mesh.triangles().as_flattened().iter().for_each(|&vertex| is_used[vertex as usize] = true);
    is_used.iter().filter(|&&is_used| is_used).count()
}

/// Counter-clockwise normal, zero for a triangle without area.
fn unit_normal([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    let edge = |end: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| end[k] - a[k]) };
    let (u, v) = (edge(b), edge(c));
    let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let length = cross.iter().map(|c| c * c).sum::<f64>().sqrt();
    if length > 0.0 { cross.map(|c| c / length) } else { [0.0; 3] }
}
