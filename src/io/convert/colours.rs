//! Colours in the colour space and the type of a format.
//!
//! Colours in PLY, OBJ and LAS are sRGB by convention, those of glTF are linear by its specification. Readers keep what
//! the file says, under the name it has there; a writer of the other kind turns it. Opacity is never turned.

use crate::{
    losses::{Loss, LossKind, Losses, Stage},
    mesh::{
        Attribute, ComponentType, Semantic, Values,
        srgb::{is_linear, linear_of, srgb_of},
    },
};
use std::borrow::Cow;

/// What a format has as colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ColourFormat {
    /// Whether they are linear; `None`: whatever they are.
    pub is_linear: Option<bool>,
    pub numbers: ColourNumbers,
}

/// The types that a format has colours in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColourNumbers {
    /// This one: fractions if it is one of integers.
    Of(ComponentType),
    /// Fractions of 8 and 16 bits, and float32: the least of them that keeps the colours.
    Gltf,
    /// Any. Those of another colour space are float32.
    Any,
}

/// The way from the colour space that colours have to another, and back.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Turn {
    None,
    ToLinear,
    ToSrgb,
}

impl Turn {
    fn new(attribute: &Attribute, format: ColourFormat) -> Self {
        match (is_linear(attribute), format.is_linear) {
            (false, Some(true)) => Self::ToLinear,
            (true, Some(false)) => Self::ToSrgb,
            _ => Self::None,
        }
    }

    fn there(self, number: f64) -> f64 {
        match self {
            Self::None => number,
            Self::ToLinear => linear_of(number),
            Self::ToSrgb => srgb_of(number),
        }
    }

    fn back(self, number: f64) -> f64 {
        match self {
            Self::None => number,
            Self::ToLinear => srgb_of(number),
            Self::ToSrgb => linear_of(number),
        }
    }
}

/// Colours as a format has them. Components beyond 0..1 are clamped where integers stand for them, and what is not finite
/// is 1, as where there is no colour. Anything but numbers that are colours stays as it is.
pub fn converted<'a>(
    attribute: Cow<'a, Attribute>,
    format: ColourFormat,
    losses: &mut Losses,
) -> Cow<'a, Attribute> {
    let Some(from) = attribute.values.component_type() else { return attribute };
    if !matches!(attribute.semantic, Semantic::Color(_)) {
        return attribute;
    }
    let turn = Turn::new(&attribute, format);
    let to = target(from, turn, format.numbers);
    let is_fraction = to.is_integer();
    let must_be_finite = format.numbers == ColourNumbers::Gltf && !is_fraction;
    let is_fine = |k: usize| attribute.values.number(k).is_some_and(f64::is_finite);
    let is_right = turn == Turn::None && from == to && attribute.is_normalized == is_fraction;
    if is_right && (!must_be_finite || (0..attribute.values.len()).all(is_fine)) {
        return attribute;
    }
    let mut measured = Measured::default();
    let mut values = Values::new(to);
    let turned = |k: usize| if k % attribute.num_components == 3 { Turn::None } else { turn };
    for k in 0..attribute.values.len() {
        let number = attribute.values.number(k).unwrap_or(0.0) / from.one();
        let is_usable = (number as f32).is_finite();
        let exact = if is_usable { turned(k).there(number) } else { 1.0 };
        let bits = bits_of(exact, to);
        values.push_bits(bits);
        let written = to.value(bits) / to.one();
        if number.is_finite() {
            let error = if is_usable { exact - written } else { number - written };
            measured.add(error, is_same(turned(k).back(written), number, from));
        } else {
            measured.num_made_up += 1;
        }
    }
    measured.say(&attribute, values.len(), losses);
    Cow::Owned(Attribute { values, is_normalized: is_fraction, ..attribute.into_owned() })
}

/// The type that colours of the type `from` get.
fn target(from: ComponentType, turn: Turn, numbers: ColourNumbers) -> ComponentType {
    match (numbers, turn) {
        (ColourNumbers::Of(to), _) => to,
        (ColourNumbers::Any, Turn::None) => from,
        (ColourNumbers::Any, _) => ComponentType::F32,
        (ColourNumbers::Gltf, Turn::None) if matches!(from, ComponentType::U8 | ComponentType::U16) => from,
        // Linear colours need more than 8 bits near black.
        (ColourNumbers::Gltf, Turn::ToLinear) if from == ComponentType::U8 => ComponentType::U16,
        (ColourNumbers::Gltf, _) => ComponentType::F32,
    }
}

/// A fraction in a type. Colours are not negative.
fn bits_of(number: f64, to: ComponentType) -> u64 {
    match to {
        ComponentType::F32 => u64::from((number as f32).to_bits()),
        ComponentType::F64 => number.to_bits(),
        _ => (number.clamp(0.0, 1.0) * to.one()).round() as u64,
    }
}

/// Whether a fraction is the same in the type that colours had.
fn is_same(back: f64, number: f64, from: ComponentType) -> bool {
    let is_float = |x: f64| f64::from(x as f32) == x;
    match from {
        ComponentType::F32 => back as f32 == number as f32,
        // Numbers that were float32 before.
        ComponentType::F64 => back == number || (is_float(number) && back as f32 == number as f32),
        _ => (back * from.one()).round() == number * from.one(),
    }
}

/// What conversion did to colours.
#[derive(Default)]
struct Measured {
    /// Numbers that were none before.
    num_made_up: usize,
    count: usize,
    largest: f64,
}

impl Measured {
    fn add(&mut self, error: f64, is_same: bool) {
        if !is_same {
            self.count += 1;
            self.largest = self.largest.max(error.abs());
        }
    }

    fn say(&self, attribute: &Attribute, total: usize, losses: &mut Losses) {
        if self.num_made_up > 0 {
            let subject = format!("{} (1)", attribute.name);
            let loss = Loss::new(Stage::Writing, LossKind::ValuesFilled, subject);
            losses.push(loss.count(self.num_made_up).of(total));
        }
        if self.count > 0 {
            let loss = Loss::new(Stage::Writing, LossKind::ValuesConverted, attribute.name.clone());
            losses.push(loss.count(self.count).of(total).at_most(self.largest));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Domain;

    const PLY: ColourFormat =
        ColourFormat { is_linear: Some(false), numbers: ColourNumbers::Of(ComponentType::U8) };
    const GLTF: ColourFormat = ColourFormat { is_linear: Some(true), numbers: ColourNumbers::Gltf };

    fn colours(name: &str, n: usize, values: Values) -> Attribute {
        let is_normalized = values.component_type().unwrap().is_integer();
        Attribute { is_normalized, ..Attribute::new(name, Semantic::Color(0), Domain::Vertex, n, values) }
    }

    fn through(attribute: &Attribute, format: ColourFormat) -> (Attribute, Losses) {
        let mut losses = Losses::default();
        (converted(Cow::Borrowed(attribute), format, &mut losses).into_owned(), losses)
    }

    #[test]
    fn bytes_go_to_gltf_and_back_without_loss() {
        let bytes = colours("red green blue alpha", 4, Values::U8((0..=255).collect()));
        let (linear, losses) = through(&bytes, GLTF);
        assert_eq!((linear.values.component_type(), losses.len()), (Some(ComponentType::U16), 0));
        assert_eq!(linear.number(128 / 4, 3), Some(131.0 / 255.0), "opacity stays");
        let linear = Attribute { name: "COLOR_0".to_owned(), ..linear };
        let (back, losses) = through(&linear, PLY);
        assert_eq!((back.values, losses.len()), (bytes.values.clone(), 0));
        assert_eq!(through(&bytes, PLY).0, bytes);
        let grey = through(&colours("red green blue", 3, Values::U8(vec![128; 3])), GLTF).0;
        assert!((grey.number(0, 0).unwrap() - 0.216).abs() < 1e-3);
    }

    #[test]
    fn what_conversion_changes_is_measured() {
        let (bytes, losses) = through(&colours("c", 3, Values::U16(vec![0, 257 * 17, 65535])), PLY);
        assert_eq!((bytes.values, losses.len()), (Values::U8(vec![0, 17, 255]), 0));
        let (bytes, losses) = through(&colours("c", 3, Values::U16(vec![0, 257 * 17 + 100, 65535])), PLY);
        assert_eq!(bytes.values, Values::U8(vec![0, 17, 255]));
        let loss = losses.iter().next().unwrap();
        assert_eq!(loss.count, Some(1));
        assert!((loss.largest_error.unwrap() - 100.0 / 65535.0).abs() < 1e-12);
        let floats = vec![-0.5, 0.2, 1.5, f32::NAN, 0.4, 1.0];
        let (bytes, losses) = through(&colours("c", 3, Values::F32(floats)), PLY);
        assert_eq!(bytes.values, Values::U8(vec![0, 51, 255, 255, 102, 255]));
        let [made_up, converted] = [0, 1].map(|k| losses.iter().nth(k).unwrap().clone());
        assert_eq!(made_up.to_string(), "c (1): 1 of 6 values made up where there was none");
        assert_eq!((converted.count, converted.largest_error), (Some(2), Some(0.5)));
        let (bytes, losses) = through(&colours("v.rgb", 3, Values::F64(vec![0.2, 0.4, 1.0])), PLY);
        assert_eq!((bytes.values, losses.len()), (Values::U8(vec![51, 102, 255]), 0));
    }

    #[test]
    fn numbers_stay_where_the_space_does() {
        let keep = ColourFormat { is_linear: None, numbers: ColourNumbers::Gltf };
        let bytes = colours("red green blue", 3, Values::U8(vec![1, 2, 3]));
        assert_eq!(through(&bytes, keep).0, bytes);
        let linear = colours("COLOR_0", 3, Values::F32(vec![0.25, 0.5, 7.0]));
        assert_eq!(through(&linear, GLTF).0, linear);
        let any = ColourFormat { is_linear: Some(false), numbers: ColourNumbers::Any };
        let (srgb, _) = through(&linear, any);
        assert!((srgb.number(0, 0).unwrap() - 0.537_098_7).abs() < 1e-6);
        assert_eq!(through(&colours("v.rgb", 3, Values::F64(vec![0.1; 3])), any).1.len(), 0);
    }
}
