//! Scenes of several files.

use super::Scene;
use crate::{
    io::{MeshFile, gltf},
    mesh::{GltfMaterials, Instance, Semantic, Values},
};
use std::collections::{HashMap, HashSet};

impl Scene {
    /// Adds the meshes of another file with their instances.
    ///
    /// Materials are known by their names: one of `other` that has the name of another here, and does not look the same,
    /// gets a number.
    pub fn append(&mut self, mut other: Self) {
        let renamed = self.renamed_materials(&other);
        other.meshes.iter_mut().for_each(|file| rename(file, &renamed));
        let first = self.meshes.len();
        self.meshes.append(&mut other.meshes);
        let moved = |instance: Instance| Instance { mesh: first + instance.mesh, ..instance };
        self.instances.extend(other.instances.into_iter().map(moved));
        if let Some(more) = other.gltf_materials {
            let known = self.gltf_materials.get_or_insert_with(GltfMaterials::default);
            gltf::append_materials(known, more, &renamed);
        }
        self.report.add(&other.report);
        self.num_bytes = self.num_bytes.saturating_add(other.num_bytes);
    }

    /// The materials of another scene that need other names in this one.
    fn renamed_materials(&self, other: &Self) -> HashMap<String, String> {
        let looks = |scene: &Self| scene.gltf_materials.as_ref().map(gltf::looks).unwrap_or_default();
        let (own, others) = (looks(self), looks(other));
        let mut taken: HashSet<String> = material_names(self).chain(own.keys().cloned()).collect();
        let own_names = taken.clone();
        let mut names: Vec<String> = material_names(other).chain(others.keys().cloned()).collect();
        names.sort_unstable();
        names.dedup();
        taken.extend(names.iter().cloned());
        let is_alike = |name: &String| match (own.get(name), others.get(name)) {
            (None, None) => true,
            (Some(Some(own)), Some(Some(other))) => own == other,
            _ => false,
        };
        let is_other = |name: &String| own_names.contains(name) && !is_alike(name);
        let mut renamed = HashMap::new();
        for name in names.into_iter().filter(is_other) {
            let free = (2..).map(|k| format!("{name}#{k}")).find(|name| !taken.contains(name));
            let free = free.unwrap_or_default();
            taken.insert(free.clone());
            renamed.insert(name, free);
        }
        renamed
    }
}

fn material_names(scene: &Scene) -> impl Iterator<Item = String> {
    let lists = scene.meshes.iter().flat_map(|file| &file.attributes.list);
    let lists = lists.filter(|attribute| attribute.semantic == Semantic::Material);
    lists.flat_map(|attribute| attribute.values.names().unwrap_or_default()).cloned()
}

fn rename(file: &mut MeshFile, renamed: &HashMap<String, String>) {
    for attribute in &mut file.attributes.list {
        if let (Semantic::Material, Values::Names(names)) = (attribute.semantic, &mut attribute.values) {
            names
                .iter_mut()
                .filter_map(|name| Some((renamed.get(name)?.clone(), name)))
                .for_each(|(new, name)| *name = new);
        }
    }
}
