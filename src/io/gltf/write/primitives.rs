//! Meshes of the document.

use super::{
    buffer::Buffer,
    columns::{Column, columns, first_material},
    origin::origin,
};
use crate::{
    io::{
        WriteError, WriteOptions,
        convert::{Neutral, Split, check_float32, filled, loss_of},
        gltf::materials,
    },
    losses::{Loss, LossKind, Losses, Stage},
    mesh::{Attribute, Attributes, GltfMaterials, TriMesh},
};
use serde_json::{Map, Value, json};
use std::{borrow::Cow, collections::HashMap};

/// Meshes and materials so far.
#[derive(Default)]
pub(super) struct Meshes {
    pub buffer: Buffer,
    pub list: Vec<Value>,
    pub materials: Vec<Value>,
    /// What else there is about materials.
    pub lists: Map<String, Value>,
    /// Materials are identified by their names.
    material_of: HashMap<String, usize>,
    /// What else is known of the whole.
    pub metadata: Map<String, Value>,
    pub losses: Losses,
}

impl Meshes {
    /// Takes over materials as they are.
    pub fn carry(&mut self, carried: Option<&GltfMaterials>) {
        let Some(carried) = carried else { return };
        self.lists = materials::lists(carried, |bytes| self.buffer.image(bytes));
        if let Some(Value::Array(list)) = self.lists.remove("materials") {
            self.materials = list;
        }
        let name =
            |material: &Value| material.get("name").and_then(Value::as_str).unwrap_or_default().to_owned();
        self.material_of =
            self.materials.iter().enumerate().map(|(k, material)| (name(material), k)).collect();
    }

    /// Takes over the metadata of a mesh.
    pub fn describe(&mut self, attributes: &Attributes) {
        let metadata = attributes.metadata.iter();
        self.metadata.extend(metadata.map(|(key, text)| (key.clone(), text.as_str().into())));
    }

    /// Adds a mesh that has triangles. Gives the origin of its coordinates.
    ///
    /// # Errors
    /// If it is too far away, or has too many vertices after splitting.
    pub fn add(
        &mut self,
        mesh: &TriMesh,
        attributes: &Attributes,
        step: Option<f64>,
        options: &WriteOptions,
    ) -> Result<[f64; 3], WriteError> {
        check_float32(mesh, "glTF")?;
        let (origin, rounding) = origin(mesh, step, options);
        self.losses.append(rounding.map(|r| loss_of(r, mesh, "PLY and OBJ keep them")).into_iter().collect());
        let columns = columns(mesh, attributes, options, &mut self.losses);
        let split = Split::new(mesh, columns.iter().map(|column| &*column.attribute))?;
        self.losses.append(split.loss(mesh));
        let position = |&v: &u32| {
            let position = mesh.positions()[v as usize];
            [0, 1, 2].map(|k| (position[k] - origin[k]) as f32)
        };
        let positions: Vec<[f32; 3]> = split.sources.iter().map(position).collect();
        let mut named = Map::new();
        named.insert("POSITION".to_owned(), self.buffer.positions(&positions).into());
        let mut neutral = Neutral::new(mesh);
        for Column { attribute, name } in columns {
            let accessor = self.column(&attribute, &split, &mut neutral);
            named.insert(name, accessor.into());
        }
        let primitives = self.primitives(attributes, &split.triangles, named.into());
        self.list.push(json!({ "primitives": primitives }));
        Ok(origin)
    }

    fn column(&mut self, attribute: &Attribute, split: &Split, neutral: &mut Neutral) -> usize {
        let source = |vertex: usize| split.sources[vertex] as usize;
        let num_vertices = split.sources.len();
        let on_vertices = Cow::Owned(split.on_vertices(attribute));
        let filled = filled(on_vertices, num_vertices, source, neutral, &mut self.losses);
        self.buffer.column(&filled, num_vertices)
    }

    /// One primitive for each material, in the order of the table, and one for triangles without. All
    /// share the vertices.
    fn primitives(&mut self, attributes: &Attributes, triangles: &[[u32; 3]], named: Value) -> Vec<Value> {
        let material = first_material(attributes);
        let row = |t: usize| material.and_then(|material| material.entry(t));
        let mut order: Vec<(Option<usize>, usize)> = (0..triangles.len()).map(|t| (row(t), t)).collect();
        if !order.is_sorted_by_key(|&(row, _)| row) {
            let subject = "triangles by material";
            self.losses.push(Loss::new(Stage::Writing, LossKind::Reordered, subject));
            order.sort_by_key(|&(row, _)| row);
        }
        let mut primitives = Vec::new();
        for group in order.chunk_by(|a, b| a.0 == b.0) {
            let indices = self.buffer.indices(group.iter().map(|&(_, t)| triangles[t]));
            let mut primitive = json!({ "attributes": named, "indices": indices });
            if let Some(name) = group[0].0.and_then(|row| material?.values.names()?.get(row)) {
                primitive["material"] = self.material(name).into();
            }
            primitives.push(primitive);
        }
        primitives
    }

    fn material(&mut self, name: &str) -> usize {
        if let Some(&known) = self.material_of.get(name) {
            return known;
        }
        self.materials.push(if name.is_empty() { json!({}) } else { json!({ "name": name }) });
        self.material_of.insert(name.to_owned(), self.materials.len() - 1);
        self.materials.len() - 1
    }
}
