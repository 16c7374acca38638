//! The instances of the meshes of a scene.

/// A mesh in its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    /// Zero-based index of the mesh in its scene.
    pub mesh: usize,
    /// The name of the node, or of its mesh; may be empty.
    pub name: String,
    /// Three rows of a 3 × 3 matrix and a translation, from the coordinates of the mesh to those of the scene.
    pub transform: [[f64; 4]; 3],
}

/// The transform that changes nothing.
pub const IDENTITY: [[f64; 4]; 3] = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];

/// What a stream says about a scene: its meshes share the stream's grid, each times a power of two.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneTable {
    /// One per mesh: its own coordinates times 2 to this power are those of the stream.
    pub exponents: Vec<i8>,
    /// The instances of the meshes.
    pub instances: Vec<Instance>,
}
