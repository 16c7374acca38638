//! One type for each attribute of a scene: what one mesh has as floats another may have as integers.

use super::Scene;
use crate::{
    io::{MeshFile, common_type::Layout},
    mesh::{Attribute, ComponentType, Domain, Semantic},
};
use std::borrow::Cow;
use std::collections::HashMap;

/// The layouts of the attributes of all meshes.
pub(super) struct Layouts<'a> {
    /// Of one name and meaning there may be several that have nothing in common.
    of: HashMap<Key<'a>, Vec<Layout>>,
    is_turning: bool,
}

type Key<'a> = (&'a str, Semantic, bool);

fn key(attribute: &Attribute) -> Key<'_> {
    (&attribute.name, attribute.semantic, attribute.domain == Domain::Triangle)
}

impl<'a> Layouts<'a> {
    pub fn of(scene: &'a Scene) -> Self {
        let mut of: HashMap<Key, Vec<Layout>> = HashMap::new();
        for attribute in scene.meshes.iter().flat_map(|file| &file.attributes.list) {
            let Some(layout) = Layout::of(attribute) else { continue };
            let known = of.entry(key(attribute)).or_default();
            let common = known.iter().enumerate();
            let mut common =
                common.filter_map(|(k, known)| Some((k, known.common(layout, attribute.semantic)?)));
            match common.next() {
                Some((k, wider)) => known[k] = wider,
                None => known.push(layout),
            }
        }
        Self { of, is_turning: false }
    }

    /// For meshes that are turned, normals as float32.
    pub fn turning(self) -> Self {
        Self { is_turning: true, ..self }
    }

    /// A mesh of the scene with its attributes in these layouts.
    pub fn convert<'f>(&self, file: &'f MeshFile) -> Cow<'f, MeshFile> {
        let is_converted = |attribute: &Attribute| self.layout(attribute) != Layout::of(attribute);
        if !file.attributes.list.iter().any(is_converted) {
            return Cow::Borrowed(file);
        }
        let mut converted = file.clone();
        for attribute in &mut converted.attributes.list {
            if let Some(layout) = self.layout(attribute) {
                *attribute = layout.convert(attribute).into_owned();
            }
        }
        Cow::Owned(converted)
    }

    /// The layout that an attribute is to have; `None` for names.
    fn layout(&self, attribute: &Attribute) -> Option<Layout> {
        let own = Layout::of(attribute)?;
        if self.is_turning && attribute.semantic == Semantic::Normal {
            return Some(Layout { component_type: ComponentType::F32, is_normalized: false, ..own });
        }
        let is_common = |layout: &&Layout| own.common(**layout, attribute.semantic) == Some(**layout);
        self.of.get(&key(attribute))?.iter().find(is_common).copied()
    }
}
