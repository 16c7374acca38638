//! Which attribute is written as which statement of OBJ.

use crate::{
    io::{
        WriteError, WriteOptions,
        convert::{
            ColourFormat, ColourNumbers, Neutral, SPLIT_SEAMS, Split, converted, dropped, filled, joined,
            oriented,
        },
    },
    losses::{Loss, LossKind, Losses, Stage},
    mesh::{Attribute, Attributes, Domain, Semantic, TriMesh},
};
use std::{borrow::Cow, collections::HashSet};

/// Statements that name what the faces below belong to. Programs forget the group at `o`, so this is their order.
const KEYWORDS: [&str; 4] = ["o", "g", "usemtl", "s"];

/// Names of triangles.
pub(super) struct Names<'a> {
    pub keyword: &'static str,
    pub attribute: &'a Attribute,
    /// Those of the attribute as they are written.
    pub table: Vec<String>,
    /// The name of what comes after a name and has none.
    pub without: String,
}

/// Which attribute goes where.
#[derive(Default)]
pub(super) struct Layout<'a> {
    pub colour: Option<Cow<'a, Attribute>>,
    pub texture: Option<Cow<'a, Attribute>>,
    pub normals: Option<Cow<'a, Attribute>>,
    pub names: Vec<Names<'a>>,
}

impl<'a> Layout<'a> {
    /// Also gives the mesh, with vertices repeated at seams if the options want that.
    pub fn new(
        mesh: &'a TriMesh,
        attributes: &'a Attributes,
        options: &WriteOptions,
        losses: &mut Losses,
    ) -> Result<(Cow<'a, TriMesh>, Self), WriteError> {
        let mut layout = Self::default();
        let (names, numbers): (Vec<_>, Vec<_>) =
            attributes.list.iter().partition(|attribute| attribute.values.names().is_some());
        let written = numbers.into_iter().map(|attribute| written_as(attribute, options, losses)).collect();
        for attribute in joined(written, mesh) {
            layout.place(attribute, losses);
        }
        names.into_iter().for_each(|attribute| layout.place_names(attribute, losses));
        let place = |names: &Names| KEYWORDS.iter().position(|&keyword| keyword == names.keyword);
        layout.names.sort_by_key(place);
        let mesh = if options.split_seams { layout.split(mesh, losses)? } else { Cow::Borrowed(mesh) };
        layout.finish_colours(&mesh, losses);
        Ok((mesh, layout))
    }

    fn place(&mut self, attribute: Cow<'a, Attribute>, losses: &mut Losses) {
        let n = attribute.num_components;
        let slot = match attribute.semantic {
            Semantic::TexCoord(_) if n <= 3 => &mut self.texture,
            Semantic::Normal if n == 3 => &mut self.normals,
            Semantic::Color(_) if n == 3 || n == 4 => &mut self.colour,
            _ => return losses.push(dropped(&attribute.name, "PLY keeps numbers of any name")),
        };
        if slot.is_some() {
            return losses.push(dropped(&attribute.name, "OBJ has one set; PLY and glTF have several"));
        }
        *slot = Some(attribute);
    }

    fn place_names(&mut self, attribute: &'a Attribute, losses: &mut Losses) {
        let keyword = match attribute.semantic {
            Semantic::Object => Some("o"),
            Semantic::Group => Some("g"),
            Semantic::Material => Some("usemtl"),
            Semantic::Generic if attribute.name == "s" => Some("s"),
            _ => None,
        };
        let is_new = |keyword: &&str| self.names.iter().all(|names| names.keyword != *keyword);
        match keyword.filter(|_| attribute.domain == Domain::Triangle).filter(is_new) {
            Some(keyword) => self.names.push(Names::new(keyword, attribute, losses)),
            None => losses.push(dropped(&attribute.name, "")),
        }
    }

    /// Repeats vertices so that position, texture coordinates and normal of a corner have one number each.
    fn split(&mut self, mesh: &'a TriMesh, losses: &mut Losses) -> Result<Cow<'a, TriMesh>, WriteError> {
        let slots = [&mut self.colour, &mut self.texture, &mut self.normals];
        let split = Split::new(mesh, slots.iter().filter_map(|slot| slot.as_deref()))?;
        losses.append(split.loss(mesh));
        for slot in slots {
            *slot = slot.take().map(|attribute| Cow::Owned(in_order(&split.on_vertices(&attribute))));
        }
        Ok(Cow::Owned(split.mesh(mesh)))
    }

    /// Colours are behind positions: those of vertices, and either all have one or none. There is no opacity.
    fn finish_colours(&mut self, mesh: &TriMesh, losses: &mut Losses) {
        let Some(colour) = self.colour.take() else { return };
        let colour = match colour.domain {
            Domain::Vertex => colour,
            _ => match colour.without_seams(mesh) {
                Some(smooth) => Cow::Owned(smooth),
                None => return losses.push(dropped(&colour.name, no_seams(&colour))),
            },
        };
        let is_clear = |row| colour.number(row, 3).is_some_and(|opacity| opacity != 1.0);
        if colour.num_components == 4 && (0..colour.num_entries()).any(is_clear) {
            losses.push(dropped(&format!("{} (alpha)", colour.name), "PLY and glTF keep it"));
        }
        let mut neutral = Neutral::new(mesh);
        self.colour = Some(filled(colour, mesh.num_vertices(), |vertex| vertex, &mut neutral, losses));
    }
}

fn no_seams(colour: &Attribute) -> &'static str {
    match colour.domain {
        Domain::Corner => SPLIT_SEAMS,
        _ => "PLY keeps it, and `--split-seams` repeats vertices for it",
    }
}

/// The attribute in the conventions of OBJ.
fn written_as<'a>(
    attribute: &'a Attribute,
    options: &WriteOptions,
    losses: &mut Losses,
) -> Cow<'a, Attribute> {
    if !matches!(attribute.semantic, Semantic::Color(_)) {
        return oriented(attribute, false, losses);
    }
    let is_linear = options.linear_colours(false);
    let format = ColourFormat { is_linear, numbers: ColourNumbers::Any };
    let colour = converted(Cow::Borrowed(attribute), format, losses);
    let is_integer = colour.values.component_type().is_some_and(|scalar| scalar.is_integer());
    // Integers that nobody called normalised are colours of their range.
    if is_integer && !colour.is_normalized {
        return Cow::Owned(Attribute { is_normalized: true, ..colour.into_owned() });
    }
    colour
}

/// An attribute of vertices with a row for each: row k is that of vertex k. Vertices without any share one more.
fn in_order(attribute: &Attribute) -> Attribute {
    let num_vertices = attribute.indices.as_ref().map_or(0, Vec::len);
    if (0..num_vertices).any(|vertex| attribute.entry(vertex).is_none()) {
        return attribute.clone();
    }
    let n = attribute.num_components;
    let mut values = attribute.values.emptied();
    for row in (0..num_vertices).filter_map(|vertex| attribute.entry(vertex)) {
        (row * n..(row + 1) * n).for_each(|k| values.push_bits(attribute.values.bits(k).unwrap_or(0)));
    }
    Attribute { values, indices: None, ..attribute.clone() }
}

impl<'a> Names<'a> {
    fn new(keyword: &'static str, attribute: &'a Attribute, losses: &mut Losses) -> Self {
        let mut table = clean(attribute.values.names().unwrap_or_default(), keyword, losses);
        let mut without = String::new();
        if keyword == "o" {
            without = name_all(&mut table, losses);
        } else if keyword == "s" {
            "off".clone_into(&mut without);
        }
        let num_without = num_after_names(attribute);
        if num_without > 0 {
            let subject = format!("{} (`{without}`)", attribute.name);
            let loss = Loss::new(Stage::Writing, LossKind::ValuesFilled, subject);
            losses.push(loss.count(num_without));
        }
        Self { keyword, attribute, table, without }
    }
}

/// Triangles without a name after one that has one: OBJ cannot end the use of a name but by another.
fn num_after_names(attribute: &Attribute) -> usize {
    let num_triangles = attribute.indices.as_ref().map_or(0, Vec::len);
    let after = (0..num_triangles).skip_while(|&triangle| attribute.entry(triangle).is_none());
    after.filter(|&triangle| attribute.entry(triangle).is_none()).count()
}

/// Gives each object without a name one of its own, since programs do not know an `o` without. Returns one more.
fn name_all(table: &mut [String], losses: &mut Losses) -> String {
    let known: HashSet<String> = table.iter().cloned().collect();
    let numbered = (2..).map(|k| format!("object_{k}"));
    let mut free =
        std::iter::once("object".to_owned()).chain(numbered).filter(|name: &String| !known.contains(name));
    let mut count = 0;
    for name in table.iter_mut().filter(|name| name.is_empty()) {
        *name = free.next().unwrap_or_default();
        count += 1;
    }
    if count > 0 {
        let subject = "objects (empty before)";
        losses.push(Loss::new(Stage::Writing, LossKind::NamesChanged, subject).count(count));
    }
    free.next().unwrap_or_default()
}

/// Names as OBJ can have them: in one line, without white space around them; `#` begins a comment after `s` only.
pub(super) fn clean(names: &[String], keyword: &str, losses: &mut Losses) -> Vec<String> {
    let is_bad = |c: char| matches!(c, '\n' | '\r') || (c == '#' && keyword == "s");
    let clean = |name: &String| {
        let name: String = name.chars().map(|c| if is_bad(c) { '_' } else { c }).collect();
        name.trim_ascii().to_owned()
    };
    let cleaned: Vec<String> = names.iter().map(clean).collect();
    let num_changed = names.iter().zip(&cleaned).filter(|(before, after)| before != after).count();
    if num_changed > 0 {
        losses.push(Loss::new(Stage::Writing, LossKind::NamesChanged, keyword).count(num_changed));
    }
    cleaned
}
