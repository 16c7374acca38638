//! The nodes of a scene: which mesh is where.

use super::json::{Document, Node};
use crate::{
    io::{Place, ReadError, ReadReport},
    mesh::{IDENTITY, Instance},
};

/// An affine map: three rows of a 3 × 3 matrix and a translation.
pub(super) type Transform = [[f64; 4]; 3];

/// The instances of the scene that is to be shown, in the order of a walk over the nodes; of all meshes
/// where they are if there is no scene.
pub(super) fn instances(document: &Document, report: &mut ReadReport) -> Result<Vec<Instance>, ReadError> {
    let index = document.scene.unwrap_or(0);
    let Some(scene) = document.scenes.get(index) else {
        if document.scene.is_some() {
            return Err(ReadError::syntax(Place::Part("scene", index), "does not exist"));
        }
        let instance = |mesh| Instance { mesh, name: String::new(), transform: IDENTITY };
        return Ok((0..document.meshes.len()).map(instance).collect());
    };
    if document.scenes.len() > 1 {
        report.ignore("scenes");
    }
    let mut instances = Vec::new();
    let mut is_visited = vec![false; document.nodes.len()];
    let mut stack: Vec<(usize, Transform)> = scene.nodes.iter().rev().map(|&node| (node, IDENTITY)).collect();
    while let Some((index, parent)) = stack.pop() {
        let place = Place::Part("node", index);
        let node = document.nodes.get(index).ok_or_else(|| ReadError::syntax(place, "does not exist"))?;
        if std::mem::replace(&mut is_visited[index], true) {
            return Err(ReadError::syntax(place, "is in the scene twice"));
        }
        if node.extensions.contains_key("EXT_mesh_gpu_instancing") {
            report.ignore("EXT_mesh_gpu_instancing");
        }
        let transform = product(&parent, &local(node));
        if !transform.iter().flatten().all(|entry| entry.is_finite()) {
            return Err(ReadError::syntax(place, "has a transform that is not finite"));
        }
        if let Some(mesh) = node.mesh {
            if mesh >= document.meshes.len() {
                return Err(ReadError::syntax(place, format!("there is no mesh {mesh}")));
            }
            let name = if node.name.is_empty() { &document.meshes[mesh].name } else { &node.name };
            instances.push(Instance { mesh, name: name.clone(), transform });
        }
        stack.extend(node.children.iter().rev().map(|&child| (child, transform)));
    }
    Ok(instances)
}

fn local(node: &Node) -> Transform {
    if let Some(matrix) = &node.matrix {
        return [0, 1, 2].map(|row| [0, 1, 2, 3].map(|column| matrix[4 * column + row]));
    }
    let [x, y, z, w] = node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]);
    let scale = node.scale.unwrap_or([1.0; 3]);
    let translation = node.translation.unwrap_or_default();
    let rotation = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
        [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
        [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
    ];
    [0, 1, 2].map(|row| {
        let [a, b, c] = [0, 1, 2].map(|column| rotation[row][column] * scale[column]);
        [a, b, c, translation[row]]
    })
}

/// First `b`, then `a`.
fn product(a: &Transform, b: &Transform) -> Transform {
    a.map(|row| {
        [0, 1, 2, 3].map(|column| {
            let sum: f64 = (0..3).map(|k| row[k] * b[k][column]).sum();
            if column == 3 { sum + row[3] } else { sum }
        })
    })
}
