//! A mesh that was in a file, and what reading leaves out.

use crate::mesh::{Attributes, TriMesh};

/// What a file held: the mesh, and what was changed or left out on the way.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct MeshFile {
    /// Vertices in the order of the file, unused ones included; triangles in the order of the file.
    pub mesh: TriMesh,
    /// Normals, texture coordinates, colours, materials and whatever else the file has; valid for the mesh.
    pub attributes: Attributes,
    /// What was changed or left out.
    pub report: ReadReport,
}

/// What a reader changed or left out. Degenerate triangles (a repeated index) are *not* left out.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct ReadReport {
    /// Faces of four or more corners that were cut into triangles.
    pub polygons_triangulated: usize,
    /// Of these, the ones whose triangles overlap: they cross themselves, or have thousands of corners and are not
    /// convex. They were cut into the fan of their first corner.
    pub polygons_overlapping: usize,
    /// Faces of fewer than three corners, left out.
    pub faces_skipped: usize,
    /// STL and glTF: corners or vertices that were joined with an earlier one at exactly the same place.
    pub corners_welded: usize,
    /// LAS only: points that are no vertices, because they lie above another, are not the last return, or were
    /// thinned out.
    pub points_left_out: usize,
    /// LAS only: points flagged as withheld, which counts as deleted. They are left out.
    pub points_withheld: usize,
    /// LAS only: points whose colours are of 8 bits in fields of 16, and are kept as 8 bits.
    pub colours_of_8_bits: usize,
    /// Names that are others in the mesh, each once, as `height above (height_above)`.
    pub renamed: Vec<String>,
    /// Names of what was in the file and is neither in the mesh nor in the attributes, each once, in order of
    /// appearance: OBJ statements (`l`), PLY properties that are lists (`vertex.bones`) and elements (`edge`), or a few
    /// words where it has no name (`2 bytes after the last triangle`).
    pub ignored: Vec<String>,
}
