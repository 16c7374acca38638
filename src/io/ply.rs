//! Stanford PLY: text, binary little-endian and binary big-endian.
//!
//! The reader is our own. That of `ply-rs-bw` believes the count of an element without properties, which
//! takes no bytes, and then fills memory with nothing; it allocates a list per face, and does not know the
//! byte offset of an error. This one goes through the body once, value by value, and allocates for what it
//! has found.

use super::{
    MeshFile, Place, ReadError,
    builder::MeshBuilder,
    text::{Lines, parse_number, quoted, words},
};
use crate::mesh::TriMesh;
use std::io::{self, Write};

/// Reads a PLY file. Of the elements `vertex`, `face` and `tristrips` the position and the vertex indices
/// are used; other elements and properties are skipped.
pub(super) fn read(bytes: &[u8]) -> Result<MeshFile, ReadError> {
    let (header, mut body) = read_header(bytes)?;
    let num_vertices = header.num_vertices()?;
    let mut builder = MeshBuilder::default();
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => read_vertices(&mut body, element, &mut builder)?,
            "face" | "tristrips" => read_faces(&mut body, element, num_vertices, &mut builder)?,
            _ => {
                builder.report.ignore(&element.name);
                skip_element(&mut body, element)?;
            }
        }
    }
    builder.finish()
}

/// Writes a binary little-endian file: `float` if every coordinate is a float32, else `double`.
pub(super) fn write(out: &mut impl Write, mesh: &TriMesh) -> io::Result<()> {
    write_coloured(out, mesh, None)
}

/// As [`write`], with red, green and blue of every vertex if they are given.
pub(super) fn write_coloured(
    out: &mut impl Write,
    mesh: &TriMesh,
    colours: Option<&[[u8; 3]]>,
) -> io::Result<()> {
    let colour = if colours.is_some() {
        "property uchar red\nproperty uchar green\nproperty uchar blue\n"
    } else {
        ""
    };
    let is_float = mesh.positions().iter().flatten().all(|&c| f64::from(c as f32) == c);
    let coordinate = if is_float { "float" } else { "double" };
    // Many readers know `int` only; it reaches far enough nearly always.
    let index = if mesh.num_vertices() <= i32::MAX as usize { "int" } else { "uint" };
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\n\
         element vertex {}\nproperty {coordinate} x\nproperty {coordinate} y\nproperty {coordinate} z\n{colour}\
         element face {}\nproperty list uchar {index} vertex_indices\nend_header\n",
        mesh.num_vertices(),
        mesh.num_triangles(),
    )?;
    for (v, position) in mesh.positions().iter().enumerate() {
        if is_float {
            out.write_all(position.map(|c| (c as f32).to_le_bytes()).as_flattened())?;
        } else {
            out.write_all(position.map(f64::to_le_bytes).as_flattened())?;
        }
        if let Some(colours) = colours {
            out.write_all(&colours[v])?;
        }
    }
    for triangle in mesh.triangles() {
        let mut face = [3; 13];
        face[1..].copy_from_slice(triangle.map(u32::to_le_bytes).as_flattened());
        out.write_all(&face)?;
    }
    Ok(())
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn from_name(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    fn num_bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    fn is_integer(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }

    /// The value of the lowest [`Self::num_bytes`] bytes of `bits`. Every type fits into a float64.
    fn value(self, bits: u64) -> f64 {
        match self {
            Self::I8 => f64::from(bits as i8),
            Self::U8 => f64::from(bits as u8),
            Self::I16 => f64::from(bits as i16),
            Self::U16 => f64::from(bits as u16),
            Self::I32 => f64::from(bits as i32),
            Self::U32 => f64::from(bits as u32),
            Self::F32 => f64::from(f32::from_bits(bits as u32)),
            Self::F64 => f64::from_bits(bits),
        }
    }
}

struct Property {
    name: String,
    /// The type of the count before a list; `None` if this is a single value.
    list_count: Option<Scalar>,
    scalar: Scalar,
}

struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
    /// The line of its declaration.
    place: Place,
}

struct Header {
    elements: Vec<Element>,
}

impl Header {
    fn num_vertices(&self) -> Result<u32, ReadError> {
        let mut counts = self.elements.iter().filter(|e| e.name == "vertex");
        let count = counts.next().map_or(0, |element| element.count);
        if let Some(second) = counts.next() {
            return Err(ReadError::syntax(second.place, "a second element named vertex"));
        }
        match u32::try_from(count) {
            Ok(count) if count < u32::MAX => Ok(count),
            _ => Err(ReadError::TooLarge { message: format!("{count} vertices") }),
        }
    }
}

fn read_header(bytes: &[u8]) -> Result<(Header, Body<'_>), ReadError> {
    let mut lines = Lines::new(bytes);
    match lines.next() {
        Some((_, magic)) if magic.trim_ascii_end() == b"ply" => {}
        _ => return Err(ReadError::syntax(Place::Line(1), "not a PLY file: it does not begin with `ply`")),
    }
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    while let Some((number, line)) = lines.next() {
        let is_cut = lines.num_left() == 0 && !bytes.ends_with(b"\n") && !bytes.ends_with(b"\r");
        if is_cut && line != b"end_header" {
            break;
        }
        let place = Place::Line(number);
        let bad = |cause: &str| ReadError::syntax(place, format!("{cause}: {}", quoted(line)));
        let words: Vec<&[u8]> = words(line).take(6).collect();
        match words[..] {
            [] | [b"comment" | b"obj_info", ..] => {}
            [b"format", name, version] => encoding = Some(parse_encoding(name, version, place)?),
            [b"element", name, count] => {
                let count = std::str::from_utf8(count).ok().and_then(|count| count.parse().ok());
                elements.push(Element {
                    name: String::from_utf8_lossy(name).into_owned(),
                    count: count.ok_or_else(|| bad("the count of an element is not a number"))?,
                    properties: Vec::new(),
                    place,
                });
            }
            [b"property", ref declaration @ ..] => {
                let property = parse_property(declaration).ok_or_else(|| bad("not a property"))?;
                let element = elements.last_mut().ok_or_else(|| bad("a property before any element"))?;
                element.properties.push(property);
            }
            [b"end_header"] => {
                let encoding =
                    encoding.ok_or_else(|| ReadError::syntax(place, "the header names no format"))?;
                return Ok((Header { elements }, Body::new(encoding, bytes, lines)));
            }
            _ => return Err(bad("not a line of a PLY header")),
        }
    }
    Err(ReadError::syntax(Place::Line(lines.number()), "the file ends in the header"))
}

fn parse_encoding(name: &[u8], version: &[u8], place: Place) -> Result<Encoding, ReadError> {
    let encoding = match name {
        b"ascii" => Encoding::Ascii,
        b"binary_little_endian" => Encoding::LittleEndian,
        b"binary_big_endian" => Encoding::BigEndian,
        _ => return Err(ReadError::syntax(place, format!("unknown format {}", quoted(name)))),
    };
    if version != b"1.0" {
        return Err(ReadError::Unsupported { place, message: format!("PLY version {}", quoted(version)) });
    }
    Ok(encoding)
}

fn parse_property(declaration: &[&[u8]]) -> Option<Property> {
    let (list_count, scalar, name) = match *declaration {
        [b"list", count, scalar, name] => (Some(Scalar::from_name(count)?), scalar, name),
        [scalar, name] => (None, scalar, name),
        _ => return None,
    };
    if list_count.is_some_and(|count| !count.is_integer()) {
        return None;
    }
    let name = String::from_utf8_lossy(name).into_owned();
    Some(Property { name, list_count, scalar: Scalar::from_name(scalar)? })
}

/// What follows the header, as a sequence of numbers.
enum Body<'a> {
    /// One element to a line. `word` is the last one read, for messages.
    Ascii { lines: Lines<'a>, rest: &'a [u8], word: &'a [u8] },
    /// `element_offset` is where the current element begins.
    Binary { bytes: &'a [u8], offset: usize, element_offset: usize, is_big_endian: bool },
}

/// Why there is no next number.
#[derive(Clone, Copy)]
enum Fault {
    EndOfFile,
    EndOfLine,
    NotANumber,
}

impl<'a> Body<'a> {
    fn new(encoding: Encoding, bytes: &'a [u8], lines: Lines<'a>) -> Self {
        match encoding {
            Encoding::Ascii => Self::Ascii { lines, rest: b"", word: b"" },
            _ => Self::Binary {
                bytes,
                offset: lines.offset(),
                element_offset: lines.offset(),
                is_big_endian: encoding == Encoding::BigEndian,
            },
        }
    }

    /// Goes to the next element: in a text, to the next line that is not blank.
    fn begin_element(&mut self) -> Result<(), Fault> {
        match self {
            Self::Ascii { lines, rest, .. } => {
                let mut filled = lines.map(|(_, line)| line.trim_ascii()).filter(|line| !line.is_empty());
                *rest = filled.next().ok_or(Fault::EndOfFile)?;
            }
            Self::Binary { offset, element_offset, .. } => *element_offset = *offset,
        }
        Ok(())
    }

    fn number(&mut self, scalar: Scalar) -> Result<f64, Fault> {
        match self {
            Self::Ascii { rest, word, .. } => {
                let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
                (*word, *rest) = rest.split_at(length);
                *rest = rest.trim_ascii_start();
                if word.is_empty() {
                    return Err(Fault::EndOfLine);
                }
                let number = parse_number(word).ok_or(Fault::NotANumber)?;
                let fits = !scalar.is_integer() || number.fract() == 0.0;
                if fits { Ok(number) } else { Err(Fault::NotANumber) }
            }
            Self::Binary { bytes, offset, is_big_endian, .. } => {
                let num_bytes = scalar.num_bytes();
                let raw = bytes.get(*offset..*offset + num_bytes).ok_or(Fault::EndOfFile)?;
                *offset += num_bytes;
                let push = |bits: u64, &byte: &u8| bits << 8 | u64::from(byte);
                let bits =
                    if *is_big_endian { raw.iter().fold(0, push) } else { raw.iter().rev().fold(0, push) };
                Ok(scalar.value(bits))
            }
        }
    }

    /// The number of values in the list that comes next.
    fn list_length(&mut self, count: Scalar) -> Result<u64, Fault> {
        let length = self.number(count)?;
        if length >= 0.0 { Ok(length as u64) } else { Err(Fault::NotANumber) }
    }

    fn skip(&mut self, property: &Property) -> Result<(), Fault> {
        let length = match property.list_count {
            Some(count) => self.list_length(count)?,
            None => 1,
        };
        match self {
            Self::Binary { bytes, offset, .. } => {
                let end = length.saturating_mul(property.scalar.num_bytes() as u64);
                let end = end.saturating_add(*offset as u64);
                if end > bytes.len() as u64 {
                    return Err(Fault::EndOfFile);
                }
                *offset = end as usize;
            }
            Self::Ascii { .. } => {
                for _ in 0..length {
                    self.number(property.scalar)?;
                }
            }
        }
        Ok(())
    }

    /// How many elements of at least `min_bytes` the rest of the file has room for, of `count` declared.
    fn room_for(&self, count: u64, min_bytes: usize) -> usize {
        let num_left = match self {
            Self::Ascii { lines, .. } => lines.num_left(),
            Self::Binary { bytes, offset, .. } => bytes.len() - offset,
        };
        count.min((num_left / min_bytes) as u64) as usize
    }

    /// The line, or the first byte, of the current element.
    fn place(&self) -> Place {
        match self {
            Self::Ascii { lines, .. } => Place::Line(lines.number()),
            Self::Binary { element_offset, .. } => Place::Byte(*element_offset),
        }
    }

    /// The error for `fault` in the element with the zero-based number `index`.
    fn error(&self, fault: Fault, element: &Element, index: u64) -> ReadError {
        let Element { name, count, .. } = element;
        let nth = format!("{name} {} of {count}", index + 1);
        let message = match (fault, self) {
            (Fault::EndOfFile, _) => format!("the file ends in {nth}"),
            (Fault::EndOfLine, _) => format!("too few values for {nth}"),
            (Fault::NotANumber, Self::Ascii { word, .. }) => {
                format!("not a number for its property: {} in {nth}", quoted(word))
            }
            (Fault::NotANumber, Self::Binary { .. }) => format!("a list of negative length in {nth}"),
        };
        ReadError::syntax(self.place(), message)
    }
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
    ignore_others(element, builder, |k| axes[k].is_some());

    let read_position = |body: &mut Body| {
        body.begin_element()?;
        let mut position = [0.0; 3];
        for (property, axis) in element.properties.iter().zip(&axes) {
            match *axis {
                Some(axis) => position[axis] = body.number(property.scalar)?,
                None => body.skip(property)?,
            }
        }
        Ok(position)
    };
    builder.positions.reserve_exact(body.room_for(element.count, 3));
    for index in 0..element.count {
        let position = read_position(body).map_err(|fault| body.error(fault, element, index))?;
        if !position.iter().all(|c| c.is_finite()) {
            let message =
                format!("vertex {} of {} has a coordinate that is not finite", index + 1, element.count);
            return Err(ReadError::syntax(body.place(), message));
        }
        builder.positions.push(position);
    }
    Ok(())
}

/// Reads polygons, or triangle strips in which -1 ends one and begins the next.
fn read_faces(
    body: &mut Body,
    element: &Element,
    num_vertices: u32,
    builder: &mut MeshBuilder,
) -> Result<(), ReadError> {
    let is_strips = element.name == "tristrips";
    let is_corners = |p: &Property| matches!(p.name.as_str(), "vertex_indices" | "vertex_index");
    let corners_at = element.properties.iter().position(|p| is_corners(p) && p.list_count.is_some());
    if corners_at.is_none() && element.count > 0 {
        let message = format!("element {} has no list of vertex_indices", element.name);
        return Err(ReadError::syntax(element.place, message));
    }
    ignore_others(element, builder, |k| corners_at == Some(k));

    // Indices are float64 until they are checked.
    let read_corners = |body: &mut Body, corners: &mut Vec<f64>| {
        body.begin_element()?;
        corners.clear();
        for (k, property) in element.properties.iter().enumerate() {
            match property.list_count {
                Some(count) if corners_at == Some(k) => {
                    for _ in 0..body.list_length(count)? {
                        corners.push(body.number(property.scalar)?);
                    }
                }
                _ => body.skip(property)?,
            }
        }
        Ok(())
    };
    if !is_strips {
        builder.triangles.reserve_exact(body.room_for(element.count, 4));
    }
    let mut numbers = Vec::new();
    let mut corners = Vec::new();
    for index in 0..element.count {
        read_corners(body, &mut numbers).map_err(|fault| body.error(fault, element, index))?;
        corners.clear();
        for &number in &numbers {
            if is_strips && number == -1.0 {
                builder.push_strip(&corners);
                corners.clear();
            } else if number >= 0.0 && number < f64::from(num_vertices) && number.fract() == 0.0 {
                corners.push(number as u32);
            } else {
                let Element { name, count, .. } = element;
                let message = format!(
                    "{name} {} of {count} has the vertex index {number}, but there are {num_vertices} vertices",
                    index + 1
                );
                return Err(ReadError::syntax(body.place(), message));
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
        let skipped =
            body.begin_element().and_then(|()| element.properties.iter().try_for_each(|p| body.skip(p)));
        skipped.map_err(|fault| body.error(fault, element, index))?;
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
