//! The nodes that put meshes in their places.

use super::trs;
use crate::{
    io::UpAxis,
    mesh::{IDENTITY, Instance},
};
use nalgebra::Matrix3;
use serde_json::{Value, json};

/// The nodes so far.
#[derive(Default)]
pub(super) struct Nodes {
    pub list: Vec<Value>,
    /// Those without parents.
    pub roots: Vec<usize>,
}

/// Axes whose cosine is larger are not at right angles. Files have matrices of float32.
const SKEW: f64 = 1e-5;

impl Nodes {
    /// Adds the place of mesh `mesh` of the document, whose coordinates there are those around `origin`.
    ///
    /// The matrix of a node must be a product of translation, rotation and scales. What shears is no such
    /// matrix, but it is a rotation, scales and another rotation, one node inside another.
    pub fn add(&mut self, instance: &Instance, mesh: usize, origin: [f64; 3]) {
        let transform = around(instance.transform, origin);
        let linear = Matrix3::from_fn(|row, column| transform[row][column]);
        let translation = transform.map(|row| row[3]);
        let mut node = json!({ "mesh": mesh });
        if !instance.name.is_empty() {
            node["name"] = instance.name.as_str().into();
        }
        self.roots.push(self.list.len());
        if is_without_shear(&linear) {
            trs::place(&mut node, &linear, translation);
        } else {
            let svd = linear.svd(true, true);
            let [u, v] = [svd.u, svd.v_t].map(|factor| factor.unwrap_or_else(Matrix3::identity));
            // Two rotations: what mirrors goes into the scales.
            let sign = |m: &Matrix3<f64>| if m.determinant() < 0.0 { -1.0 } else { 1.0 };
            let scales = Matrix3::from_diagonal(&(svd.singular_values * sign(&u) * sign(&v)));
            trs::place(&mut node, &(v * sign(&v)), [0.0; 3]);
            let mut parent = json!({ "children": [self.list.len() + 1] });
            trs::place(&mut parent, &(u * sign(&u) * scales), translation);
            self.list.push(parent);
        }
        self.list.push(node);
    }

    /// Puts all into one node that turns the axis that points up to y.
    pub fn turn(&mut self, up: UpAxis) {
        if up == UpAxis::Y || self.list.is_empty() {
            return;
        }
        let mut node = json!({ "children": self.roots });
        trs::place(&mut node, &Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0), [0.0; 3]);
        self.roots = vec![self.list.len()];
        self.list.push(node);
    }
}

/// The transform of coordinates around `origin`.
fn around(transform: [[f64; 4]; 3], origin: [f64; 3]) -> [[f64; 4]; 3] {
    if origin == [0.0; 3] {
        return transform;
    }
    let identity = IDENTITY.map(|[a, b, c, _]| [a, b, c]);
    if transform.map(|[a, b, c, _]| [a, b, c]) == identity {
        return [0, 1, 2].map(|k| {
            let [a, b, c, d] = transform[k];
            [a, b, c, d + origin[k]]
        });
    }
    transform.map(|[a, b, c, d]| [a, b, c, a * origin[0] + b * origin[1] + c * origin[2] + d])
}

fn is_without_shear(linear: &Matrix3<f64>) -> bool {
    let cosine = |a: usize, b: usize| {
        let (a, b) = (linear.column(a), linear.column(b));
        a.dot(&b).abs() <= SKEW * a.norm() * b.norm()
    };
    cosine(0, 1) && cosine(0, 2) && cosine(1, 2)
}
