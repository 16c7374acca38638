//! The whole document.

use super::{container::Container, nodes::Nodes, primitives::Meshes};
use crate::{
    io::{Scene, WriteError, WriteOptions},
    losses::{Loss, LossKind, Losses, Stage},
    mesh::{Attributes, IDENTITY, Instance, TriMesh},
};
use serde_json::{Value, json};
use std::io::Write;

/// A file that can be written.
pub(in crate::io) struct Plan {
    document: Value,
    buffer: Vec<u8>,
}

impl Plan {
    /// The document of `mesh` and those of its (valid) attributes that glTF can hold. Says what is lost.
    ///
    /// # Errors
    /// If the mesh has no triangles, is too far away, or has too many vertices after splitting.
    pub fn new(
        mesh: &TriMesh,
        attributes: &Attributes,
        options: &WriteOptions,
        losses: &mut Losses,
    ) -> Result<Self, WriteError> {
        check_triangles(mesh.num_triangles() > 0)?;
        let mut meshes = Meshes::default();
        meshes.carry(attributes.gltf_materials.as_ref());
        let origin = meshes.add(mesh, attributes, options.step, options)?;
        meshes.describe(attributes);
        let mut nodes = Nodes::default();
        nodes.add(&Instance { mesh: 0, name: String::new(), transform: IDENTITY }, 0, origin);
        Ok(Self::finish(meshes, nodes, options, losses))
    }

    /// The document of the meshes of a scene, each in its places.
    ///
    /// # Errors
    /// As [`Plan::new`].
    pub fn of_scene(scene: &Scene, options: &WriteOptions, losses: &mut Losses) -> Result<Self, WriteError> {
        let mut meshes = Meshes::default();
        meshes.carry(scene.gltf_materials.as_ref());
        let mut written = vec![None; scene.meshes.len()];
        for (index, file) in scene.meshes.iter().enumerate() {
            if file.mesh.num_triangles() > 0 {
                let step = scene.step_of(index, options.step);
                let origin = meshes.add(&file.mesh, &file.attributes, step, options)?;
                meshes.describe(&file.attributes);
                written[index] = Some((meshes.list.len() - 1, origin));
            }
        }
        check_triangles(!meshes.list.is_empty())?;
        let num_empty = written.iter().filter(|mesh| mesh.is_none()).count();
        if num_empty > 0 {
            let loss = Loss::new(Stage::Writing, LossKind::Dropped, "meshes without triangles");
            losses.push(loss.count(num_empty));
        }
        let mut nodes = Nodes::default();
        for instance in &scene.instances {
            if let Some((mesh, origin)) = written.get(instance.mesh).copied().flatten() {
                nodes.add(instance, mesh, origin);
            }
        }
        Ok(Self::finish(meshes, nodes, options, losses))
    }

    fn finish(meshes: Meshes, mut nodes: Nodes, options: &WriteOptions, losses: &mut Losses) -> Self {
        losses.append(meshes.losses);
        nodes.turn(options.up);
        let mut document = json!({
            "asset": { "version": "2.0", "generator": "lwc" },
            "meshes": meshes.list,
            "buffers": [{ "byteLength": meshes.buffer.bytes.len() }],
            "bufferViews": meshes.buffer.views,
            "accessors": meshes.buffer.accessors,
        });
        if !meshes.metadata.is_empty() {
            document["asset"]["extras"] = meshes.metadata.into();
        }
        // Lists may not be empty.
        if !nodes.roots.is_empty() {
            document["scene"] = 0.into();
            document["scenes"] = json!([{ "nodes": nodes.roots }]);
            document["nodes"] = nodes.list.into();
        }
        if !meshes.materials.is_empty() {
            document["materials"] = meshes.materials.into();
        }
        for (name, list) in meshes.lists {
            document[name] = list;
        }
        Self { document, buffer: meshes.buffer.bytes }
    }

    /// Writes the file.
    ///
    /// # Errors
    /// If `out` fails, or that is too much for the container.
    pub fn write(mut self, out: &mut impl Write, container: Container) -> Result<(), WriteError> {
        container.write(out, &mut self.document, &self.buffer)
    }
}

fn check_triangles(has_some: bool) -> Result<(), WriteError> {
    let message = "glTF has no meshes without triangles".to_owned();
    if has_some { Ok(()) } else { Err(WriteError::Unrepresentable { message }) }
}
