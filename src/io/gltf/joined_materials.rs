//! Materials of several files in one document.

use crate::mesh::GltfMaterials;
use serde_json::{Map, Value};
use std::collections::HashMap;

const LISTS: [&str; 4] = ["materials", "textures", "images", "samplers"];
const EXTENSIONS: [&str; 2] = ["extensionsUsed", "extensionsRequired"];

/// The materials by name: how they look, `None` for those with textures, which look like no other.
pub(in crate::io) fn looks(carried: &GltfMaterials) -> HashMap<String, Option<String>> {
    let json = object(carried);
    let of = |material: &Value| {
        let name = material.get("name").and_then(Value::as_str).unwrap_or_default();
        let text = material.to_string();
        let is_plain = !text.contains("Texture\"");
        (name.to_owned(), is_plain.then_some(text))
    };
    list(&json, "materials").iter().map(of).collect()
}

/// Adds the materials of another file, some under other names.
pub(in crate::io) fn append_materials(
    known: &mut GltfMaterials,
    more: GltfMaterials,
    renamed: &HashMap<String, String>,
) {
    let (mut json, mut other) = (object(known), object(&more));
    let counts = LISTS.map(|name| list(&json, name).len());
    let offsets =
        Offsets { texture: counts[1], image: counts[2], sampler: counts[3], view: known.images.len() };
    let present: Vec<Value> = list(&json, "materials").to_vec();
    let mut materials = take(&mut other, "materials");
    for material in &mut materials {
        offsets.shift_references(material);
        if let Some(name) = material.get("name").and_then(Value::as_str).and_then(|name| renamed.get(name)) {
            material["name"] = name.as_str().into();
        }
    }
    // What looks the same has the same name.
    let is_new = |material: &Value| !present.iter().any(|known| known["name"] == material["name"]);
    materials.retain(is_new);
    let mut textures = take(&mut other, "textures");
    textures.iter_mut().for_each(|texture| offsets.shift_texture(texture));
    let mut images = take(&mut other, "images");
    images.iter_mut().for_each(|image| shift(image, "bufferView", offsets.view));
    let samplers = take(&mut other, "samplers");
    for (name, values) in LISTS.into_iter().zip([materials, textures, images, samplers]) {
        let mut all = take(&mut json, name);
        all.extend(values);
        json.insert(name.to_owned(), all.into());
    }
    for name in EXTENSIONS {
        let mut all = take(&mut json, name);
        let new: Vec<Value> = take(&mut other, name).into_iter().filter(|name| !all.contains(name)).collect();
        all.extend(new);
        json.insert(name.to_owned(), all.into());
    }
    known.json = Value::Object(json).to_string();
    known.images.extend(more.images);
}

/// How many there are already of what is counted.
struct Offsets {
    texture: usize,
    image: usize,
    sampler: usize,
    view: usize,
}

impl Offsets {
    /// References to textures have names such as `normalTexture`.
    fn shift_references(&self, value: &mut Value) {
        match value {
            Value::Object(fields) => {
                for (key, field) in fields {
                    if key.ends_with("Texture") {
                        shift(field, "index", self.texture);
                    }
                    self.shift_references(field);
                }
            }
            Value::Array(list) => list.iter_mut().for_each(|item| self.shift_references(item)),
            _ => {}
        }
    }

    fn shift_texture(&self, texture: &mut Value) {
        shift(texture, "sampler", self.sampler);
        shift(texture, "source", self.image);
        let extensions = texture.get_mut("extensions").and_then(Value::as_object_mut);
        for extension in extensions.into_iter().flat_map(Map::values_mut) {
            shift(extension, "source", self.image);
        }
    }
}

fn shift(object: &mut Value, key: &str, offset: usize) {
    if let Some(value) = object.get_mut(key)
        && let Some(index) = value.as_u64()
    {
        *value = index.saturating_add(offset as u64).into();
    }
}

/// What is not of the form that it should have is empty.
fn object(carried: &GltfMaterials) -> Map<String, Value> {
    match serde_json::from_str(&carried.json) {
        Ok(Value::Object(json)) => json,
        _ => Map::new(),
    }
}

fn list<'a>(json: &'a Map<String, Value>, name: &str) -> &'a [Value] {
    json.get(name).and_then(Value::as_array).map_or(&[], Vec::as_slice)
}

fn take(json: &mut Map<String, Value>, name: &str) -> Vec<Value> {
    match json.remove(name) {
        Some(Value::Array(list)) => list,
        _ => Vec::new(),
    }
}
