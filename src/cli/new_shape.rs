//! Meshes whose shape has changed: which of the attributes still hold.

use super::output::Destination;
use super::ui::Ui;
use super::writing::say_losses;
use lwc::TriMesh;
use lwc::io::{WriteError, WriteOptions};
use lwc::mesh::{Attributes, Semantic};
use std::path::Path;

/// Writes a mesh with the attributes that it had before its vertices moved, and warns of those that are left out. Normals
/// are: they are those of the shape before.
pub fn write(
    path: &Path,
    mesh: &TriMesh,
    mut attributes: Attributes,
    options: &WriteOptions,
    ui: &Ui,
) -> Result<(), WriteError> {
    let name = path.display().to_string();
    let (normals, others): (Vec<_>, Vec<_>) =
        attributes.list.into_iter().partition(|attribute| attribute.semantic == Semantic::Normal);
    attributes.list = others;
    if !normals.is_empty() {
        ui.warn(&name, "normals left out: they are those of the shape before");
    }
    let losses = options.write(path, mesh, &attributes)?;
    say_losses(&Destination::File(path.to_owned()), &losses, ui);
    Ok(())
}
