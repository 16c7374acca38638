//! Stanford PLY: text, binary little-endian and binary big-endian.
//!
//! The reader is our own. That of `ply-rs-bw` believes the count of an element without properties, which
//! takes no bytes, and then fills memory with nothing; it allocates a list per face, and does not know the
//! byte offset of an error. This one goes through the body once, value by value, and allocates for what it
//! has found.
//!
//! Every property of vertices and faces that is a single value is kept under its name, in its type. Of the
//! lists only `texcoord` of faces is kept, two numbers for each corner.

mod body;
mod columns;
mod header;
mod layout;
mod scalar;
mod textures;
mod write;

pub(super) use write::Plan;

use super::{MeshFile, ReadError, beside::Folder, builder::MeshBuilder, builder::fan, source::Source};
use crate::mesh::{Attribute, ComponentType, Domain, NO_ENTRY, Semantic, Values};
use body::Body;
use columns::attributes_of;
use header::{Element, Property, read_header};
use scalar::widen;

/// Reads a PLY file, and the images of its textures from `folder`. Elements other than `vertex`, `face` and `tristrips` are skipped.
pub(super) fn read(source: &mut Source, folder: &mut Folder) -> Result<MeshFile, ReadError> {
    let header = read_header(source)?;
    let mut body = Body::new(header.encoding, source);
    let num_vertices = header.num_vertices()?;
    let mut builder = MeshBuilder::default();
    let mut is_first = true;
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => read_vertices(&mut body, element, &mut builder)?,
            // The triangles of any other are bare.
            "face" if std::mem::take(&mut is_first) => {
                read_faces(&mut body, element, num_vertices, &mut builder)?;
            }
            "face" => read_bare_faces(&mut body, element, num_vertices, &mut builder)?,
            "tristrips" => read_bare_faces(&mut body, element, num_vertices, &mut builder)?,
            _ => {
                builder.report.ignore(&element.name);
                skip_element(&mut body, element)?;
            }
        }
    }
    if body.has_rounded {
        builder.report.ignore("the last digits of integers beyond 53 bits");
    }
    builder.num_bytes = body.offset();
    builder.attributes.metadata = header.metadata.into();
    let mut file = builder.finish()?;
    textures::attach(&mut file, header.textures, folder);
    Ok(file)
}

fn read_vertices(body: &mut Body, element: &Element, builder: &mut MeshBuilder) -> Result<(), ReadError> {
    let axis_of = |p: &Property| match p.name.as_str() {
        _ if p.list_count.is_some() => None,
        "x" => Some(0),
        "y" => Some(1),
        "z" => Some(2),
        _ => None,
    };
    let axes: Vec<Option<usize>> = element.properties.iter().map(axis_of).collect();
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        if element.count > 0 && !axes.contains(&Some(axis)) {
            return Err(ReadError::syntax(element.place, format!("vertices without property {name}")));
        }
    }
    let (mut attributes, owners) = attributes_of(element, Domain::Vertex, |p| axis_of(p).is_none());
    ignore_others(element, builder, |k| axes[k].is_some() || owners[k].is_some());

    let read_vertex = |body: &mut Body, attributes: &mut [Attribute]| {
        body.begin_element()?;
        let mut position = [0.0; 3];
        for (k, property) in element.properties.iter().enumerate() {
            match (axes[k], owners[k]) {
                (Some(axis), _) => position[axis] = body.number(property.scalar)?,
                (_, Some(owner)) => body.push(&mut attributes[owner].values, property.scalar)?,
                _ => body.skip(property)?,
            }
        }
        body.end_element()?;
        Ok(position)
    };
    reserve(&mut builder.positions, body.room_for(element.count, 3))?;
    for index in 0..element.count {
        let position =
            read_vertex(body, &mut attributes).map_err(|fault| body.error(fault, element, index))?;
        if !position.iter().all(|c| c.is_finite()) {
            let message =
                format!("vertex {} of {} has a coordinate that is not finite", index + 1, element.count);
            return Err(ReadError::syntax(body.place(), message));
        }
        builder.positions.push(position);
    }
    builder.attributes.list.append(&mut attributes);
    Ok(())
}

/// Makes room for as many elements as a file may have; where addresses have 32 bits there may be none.
fn reserve<T>(list: &mut Vec<T>, count: usize) -> Result<(), ReadError> {
    let too_large = |_| ReadError::TooLarge { message: format!("no memory for {count} elements") };
    list.try_reserve_exact(count).map_err(too_large)
}

/// The list of vertex indices among the properties of an element.
fn corners_property(element: &Element) -> Result<usize, ReadError> {
    let is_corners = |p: &Property| matches!(p.name.as_str(), "vertex_indices" | "vertex_index");
    let found = element.properties.iter().position(|p| is_corners(p) && p.list_count.is_some());
    match found {
        Some(k) => Ok(k),
        None if element.count == 0 => Ok(element.properties.len()),
        None => {
            let message = format!("element {} has no list of vertex_indices", element.name);
            Err(ReadError::syntax(element.place, message))
        }
    }
}

/// Indices are float64 until they are checked.
fn checked_index(
    number: f64,
    num_vertices: u32,
    body: &Body,
    element: &Element,
    index: u64,
) -> Result<u32, ReadError> {
    let found = number as u32;
    if f64::from(found) == number && found < num_vertices {
        return Ok(found);
    }
    let Element { name, count, .. } = element;
    let message = format!(
        "{name} {} of {count} has the vertex index {number}, but there are {num_vertices} vertices",
        index + 1
    );
    Err(ReadError::syntax(body.place(), message))
}

fn read_faces(
    body: &mut Body,
    element: &Element,
    num_vertices: u32,
    builder: &mut MeshBuilder,
) -> Result<(), ReadError> {
    let corners_at = corners_property(element)?;
    let is_wedge = |p: &Property| p.name == "texcoord" && p.list_count.is_some() && !p.scalar.is_integer();
    let wedge_at = element.properties.iter().position(is_wedge).filter(|&k| k != corners_at);
    let (attributes, owners) = attributes_of(element, Domain::Triangle, |_| true);
    ignore_others(element, builder, |k| k == corners_at || wedge_at == Some(k) || owners[k].is_some());

    // Triangles that came before have no row.
    builder.num_bytes = body.offset();
    builder.check_rows(attributes.len(), builder.triangles.len())?;
    let mut faces = Faces {
        attributes,
        wedge: wedge_at.map(|k| {
            let values = Values::new(element.properties[k].scalar.kept);
            Attribute::new("texcoord", Semantic::TexCoord(0), Domain::Corner, 2, values)
        }),
        rows: vec![NO_ENTRY; builder.triangles.len()],
        wedge_rows: vec![NO_ENTRY; 3 * builder.triangles.len()],
        num_rows: 0,
    };
    let mut numbers = Vec::new();
    let wedge_type = wedge_at.map_or(ComponentType::F32, |k| element.properties[k].scalar.kept);
    let mut wedge_values = Values::new(wedge_type);
    let read_face =
        |body: &mut Body, attributes: &mut [Attribute], numbers: &mut Vec<f64>, wedge: &mut Values| {
            body.begin_element()?;
            for (k, property) in element.properties.iter().enumerate() {
                match (property.list_count, owners[k]) {
                    (_, Some(owner)) => body.push(&mut attributes[owner].values, property.scalar)?,
                    (Some(count), _) if k == corners_at => {
                        for _ in 0..body.list_length(count)? {
                            numbers.push(body.number(property.scalar)?);
                        }
                    }
                    (Some(count), _) if wedge_at == Some(k) => {
                        for _ in 0..body.list_length(count)? {
                            body.push(wedge, property.scalar)?;
                        }
                    }
                    _ => body.skip(property)?,
                }
            }
            body.end_element()
        };
    reserve(&mut builder.triangles, body.room_for(element.count, 4))?;
    let mut corners = Vec::new();
    for index in 0..element.count {
        numbers.clear();
        wedge_values.truncate(0);
        corners.clear();
        read_face(body, &mut faces.attributes, &mut numbers, &mut wedge_values)
            .map_err(|fault| body.error(fault, element, index))?;
        for &number in &numbers {
            corners.push(checked_index(number, num_vertices, body, element, index)?);
        }
        builder.push_polygon(&corners);
        faces.end_polygon(corners.len(), &wedge_values, builder)?;
    }
    builder.num_bytes = body.offset();
    builder.check_rows(faces.attributes.len(), builder.triangles.len())?;
    faces.finish(builder);
    Ok(())
}

/// The attributes of faces and their corners while polygons become triangles.
struct Faces {
    attributes: Vec<Attribute>,
    /// Texture coordinates of corners.
    wedge: Option<Attribute>,
    /// The row that each triangle so far has in all of `attributes`.
    rows: Vec<u32>,
    /// The same of each corner, in `wedge`.
    wedge_rows: Vec<u32>,
    num_rows: usize,
}

impl Faces {
    /// After the values of a polygon were added to `attributes`, and its triangles to `builder`.
    fn end_polygon(
        &mut self,
        num_corners: usize,
        wedge_values: &Values,
        builder: &mut MeshBuilder,
    ) -> Result<(), ReadError> {
        let too_many = |_| ReadError::TooLarge { message: "more than 2^32 values".to_owned() };
        if num_corners < 3 {
            // The face was skipped.
            for attribute in &mut self.attributes {
                attribute.values.truncate(self.num_rows * attribute.num_components);
            }
            return Ok(());
        }
        if !self.attributes.is_empty() {
            let row = u32::try_from(self.num_rows).map_err(too_many)?;
            self.rows.resize(builder.triangles.len(), row);
        }
        self.num_rows += 1;
        if let Some(wedge) = &mut self.wedge {
            if wedge_values.len() == 2 * num_corners {
                let first = u32::try_from(wedge.num_entries()).map_err(too_many)?;
                u32::try_from(wedge.num_entries() + num_corners).map_err(too_many)?;
                // Once a number is float64, all that follow are.
                if wedge_values.component_type() == Some(ComponentType::F64) {
                    widen(&mut wedge.values);
                }
                wedge.values.append(wedge_values.clone());
                let row = |corner: usize| first + corner as u32;
                self.wedge_rows.extend(fan(num_corners).flatten().map(row));
            } else {
                if !wedge_values.is_empty() {
                    builder.report.ignore("face.texcoord of another length");
                }
                self.wedge_rows.resize(3 * builder.triangles.len(), NO_ENTRY);
            }
        }
        Ok(())
    }

    fn finish(self, builder: &mut MeshBuilder) {
        let with_rows = |attribute| Attribute { indices: Some(self.rows.clone()), ..attribute };
        builder.attributes.list.extend(self.attributes.into_iter().map(with_rows));
        let with_rows = |wedge| Attribute { indices: Some(self.wedge_rows), ..wedge };
        builder.attributes.list.extend(self.wedge.map(with_rows));
    }
}

/// Reads polygons without their attributes, or triangle strips, in which -1 ends one and begins the next.
fn read_bare_faces(
    body: &mut Body,
    element: &Element,
    num_vertices: u32,
    builder: &mut MeshBuilder,
) -> Result<(), ReadError> {
    let is_strips = element.name == "tristrips";
    let corners_at = corners_property(element)?;
    ignore_others(element, builder, |k| k == corners_at);
    let read_corners = |body: &mut Body, numbers: &mut Vec<f64>| {
        body.begin_element()?;
        for (k, property) in element.properties.iter().enumerate() {
            match property.list_count {
                Some(count) if k == corners_at => {
                    for _ in 0..body.list_length(count)? {
                        numbers.push(body.number(property.scalar)?);
                    }
                }
                _ => body.skip(property)?,
            }
        }
        body.end_element()
    };
    let mut numbers = Vec::new();
    let mut corners = Vec::new();
    for index in 0..element.count {
        numbers.clear();
        corners.clear();
        read_corners(body, &mut numbers).map_err(|fault| body.error(fault, element, index))?;
        for &number in &numbers {
            if is_strips && number == -1.0 {
                builder.push_strip(&corners);
                corners.clear();
            } else {
                corners.push(checked_index(number, num_vertices, body, element, index)?);
            }
        }
        if is_strips { builder.push_strip(&corners) } else { builder.push_polygon(&corners) }
    }
    Ok(())
}

fn skip_element(body: &mut Body, element: &Element) -> Result<(), ReadError> {
    // Without properties it has no bytes and no line, whatever its count.
    let count = if element.properties.is_empty() { 0 } else { element.count };
    for index in 0..count {
        let mut skip = || {
            body.begin_element()?;
            element.properties.iter().try_for_each(|p| body.skip(p))?;
            body.end_element()
        };
        skip().map_err(|fault| body.error(fault, element, index))?;
    }
    Ok(())
}

/// Notes the properties that are not used, by their position in the element.
fn ignore_others(element: &Element, builder: &mut MeshBuilder, is_used: impl Fn(usize) -> bool) {
    for (k, property) in element.properties.iter().enumerate() {
        if !is_used(k) {
            builder.report.ignore(&format!("{}.{}", element.name, property.name));
        }
    }
}
