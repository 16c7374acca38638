//! Meshes whose shape has changed: which of the attributes still hold.

use super::losses;
use super::ui::Ui;
use lwc::TriMesh;
use lwc::io::{WriteError, WriteOptions};
use lwc::losses::{Loss, LossKind, Losses, Stage};
use lwc::mesh::{Attribute, Attributes, Semantic};
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
    let dropped = |attribute: &Attribute| {
        let loss = Loss::new(Stage::Writing, LossKind::Dropped, attribute.name.as_str());
        loss.remedy("these normals are those of the shape before")
    };
    let mut losses: Losses = normals.iter().map(dropped).collect();
    losses.append(options.write(path, mesh, &attributes)?);
    losses::warn(&name, &losses, ui);
    losses.iter().filter(|loss| loss.is_usual()).for_each(|loss| ui.detail(&name, &loss.to_string()));
    Ok(())
}
