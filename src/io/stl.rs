//! STL, text and binary.
//!
//! STL has no shared vertices: corners at exactly the same place become one vertex. Normals are not read,
//! as the order of the corners says the same.

use super::{
    MeshFile, Place, ReadError, WriteError,
    builder::MeshBuilder,
    source::Source,
    text::{parse_number, quoted, words},
};
use crate::mesh::TriMesh;
use std::{
    collections::{HashMap, hash_map::Entry},
    io::Write,
};

/// A binary file: a comment of 80 bytes, the number of triangles in 4 bytes, the triangles.
const BINARY_HEADER_BYTES: usize = 84;
/// Normal and three corners, each three float32, and two bytes of whatever.
const BINARY_TRIANGLE_BYTES: usize = 50;

/// Blanks in front of `solid` that are looked past.
const MAX_BLANKS: usize = 4096;

/// Reads an STL file.
pub(super) fn read(source: &mut Source) -> Result<MeshFile, ReadError> {
    let begins_as_text = source.peek(MAX_BLANKS).trim_ascii_start().starts_with(b"solid");
    let Some(header) = source.peek(BINARY_HEADER_BYTES).first_chunk::<BINARY_HEADER_BYTES>() else {
        return if begins_as_text { read_text(source) } else { Err(neither(source)) };
    };
    let num_triangles = u32::from_le_bytes([80, 81, 82, 83].map(|at| header[at]));
    let last_of_count = header[83];
    let declared_size = BINARY_HEADER_BYTES as u64 + BINARY_TRIANGLE_BYTES as u64 * u64::from(num_triangles);
    // Binary files may begin with `solid` as well, so the size decides. Before it is known: a text has no control
    // character in the place where a count below 150 million has one.
    let is_text = begins_as_text
        && source.num_bytes().map_or(last_of_count >= b'\t', |num_bytes| num_bytes != declared_size);
    if is_text { read_text(source) } else { read_binary(source, num_triangles, declared_size) }
}

fn neither(source: &mut Source) -> ReadError {
    source.skip(u64::MAX);
    let message = "not an STL file: neither `solid` nor a binary header";
    ReadError::syntax(Place::Byte(source.offset()), message)
}

/// Writes a binary file. Coordinates are rounded to float32.
pub(super) fn write(out: &mut impl Write, mesh: &TriMesh) -> Result<(), WriteError> {
    if let Some(vertex) = mesh.positions().iter().position(|p| p.iter().any(|&c| (c as f32).is_infinite())) {
        let message = format!("vertex {} is too far away for the float32 coordinates of STL", vertex + 1);
        return Err(WriteError::Unrepresentable { message });
    }
    // Must not begin with `solid`, the mark of a text.
    let mut header = [b' '; BINARY_HEADER_BYTES];
    header[..10].copy_from_slice(b"binary STL");
    header[80..].copy_from_slice(&(mesh.num_triangles() as u32).to_le_bytes());
    out.write_all(&header)?;
    for triangle in mesh.triangles() {
        let corners = triangle.map(|index| mesh.positions()[index as usize]);
        let vectors = [unit_normal(corners), corners[0], corners[1], corners[2]];
        let mut record = [0; BINARY_TRIANGLE_BYTES];
        let floats = vectors.as_flattened().iter().flat_map(|&c| (c as f32).to_le_bytes());
        for (byte, value) in record.iter_mut().zip(floats) {
            *byte = value;
        }
        out.write_all(&record)?;
    }
    Ok(())
}

/// Counter-clockwise normal, zero for a triangle without area.
fn unit_normal([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    let edge = |end: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| end[k] - a[k]) };
    let (u, v) = (edge(b), edge(c));
    let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let length = cross.iter().map(|c| c * c).sum::<f64>().sqrt();
    if length > 0.0 { cross.map(|c| c / length) } else { [0.0; 3] }
}

/// Joins corners at the same place.
#[derive(Default)]
struct Welder {
    builder: MeshBuilder,
    vertex_at: HashMap<[u64; 3], u32>,
}

impl Welder {
    /// A triangle of a binary file.
    fn triangle(&mut self, record: &[u8], place: Place) -> Result<(), ReadError> {
        let (floats, _) = record.as_chunks::<4>();
        let mut triangle = [0; 3];
        for (corner, xyz) in triangle.iter_mut().zip(floats[3..].chunks_exact(3)) {
            let position = std::array::from_fn(|axis| f64::from(f32::from_le_bytes(xyz[axis])));
            *corner = self.vertex(position, place)?;
        }
        self.builder.triangles.push(triangle);
        Ok(())
    }

    fn vertex(&mut self, position: [f64; 3], place: Place) -> Result<u32, ReadError> {
        if !position.iter().all(|c| c.is_finite()) {
            return Err(ReadError::syntax(place, "a corner has a coordinate that is not finite"));
        }
        // Adding zero turns -0 into 0, which is the same place.
        let key = position.map(|c| (c + 0.0).to_bits());
        match self.vertex_at.entry(key) {
            Entry::Occupied(known) => {
                self.builder.report.corners_welded += 1;
                Ok(*known.get())
            }
            Entry::Vacant(new) => {
                let Ok(vertex) = u32::try_from(self.builder.positions.len()) else {
                    return Err(ReadError::TooLarge { message: "more than 2^32 vertices".to_owned() });
                };
                self.builder.positions.push(position);
                Ok(*new.insert(vertex))
            }
        }
    }
}

fn read_binary(source: &mut Source, num_triangles: u32, declared_size: u64) -> Result<MeshFile, ReadError> {
    let misfit = |num_bytes: u64| {
        let message = format!("the file declares {declared_size} bytes and has {num_bytes}");
        ReadError::syntax(Place::Byte(80), message)
    };
    if let Some(num_bytes) = source.num_bytes().filter(|&num_bytes| num_bytes != declared_size) {
        return Err(misfit(num_bytes));
    }
    source.skip(BINARY_HEADER_BYTES as u64);
    let mut welder = Welder::default();
    for _ in 0..num_triangles {
        let place = Place::Byte(source.offset());
        match source.take(BINARY_TRIANGLE_BYTES) {
            Some(record) => welder.triangle(record, place)?,
            None => break,
        }
    }
    source.skip(u64::MAX);
    match source.offset() as u64 {
        num_bytes if num_bytes == declared_size => welder.builder.finish(),
        num_bytes => Err(misfit(num_bytes)),
    }
}

/// Reads `vertex` lines between `outer loop` and `endloop`. The other statements carry nothing we need.
fn read_text(source: &mut Source) -> Result<MeshFile, ReadError> {
    let mut welder = Welder::default();
    let mut corners = Vec::new();
    let mut is_in_loop = false;
    loop {
        source.skip_empty_lines();
        let Some(line) = source.line() else { break };
        let place = Place::Line(line.number);
        let bad = |cause: &str| ReadError::syntax(place, format!("{cause}: {}", quoted(line.text)));
        if line.text.contains(&0) {
            return Err(bad("neither a text nor a binary file of the size it declares"));
        }
        let mut words = words(line.text);
        match words.next() {
            Some(b"outer") if !is_in_loop => {
                is_in_loop = true;
                corners.clear();
            }
            Some(b"vertex") if is_in_loop => {
                let mut position = [0.0; 3];
                for coordinate in &mut position {
                    let number = words.next().and_then(parse_number);
                    *coordinate = number.ok_or_else(|| bad("a vertex needs three numbers"))?;
                }
                corners.push(welder.vertex(position, place)?);
            }
            Some(b"endloop") if is_in_loop => {
                is_in_loop = false;
                welder.builder.push_polygon(&corners);
            }
            Some(b"outer" | b"vertex" | b"endloop") => return Err(bad("out of place")),
            None | Some(b"solid" | b"facet" | b"endfacet" | b"endsolid") => {}
            Some(_) => return Err(bad("not an STL statement")),
        }
    }
    if is_in_loop {
        return Err(ReadError::syntax(Place::Line(source.num_lines()), "the file ends in a facet"));
    }
    welder.builder.finish()
}
