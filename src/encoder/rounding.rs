//! What the entries of an attribute lose as integers.

use crate::losses::{Loss, LossKind, Stage};
use crate::mesh::{Attribute, Semantic, Values};
use crate::passes::attribute::Declaration;

/// What the entries `used` of an attribute lose as channels; `None` if nothing.
pub(super) fn rounding(
    attribute: &Attribute,
    used: &[u32],
    declaration: &Declaration,
    channels: &[i32],
) -> Option<Loss> {
    let values = restored(declaration, channels)?;
    let restored = Attribute {
        is_normalized: attribute.is_normalized,
        ..Attribute::new("", attribute.semantic, attribute.domain, attribute.num_components, values)
    };
    let error = |(k, &entry): (usize, &u32)| match attribute.semantic {
        Semantic::Normal if attribute.num_components == 3 => angle(attribute, entry as usize, &restored, k),
        _ => difference(attribute, entry as usize, &restored, k),
    };
    let errors = used.iter().enumerate().map(error).filter(|&error| error > 0.0);
    let (count, largest) = errors.fold((0, 0.0), |(n, largest), error| (n + 1, error.max(largest)));
    let loss = || Loss::new(Stage::Encoding, LossKind::ValuesRounded, &attribute.name);
    let rounded = || loss().count(count).of(used.len());
    (count > 0).then(|| rounded().at_most(largest).remedy("`--lossless` keeps them"))
}

/// The numbers that channels stand for; `None` for names.
fn restored(declaration: &Declaration, channels: &[i32]) -> Option<Values> {
    let mut values = Values::new(declaration.scalar?);
    channels
        .chunks_exact(declaration.num_channels())
        .for_each(|entry| declaration.restore(entry, &mut values));
    Some(values)
}

/// The largest difference of a component.
fn difference(a: &Attribute, entry: usize, b: &Attribute, other: usize) -> f64 {
    let off = |k: usize| Some((a.number(entry, k)? - b.number(other, k)?).abs());
    (0..a.num_components).filter_map(off).fold(0.0, f64::max)
}

/// The angle between two directions, and no less than what their lengths differ by.
fn angle(a: &Attribute, entry: usize, b: &Attribute, other: usize) -> f64 {
    let vector = |of: &Attribute, entry: usize| [0, 1, 2].map(|k| of.number(entry, k).unwrap_or(0.0));
    let (u, v) = (vector(a, entry), vector(b, other));
    if u == v {
        return 0.0;
    }
    let length = |v: [f64; 3]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
    let chord = |s: f64, t: f64| length([0, 1, 2].map(|k| u[k] / s - v[k] / t));
    let (s, t) = (length(u), length(v));
    let turned = if s > 0.0 && t > 0.0 { 2.0 * libm::asin((chord(s, t) * 0.5).min(1.0)) } else { 0.0 };
    turned.max((s - t).abs())
}
