//! Which properties of an element make an attribute, and under which names one is written.

use super::header::{Element, Property};
use crate::mesh::{Attribute, ComponentType, Domain, Semantic, Values};

/// Names of properties that belong together if they follow each other and have one type.
const GROUPS: [(&[&str], Kind); 9] = [
    (&["nx", "ny", "nz"], Kind::Normal),
    (&["red", "green", "blue", "alpha"], Kind::Color),
    (&["red", "green", "blue"], Kind::Color),
    (&["r", "g", "b", "a"], Kind::Color),
    (&["r", "g", "b"], Kind::Color),
    (&["diffuse_red", "diffuse_green", "diffuse_blue"], Kind::Color),
    (&["s", "t"], Kind::TexCoord),
    (&["u", "v"], Kind::TexCoord),
    (&["texture_u", "texture_v"], Kind::TexCoord),
];

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Normal,
    Color,
    TexCoord,
}

/// Puts the single values among the properties of `element` for which `is_free` holds together to
/// attributes. Gives the (still empty) attributes, and for each property the one it belongs to.
pub(super) fn attributes_of(
    element: &Element,
    domain: Domain,
    is_free: impl Fn(&Property) -> bool,
) -> (Vec<Attribute>, Vec<Option<usize>>) {
    let mut attributes = Vec::new();
    let mut owners = vec![None; element.properties.len()];
    let is_column = |&k: &usize| {
        let property = &element.properties[k];
        property.list_count.is_none() && is_free(property)
    };
    let columns: Vec<usize> = (0..element.properties.len()).filter(is_column).collect();
    let mut sets = [0; 2];
    let mut rest = &columns[..];
    while let Some(&first) = rest.first() {
        let scalar = element.properties[first].scalar;
        let is_next = |(&k, &name): (&usize, &&str)| {
            element.properties[k].name == name && element.properties[k].scalar == scalar
        };
        let group = GROUPS
            .iter()
            .find(|(names, _)| names.len() <= rest.len() && rest.iter().zip(names.iter()).all(is_next));
        let num_components = group.map_or(1, |(names, _)| names.len());
        let name = match group {
            Some((names, _)) => names.join(" "),
            None => element.properties[first].name.clone(),
        };
        let mut next_set = |k: usize| {
            sets[k] += 1;
            sets[k] - 1
        };
        let semantic = match group {
            Some((_, Kind::Normal)) => Semantic::Normal,
            Some((_, Kind::Color)) => Semantic::Color(next_set(0)),
            Some((_, Kind::TexCoord)) => Semantic::TexCoord(next_set(1)),
            None if scalar.is_integer() && matches!(&*name, "material_index" | "texnumber") => {
                Semantic::Material
            }
            None => Semantic::Generic,
        };
        let (own, others) = rest.split_at(num_components);
        own.iter().for_each(|&k| owners[k] = Some(attributes.len()));
        rest = others;
        attributes.push(Attribute {
            is_normalized: scalar.is_integer() && matches!(semantic, Semantic::Color(_)),
            ..Attribute::new(name, semantic, domain, num_components, Values::new(scalar.kept))
        });
    }
    (attributes, owners)
}

/// The names of the properties that `attribute` is written as: its own if it has one for each component,
/// else those that its meaning has in most files.
pub(super) fn property_names(attribute: &Attribute) -> Vec<String> {
    let num_components = attribute.num_components;
    let own: Vec<&str> = attribute.name.split(' ').collect();
    let is_name =
        |word: &&str| !word.is_empty() && !word.contains(|c: char| c.is_control() || c.is_ascii_whitespace());
    let is_free = |word: &&str| attribute.domain != Domain::Vertex || !matches!(*word, "x" | "y" | "z");
    let is_usual = num_components > 1 || matches!(attribute.semantic, Semantic::Generic | Semantic::Material);
    if own.len() == num_components && is_usual && own.iter().all(|w| is_name(w) && is_free(w)) {
        return own.into_iter().map(str::to_owned).collect();
    }
    let (stems, set): (&[&str], u32) = match attribute.semantic {
        Semantic::Normal => (&["nx", "ny", "nz"], 0),
        Semantic::Color(set) => (&["red", "green", "blue", "alpha"], set),
        Semantic::TexCoord(set) => (&["s", "t"], set),
        Semantic::Material => (&["material_index"], 0),
        _ => (&[], 0),
    };
    if num_components <= stems.len() {
        let suffix = if set == 0 { String::new() } else { set.to_string() };
        return stems[..num_components].iter().map(|stem| format!("{stem}{suffix}")).collect();
    }
    let clean = |c: char| if c.is_control() || c.is_ascii_whitespace() { '_' } else { c };
    let stem: String = attribute.name.chars().map(clean).collect();
    (0..num_components).map(|k| format!("{stem}_{k}")).collect()
}

/// Whether readers know properties of these names as the attribute: by its own name, or by one that has its meaning.
pub(super) fn is_readable(attribute: &Attribute, names: &[String]) -> bool {
    let joined = names.join(" ");
    let has_meaning = match attribute.semantic {
        Semantic::Normal => joined == "nx ny nz",
        Semantic::Color(_) => matches!(&*joined, "red green blue" | "red green blue alpha"),
        Semantic::TexCoord(_) => joined == "s t",
        Semantic::Material => joined == "material_index",
        _ => false,
    };
    has_meaning || joined == attribute.name
}

/// What PLY calls a type. The names with bits are as old as `short` and `ushort`, which meshio does not know.
pub(super) fn scalar_name(scalar: ComponentType) -> &'static str {
    match scalar {
        ComponentType::I8 => "char",
        ComponentType::U8 => "uchar",
        ComponentType::I16 => "int16",
        ComponentType::U16 => "uint16",
        ComponentType::I32 => "int",
        ComponentType::U32 => "uint",
        ComponentType::F32 => "float",
        ComponentType::F64 => "double",
    }
}
