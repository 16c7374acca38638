//! Materials of other formats as those of glTF.

use super::{
    ReadReport,
    beside::{Folder, Image},
};
use crate::mesh::GltfMaterials;
use serde_json::{Map, Value, json};
use std::collections::HashMap;

/// `CLAMP_TO_EDGE`.
const CLAMP: u32 = 33071;

/// The lists of a glTF document while materials are made.
#[derive(Default)]
pub(super) struct Materials {
    list: Vec<Value>,
    textures: Vec<Value>,
    images: Vec<Value>,
    bytes: Vec<Vec<u8>>,
    extensions: Vec<&'static str>,
    has_clamp: bool,
    /// `None` for files that are not there.
    image_of: HashMap<String, Option<usize>>,
    texture_of: HashMap<(usize, bool), usize>,
}

impl Materials {
    pub fn push(&mut self, material: Value) {
        self.list.push(material);
    }

    /// Notes that materials use an extension.
    pub fn uses(&mut self, extension: &'static str) {
        if !self.extensions.contains(&extension) {
            self.extensions.push(extension);
        }
    }

    /// A reference to the texture with the image of a file; `None` if that cannot be read, which is reported.
    pub fn texture(
        &mut self,
        name: &str,
        is_clamped: bool,
        folder: &mut Folder,
        report: &mut ReadReport,
    ) -> Option<Map<String, Value>> {
        if !folder.has_textures {
            report.ignore("textures");
            return None;
        }
        let image = match self.image_of.get(name) {
            Some(&known) => known?,
            None => {
                let image =
                    folder.image(name).map_err(|message| report.ignore(&format!("image {message}"))).ok();
                let image = image.map(|image| self.add_image(name, image));
                self.image_of.insert(name.to_owned(), image);
                image?
            }
        };
        let index = *self.texture_of.entry((image, is_clamped)).or_insert_with(|| {
            let mut texture = json!({ "source": image });
            if is_clamped {
                texture["sampler"] = 0.into();
            }
            self.textures.push(texture);
            self.textures.len() - 1
        });
        self.has_clamp |= is_clamped;
        Some(Map::from_iter([("index".to_owned(), index.into())]))
    }

    fn add_image(&mut self, name: &str, Image { media_type, bytes }: Image) -> usize {
        let view = self.bytes.len();
        self.images.push(json!({ "name": name, "bufferView": view, "mimeType": media_type }));
        self.bytes.push(bytes);
        self.images.len() - 1
    }

    /// `None` if there are none.
    pub fn finish(self) -> Option<GltfMaterials> {
        let clamp = json!({ "wrapS": CLAMP, "wrapT": CLAMP });
        let json = json!({
            "materials": self.list,
            "textures": self.textures,
            "images": self.images,
            "samplers": if self.has_clamp { vec![clamp] } else { Vec::new() },
            "extensionsUsed": self.extensions,
            "extensionsRequired": [],
        });
        (!self.list.is_empty()).then(|| GltfMaterials { json: json.to_string(), images: self.bytes })
    }
}
