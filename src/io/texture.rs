//! Which way up textures are.
//!
//! glTF counts texture coordinates downwards from the top of the image, OBJ and PLY upwards from its bottom.
//! Readers keep what the file says, under the name it has there; a writer of the other kind turns it.

use crate::mesh::{Attribute, ComponentType, Semantic, Values};
use std::borrow::Cow;

/// `attribute` as a file has it that counts downwards (or not): texture coordinates from the other kind of
/// file turned, everything else as it is.
pub(super) fn oriented(attribute: &Attribute, is_downwards: bool) -> Cow<'_, Attribute> {
    let comes_downwards = attribute.name.starts_with("TEXCOORD_");
    let is_texture = matches!(attribute.semantic, Semantic::TexCoord(_)) && attribute.num_components >= 2;
    let n = attribute.num_components;
    if !is_texture || comes_downwards == is_downwards || attribute.values.names().is_some() {
        return Cow::Borrowed(attribute);
    }
    let number = |k: usize| {
        let number = attribute.number(k / n, k % n).unwrap_or(0.0);
        if k % n == 1 { 1.0 - number } else { number }
    };
    let numbers = (0..attribute.values.len()).map(number);
    let values = match attribute.values.component_type() {
        Some(ComponentType::F64) => Values::F64(numbers.collect()),
        _ => Values::F32(numbers.map(|number| number as f32).collect()),
    };
    Cow::Owned(Attribute { values, is_normalized: false, ..attribute.clone() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Domain;

    #[test]
    fn texture_coordinates_are_turned_for_the_other_kind_of_file() {
        let uv = |name: &str, values| Attribute::new(name, Semantic::TexCoord(0), Domain::Vertex, 2, values);
        let from_obj = uv("vt", Values::F64(vec![0.25, 0.25, 1.0, 0.0]));
        assert_eq!(*oriented(&from_obj, false), from_obj);
        assert_eq!(oriented(&from_obj, true).values, Values::F64(vec![0.25, 0.75, 1.0, 1.0]));
        let mut from_gltf = uv("TEXCOORD_0", Values::U8(vec![255, 0]));
        from_gltf.is_normalized = true;
        assert_eq!(*oriented(&from_gltf, true), from_gltf);
        assert_eq!(oriented(&from_gltf, false).values, Values::F32(vec![1.0, 1.0]));
    }
}
