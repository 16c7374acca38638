//! glTF 2.0, as text (`.gltf`) and binary (`.glb`).
//!
//! The document is parsed with `serde_json` into the few types we need. The crate `gltf` would do that too,
//! but it refuses files that require `KHR_mesh_quantization`, rounds the transforms of nodes to float32, and
//! looks up indices before it has checked them: a damaged file makes it panic.

mod accessor;
mod gpu_instances;
mod ignored;
mod joined_materials;
mod json;
mod materials;
mod mesh;
mod nodes;
mod nulls;
mod placement;
mod source;
mod write;

pub(super) use joined_materials::{append_materials, looks};
pub(super) use materials::strip_textures;
pub(super) use write::{Container, Plan};

use super::{Place, ReadError, Scene, beside::Folder};
use accessor::Store;
use json::Document;
use serde_json::Value;
use std::sync::Arc;

/// Extensions that a file may require: they are read, or change nothing that is. Those of materials as well.
const KNOWN_EXTENSIONS: [&str; 9] = [
    "EXT_mesh_gpu_instancing",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
    "KHR_texture_basisu",
    "EXT_texture_webp",
    "EXT_texture_avif",
    "MSFT_texture_dds",
    "KHR_lights_punctual",
    "KHR_xmp_json_ld",
];

/// Reads a document with all its meshes. Buffers and images in other files are looked for in `folder`.
pub(super) fn read(bytes: &[u8], folder: &mut Folder) -> Result<Scene, ReadError> {
    let source::Parsed { document, binary, has_cut_names } = source::parse(bytes)?;
    check_extensions(&document)?;
    let buffers = source::load_buffers(&document, binary, folder)?;
    let mut store = Store::new(&document, buffers, bytes.len());
    let mut scene = Scene::default();
    scene.instances = nodes::instances(&document, &mut store, &mut scene.report)?;
    ignored::note(&document, &scene.instances, &mut scene.report);
    if has_cut_names {
        scene.report.ignore("names beyond their first 1024 bytes");
    }
    let names = materials::names(&document, &mut scene.report);
    for index in 0..document.meshes.len() {
        scene.meshes.push(mesh::read_mesh(&document, index, &names, &mut store)?);
    }
    let metadata: Arc<[(String, String)]> = metadata(&document.asset.extras).into();
    scene.meshes.iter_mut().for_each(|file| file.attributes.metadata = metadata.clone());
    scene.gltf_materials = materials::read(&document, &names, &mut store, folder, &mut scene.report)?;
    scene.num_bytes = store.num_bytes();
    Ok(scene)
}

/// Keys of the metadata of a file, and bytes of each of its texts.
const MAX_KEYS: usize = 16;
const MAX_METADATA_BYTES: usize = 1 << 16;

/// Coordinate reference systems among what a program has noted, as they are written here.
fn metadata(extras: &Value) -> Vec<(String, String)> {
    let pair = |(key, text): (&String, &Value)| Some((key.clone(), text.as_str()?.to_owned()));
    let is_known =
        |(key, text): &(String, String)| key.starts_with("crs.") && text.len() <= MAX_METADATA_BYTES;
    extras.as_object().into_iter().flatten().filter_map(pair).filter(is_known).take(MAX_KEYS).collect()
}

fn check_extensions(document: &Document) -> Result<(), ReadError> {
    let is_known = |name: &str| KNOWN_EXTENSIONS.contains(&name) || name.starts_with("KHR_materials_");
    match document.extensions_required.iter().find(|name| !is_known(name)) {
        Some(name) => {
            let name: String = name.chars().filter(|c| c.is_ascii_graphic()).take(60).collect();
            let message = format!("the file requires {name}");
            Err(ReadError::Unsupported { place: Place::Part("document", 0), message })
        }
        None => Ok(()),
    }
}
