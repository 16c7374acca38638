//! What a document has that is neither a mesh nor how one looks.

use super::json::{Document, Node};
use crate::{
    io::{ReadReport, builder::plain},
    mesh::Instance,
};
use serde_json::Value;
use std::collections::HashSet;

/// Extensions of which nothing is lost, or that meshes which are read do not need. Those of materials as well.
const KEPT_EXTENSIONS: [&str; 6] = [
    "EXT_mesh_gpu_instancing",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
    "KHR_texture_basisu",
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
];

/// Names all of it in `report`.
pub(super) fn note(document: &Document, instances: &[Instance], report: &mut ReadReport) {
    let used: HashSet<&str> = instances.iter().map(|instance| instance.name.as_str()).collect();
    let asset = &document.asset;
    let primitives = || document.meshes.iter().flat_map(|mesh| &mesh.primitives);
    for (what, is_there) in [
        ("animations", !document.animations.is_empty()),
        ("skins", !document.skins.is_empty()),
        ("cameras", !document.cameras.is_empty()),
        ("copyright of the asset", asset.copyright.is_some()),
        ("extras of the asset", has_others(&asset.extras)),
        ("extras of the document", document.extras.is_some()),
        ("extras of scenes", document.scenes.iter().any(|scene| scene.extras.is_some())),
        ("extras of nodes", document.nodes.iter().any(|node| node.extras.is_some())),
        ("extras of meshes", document.meshes.iter().any(|mesh| mesh.extras.is_some())),
        ("extras of primitives", primitives().any(|primitive| primitive.extras.is_some())),
        ("names of meshes", has_lost_names(document, instances)),
        ("nodes without meshes", document.nodes.iter().any(|node| is_lost(node, &used))),
        ("bottom rows of matrices", document.nodes.iter().any(is_projective)),
    ] {
        if is_there {
            report.ignore(what);
        }
    }
    for name in document.extensions_used.iter().filter(|name| !is_kept(name)) {
        report.ignore(&plain(name));
    }
}

/// Whether there is more than what becomes metadata.
fn has_others(extras: &Value) -> bool {
    match extras {
        Value::Null => false,
        Value::Object(fields) => {
            !fields.iter().all(|(key, text)| key.starts_with("crs.") && text.is_string())
        }
        _ => true,
    }
}

/// Whether the name of a mesh is that of none of its instances.
fn has_lost_names(document: &Document, instances: &[Instance]) -> bool {
    let mut is_kept = vec![false; document.meshes.len()];
    for instance in instances {
        is_kept[instance.mesh] |= document.meshes[instance.mesh].name == instance.name;
    }
    document.meshes.iter().zip(is_kept).any(|(mesh, is_kept)| !mesh.name.is_empty() && !is_kept)
}

/// Whether a node holds nothing, or has a name that no instance took over.
fn is_lost(node: &Node, used: &HashSet<&str>) -> bool {
    let has_lost_name = !node.name.is_empty() && !used.contains(node.name.as_str());
    node.mesh.is_none() && (node.children.is_empty() || has_lost_name)
}

fn is_projective(node: &Node) -> bool {
    node.matrix.as_ref().is_some_and(|m| [m[3], m[7], m[11], m[15]] != [0.0, 0.0, 0.0, 1.0])
}

fn is_kept(name: &str) -> bool {
    let is_of_materials = name.starts_with("KHR_materials_") && name != "KHR_materials_variants";
    is_of_materials || name.contains("_texture_") || KEPT_EXTENSIONS.contains(&name)
}
