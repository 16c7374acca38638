//! How the entries of an attribute are coded: by a table, as directions, or uniformly.

use super::options::EncodeOptions;
use crate::mesh::{Attribute, ComponentType, Domain, Semantic, Values};
use crate::passes::attribute::Coding;
use crate::passes::attribute::declaration::{MAX_BITS, MAX_TABLE};
use std::collections::HashMap;

/// How the entries are coded: names, and numbers of few kinds that name things, by a table; directions on the octahedron;
/// all others uniformly, whole numbers that fit exactly. `None` if a table would be too long for names. `must_be_exact`: see
/// [`must_be_exact`].
pub(super) fn choose(
    attribute: &Attribute,
    used: &[u32],
    must_be_exact: bool,
    options: &EncodeOptions,
) -> Option<Coding> {
    let Some(scalar) = attribute.values.component_type() else { return table(attribute, used) };
    if is_label(attribute, scalar)
        && let Some(table) = table(attribute, used)
    {
        return Some(table);
    }
    let bits = match attribute.semantic {
        Semantic::Normal => options.normal_bits,
        Semantic::TexCoord(_) => options.texcoord_bits,
        Semantic::Color(_) if is_linear_colour(attribute) => {
            (options.color_bits + MORE_BITS_IF_LINEAR).min(MAX_BITS)
        }
        Semantic::Color(_) => options.color_bits,
        _ => options.generic_bits,
    };
    let span = Span::of(attribute, used);
    let steps = f64::from((1_u32 << bits) - 1);
    if must_be_exact {
        return Some(identifiers(attribute, used, span, bits));
    }
    if scalar.is_integer() && span.range <= steps {
        return Some(span.whole_numbers());
    }
    if attribute.semantic == Semantic::Normal
        && attribute.num_components == 3
        && are_directions(attribute, used, scalar)
    {
        return Some(Coding::Octahedral { bits });
    }
    // Fractions of 8 bits that a text file holds come back as they were.
    let is_fraction = matches!(attribute.semantic, Semantic::Color(_)) && !scalar.is_integer();
    if is_fraction && span.is_within_0_and_1() {
        let minimum = vec![0.0; attribute.num_components];
        return Some(Coding::Uniform { bits, minimum, step: 1.0 / steps });
    }
    Some(span.in_steps(bits))
}

/// Bits that colours need in addition where equal steps are steps of light: the eye tells dark ones better.
const MORE_BITS_IF_LINEAR: u32 = 4;

/// Colours of glTF that are not in 8 bits already.
fn is_linear_colour(attribute: &Attribute) -> bool {
    attribute.name.starts_with("COLOR_") && attribute.values.component_type() != Some(ComponentType::U8)
}

/// Numbers that tell triangles apart, or their materials, groups and objects.
fn is_label(attribute: &Attribute, scalar: ComponentType) -> bool {
    matches!(attribute.semantic, Semantic::Material | Semantic::Group | Semantic::Object)
        || attribute.domain == Domain::Triangle && scalar.is_integer()
}

/// Whole numbers that measure something though they are of an integer type: fields of LAS.
const MEASURED: [&str; 2] = ["intensity", "nir"];

/// Whether the numbers may name things, such as ids and labels, so that rounding would make them name others: whole
/// numbers, in whatever type, that are neither fractions nor known to measure something.
pub(super) fn must_be_exact(attribute: &Attribute, used: &[u32]) -> bool {
    let may_name = matches!(
        attribute.semantic,
        Semantic::Generic | Semantic::Material | Semantic::Group | Semantic::Object
    );
    let n = attribute.num_components;
    let is_whole = |entry: &u32| {
        let first = *entry as usize * n;
        (first..first + n).all(|k| attribute.values.number(k).is_some_and(|x| x.fract() == 0.0))
    };
    may_name
        && !attribute.is_normalized
        && !MEASURED.contains(&attribute.name.as_str())
        && used.iter().all(is_whole)
}

/// Entries that are shared by at least this many elements are better named by their place in a table.
const ELEMENTS_PER_ENTRY: usize = 4;

/// Numbers that name things: exactly, or where even 30 bits do not reach, roughly. Exact values follow the passes then.
fn identifiers(attribute: &Attribute, used: &[u32], span: Span, bits: u32) -> Coding {
    if span.range <= f64::from((1_u32 << bits) - 1) {
        return span.whole_numbers();
    }
    let is_wide = span.range > f64::from((1_u32 << MAX_BITS) - 1);
    let most = if is_wide { MAX_TABLE } else { used.len() / ELEMENTS_PER_ENTRY };
    let is_worth = |table: &Coding| matches!(table, Coding::Table { entries } if entries.len() / attribute.num_components <= most);
    match table(attribute, used).filter(is_worth) {
        Some(table) => table,
        None if is_wide => span.in_steps(bits),
        None => span.whole_numbers(),
    }
}

/// The least and the largest number of each component.
struct Span {
    low: Vec<f64>,
    high: Vec<f64>,
    /// Of the component that has the widest.
    range: f64,
}

impl Span {
    fn of(attribute: &Attribute, used: &[u32]) -> Self {
        let n = attribute.num_components;
        let number = |entry: u32, k: usize| attribute.values.number(entry as usize * n + k).unwrap_or(0.0);
        let mut low = vec![f64::INFINITY; n];
        let mut high = vec![f64::NEG_INFINITY; n];
        for &entry in used {
            for k in 0..n {
                low[k] = low[k].min(number(entry, k));
                high[k] = high[k].max(number(entry, k));
            }
        }
        if used.is_empty() {
            (low, high) = (vec![0.0; n], vec![0.0; n]);
        }
        let range = low.iter().zip(&high).map(|(l, h)| h - l).fold(0.0, f64::max);
        Self { low, high, range }
    }

    fn is_within_0_and_1(&self) -> bool {
        self.low.iter().all(|&l| l >= 0.0) && self.high.iter().all(|&h| h <= 1.0)
    }

    /// Steps of 1, as many as it takes.
    fn whole_numbers(self) -> Coding {
        let bits = 64 - (self.range as u64).leading_zeros();
        Coding::Uniform { bits: bits.max(1), minimum: self.minimum(), step: 1.0 }
    }

    /// As many steps as the bits have.
    fn in_steps(self, bits: u32) -> Coding {
        let steps = f64::from((1_u32 << bits) - 1);
        // A range beyond double precision is quantized in halves.
        let step = if self.range.is_finite() { self.range / steps } else { f64::MAX / steps * 2.0 };
        let step = step.min(f64::MAX);
        let step = if step > 0.0 { step } else { 1.0 };
        Coding::Uniform { bits, minimum: self.minimum(), step }
    }

    /// Zeros have no sign.
    fn minimum(&self) -> Vec<f64> {
        self.low.iter().map(|l| l + 0.0).collect()
    }
}

/// Whether vectors have unit length, to a tenth.
fn are_directions(attribute: &Attribute, used: &[u32], scalar: ComponentType) -> bool {
    if scalar.is_integer() && !attribute.is_normalized {
        return false;
    }
    used.iter().all(|&entry| {
        let squared = (0..3).filter_map(|k| attribute.number(entry as usize, k)).map(|x| x * x).sum::<f64>();
        (0.81..=1.21).contains(&squared)
    })
}

/// The different entries in the order of their first use; `None` if there are too many.
fn table(attribute: &Attribute, used: &[u32]) -> Option<Coding> {
    let n = attribute.num_components;
    let mut entries = attribute.values.emptied();
    let mut seen = HashMap::new();
    for &entry in used {
        let key = key_of(attribute, entry);
        if seen.insert(key, ()).is_none() {
            let first = entry as usize * n;
            match (&attribute.values, &mut entries) {
                (Values::Names(names), Values::Names(out)) => out.push(names[first].clone()),
                (values, out) => {
                    (first..first + n).filter_map(|k| values.bits(k)).for_each(|b| out.push_bits(b))
                }
            }
        }
    }
    if entries.is_empty() {
        // Nothing has a value, but a table has entries.
        match &mut entries {
            Values::Names(names) => names.push(String::new()),
            numbers => (0..n).for_each(|_| numbers.push_bits(0)),
        }
    }
    (entries.len() / n <= MAX_TABLE).then_some(Coding::Table { entries })
}

/// What distinguishes entries of a table: a name, or the bits of numbers.
#[derive(PartialEq, Eq, Hash)]
pub(super) enum Key<'a> {
    Name(&'a str),
    Bits(Vec<u64>),
}

pub(super) fn key_of(attribute: &Attribute, entry: u32) -> Key<'_> {
    let (entry, n) = (entry as usize, attribute.num_components);
    match &attribute.values {
        Values::Names(names) => Key::Name(&names[entry]),
        values => Key::Bits((entry * n..entry * n + n).filter_map(|k| values.bits(k)).collect()),
    }
}
