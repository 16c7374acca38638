//! Which way up textures are.
//!
//! glTF counts texture coordinates downwards from the top of the image, OBJ and PLY upwards from its bottom.
//! Readers keep what the file says, under the name it has there; a writer of the other kind turns it.

use crate::{
    losses::{Loss, LossKind, Losses, Stage},
    mesh::{Attribute, ComponentType, Semantic, Values},
};
use std::borrow::Cow;

/// `attribute` as a file has it that counts downwards (or not): texture coordinates from the other kind of
/// file turned, everything else as it is. Turned ones are float32, float64 only where they were.
pub fn oriented<'a>(attribute: &'a Attribute, is_downwards: bool, losses: &mut Losses) -> Cow<'a, Attribute> {
    let comes_downwards = attribute.name.starts_with("TEXCOORD_");
    let is_texture = matches!(attribute.semantic, Semantic::TexCoord(_)) && attribute.num_components >= 2;
    let Some(scalar) = attribute.values.component_type() else { return Cow::Borrowed(attribute) };
    if !is_texture || comes_downwards == is_downwards {
        return Cow::Borrowed(attribute);
    }
    let n = attribute.num_components;
    let number = |k: usize| attribute.number(k / n, k % n).unwrap_or(0.0);
    let turned = |k: usize| if k % n == 1 { 1.0 - number(k) } else { number(k) };
    let all = 0..attribute.values.len();
    let values = if scalar == ComponentType::F64 {
        Values::F64(all.map(turned).collect())
    } else {
        let floats: Vec<f32> = all.clone().map(|k| turned(k) as f32).collect();
        let vertical = all.filter(|k| k % n == 1);
        let is_lost = |&k: &usize| !is_same(1.0 - f64::from(floats[k]), number(k), scalar, attribute);
        let errors = vertical.filter(is_lost).map(|k| (f64::from(floats[k]) - turned(k)).abs());
        say(attribute, errors, losses);
        Values::F32(floats)
    };
    Cow::Owned(Attribute { values, is_normalized: false, ..attribute.clone() })
}

/// Whether a number that was turned and turned back is the same in its type.
fn is_same(back: f64, number: f64, scalar: ComponentType, attribute: &Attribute) -> bool {
    let one = if attribute.is_normalized { scalar.one() } else { 1.0 };
    if scalar.is_integer() {
        return (back * one).round() == (number * one).round();
    }
    back as f32 == number as f32 || number.is_nan()
}

fn say(attribute: &Attribute, errors: impl Iterator<Item = f64>, losses: &mut Losses) {
    let (count, largest) =
        errors.fold((0, 0.0f64), |(count, largest), error| (count + 1, largest.max(error)));
    if count > 0 {
        let loss = Loss::new(Stage::Writing, LossKind::ValuesRounded, attribute.name.clone());
        losses.push(loss.count(count).of(attribute.values.len()).at_most(largest));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Domain;

    #[test]
    fn texture_coordinates_are_turned_for_the_other_kind_of_file() {
        let uv = |name: &str, values| Attribute::new(name, Semantic::TexCoord(0), Domain::Vertex, 2, values);
        let turned = |attribute: &Attribute, is_downwards| {
            let mut losses = Losses::default();
            (oriented(attribute, is_downwards, &mut losses).into_owned(), losses.len())
        };
        let from_obj = uv("vt", Values::F64(vec![0.25, 0.25, 1.0, 0.0]));
        assert_eq!(turned(&from_obj, false), (from_obj.clone(), 0));
        assert_eq!(turned(&from_obj, true).0.values, Values::F64(vec![0.25, 0.75, 1.0, 1.0]));
        let mut from_gltf = uv("TEXCOORD_0", Values::U8(vec![255, 0]));
        from_gltf.is_normalized = true;
        assert_eq!(turned(&from_gltf, true), (from_gltf.clone(), 0));
        let (as_ply, num_losses) = turned(&from_gltf, false);
        assert_eq!((as_ply.values, num_losses), (Values::F32(vec![1.0, 1.0]), 0));
        let small = uv("TEXCOORD_0", Values::F32(vec![1e-9, 1e-9]));
        assert_eq!(turned(&small, false).1, 1, "1 − 1e-9 is 1 in float32");
    }
}
