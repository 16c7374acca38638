//! Which attributes glTF can hold, under which names and in which types.

use crate::{
    io::{
        WriteOptions,
        convert::{ColourFormat, ColourNumbers, as_float32, converted, dropped, joined, oriented},
    },
    losses::{Loss, LossKind, Losses, Stage},
    mesh::{Attribute, Attributes, ComponentType, Domain, Semantic, TriMesh, Values},
};
use std::{borrow::Cow, collections::HashSet};

/// An attribute in a type that glTF has.
pub(super) struct Column<'a> {
    pub attribute: Cow<'a, Attribute>,
    pub name: String,
}

const TANGENT: &str = "TANGENT";

/// Chooses names and types, and says what is lost.
pub(super) fn columns<'a>(
    mesh: &TriMesh,
    attributes: &'a Attributes,
    options: &WriteOptions,
    losses: &mut Losses,
) -> Vec<Column<'a>> {
    let material = first_material(attributes);
    let is_material = |a: &&Attribute| material.is_some_and(|material| std::ptr::eq(*a, material));
    let written = attributes.list.iter().filter(|a| !is_material(a));
    let written = written.filter_map(|attribute| written_as(attribute, attributes, options, losses));
    let written = joined(written.collect(), mesh);
    if !attributes.material_libraries.is_empty() {
        losses.push(dropped("mtllib", "OBJ keeps it"));
    }
    let mut names = Names::default();
    written.into_iter().filter_map(|attribute| names.named(attribute, losses)).collect()
}

/// The names of materials: those of triangles.
pub(super) fn first_material(attributes: &Attributes) -> Option<&Attribute> {
    let is_material = |a: &&Attribute| {
        a.semantic == Semantic::Material && a.domain == Domain::Triangle && a.values.names().is_some()
    };
    attributes.list.iter().find(is_material)
}

/// The attribute in the conventions and types of glTF, `None` if it has no place for it.
fn written_as<'a>(
    attribute: &'a Attribute,
    all: &Attributes,
    options: &WriteOptions,
    losses: &mut Losses,
) -> Option<Cow<'a, Attribute>> {
    if let Some(remedy) = obstacle(attribute, all) {
        losses.push(dropped(&attribute.name, remedy));
        return None;
    }
    let written = match attribute.semantic {
        Semantic::Color(_) => {
            let is_linear = options.linear_colours(true);
            let format = ColourFormat { is_linear, numbers: ColourNumbers::Gltf };
            return Some(converted(Cow::Borrowed(attribute), format, losses));
        }
        Semantic::Normal if attribute.num_components == 3 => Some(unit_directions(attribute, losses)),
        _ if attribute.name == TANGENT => Some(unit_directions(attribute, losses)),
        _ => representable(oriented(attribute, true, losses), losses),
    };
    if written.is_none() {
        let remedy = "glTF has whole numbers up to 16777216 and finite numbers; PLY keeps it";
        losses.push(dropped(&attribute.name, remedy));
    }
    written
}

/// Why glTF has no place for an attribute: what keeps it.
fn obstacle(attribute: &Attribute, all: &Attributes) -> Option<&'static str> {
    let n = attribute.num_components;
    let is_of = |wanted: fn(Semantic) -> bool| wanted(attribute.semantic);
    let is_colour = is_of(|semantic| matches!(semantic, Semantic::Color(_))) && (n == 3 || n == 4);
    let has = |wanted: &dyn Fn(&Attribute) -> bool| all.list.iter().any(wanted);
    match attribute.domain {
        _ if attribute.num_entries() == 0 => Some("it has no values"),
        _ if attribute.values.names().is_some() => Some("OBJ keeps names"),
        // Colours of faces are those of their corners, if these have no others.
        Domain::Triangle if is_colour => {
            let is_other =
                |a: &Attribute| a.domain != Domain::Triangle && matches!(a.semantic, Semantic::Color(_));
            has(&is_other).then_some("glTF has one colour at a corner; PLY keeps both")
        }
        Domain::Triangle => Some("PLY keeps numbers of faces"),
        _ if attribute.name == TANGENT && n == 4 => {
            let is_normal = |a: &Attribute| a.semantic == Semantic::Normal && a.num_components == 3;
            (!has(&is_normal)).then_some("tangents need normals")
        }
        // They mean something together with others that are not here.
        _ if is_dependent(&attribute.name) => Some("it means nothing without what it belongs to"),
        _ if n > 4 => Some("PLY keeps more than four numbers"),
        _ => None,
    }
}

fn is_dependent(name: &str) -> bool {
    name == TANGENT || name.starts_with("JOINTS_") || name.starts_with("WEIGHTS_")
}

/// Names given so far. Sets are numbered from 0.
#[derive(Default)]
struct Names {
    known: HashSet<String>,
    num_texcoords: usize,
    num_colors: usize,
}

impl Names {
    fn named<'a>(&mut self, attribute: Cow<'a, Attribute>, losses: &mut Losses) -> Option<Column<'a>> {
        let n = attribute.num_components;
        let set = |count: &mut usize, prefix: &str| {
            *count += 1;
            format!("{prefix}_{}", *count - 1)
        };
        let name = match attribute.semantic {
            Semantic::Normal if n == 3 => "NORMAL".to_owned(),
            Semantic::TexCoord(_) if n == 2 => set(&mut self.num_texcoords, "TEXCOORD"),
            Semantic::Color(_) if n == 3 || n == 4 => set(&mut self.num_colors, "COLOR"),
            _ if attribute.name == TANGENT => TANGENT.to_owned(),
            _ => self.custom(&attribute.name),
        };
        if self.known.contains(&name) {
            losses.push(dropped(&attribute.name, "glTF has one set; PLY keeps both"));
            return None;
        }
        // What other formats call texture coordinates, colours and normals is the same under its name here.
        let is_gltf = ["TEXCOORD_", "COLOR_"].iter().any(|prefix| attribute.name.starts_with(prefix));
        if attribute.name != name && (is_gltf || name.starts_with('_')) {
            let subject = format!("{} ({name})", attribute.name);
            losses.push(Loss::new(Stage::Writing, LossKind::NamesChanged, subject));
        }
        self.known.insert(name.clone());
        Some(Column { attribute, name })
    }

    /// Names of applications begin with an underscore. They are case-sensitive.
    fn custom(&self, name: &str) -> String {
        let clean: String = name.chars().map(|c| if c.is_control() { '_' } else { c }).collect();
        let name = if clean.starts_with('_') { clean } else { format!("_{clean}") };
        let numbered = (2..).map(|k| format!("{name}_{k}"));
        let is_free = |name: &String| !self.known.contains(name);
        std::iter::once(name.clone()).chain(numbered).find(is_free).unwrap_or_default()
    }
}

/// The attribute as it is if glTF has such values there, else as float32; `None` if that would lose something
/// that is not only rounding, or is not finite.
fn representable<'a>(attribute: Cow<'a, Attribute>, losses: &mut Losses) -> Option<Cow<'a, Attribute>> {
    let scalar = attribute.values.component_type()?;
    let is_free = !matches!(attribute.semantic, Semantic::TexCoord(_));
    let is_kept = match scalar {
        ComponentType::U8 | ComponentType::U16 => is_free || attribute.is_normalized,
        ComponentType::I8 | ComponentType::I16 => is_free,
        _ => false,
    };
    if is_kept {
        return Some(attribute);
    }
    let is_counted = is_counted(&attribute, scalar);
    let fits = |k: usize| {
        let number = attribute.values.number(k).unwrap_or(0.0);
        let float = number as f32;
        float.is_finite() && (!is_counted || f64::from(float) == number)
    };
    let fits = (0..attribute.values.len()).all(fits);
    fits.then(|| as_float32(attribute, losses))
}

/// Whether the numbers may name or count something: integers, or floats that are all whole and no directions or colours.
fn is_counted(attribute: &Attribute, scalar: ComponentType) -> bool {
    if scalar.is_integer() {
        return !attribute.is_normalized;
    }
    let has_fractions =
        matches!(attribute.semantic, Semantic::Normal | Semantic::TexCoord(_) | Semantic::Color(_));
    let is_whole = |k: usize| attribute.values.number(k).is_some_and(|number| number.fract() == 0.0);
    !has_fractions && (0..attribute.values.len()).all(is_whole)
}

/// Directions of length 1, as glTF wants them, those that are nearly so as they are; what has no direction points along x
/// if it is a tangent, else along z. Tangents are followed by a sign.
fn unit_directions<'a>(attribute: &'a Attribute, losses: &mut Losses) -> Cow<'a, Attribute> {
    /// Lengths that rounding explains.
    const NEARLY: f64 = 1e-5;
    let (other, other_name) =
        if attribute.name == TANGENT { ([1.0, 0.0, 0.0], "1 0 0") } else { ([0.0, 0.0, 1.0], "0 0 1") };
    let (mut num_made_up, mut num_changed) = (0, 0);
    let mut unit = |row: usize| {
        let number = |k: usize| attribute.number(row, k).unwrap_or(0.0);
        let direction = [0, 1, 2].map(number);
        let length = direction.iter().map(|c| c * c).sum::<f64>().sqrt();
        let is_direction = length > 0.0 && length.is_finite();
        let is_unit = (length - 1.0).abs() < NEARLY;
        let unit = match (is_direction, is_unit) {
            (false, _) => other,
            (true, true) => direction,
            (true, false) => direction.map(|c| c / length),
        };
        let sign = (attribute.num_components > 3).then(|| if number(3) < 0.0 { -1.0 } else { 1.0 });
        num_made_up += usize::from(!is_direction);
        let is_turned = sign.is_some_and(|sign| sign != number(3));
        num_changed += usize::from(is_direction && (!is_unit || is_turned));
        unit.into_iter().chain(sign)
    };
    let numbers: Vec<f64> = (0..attribute.num_entries()).flat_map(&mut unit).collect();
    let mut say = |kind, count: usize, how: &str| {
        let loss = Loss::new(Stage::Writing, kind, format!("{} ({how})", attribute.name));
        losses.append(
            Some(loss.count(count).of(attribute.num_entries())).filter(|_| count > 0).into_iter().collect(),
        );
    };
    say(LossKind::ValuesFilled, num_made_up, other_name);
    say(LossKind::ValuesConverted, num_changed, "to length 1");
    let is_float = attribute.values.component_type() == Some(ComponentType::F32);
    let values = if is_float || num_made_up + num_changed > 0 {
        Values::F32(numbers.into_iter().map(|c| c as f32).collect())
    } else {
        Values::F64(numbers)
    };
    as_float32(Cow::Owned(Attribute { values, is_normalized: false, ..attribute.clone() }), losses)
}
