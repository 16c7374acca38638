//! Writing PLY: binary, little-endian.

use super::{
    columns::{property_names, scalar_name},
    textures::TEXTURE_FILE,
};
use crate::{
    io::{WriteReport, texture::oriented},
    mesh::{Attribute, Attributes, ComponentType, Domain, Semantic, TriMesh, Values},
};
use std::{
    borrow::Cow,
    io::{self, Write},
};

/// Writes `mesh` and those of its (valid) attributes that PLY can hold, and says which it cannot.
pub(in crate::io) fn write(
    out: &mut impl Write,
    mesh: &TriMesh,
    attributes: &Attributes,
) -> io::Result<WriteReport> {
    let (layout, report) = Layout::new(mesh, attributes);
    let is_float = mesh.positions().iter().flatten().all(|&c| f64::from(c as f32) == c);
    let coordinate = if is_float { "float" } else { "double" };
    // Many readers know `int` only; it reaches far enough nearly always.
    let index = if mesh.num_vertices() <= i32::MAX as usize { "int" } else { "uint" };
    out.write_all(b"ply\nformat binary_little_endian 1.0\n")?;
    for name in layout.textures {
        writeln!(out, "comment {TEXTURE_FILE} {}", one_line(name))?;
    }
    for (key, text) in &*attributes.metadata {
        writeln!(out, "comment {} {}", one_line(key), one_line(text))?;
    }
    write!(
        out,
        "element vertex {}\nproperty {coordinate} x\nproperty {coordinate} y\nproperty {coordinate} z\n",
        mesh.num_vertices(),
    )?;
    declare(out, &layout.of_vertices)?;
    write!(out, "element face {}\nproperty list uchar {index} vertex_indices\n", mesh.num_triangles())?;
    if let Some(wedge) = &layout.wedge {
        writeln!(out, "property list uchar {} texcoord", scalar_name(number_type(wedge)))?;
    }
    declare(out, &layout.of_faces)?;
    out.write_all(b"end_header\n")?;

    for (vertex, position) in mesh.positions().iter().enumerate() {
        if is_float {
            out.write_all(position.map(|c| (c as f32).to_le_bytes()).as_flattened())?;
        } else {
            out.write_all(position.map(f64::to_le_bytes).as_flattened())?;
        }
        layout
            .of_vertices
            .iter()
            .try_for_each(|attribute| write_row(out, attribute, attribute.entry(vertex)))?;
    }
    for (t, triangle) in mesh.triangles().iter().enumerate() {
        let mut face = [3; 13];
        face[1..].copy_from_slice(triangle.map(u32::to_le_bytes).as_flattened());
        out.write_all(&face)?;
        if let Some(wedge) = &layout.wedge {
            write_wedge(out, wedge, [0, 1, 2].map(|corner| wedge.entry(3 * t + corner)))?;
        }
        layout.of_faces.iter().try_for_each(|attribute| write_row(out, attribute, attribute.entry(t)))?;
    }
    Ok(report)
}

/// A comment ends where its line ends.
fn one_line(text: &str) -> String {
    text.replace(['\n', '\r'], " ")
}

/// Which attribute goes where.
#[derive(Default)]
struct Layout<'a> {
    of_vertices: Vec<Cow<'a, Attribute>>,
    of_faces: Vec<Cow<'a, Attribute>>,
    /// Texture coordinates of corners: a list in each face.
    wedge: Option<Cow<'a, Attribute>>,
    /// Files of textures.
    textures: &'a [String],
}

impl<'a> Layout<'a> {
    fn new(mesh: &TriMesh, attributes: &'a Attributes) -> (Self, WriteReport) {
        let mut layout = Self::default();
        let mut report = WriteReport::default();
        for attribute in &attributes.list {
            let may_be_wedge = layout.wedge.is_none()
                && matches!(attribute.semantic, Semantic::TexCoord(_))
                && attribute.num_components == 2
                && !number_type(attribute).is_integer();
            let came_as_wedge = attribute.name == "texcoord" && may_be_wedge;
            match attribute.domain {
                _ if attribute.name == TEXTURE_FILE && attribute.values.names().is_some() => {
                    layout.textures = attribute.values.names().unwrap_or_default();
                }
                _ if attribute.values.names().is_some() => report.ignored.push(attribute.name.clone()),
                Domain::Vertex => layout.of_vertices.push(written_as(Cow::Borrowed(attribute))),
                Domain::Triangle => layout.of_faces.push(written_as(Cow::Borrowed(attribute))),
                Domain::Corner => match attribute.without_seams(mesh).filter(|_| !came_as_wedge) {
                    Some(smooth) => layout.of_vertices.push(written_as(Cow::Owned(smooth))),
                    None if may_be_wedge => layout.wedge = Some(written_as(Cow::Borrowed(attribute))),
                    None => report.ignored.push(attribute.name.clone()),
                },
            }
        }
        report.ignored.extend(attributes.material_libraries.first().map(|_| "mtllib".to_owned()));
        let columns = layout.of_vertices.iter().chain(&layout.of_faces);
        let has_gaps = |a: &&Cow<Attribute>| (0..a.domain.num_elements(mesh)).any(|e| a.entry(e).is_none());
        report.zeroed = columns.filter(has_gaps).map(|a| a.name.clone()).collect();
        (layout, report)
    }
}

/// Integers that stand for fractions are understood as such in colours only: others become float32.
fn written_as(attribute: Cow<'_, Attribute>) -> Cow<'_, Attribute> {
    let attribute = match oriented(&attribute, false) {
        Cow::Owned(turned) => Cow::Owned(turned),
        Cow::Borrowed(_) => attribute,
    };
    if !attribute.is_normalized || matches!(attribute.semantic, Semantic::Color(_)) {
        return attribute;
    }
    let number = |k: usize| {
        attribute.number(k / attribute.num_components, k % attribute.num_components).unwrap_or(0.0) as f32
    };
    let values = Values::F32((0..attribute.values.len()).map(number).collect());
    Cow::Owned(Attribute { values, is_normalized: false, ..attribute.into_owned() })
}

fn number_type(attribute: &Attribute) -> ComponentType {
    attribute.values.component_type().unwrap_or(ComponentType::F32)
}

fn declare(out: &mut impl Write, attributes: &[Cow<Attribute>]) -> io::Result<()> {
    for attribute in attributes {
        for name in property_names(attribute) {
            writeln!(out, "property {} {name}", scalar_name(number_type(attribute)))?;
        }
    }
    Ok(())
}

/// Writes a row, zeros if there is none.
fn write_row(out: &mut impl Write, attribute: &Attribute, row: Option<usize>) -> io::Result<()> {
    let num_bytes = number_type(attribute).num_bytes();
    for k in 0..attribute.num_components {
        let bits = row.and_then(|row| attribute.values.bits(row * attribute.num_components + k));
        out.write_all(&bits.unwrap_or(0).to_le_bytes()[..num_bytes])?;
    }
    Ok(())
}

/// Writes the list of the corners' values, an empty one if a corner has none.
fn write_wedge(out: &mut impl Write, wedge: &Attribute, rows: [Option<usize>; 3]) -> io::Result<()> {
    if rows.contains(&None) {
        return out.write_all(&[0]);
    }
    out.write_all(&[6])?;
    rows.into_iter().try_for_each(|row| write_row(out, wedge, row))
}
