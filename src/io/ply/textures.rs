//! Textures, which are in comments: `comment TextureFile skin.png`. Each is the look of a material of that name.

use crate::{
    io::{MeshFile, beside::Folder},
    mesh::{Attribute, Domain, NO_ENTRY, Semantic, Values},
};

/// The attribute that says which texture a triangle has.
pub(in crate::io) const TEXTURE_FILE: &str = "TextureFile";

/// More textures than anybody has; their names are in memory for little of the file.
const MAX_TEXTURES: usize = 1 << 16;

/// Gives the triangles of `file` their textures: that of their `texnumber`, the first where there is none.
#[cfg_attr(not(feature = "gltf"), allow(unused_variables))]
pub(super) fn attach(file: &mut MeshFile, mut names: Vec<String>, folder: &mut Folder) {
    if names.len() > MAX_TEXTURES {
        file.report.ignore("textures beyond the 65536th");
        names.truncate(MAX_TEXTURES);
    }
    if names.is_empty() {
        return;
    }
    #[cfg(feature = "gltf")]
    {
        file.attributes.gltf_materials = materials(&names, folder, &mut file.report);
    }
    let numbers = file.attributes.list.iter().find(|a| a.name == "texnumber" && a.domain == Domain::Triangle);
    let number = |triangle| match numbers {
        Some(numbers) => numbers.number(numbers.entry(triangle)?, 0),
        None => Some(0.0),
    };
    let is_texture = |number: &f64| *number >= 0.0 && *number < names.len() as f64;
    let row = |triangle| number(triangle).filter(is_texture).map_or(NO_ENTRY, |number| number as u32);
    let rows = (0..file.mesh.num_triangles()).map(row).collect();
    let values = Values::Names(names);
    let textures = Attribute::new(TEXTURE_FILE, Semantic::Material, Domain::Triangle, 1, values);
    file.attributes.list.push(Attribute { indices: Some(rows), ..textures });
}

#[cfg(feature = "gltf")]
fn materials(
    names: &[String],
    folder: &mut Folder,
    report: &mut crate::io::ReadReport,
) -> Option<crate::mesh::GltfMaterials> {
    let mut materials = crate::io::materials::Materials::default();
    for name in names {
        let mut surface = serde_json::json!({ "metallicFactor": 0.0 });
        if let Some(texture) = materials.texture(name, false, folder, report) {
            surface["baseColorTexture"] = texture.into();
        }
        materials.push(serde_json::json!({ "name": name, "pbrMetallicRoughness": surface }));
    }
    materials.finish()
}
