//! Writing OBJ. The numbers are the shortest that read back exactly: as float64, or as float32 if that is the type
//! that positions have in other formats.

use super::layout::{Layout, Names};
use crate::{
    io::{
        PositionType, WriteError, WriteOptions,
        convert::{check_float32, is_float32, loss_of, rounding},
    },
    losses::Losses,
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
    material_libraries: Vec<String>,
    is_float: bool,
}

impl<'a> Plan<'a> {
    /// Chooses statements for `mesh` and those of its (valid) attributes that OBJ has some for, and says what is lost.
    ///
    /// # Errors
    /// If positions do not fit the type that the options want, or there are too many vertices after splitting.
    pub fn new(
        mesh: &'a TriMesh,
        attributes: &'a Attributes,
        options: &WriteOptions,
        losses: &mut Losses,
    ) -> Result<Self, WriteError> {
        // Where nothing may move, numbers are the same float64, too.
        let may_move = options.step.is_some() || options.position_type == PositionType::Float;
        let is_float = may_move && is_float32(mesh, options);
        if is_float {
            check_float32(mesh, "OBJ")?;
            let remedy = "`--position-type double` keeps them";
            let rounding = rounding(mesh, [0.0; 3]);
            losses.append(rounding.map(|r| loss_of(r, mesh, remedy)).into_iter().collect());
        }
        let (mesh, layout) = Layout::new(mesh, attributes, options, losses)?;
        let material_libraries = super::layout::clean(&attributes.material_libraries, "mtllib", losses);
        Ok(Self { mesh, layout, material_libraries, is_float })
    }

    /// Writes the file.
    ///
    /// # Errors
    /// If `out` fails.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        self.material_libraries.iter().try_for_each(|name| write_name(out, "mtllib", name))?;
        self.write_vertices(out)?;
        for (keyword, table) in [("vt", &self.layout.texture), ("vn", &self.layout.normals)] {
            if let Some(table) = table {
                self.write_table(out, keyword, table)?;
            }
        }
        self.write_faces(out)
    }

    fn write_vertices(&self, out: &mut impl Write) -> io::Result<()> {
        for (vertex, position) in self.mesh.positions().iter().enumerate() {
            out.write_all(b"v")?;
            position.iter().try_for_each(|&c| write_number(out, c, self.is_float))?;
            if let Some((colour, row)) = self.layout.colour.as_ref().and_then(|c| Some((c, c.entry(vertex)?)))
            {
                (0..3).try_for_each(|k| self.write_value(out, colour, row, k))?;
            }
            out.write_all(b"\n")?;
        }
        Ok(())
    }

    fn write_table(&self, out: &mut impl Write, keyword: &str, table: &Attribute) -> io::Result<()> {
        for row in 0..table.num_entries() {
            out.write_all(keyword.as_bytes())?;
            (0..table.num_components).try_for_each(|k| self.write_value(out, table, row, k))?;
            out.write_all(b"\n")?;
        }
        Ok(())
    }

    fn write_value(&self, out: &mut impl Write, table: &Attribute, row: usize, k: usize) -> io::Result<()> {
        let is_float = self.is_float && table.values.component_type() == Some(ComponentType::F32);
        write_number(out, table.number(row, k).unwrap_or(0.0), is_float)
    }

    fn write_faces(&self, out: &mut impl Write) -> io::Result<()> {
        let (texture, normals) = (self.layout.texture.as_deref(), self.layout.normals.as_deref());
        let mut current = vec![None; self.layout.names.len()];
        for (t, triangle) in self.mesh.triangles().iter().enumerate() {
            for (names, current) in self.layout.names.iter().zip(&mut current) {
                write_names(out, names, t, current)?;
            }
            out.write_all(b"f")?;
            for (corner, &vertex) in triangle.iter().enumerate() {
                write!(out, " {}", u64::from(vertex) + 1)?;
                let row = |table: Option<&Attribute>| {
                    table?.entry_at_corner(&self.mesh, t, corner).map(|row| row + 1)
                };
                match (row(texture), row(normals)) {
                    (None, None) => {}
                    (Some(texture), None) => write!(out, "/{texture}")?,
                    (None, Some(normal)) => write!(out, "//{normal}")?,
                    (Some(texture), Some(normal)) => write!(out, "/{texture}/{normal}")?,
                }
            }
            out.write_all(b"\n")?;
        }
        Ok(())
    }
}

/// Writes the statement for the name of a triangle if it is another than that of the one before.
fn write_names(
    out: &mut impl Write,
    names: &Names,
    triangle: usize,
    current: &mut Option<usize>,
) -> io::Result<()> {
    let row = names.attribute.entry(triangle);
    if row == *current {
        return Ok(());
    }
    *current = row;
    let name = row.and_then(|row| names.table.get(row)).unwrap_or(&names.without);
    write_name(out, names.keyword, name)
}

fn write_number(out: &mut impl Write, number: f64, is_float: bool) -> io::Result<()> {
    // Rust writes all the digits of a very large or small number unless asked for an exponent.
    let is_plain = number == 0.0 || !number.is_finite() || (1e-5..1e16).contains(&number.abs());
    match (is_plain, is_float) {
        (true, true) => write!(out, " {}", number as f32),
        (true, false) => write!(out, " {number}"),
        (false, true) => write!(out, " {:e}", number as f32),
        (false, false) => write!(out, " {number:e}"),
    }
}

/// Writes a statement whose argument is a name.
fn write_name(out: &mut impl Write, keyword: &str, name: &str) -> io::Result<()> {
    // A backslash at the very end would continue the line.
    let end = if name.ends_with('\\') { " " } else { "" };
    if name.is_empty() { writeln!(out, "{keyword}") } else { writeln!(out, "{keyword} {name}{end}") }
}
