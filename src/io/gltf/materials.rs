//! Materials, textures and images, carried from file to file as they are.

use super::{
    accessor::Store,
    json::Document,
    source::{file_name, shorten},
};
use crate::{
    io::{
        ReadError, ReadReport,
        beside::{Folder, Image},
    },
    mesh::GltfMaterials,
};
use serde_json::{Map, Value, json};
use std::collections::{HashMap, HashSet};

/// The lists of a document that materials refer to each other by.
const LISTS: [&str; 4] = ["materials", "textures", "images", "samplers"];
const EXTENSIONS: [&str; 2] = ["extensionsUsed", "extensionsRequired"];

/// The name of each material. Two that share one get numbers.
pub(super) fn names(document: &Document, report: &mut ReadReport) -> Vec<String> {
    let mut known = HashSet::new();
    let mut unique = |(index, material): (usize, &Map<String, Value>)| {
        let mut name = material.get("name").and_then(Value::as_str).unwrap_or_default().to_owned();
        if shorten(&mut name) {
            report.ignore("names beyond their first 1024 bytes");
        }
        if !known.insert(name.clone()) {
            let other = format!("{name}#{index}");
            if !name.is_empty() {
                report.rename(&name, &other);
            }
            name = other;
            known.insert(name.clone());
        }
        name
    };
    document.materials.iter().enumerate().map(&mut unique).collect()
}

/// `None` if there is nothing about materials but their names.
///
/// # Errors
/// If there are more images than the buffers have bytes for.
pub(super) fn read(
    document: &Document,
    names: &[String],
    store: &mut Store,
    folder: &mut Folder,
    report: &mut ReadReport,
) -> Result<Option<GltfMaterials>, ReadError> {
    let is_bare = |material: &Map<String, Value>| material.keys().all(|key| key == "name");
    if document.materials.iter().all(is_bare) {
        if has_unused(document) {
            report.ignore("materials that nothing has");
        }
        return Ok(None);
    }
    let mut materials = document.materials.clone();
    for (material, name) in materials.iter_mut().zip(names) {
        if !name.is_empty() {
            material.insert("name".to_owned(), name.as_str().into());
        }
    }
    let mut embedded = Vec::new();
    let mut images = document.images.clone();
    let mut index_of = HashMap::new();
    for image in &mut images {
        let view = image.get("bufferView").and_then(Value::as_u64);
        let Some(view) = view else {
            embed(image, folder, &mut index_of, &mut embedded, report);
            continue;
        };
        match store.view(view) {
            Some(bytes) => {
                let bytes = bytes.to_vec();
                store.claim(bytes.len() as u64)?;
                image.insert("bufferView".to_owned(), embedded.len().into());
                embedded.push(bytes);
            }
            None => {
                report.ignore("images outside their buffers");
                image.remove("bufferView");
            }
        }
    }
    let of_materials = |names: &[String]| -> Vec<Value> {
        let is_ours = |name: &&String| {
            name.starts_with("KHR_materials_")
                || name.starts_with("KHR_texture_")
                || name.contains("_texture_")
        };
        names.iter().filter(is_ours).map(|name| name.as_str().into()).collect()
    };
    let json = json!({
        "materials": materials,
        "textures": document.textures,
        "images": images,
        "samplers": document.samplers,
        "extensionsUsed": of_materials(&document.extensions_used),
        "extensionsRequired": of_materials(&document.extensions_required),
    });
    Ok(Some(GltfMaterials { json: json.to_string(), images: embedded }))
}

/// Whether there is a material that no primitive has.
fn has_unused(document: &Document) -> bool {
    let mut is_used = vec![false; document.materials.len()];
    for primitive in document.meshes.iter().flat_map(|mesh| &mesh.primitives) {
        if let Some(is_used) = primitive.material.and_then(|material| is_used.get_mut(material)) {
            *is_used = true;
        }
    }
    is_used.contains(&false)
}

/// Takes the file that an image names into the document. `index_of`: of those that are in `embedded` already.
fn embed(
    image: &mut Map<String, Value>,
    folder: &mut Folder,
    index_of: &mut HashMap<String, (usize, &'static str)>,
    embedded: &mut Vec<Vec<u8>>,
    report: &mut ReadReport,
) {
    let uri = image.get("uri").and_then(Value::as_str).unwrap_or("data:");
    if uri.starts_with("data:") || !folder.has_textures {
        return;
    }
    let name = file_name(uri).into_owned();
    let found = match index_of.get(&name) {
        Some(&found) => found,
        None => match folder.image(&name) {
            Ok(Image { media_type, bytes }) => {
                embedded.push(bytes);
                (embedded.len() - 1, media_type)
            }
            Err(message) => return report.ignore(&format!("image {message}")),
        },
    };
    image.remove("uri");
    image.insert("bufferView".to_owned(), found.0.into());
    image.insert("mimeType".to_owned(), found.1.into());
    image.entry("name").or_insert_with(|| name.as_str().into());
    index_of.insert(name, found);
}

/// Takes out all textures, with what refers to them. Returns whether there were any.
pub(in crate::io) fn strip_textures(carried: &mut GltfMaterials) -> bool {
    let Ok(Value::Object(mut json)) = serde_json::from_str(&carried.json) else { return false };
    if json.get("textures").and_then(Value::as_array).is_none_or(Vec::is_empty) {
        return false;
    }
    json.retain(|key, _| !matches!(key.as_str(), "textures" | "images" | "samplers"));
    for key in EXTENSIONS {
        if let Some(Value::Array(names)) = json.get_mut(key) {
            names.retain(|name| !name.as_str().is_some_and(|name| name.contains("_texture_")));
        }
    }
    json.get_mut("materials").into_iter().for_each(forget_textures);
    *carried = GltfMaterials { json: Value::Object(json).to_string(), images: Vec::new() };
    true
}

/// References to textures have names such as `normalTexture`.
fn forget_textures(value: &mut Value) {
    match value {
        Value::Object(fields) => {
            fields.retain(|key, _| !key.ends_with("Texture"));
            fields.values_mut().for_each(forget_textures);
        }
        Value::Array(list) => list.iter_mut().for_each(forget_textures),
        _ => {}
    }
}

/// The lists for a document, images referring to buffer views that `view` makes of their bytes. What is not of
/// this form is left out.
pub(super) fn lists(carried: &GltfMaterials, mut view: impl FnMut(&[u8]) -> usize) -> Map<String, Value> {
    let Ok(Value::Object(mut json)) = serde_json::from_str(&carried.json) else { return Map::new() };
    json.retain(|key, value| {
        let is_list = matches!(value, Value::Array(list) if !list.is_empty());
        is_list && (LISTS.contains(&key.as_str()) || EXTENSIONS.contains(&key.as_str()))
    });
    if let Some(Value::Array(images)) = json.get_mut("images") {
        for image in images.iter_mut().filter_map(Value::as_object_mut) {
            let index = image.get("bufferView").and_then(Value::as_u64);
            let index = index.map(|index| usize::try_from(index).unwrap_or(usize::MAX));
            if let Some(index) = index {
                match carried.images.get(index) {
                    Some(bytes) => image.insert("bufferView".to_owned(), view(bytes).into()),
                    None => image.remove("bufferView"),
                };
            }
        }
    }
    json
}
