//! Writing OBJ. The numbers are the shortest that read back exactly.

use crate::{
    io::{WriteReport, texture::oriented},
    mesh::{Attribute, Attributes, Domain, Semantic, TriMesh},
};
use std::{
    borrow::Cow,
    io::{self, Write},
};

/// Writes `mesh` and those of its (valid) attributes that OBJ has statements for, and says which it has not.
pub(in crate::io) fn write(
    out: &mut impl Write,
    mesh: &TriMesh,
    attributes: &Attributes,
) -> io::Result<WriteReport> {
    let (layout, report) = Layout::new(mesh, attributes);
    for library in attributes.material_libraries.iter() {
        write_name(out, "mtllib", library)?;
    }
    for (vertex, position) in mesh.positions().iter().enumerate() {
        out.write_all(b"v")?;
        position.iter().try_for_each(|&c| write_number(out, c))?;
        if let Some((colour, row)) = layout.colour.as_ref().and_then(|c| Some((c, c.entry(vertex)?))) {
            (0..3).try_for_each(|k| write_number(out, colour.number(row, k).unwrap_or(0.0)))?;
        }
        out.write_all(b"\n")?;
    }
    let texture = layout.texture.as_deref();
    for (keyword, table) in [("vt", texture), ("vn", layout.normals)] {
        let Some(table) = table else { continue };
        for row in 0..table.num_entries() {
            out.write_all(keyword.as_bytes())?;
            for k in 0..table.num_components {
                write_number(out, table.number(row, k).unwrap_or(0.0))?;
            }
            out.write_all(b"\n")?;
        }
    }
    let mut current = vec![None; layout.names.len()];
    for (t, triangle) in mesh.triangles().iter().enumerate() {
        for ((keyword, names), current) in layout.names.iter().zip(&mut current) {
            let row = names.entry(t);
            if row != *current {
                let name = row.and_then(|row| names.values.names()?.get(row));
                write_name(out, keyword, name.map_or("", String::as_str))?;
                *current = row;
            }
        }
        out.write_all(b"f")?;
        for (corner, &vertex) in triangle.iter().enumerate() {
            write!(out, " {}", u64::from(vertex) + 1)?;
            let row = |table: Option<&Attribute>| table?.entry_at_corner(mesh, t, corner).map(|row| row + 1);
            match (row(texture), row(layout.normals)) {
                (None, None) => {}
                (Some(texture), None) => write!(out, "/{texture}")?,
                (None, Some(normal)) => write!(out, "//{normal}")?,
                (Some(texture), Some(normal)) => write!(out, "/{texture}/{normal}")?,
            }
        }
        out.write_all(b"\n")?;
    }
    Ok(report)
}

/// Which attribute goes where.
#[derive(Default)]
struct Layout<'a> {
    colour: Option<Cow<'a, Attribute>>,
    texture: Option<Cow<'a, Attribute>>,
    normals: Option<&'a Attribute>,
    names: Vec<(&'static str, &'a Attribute)>,
}

impl<'a> Layout<'a> {
    fn new(mesh: &TriMesh, attributes: &'a Attributes) -> (Self, WriteReport) {
        let mut layout = Self::default();
        let mut report = WriteReport::default();
        for attribute in &attributes.list {
            let n = attribute.num_components;
            let keyword = match attribute.semantic {
                Semantic::Material => Some("usemtl"),
                Semantic::Group => Some("g"),
                Semantic::Object => Some("o"),
                Semantic::Generic if attribute.name == "s" => Some("s"),
                _ => None,
            };
            let is_new = |keyword: &str| layout.names.iter().all(|(known, _)| *known != keyword);
            match (attribute.semantic, keyword) {
                (_, Some(keyword))
                    if attribute.values.names().is_some()
                        && attribute.domain == Domain::Triangle
                        && is_new(keyword) =>
                {
                    layout.names.push((keyword, attribute));
                }
                _ if attribute.values.names().is_some() => report.ignored.push(attribute.name.clone()),
                (Semantic::TexCoord(_), _) if n <= 3 && layout.texture.is_none() => {
                    layout.texture = Some(oriented(attribute, false));
                }
                (Semantic::Normal, _) if n == 3 && layout.normals.is_none() => {
                    layout.normals = Some(attribute)
                }
                (Semantic::Color(_), _) if (3..=4).contains(&n) && layout.colour.is_none() => {
                    layout.colour = match attribute.domain {
                        Domain::Vertex => Some(Cow::Borrowed(attribute)),
                        _ => attribute.without_seams(mesh).map(Cow::Owned),
                    };
                    match layout.colour {
                        None => report.ignored.push(attribute.name.clone()),
                        Some(_) if n == 4 => report.ignored.push(format!("{} (alpha)", attribute.name)),
                        Some(_) => {}
                    }
                }
                _ => report.ignored.push(attribute.name.clone()),
            }
        }
        (layout, report)
    }
}

fn write_number(out: &mut impl Write, number: f64) -> io::Result<()> {
    // Rust writes all the digits of a very large or small number unless asked for an exponent.
    if number == 0.0 || !number.is_finite() || (1e-5..1e16).contains(&number.abs()) {
        write!(out, " {number}")
    } else {
        write!(out, " {number:e}")
    }
}

/// Writes a statement whose argument is a name, with what would end the name replaced.
fn write_name(out: &mut impl Write, keyword: &str, name: &str) -> io::Result<()> {
    let name: String = name.chars().map(|c| if matches!(c, '\n' | '\r') { '_' } else { c }).collect();
    // A backslash at the very end would continue the line.
    let end = if name.ends_with('\\') { " " } else { "" };
    match name.as_str() {
        "" => writeln!(out, "{keyword}"),
        name => writeln!(out, "{keyword} {name}{end}"),
    }
}
