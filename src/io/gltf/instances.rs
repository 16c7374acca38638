//! The nodes that put meshes in their places.

use crate::mesh::{IDENTITY, Instance};
use nalgebra::Matrix3;
use serde_json::{Value, json};

/// The nodes so far.
#[derive(Default)]
pub(super) struct Nodes {
    pub(super) list: Vec<Value>,
    /// Those without parents.
    pub(super) roots: Vec<usize>,
}

/// Axes whose cosine is larger are not at right angles. Files have matrices of float32.
const SKEW: f64 = 1e-5;

impl Nodes {
    /// Adds the place of mesh `mesh` of the document.
    ///
    /// The matrix of a node must be a product of translation, rotation and scales. What shears is no such
    /// matrix, but it is a rotation, scales and another rotation, one node inside another.
    pub(super) fn add(&mut self, instance: &Instance, mesh: usize) {
        let transform = instance.transform;
        let linear = Matrix3::from_fn(|row, column| transform[row][column]);
        let mut node = json!({ "mesh": mesh });
        if !instance.name.is_empty() {
            node["name"] = instance.name.as_str().into();
        }
        if transform == IDENTITY {
            self.roots.push(self.list.len());
        } else if is_without_shear(&linear) {
            node["matrix"] = matrix(&linear, transform.map(|row| row[3]));
            self.roots.push(self.list.len());
        } else {
            let svd = linear.svd(true, true);
            let [u, v] = [svd.u, svd.v_t].map(|factor| factor.unwrap_or_else(Matrix3::identity));
            // Two rotations: what mirrors goes into the scales.
            let sign = |m: &Matrix3<f64>| if m.determinant() < 0.0 { -1.0 } else { 1.0 };
            let scales = Matrix3::from_diagonal(&(svd.singular_values * sign(&u) * sign(&v)));
            node["matrix"] = matrix(&(v * sign(&v)), [0.0; 3]);
            let parent = self.list.len();
            self.roots.push(parent);
            self.list.push(json!({
                "matrix": matrix(&(u * sign(&u) * scales), transform.map(|row| row[3])),
                "children": [parent + 1],
            }));
        }
        self.list.push(node);
    }
}

fn is_without_shear(linear: &Matrix3<f64>) -> bool {
    let cosine = |a: usize, b: usize| {
        let (a, b) = (linear.column(a), linear.column(b));
        a.dot(&b).abs() <= SKEW * a.norm() * b.norm()
    };
    cosine(0, 1) && cosine(0, 2) && cosine(1, 2)
}

/// Column by column, as glTF has it.
fn matrix(linear: &Matrix3<f64>, translation: [f64; 3]) -> Value {
    let column = |k: usize| [linear[(0, k)], linear[(1, k)], linear[(2, k)], 0.0];
    let [x, y, z] = translation;
    [column(0), column(1), column(2), [x, y, z, 1.0]].concat().into()
}
