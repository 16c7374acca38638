//! Writing PLY: binary, little-endian.

use super::columns::scalar_name;
use super::layout::{Column, Layout};
use super::textures::TEXTURE_FILE;
use crate::{
    io::{
        WriteError, WriteOptions,
        convert::{check_float32, is_float32, loss_of, rounding},
    },
    losses::{Loss, LossKind, Losses, Stage},
    mesh::{Attribute, Attributes, ComponentType, TriMesh},
};
use std::{
    borrow::Cow,
    io::{self, Write},
};

/// A file that can be written.
pub(in crate::io) struct Plan<'a> {
    mesh: Cow<'a, TriMesh>,
    layout: Layout<'a>,
    metadata: &'a [(String, String)],
    is_float: bool,
}

impl<'a> Plan<'a> {
    /// Chooses names and types for `mesh` and those of its (valid) attributes that PLY can hold, and says what is lost.
    ///
    /// # Errors
    /// If positions do not fit the type that the options want, or there are too many vertices after splitting.
    pub fn new(
        mesh: &'a TriMesh,
        attributes: &'a Attributes,
        options: &WriteOptions,
        losses: &mut Losses,
    ) -> Result<Self, WriteError> {
        let is_float = is_float32(mesh, options);
        if is_float {
            check_float32(mesh, "PLY")?;
            let remedy = "`--position-type double` keeps them";
            losses.append(rounding(mesh, [0.0; 3]).map(|r| loss_of(r, mesh, remedy)).into_iter().collect());
        }
        let (mesh, layout) = Layout::new(mesh, attributes, options, losses)?;
        let texts = attributes.metadata.iter().map(|(key, text)| (key.as_str(), text));
        let textures = layout.textures.iter().map(|name| (TEXTURE_FILE, name));
        for (key, _) in
            texts.chain(textures).filter(|(key, text)| one_line(text) != **text || one_line(key) != *key)
        {
            let subject = format!("{key} (line breaks)");
            losses.push(Loss::new(Stage::Writing, LossKind::NamesChanged, subject).count(1));
        }
        Ok(Self { mesh, layout, metadata: &attributes.metadata, is_float })
    }

    /// Writes the file.
    ///
    /// # Errors
    /// If `out` fails.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        self.write_header(out)?;
        self.write_vertices(out)?;
        self.write_faces(out)
    }

    fn write_header(&self, out: &mut impl Write) -> io::Result<()> {
        let coordinate = if self.is_float { "float" } else { "double" };
        // Many readers know `int` only; it reaches far enough nearly always.
        let index = if self.mesh.num_vertices() <= i32::MAX as usize { "int" } else { "uint" };
        let num_vertices = self.mesh.num_vertices();
        out.write_all(b"ply\nformat binary_little_endian 1.0\n")?;
        self.write_comments(out)?;
        writeln!(out, "element vertex {num_vertices}")?;
        ["x", "y", "z"].iter().try_for_each(|axis| writeln!(out, "property {coordinate} {axis}"))?;
        declare(out, &self.layout.of_vertices)?;
        let num_triangles = self.mesh.num_triangles();
        write!(out, "element face {num_triangles}\nproperty list uchar {index} vertex_indices\n")?;
        if let Some(wedge) = &self.layout.wedge {
            writeln!(out, "property list uchar {} texcoord", scalar_name(number_type(wedge)))?;
        }
        declare(out, &self.layout.of_faces)?;
        out.write_all(b"end_header\n")
    }

    fn write_comments(&self, out: &mut impl Write) -> io::Result<()> {
        for name in self.layout.textures {
            writeln!(out, "comment {TEXTURE_FILE} {}", one_line(name))?;
        }
        for (key, text) in self.metadata {
            writeln!(out, "comment {} {}", one_line(key), one_line(text))?;
        }
        Ok(())
    }

    fn write_vertices(&self, out: &mut impl Write) -> io::Result<()> {
        for (vertex, position) in self.mesh.positions().iter().enumerate() {
            if self.is_float {
                out.write_all(position.map(|c| (c as f32).to_le_bytes()).as_flattened())?;
            } else {
                out.write_all(position.map(f64::to_le_bytes).as_flattened())?;
            }
            let mut columns = self.layout.of_vertices.iter().map(|column| &column.attribute);
            columns.try_for_each(|attribute| write_row(out, attribute, attribute.entry(vertex)))?;
        }
        Ok(())
    }

    fn write_faces(&self, out: &mut impl Write) -> io::Result<()> {
        for (t, triangle) in self.mesh.triangles().iter().enumerate() {
            let mut face = [3; 13];
            face[1..].copy_from_slice(triangle.map(u32::to_le_bytes).as_flattened());
            out.write_all(&face)?;
            if let Some(wedge) = &self.layout.wedge {
                write_wedge(out, wedge, [0, 1, 2].map(|corner| wedge.entry(3 * t + corner)))?;
            }
            let mut columns = self.layout.of_faces.iter().map(|column| &column.attribute);
            columns.try_for_each(|attribute| write_row(out, attribute, attribute.entry(t)))?;
        }
        Ok(())
    }
}

/// A comment ends where its line ends.
fn one_line(text: &str) -> String {
    text.replace(['\n', '\r'], " ")
}

fn number_type(attribute: &Attribute) -> ComponentType {
    attribute.values.component_type().unwrap_or(ComponentType::F32)
}

fn declare(out: &mut impl Write, columns: &[Column]) -> io::Result<()> {
    for Column { attribute, names } in columns {
        let scalar = scalar_name(number_type(attribute));
        names.iter().try_for_each(|name| writeln!(out, "property {scalar} {name}"))?;
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
