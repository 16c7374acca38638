//! The nodes of a scene: which mesh is where.

use super::{
    accessor::Store,
    gpu_instances,
    json::{Document, Node},
    placement::{Transform, placement},
};
use crate::{
    io::{Place, ReadError, ReadReport},
    mesh::{IDENTITY, Instance},
};

/// The instances of the scene that is to be shown, in the order of a walk over the nodes; of all meshes
/// where they are if there is no scene.
///
/// A node without a name has that of the nearest ancestor with one, if that holds nothing else; else that of its
/// mesh, or else that of the ancestor anyway.
pub(super) fn instances(
    document: &Document,
    store: &mut Store,
    report: &mut ReadReport,
) -> Result<Vec<Instance>, ReadError> {
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
    let mut copies = Copies::of(store.num_bytes());
    let mut is_visited = vec![false; document.nodes.len()];
    let visit = |&node: &usize| Visit { node, parent: IDENTITY, named: None };
    let mut stack: Vec<Visit> = scene.nodes.iter().rev().map(visit).collect();
    while let Some(Visit { node: index, parent, named }) = stack.pop() {
        let place = Place::Part("node", index);
        let node = document.nodes.get(index).ok_or_else(|| ReadError::syntax(place, "does not exist"))?;
        if std::mem::replace(&mut is_visited[index], true) {
            return Err(ReadError::syntax(place, "is in the scene twice"));
        }
        let transform = product(&parent, &local(node));
        check_finite(&transform, place)?;
        let named =
            if node.name.is_empty() { named } else { Some(Ancestor { name: &node.name, is_alone: true }) };
        if let Some(mesh) = node.mesh {
            let Some(of_mesh) = document.meshes.get(mesh).map(|mesh| mesh.name.as_str()) else {
                return Err(ReadError::syntax(place, format!("there is no mesh {mesh}")));
            };
            let name = named.map_or("", |ancestor| ancestor.name);
            let is_named = named.is_some_and(|ancestor| ancestor.is_alone) || of_mesh.is_empty();
            let name = if is_named { name } else { of_mesh };
            let is_own = !node.name.is_empty() && node.name == name;
            let mut instance = |transform, is_copy: bool| {
                let name = if is_copy { copies.copy(name) } else { name };
                Instance { mesh, name: name.to_owned(), transform }
            };
            match &node.extensions.instancing {
                None => instances.push(instance(transform, !is_own)),
                Some(instancing) => {
                    let transforms = gpu_instances::transforms(instancing, name, place, store, report)?;
                    for own in transforms {
                        let transform = product(&transform, &own);
                        check_finite(&transform, place)?;
                        instances.push(instance(transform, true));
                    }
                }
            }
        }
        let is_only = node.children.len() == 1 && node.mesh.is_none();
        let named = named.map(|ancestor| Ancestor { is_alone: ancestor.is_alone && is_only, ..ancestor });
        stack.extend(node.children.iter().rev().map(|&node| Visit { node, parent: transform, named }));
    }
    if copies.is_spent {
        report.ignore("names that too many nodes share");
    }
    Ok(instances)
}

/// Names that instances have of others than their node, and what they may take: many nodes may share a long one.
struct Copies {
    num_left: usize,
    is_spent: bool,
}

impl Copies {
    /// Bytes of such names for each byte of the file, and in any file.
    const PER_BYTE: usize = 4;
    const LEAST: usize = 1 << 20;

    /// For a file of this many bytes.
    fn of(num_bytes: usize) -> Self {
        Self { num_left: num_bytes.saturating_mul(Self::PER_BYTE).max(Self::LEAST), is_spent: false }
    }

    /// The name, or none if that is too much.
    fn copy<'a>(&mut self, name: &'a str) -> &'a str {
        match self.num_left.checked_sub(name.len()) {
            Some(num_left) => {
                self.num_left = num_left;
                name
            }
            None => {
                self.is_spent = true;
                ""
            }
        }
    }
}

/// A node that is yet to be visited.
struct Visit<'a> {
    node: usize,
    parent: Transform,
    named: Option<Ancestor<'a>>,
}

/// The nearest node above, or the node itself, that has a name.
#[derive(Clone, Copy)]
struct Ancestor<'a> {
    name: &'a str,
    /// Whether it holds nothing but one mesh: its name is that of the mesh there.
    is_alone: bool,
}

fn check_finite(transform: &Transform, place: Place) -> Result<(), ReadError> {
    if transform.iter().flatten().all(|entry| entry.is_finite()) {
        return Ok(());
    }
    Err(ReadError::syntax(place, "has a transform that is not finite"))
}

fn local(node: &Node) -> Transform {
    match &node.matrix {
        Some(matrix) => [0, 1, 2].map(|row| [0, 1, 2, 3].map(|column| matrix[4 * column + row])),
        None => placement(
            node.translation.unwrap_or_default(),
            node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]),
            node.scale.unwrap_or([1.0; 3]),
        ),
    }
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
