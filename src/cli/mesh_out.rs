//! A decoded mesh on its way into a file.

use super::output::Destination;
use anyhow::Context;
use lwc::TriMesh;
use lwc::io::{Format, Scene, WriteError, WriteOptions};
use lwc::losses::Losses;
use lwc::mesh::Attributes;

/// A mesh, or the scene that it is, and how it is written.
pub struct MeshOut<'a> {
    mesh: &'a TriMesh,
    attributes: &'a Attributes,
    scene: Option<Scene>,
    options: WriteOptions,
    format: Format,
}

impl<'a> MeshOut<'a> {
    /// # Errors
    /// If the meshes of the scene repeat names out of proportion.
    pub fn new(
        (mesh, attributes): (&'a TriMesh, &'a Attributes),
        options: WriteOptions,
        format: Format,
    ) -> anyhow::Result<Self> {
        let scene = Scene::unpack(mesh, attributes)?;
        Ok(Self { mesh, attributes, scene, options, format })
    }

    /// What the file will not have. Nothing is written.
    ///
    /// # Errors
    /// If the format cannot hold the mesh.
    pub fn losses(&self) -> Result<Losses, WriteError> {
        match &self.scene {
            Some(scene) => self.options.losses_of_scene(scene, self.format),
            None => self.options.losses_of(self.mesh, self.attributes, self.format),
        }
    }

    /// Writes the file, and gives what it does not have.
    ///
    /// # Errors
    /// If it cannot be written, with its name.
    pub fn write(&self, destination: &Destination) -> anyhow::Result<Losses> {
        let Destination::File(path) = destination else { return self.write_to_stdout(destination) };
        let written = match &self.scene {
            Some(scene) => self.options.write_scene(path, scene),
            None => self.options.write(path, self.mesh, self.attributes),
        };
        written.with_context(|| destination.name())
    }

    fn write_to_stdout(&self, destination: &Destination) -> anyhow::Result<Losses> {
        let mut losses = Losses::default();
        destination.write(|out| {
            losses = match &self.scene {
                Some(scene) => self.options.write_scene_to(out, scene, self.format)?,
                None => self.options.write_to(out, self.mesh, self.attributes, self.format)?,
            };
            Ok::<(), WriteError>(())
        })?;
        Ok(losses)
    }
}
