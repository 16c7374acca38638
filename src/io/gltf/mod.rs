//! glTF 2.0, as text (`.gltf`) and binary (`.glb`).
//!
//! The document is parsed with `serde_json` into the few types we need. The crate `gltf` would do that too,
//! but it refuses files that require `KHR_mesh_quantization`, rounds the transforms of nodes to float32, and
//! looks up indices before it has checked them: a damaged file makes it panic.

mod accessor;
mod json;
mod materials;
mod mesh;
mod nodes;
mod nulls;
mod source;
mod write;

pub(super) use write::{Container, Plan};

use super::{Place, ReadError, Scene};
use accessor::Store;
use json::Document;
use std::path::Path;

/// Extensions that a file may require because they change nothing that we read. Those of materials as well.
const HARMLESS_EXTENSIONS: [&str; 8] = [
    "KHR_mesh_quantization",
    "KHR_texture_transform",
    "KHR_texture_basisu",
    "EXT_texture_webp",
    "EXT_texture_avif",
    "MSFT_texture_dds",
    "KHR_lights_punctual",
    "KHR_xmp_json_ld",
];

/// Reads a document with all its meshes. Buffers in other files are looked for in `folder`.
pub(super) fn read(bytes: &[u8], folder: Option<&Path>) -> Result<Scene, ReadError> {
    let (document, binary) = source::parse(bytes)?;
    check_extensions(&document)?;
    let buffers = source::load_buffers(&document, binary, folder)?;
    let mut store = Store::new(&document, buffers, bytes.len());
    let mut scene = Scene::default();
    scene.instances = nodes::instances(&document, &mut scene.report)?;
    let names = materials::names(&document);
    for index in 0..document.meshes.len() {
        scene.meshes.push(mesh::read_mesh(&document, index, &names, &mut store)?);
    }
    scene.gltf_materials = materials::read(&document, &mut store, &mut scene.report)?;
    scene.num_bytes = store.num_bytes();
    for (what, is_there) in [
        ("animations", !document.animations.is_empty()),
        ("skins", !document.skins.is_empty()),
        ("cameras", !document.cameras.is_empty()),
    ] {
        if is_there {
            scene.report.ignore(what);
        }
    }
    Ok(scene)
}

fn check_extensions(document: &Document) -> Result<(), ReadError> {
    let is_known = |name: &str| HARMLESS_EXTENSIONS.contains(&name) || name.starts_with("KHR_materials_");
    match document.extensions_required.iter().find(|name| !is_known(name)) {
        Some(name) => {
            let name: String = name.chars().filter(|c| c.is_ascii_graphic()).take(60).collect();
            let message = format!("the file requires {name}");
            Err(ReadError::Unsupported { place: Place::Part("document", 0), message })
        }
        None => Ok(()),
    }
}
