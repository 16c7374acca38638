//! Which attribute is written where in PLY, and as what.

use super::columns::{is_readable, property_names};
use super::textures::{self, TEXTURE_FILE};
use crate::{
    io::{
        ColorType, WriteError, WriteOptions,
        convert::{
            ColourFormat, ColourNumbers, Neutral, SPLIT_SEAMS, Split, as_float32, converted, dropped, filled,
            joined, oriented,
        },
    },
    losses::{Loss, LossKind, Losses, Stage},
    mesh::{Attribute, Attributes, ComponentType, Domain, Semantic, TriMesh},
};
use std::{borrow::Cow, collections::HashSet};

/// An attribute, and the properties that its components are.
pub(super) struct Column<'a> {
    pub attribute: Cow<'a, Attribute>,
    pub names: Vec<String>,
}

/// Which attribute goes where.
#[derive(Default)]
pub(super) struct Layout<'a> {
    pub of_vertices: Vec<Column<'a>>,
    pub of_faces: Vec<Column<'a>>,
    /// Texture coordinates of corners: a list in each face.
    pub wedge: Option<Cow<'a, Attribute>>,
    /// Files of textures.
    pub textures: &'a [String],
}

impl<'a> Layout<'a> {
    /// Also gives the mesh, with vertices repeated at seams if the options want that.
    pub fn new(
        mesh: &'a TriMesh,
        attributes: &'a Attributes,
        options: &WriteOptions,
        losses: &mut Losses,
    ) -> Result<(Cow<'a, TriMesh>, Self), WriteError> {
        let (names, numbers): (Vec<_>, Vec<_>) =
            attributes.list.iter().partition(|attribute| attribute.values.names().is_some());
        let (textures, names): (Vec<&Attribute>, Vec<&Attribute>) =
            names.into_iter().partition(|attribute| attribute.name == TEXTURE_FILE);
        names.iter().for_each(|attribute| losses.push(dropped(&attribute.name, "OBJ keeps names")));
        if !attributes.material_libraries.is_empty() {
            losses.push(dropped("mtllib", "OBJ keeps it"));
        }
        let (numbers, empty): (Vec<&Attribute>, Vec<&Attribute>) =
            numbers.into_iter().partition(|attribute| has_values(attribute, mesh));
        empty.iter().for_each(|attribute| losses.push(dropped(&attribute.name, "it has no values")));
        // The names say it, and a stream may have them in another order.
        let (stale, numbers): (Vec<_>, Vec<_>) =
            numbers.into_iter().partition(|a| !textures.is_empty() && textures::is_number(a));
        stale.iter().for_each(|attribute| losses.push(dropped(&attribute.name, "")));
        let written = numbers.into_iter().map(|attribute| written_as(attribute, options, losses)).collect();
        let (mesh, mut written) = without_seams(mesh, joined(written, mesh), options, losses)?;
        let texture_numbers = textures.first().and_then(|textures| textures::numbers(textures, &mesh));
        written.extend(texture_numbers.map(Cow::Owned));
        let textures = textures.first().and_then(|attribute| attribute.values.names()).unwrap_or_default();
        let mut layout = Self { textures, ..Self::default() };
        let mut neutral = Neutral::new(&mesh);
        for attribute in written {
            layout.place(attribute, &mesh, &mut neutral, losses);
        }
        drop(neutral);
        make_unique(&mut layout.of_vertices, &["x", "y", "z"], losses);
        make_unique(&mut layout.of_faces, &["vertex_indices", "vertex_index", "texcoord"], losses);
        Ok((mesh, layout))
    }

    fn place(
        &mut self,
        attribute: Cow<'a, Attribute>,
        mesh: &TriMesh,
        neutral: &mut Neutral,
        losses: &mut Losses,
    ) {
        let num_elements = attribute.domain.num_elements(mesh);
        let names = property_names(&attribute);
        match attribute.domain {
            Domain::Vertex => {
                let attribute = filled(attribute, num_elements, |vertex| vertex, neutral, losses);
                self.of_vertices.push(Column { attribute, names });
            }
            Domain::Triangle => {
                let first = |triangle: usize| mesh.triangles()[triangle][0] as usize;
                let attribute = filled(attribute, num_elements, first, neutral, losses);
                self.of_faces.push(Column { attribute, names });
            }
            Domain::Corner if self.wedge.is_none() && may_be_wedge(&attribute) => {
                self.wedge = Some(attribute)
            }
            Domain::Corner => losses.push(dropped(&attribute.name, SPLIT_SEAMS)),
        }
    }
}

/// The attribute in the conventions and types of PLY.
fn written_as<'a>(
    attribute: &'a Attribute,
    options: &WriteOptions,
    losses: &mut Losses,
) -> Cow<'a, Attribute> {
    match attribute.semantic {
        Semantic::Color(_) => converted(Cow::Borrowed(attribute), colour_format(options), losses),
        Semantic::TexCoord(_) => as_float32(oriented(attribute, false, losses), losses),
        Semantic::Normal => as_float32(Cow::Borrowed(attribute), losses),
        // Integers that stand for fractions are understood as such in colours only.
        _ if attribute.is_normalized => as_float32(Cow::Borrowed(attribute), losses),
        _ => Cow::Borrowed(attribute),
    }
}

fn colour_format(options: &WriteOptions) -> ColourFormat {
    let numbers = match options.color_type {
        ColorType::Uchar => ColourNumbers::Of(ComponentType::U8),
        ColorType::Ushort => ColourNumbers::Of(ComponentType::U16),
        ColorType::Float => ColourNumbers::Of(ComponentType::F32),
        ColorType::Keep => ColourNumbers::Any,
    };
    ColourFormat { is_linear: options.linear_colours(false), numbers }
}

/// Attributes of corners without seams are those of vertices; with them as well, if vertices may be repeated.
fn without_seams<'a>(
    mesh: &'a TriMesh,
    attributes: Vec<Cow<'a, Attribute>>,
    options: &WriteOptions,
    losses: &mut Losses,
) -> Result<(Cow<'a, TriMesh>, Vec<Cow<'a, Attribute>>), WriteError> {
    let smooth = attributes.into_iter().map(|attribute| {
        // Faces of one mesh have lists where another has none: what came as lists stays so.
        let is_list = attribute.name == "texcoord" && may_be_wedge(&attribute) && !options.split_seams;
        attribute.without_seams(mesh).filter(|_| !is_list).map_or(attribute, Cow::Owned)
    });
    let smooth: Vec<_> = smooth.collect();
    if !options.split_seams || smooth.iter().all(|attribute| attribute.domain != Domain::Corner) {
        return Ok((Cow::Borrowed(mesh), smooth));
    }
    let of_corners = smooth.iter().filter(|attribute| attribute.domain == Domain::Corner);
    let split = Split::new(mesh, of_corners.map(|attribute| &**attribute))?;
    losses.append(split.loss(mesh));
    let split_up = |attribute: Cow<'a, Attribute>| match attribute.domain {
        Domain::Triangle => attribute,
        _ => Cow::Owned(split.on_vertices(&attribute)),
    };
    let attributes = smooth.into_iter().map(split_up).collect();
    Ok((Cow::Owned(split.mesh(mesh)), attributes))
}

fn may_be_wedge(attribute: &Attribute) -> bool {
    let is_float = attribute.values.component_type().is_some_and(|scalar| !scalar.is_integer());
    matches!(attribute.semantic, Semantic::TexCoord(_)) && attribute.num_components == 2 && is_float
}

/// Whether an element has a value, if there are any elements.
fn has_values(attribute: &Attribute, mesh: &TriMesh) -> bool {
    let num_elements = attribute.domain.num_elements(mesh);
    num_elements == 0 || (0..num_elements).any(|element| attribute.entry(element).is_some())
}

/// No two properties of an element have one name. Says which names are others than those that the attributes had.
fn make_unique(columns: &mut [Column], reserved: &[&str], losses: &mut Losses) {
    let mut known: HashSet<String> = reserved.iter().map(|&name| name.to_owned()).collect();
    for Column { attribute, names } in columns {
        if !are_free(names, &known) {
            let numbered = |k: usize| (0..names.len()).map(|c| format!("{}_{k}_{c}", names[c])).collect();
            let free = (2..).map(numbered).find(|names: &Vec<String>| are_free(names, &known));
            *names = free.unwrap_or_default();
        }
        if !is_readable(attribute, names) {
            let subject = format!("{} ({})", attribute.name, names.join(" "));
            losses.push(Loss::new(Stage::Writing, LossKind::NamesChanged, subject));
        }
        known.extend(names.iter().cloned());
    }
}

fn are_free(names: &[String], known: &HashSet<String>) -> bool {
    let is_repeated = |(k, name): (usize, &String)| names[..k].contains(name);
    !names.iter().enumerate().any(is_repeated) && !names.iter().any(|name| known.contains(name))
}
