//! Textures, which are in comments: `comment TextureFile skin.png`. Each is the look of a material of that name.

use crate::{
    io::{MeshFile, beside::Folder},
    mesh::{Attribute, Domain, NO_ENTRY, Semantic, TriMesh, Values},
};
use std::collections::HashMap;

/// The attribute that says which texture a triangle has.
pub(in crate::io) const TEXTURE_FILE: &str = "TextureFile";

/// The property that counts them.
const TEXTURE_NUMBER: &str = "texnumber";

/// More textures than anybody has; their names are in memory for little of the file.
const MAX_TEXTURES: usize = 1 << 16;

/// Gives the triangles of `file` their textures: that of their `texnumber`, the first where there is none. The names say
/// what the numbers do, also where files are joined, so the numbers go.
#[cfg_attr(not(feature = "gltf"), allow(unused_variables))]
pub(super) fn attach(file: &mut MeshFile, mut names: Vec<String>, folder: &mut Folder) {
    if names.len() > MAX_TEXTURES {
        file.report.ignore("textures beyond the 65536th");
        names.truncate(MAX_TEXTURES);
    }
    if names.is_empty() {
        return;
    }
    let numbers = file.attributes.list.iter().position(is_number);
    let mut rows = texture_rows(file, numbers.map(|k| &file.attributes.list[k]), &names);
    let (used, is_all) = keep_used(&mut rows, names);
    if !is_all {
        file.report.ignore("textures that no face has");
    }
    if used.is_empty() {
        return;
    }
    if let Some(numbers) = numbers {
        if rows.contains(&NO_ENTRY) && !says_none(&file.attributes.list[numbers], &rows) {
            file.report.ignore("numbers of textures that are not there");
        }
        file.attributes.list.remove(numbers);
    }
    #[cfg(feature = "gltf")]
    {
        file.attributes.gltf_materials = materials(&used, folder, &mut file.report);
    }
    let values = Values::Names(used);
    let textures = Attribute::new(TEXTURE_FILE, Semantic::Material, Domain::Triangle, 1, values);
    file.attributes.list.push(Attribute { indices: Some(rows), ..textures });
}

/// Whether an attribute has the numbers of textures.
pub(super) fn is_number(attribute: &Attribute) -> bool {
    attribute.name == TEXTURE_NUMBER && attribute.domain == Domain::Triangle && attribute.num_components == 1
}

/// The place in `names` that the texture of each triangle has.
fn texture_rows(file: &MeshFile, numbers: Option<&Attribute>, names: &[String]) -> Vec<u32> {
    let number = |triangle| match numbers {
        Some(numbers) => numbers.number(numbers.entry(triangle)?, 0),
        None => Some(0.0),
    };
    let is_texture = |number: &f64| *number >= 0.0 && *number < names.len() as f64;
    let row = |triangle| number(triangle).filter(is_texture).map_or(NO_ENTRY, |number| number as u32);
    (0..file.mesh.num_triangles()).map(row).collect()
}

/// The names that rows refer to, each once, and whether those are all. The rows become places among them.
fn keep_used(rows: &mut [u32], names: Vec<String>) -> (Vec<String>, bool) {
    let mut is_used = vec![false; names.len()];
    rows.iter().filter(|row| **row != NO_ENTRY).for_each(|&row| is_used[row as usize] = true);
    let mut used = Vec::new();
    let mut place_of_name = HashMap::new();
    let mut place_of = vec![NO_ENTRY; names.len()];
    for (k, name) in names.iter().enumerate().filter(|&(k, _)| is_used[k]) {
        place_of[k] = *place_of_name.entry(name.as_str()).or_insert_with(|| {
            used.push(name.clone());
            used.len() as u32 - 1
        });
    }
    rows.iter_mut().filter(|row| **row != NO_ENTRY).for_each(|row| *row = place_of[*row as usize]);
    let is_all = names.iter().all(|name| place_of_name.contains_key(name.as_str()));
    (used, is_all)
}

/// Whether -1 is the number of all triangles without a texture.
fn says_none(numbers: &Attribute, rows: &[u32]) -> bool {
    let number = |triangle| numbers.number(numbers.entry(triangle)?, 0);
    let is_none = |(triangle, _): (usize, &u32)| number(triangle).is_none_or(|number| number == -1.0);
    rows.iter().enumerate().filter(|(_, row)| **row == NO_ENTRY).all(is_none)
}

/// The numbers that say what `textures` does, -1 where a triangle has none; `None` if all have the one there is.
pub(super) fn numbers(textures: &Attribute, mesh: &TriMesh) -> Option<Attribute> {
    let number = |triangle| textures.entry(triangle).map_or(-1, |row| i32::try_from(row).unwrap_or(-1));
    let numbers: Vec<i32> = (0..mesh.num_triangles()).map(number).collect();
    let is_needed = textures.domain == Domain::Triangle && numbers.iter().any(|&number| number != 0);
    let values = Values::I32(numbers);
    is_needed.then(|| Attribute::new(TEXTURE_NUMBER, Semantic::Material, Domain::Triangle, 1, values))
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
