//! What vertices, faces and their corners have besides positions.

use super::{
    colours::Colours,
    references::References,
    rows::Rows,
    statements::{COLOURS, Statement},
};
use crate::{
    io::{Place, ReadError, ReadReport, builder::fan, text::parse_number},
    mesh::{Attribute, Attributes, Domain, NO_ENTRY, Semantic, Values},
};
use std::collections::HashMap;

/// Values that corners refer to: `vt` or `vn`.
#[derive(Default)]
struct Table {
    values: Vec<[f64; 3]>,
    num_components: usize,
    rows: Rows,
    /// Values may follow their use.
    references: References,
    /// The line of the first corner that counts back from no values.
    before_values: Option<usize>,
}

impl Table {
    fn push<'a>(
        &mut self,
        words: impl Iterator<Item = &'a [u8]>,
        least: usize,
    ) -> Result<bool, &'static str> {
        let mut value = [0.0; 3];
        let mut num_words = 0;
        for word in words {
            if let Some(component) = value.get_mut(num_words) {
                *component = number(word).ok_or("not a number")?;
            }
            num_words += 1;
        }
        if num_words < least {
            return Err("too few numbers");
        }
        self.num_components = self.num_components.max(num_words.min(3));
        self.values.push(value);
        Ok(num_words > 3)
    }

    /// Notes what a corner has between its slashes. Some programs write 0 where there is nothing.
    fn refer(
        &mut self,
        corner: usize,
        word: &[u8],
        line: usize,
        report: &mut ReadReport,
    ) -> Result<(), &'static str> {
        if word.is_empty() {
            return Ok(());
        }
        if word == b"0" {
            report.ignore("index 0 of texture coordinates or normals");
            return Ok(());
        }
        let row = self.references.resolve(word, self.values.len(), line);
        match row.ok_or("an index is not a whole number")? {
            Some(row) => self.rows.set(corner, row),
            None if self.values.is_empty() => self.before_values = self.before_values.or(Some(line)),
            None => return Err("there is no such texture coordinate or normal"),
        }
        Ok(())
    }

    /// Checks at the end that the values which corners refer to exist. Where there are none at all, nothing is
    /// referred to.
    fn check_references(&self, what: &str, report: &mut ReadReport) -> Result<(), ReadError> {
        let num_values = self.values.len();
        if num_values >= NO_ENTRY as usize {
            return Err(ReadError::TooLarge { message: format!("{num_values} values of one kind") });
        }
        let beyond = self.references.first_beyond(num_values);
        if num_values == 0 {
            if beyond.is_some() || self.before_values.is_some() {
                report.ignore(&format!("indices of {what}s, of which there are none"));
            }
            return Ok(());
        }
        let (line, message) = match (self.before_values, beyond) {
            (Some(line), _) => (line, format!("there is no such {what} above")),
            (_, Some((line, index))) => {
                (line, format!("there is no such {what}, of {num_values}: `{index}`"))
            }
            _ => return Ok(()),
        };
        Err(ReadError::syntax(Place::Line(line), message))
    }

    /// How many numbers of each value say something. The third of texture coordinates is often 0 everywhere.
    fn num_components(&self, semantic: Semantic) -> usize {
        let is_flat =
            matches!(semantic, Semantic::TexCoord(_)) && self.values.iter().all(|value| value[2] == 0.0);
        if is_flat { self.num_components.min(2) } else { self.num_components }
    }

    fn into_attribute(self, name: &str, semantic: Semantic, corners: &[u32]) -> Option<Attribute> {
        if self.values.is_empty() {
            return None;
        }
        let n = self.num_components(semantic);
        let values = self.values.iter().flat_map(|value| &value[..n]).copied().collect();
        let rows = corners.iter().map(|&corner| self.rows.get(corner as usize)).collect();
        let attribute = Attribute::new(name, semantic, Domain::Corner, n, Values::F64(values));
        Some(Attribute { indices: Some(rows), ..attribute })
    }
}

/// Names that hold for all faces until the next: `usemtl`, `g`, `o` or `s`.
#[derive(Default)]
struct Names {
    row_of: HashMap<String, u32>,
    names: Vec<String>,
    current: Option<u32>,
    rows: Rows,
}

impl Names {
    fn begin(&mut self, name: String) {
        let next = self.names.len() as u32;
        let row = *self.row_of.entry(name).or_insert_with_key(|name| {
            self.names.push(name.clone());
            next
        });
        self.current = Some(row);
    }

    fn face(&mut self, face: usize) {
        if let Some(row) = self.current {
            self.rows.set(face, row);
        }
    }

    fn into_attribute(self, name: &str, semantic: Semantic, faces: &[u32]) -> Option<Attribute> {
        if self.names.is_empty() {
            return None;
        }
        let rows = faces.iter().map(|&face| self.rows.get(face as usize)).collect();
        let attribute = Attribute::new(name, semantic, Domain::Triangle, 1, Values::Names(self.names));
        Some(Attribute { indices: Some(rows), ..attribute })
    }
}

/// Everything so far. Faces are counted as in the file, not as triangles.
#[derive(Default)]
pub(super) struct Gathered {
    num_faces: usize,
    num_corners: usize,
    colours: Colours,
    texture: Table,
    normals: Table,
    materials: Names,
    groups: Names,
    objects: Names,
    smoothing: Names,
    material_libraries: Vec<String>,
}

impl Gathered {
    /// Takes what a `v` statement has after the position: a colour, or a weight of rational curves.
    pub fn vertex<'a>(
        &mut self,
        mut words: impl Iterator<Item = &'a [u8]>,
        report: &mut ReadReport,
    ) -> Result<(), &'static str> {
        let mut colour = None;
        let channel = |word| number(word).ok_or("a colour needs three numbers");
        let mut weight = None;
        match [(); 5].map(|()| words.next()) {
            [None, ..] => {}
            [Some(r), Some(g), Some(b), None, _] => colour = Some([channel(r)?, channel(g)?, channel(b)?]),
            [Some(w), Some(r), Some(g), Some(b), None] => {
                let numbers = [channel(w)?, channel(r)?, channel(g)?, channel(b)?];
                self.colours.four(numbers);
                return Ok(());
            }
            [Some(w), None, ..] => weight = Some(w),
            _ => report.ignore("v.more"),
        }
        // All have the weight 1 who say nothing.
        if weight.is_some_and(|weight| number(weight) != Some(1.0)) {
            report.ignore("weights of vertices");
        }
        self.colours.vertex(colour);
        Ok(())
    }

    /// Takes the corners of an `f` statement.
    pub fn face(&mut self, statement: &Statement, report: &mut ReadReport) -> Result<(), &'static str> {
        for corner in statement.words().skip(1) {
            let mut indices = corner.split(|&byte| byte == b'/').skip(1);
            for table in [&mut self.texture, &mut self.normals] {
                let word = indices.next().unwrap_or_default();
                table.refer(self.num_corners, word, statement.line, report)?;
            }
            if indices.next().is_some() {
                return Err("a corner of more than three indices");
            }
            self.num_corners += 1;
        }
        for names in [&mut self.materials, &mut self.groups, &mut self.objects, &mut self.smoothing] {
            names.face(self.num_faces);
        }
        self.num_faces += 1;
        Ok(())
    }

    /// Takes any other statement that this module knows.
    pub fn statement(&mut self, statement: &Statement, report: &mut ReadReport) -> Result<(), &'static str> {
        let mut numbers = statement.words().skip(1);
        match statement.keyword() {
            b"vt" if self.texture.push(&mut numbers, 1)? => report.ignore("vt.more"),
            b"vn" if self.normals.push(&mut numbers, 3)? => report.ignore("vn.more"),
            b"usemtl" => self.materials.begin(statement.name()),
            b"g" => self.groups.begin(statement.name()),
            b"o" => self.objects.begin(statement.name()),
            b"s" => self.smoothing.begin(statement.name()),
            COLOURS => self.colours.line(&statement.text[COLOURS.len()..], report),
            b"mtllib" => self.material_libraries.push(statement.name()),
            _ => {}
        }
        Ok(())
    }

    /// Checks at the end that the values which corners refer to exist.
    pub fn check_references(&self, report: &mut ReadReport) -> Result<(), ReadError> {
        if self.num_corners >= NO_ENTRY as usize {
            return Err(ReadError::TooLarge { message: format!("{} corners", self.num_corners) });
        }
        self.texture.check_references("texture coordinate", report)?;
        self.normals.check_references("normal", report)
    }

    /// The attributes of all triangles, after each face has been split into a fan.
    pub fn into_attributes(
        self,
        num_corners: &[u32],
        num_triangles: usize,
        report: &mut ReadReport,
    ) -> Attributes {
        let has_corners = !(self.texture.values.is_empty() && self.normals.values.is_empty());
        let tables = [&self.materials, &self.groups, &self.objects, &self.smoothing];
        let has_names = tables.iter().any(|names| !names.names.is_empty());
        // From triangles to faces of the file, and from corners to corners of the file.
        let mut faces = Vec::with_capacity(if has_names { num_triangles } else { 0 });
        let mut corners = Vec::with_capacity(if has_corners { 3 * num_triangles } else { 0 });
        let mut first = 0;
        for (face, &num) in num_corners.iter().enumerate() {
            for triangle in fan(num as usize) {
                if has_corners {
                    corners.extend(triangle.map(|corner| first + corner as u32));
                }
                if has_names {
                    faces.push(face as u32);
                }
            }
            first = first.saturating_add(num);
        }

        let list = [
            self.colours.into_attribute(report),
            self.texture.into_attribute("vt", Semantic::TexCoord(0), &corners),
            self.normals.into_attribute("vn", Semantic::Normal, &corners),
            self.materials.into_attribute("usemtl", Semantic::Material, &faces),
            self.groups.into_attribute("g", Semantic::Group, &faces),
            self.objects.into_attribute("o", Semantic::Object, &faces),
            self.smoothing.into_attribute("s", Semantic::Generic, &faces),
        ];
        Attributes {
            list: list.into_iter().flatten().collect(),
            material_libraries: self.material_libraries.into(),
            ..Attributes::default()
        }
    }
}

/// NaN of either sign is written alike.
fn number(word: &[u8]) -> Option<f64> {
    parse_number(word).map(|number| if number.is_nan() { f64::NAN } else { number })
}
