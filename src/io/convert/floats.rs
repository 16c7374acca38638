//! Values as float32.

use crate::{
    losses::{Loss, LossKind, Losses, Stage},
    mesh::{Attribute, ComponentType, Semantic, Values},
};
use std::borrow::Cow;

/// The attribute with values of float32: fractions if it is normalised. Stays as it is if it is float32 already, has no
/// numbers, or one that would become infinite.
pub fn as_float32<'a>(attribute: Cow<'a, Attribute>, losses: &mut Losses) -> Cow<'a, Attribute> {
    let n = attribute.num_components;
    let Some(scalar) = attribute.values.component_type().filter(|&scalar| scalar != ComponentType::F32)
    else {
        return attribute;
    };
    let mut floats = Vec::with_capacity(attribute.values.len());
    let (mut count, mut largest) = (0, 0.0f64);
    for row in 0..attribute.num_entries() {
        let mut squares = 0.0;
        for k in 0..n {
            let number = attribute.number(row, k).unwrap_or(0.0);
            let float = number as f32;
            if float.is_infinite() && number.is_finite() {
                return attribute;
            }
            floats.push(float);
            if !is_kept(float, number, scalar, attribute.is_normalized) {
                let error = (f64::from(float) - number).abs();
                squares += error * error;
                largest = largest.max(error);
                count += 1;
            }
        }
        if attribute.semantic == Semantic::Normal {
            // A chord is as long as its angle where both are small.
            largest = largest.max(f64::sqrt(squares));
        }
    }
    if count > 0 {
        let loss = Loss::new(Stage::Writing, LossKind::ValuesRounded, attribute.name.clone());
        losses.push(loss.count(count).of(floats.len()).at_most(largest));
    }
    let values = Values::F32(floats);
    Cow::Owned(Attribute { values, is_normalized: false, ..attribute.into_owned() })
}

/// Whether a number can be had back from its float32.
fn is_kept(float: f32, number: f64, scalar: ComponentType, is_normalized: bool) -> bool {
    if !scalar.is_integer() || !is_normalized {
        return f64::from(float) == number || number.is_nan();
    }
    let one = scalar.one();
    (f64::from(float) * one).round() == (number * one).round()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Domain;

    fn of(values: Values, is_normalized: bool) -> (Values, Losses) {
        let attribute = Attribute::new("q", Semantic::TexCoord(0), Domain::Vertex, 1, values);
        let attribute = Attribute { is_normalized, ..attribute };
        let mut losses = Losses::default();
        let values = as_float32(Cow::Owned(attribute), &mut losses).into_owned().values;
        (values, losses)
    }

    #[test]
    fn what_is_rounded_is_said() {
        assert_eq!(of(Values::F64(vec![0.5, f64::INFINITY]), false).1.len(), 0);
        let (values, losses) = of(Values::F64(vec![0.5, 0.1]), false);
        assert_eq!(values, Values::F32(vec![0.5, 0.1]));
        let loss = losses.iter().next().unwrap();
        assert_eq!((loss.count, loss.total), (Some(1), Some(2)));
        assert!(loss.largest_error.unwrap() < 2e-9);
        assert_eq!(of(Values::F64(vec![1e300]), false).0, Values::F64(vec![1e300]));
    }

    #[test]
    fn fractions_of_16_bits_come_back_from_float32() {
        let (values, losses) = of(Values::U16((0..=u16::MAX).collect()), true);
        assert_eq!((values.len(), losses.len()), (65536, 0));
        assert_eq!(of(Values::U32(vec![u32::MAX - 1000]), true).1.len(), 1);
        assert_eq!(of(Values::I32(vec![(1 << 24) + 1]), false).1.len(), 1);
    }
}
