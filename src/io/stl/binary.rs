//! STL in binary: a comment of 80 bytes, the number of triangles in 4 bytes, the triangles.

use super::weld::Welder;
use crate::io::{MeshFile, Place, ReadError, source::Source};

/// The comment and the number of triangles.
pub(super) const HEADER_BYTES: usize = 84;
/// Normal and three corners, each three float32, and two bytes of whatever.
pub(super) const TRIANGLE_BYTES: usize = 50;

/// The number of triangles that a header declares.
pub(super) fn num_triangles(header: &[u8; HEADER_BYTES]) -> u32 {
    u32::from_le_bytes([80, 81, 82, 83].map(|at| header[at]))
}

/// The bytes of a file of this many triangles.
pub(super) fn num_bytes(num_triangles: u32) -> u64 {
    HEADER_BYTES as u64 + TRIANGLE_BYTES as u64 * u64::from(num_triangles)
}

/// Reads a file of this many triangles. What comes behind the last of them is left out.
pub(super) fn read(source: &mut Source, num_triangles: u32) -> Result<MeshFile, ReadError> {
    if let Some(found) = source.num_bytes() {
        check_size(num_triangles, found)?;
    }
    source.skip(HEADER_BYTES as u64);
    let mut welder = Welder::default();
    let mut has_bytes = false;
    for _ in 0..num_triangles {
        let place = Place::Byte(source.offset());
        match source.take(TRIANGLE_BYTES) {
            Some(record) => {
                has_bytes |= record[TRIANGLE_BYTES - 2..] != [0; 2];
                add_triangle(&mut welder, record, place)?;
            }
            None => break,
        }
    }
    source.skip(u64::MAX);
    if has_bytes {
        welder.builder.report.ignore("attribute bytes of triangles");
    }
    let num_more = check_size(num_triangles, source.offset() as u64)?;
    if num_more > 0 {
        let bytes = if num_more == 1 { "byte" } else { "bytes" };
        welder.builder.report.ignore(&format!("{num_more} {bytes} after the last triangle"));
    }
    welder.builder.finish()
}

/// How many of the bytes of a file come after its last triangle. A file without triangles is nothing but its header.
fn check_size(num_triangles: u32, found: u64) -> Result<u64, ReadError> {
    let declared = num_bytes(num_triangles);
    if found == declared || (found > declared && num_triangles > 0) {
        return Ok(found - declared);
    }
    let message = format!("the file declares {declared} bytes and has {found}");
    Err(ReadError::syntax(Place::Byte(80), message))
}

fn add_triangle(welder: &mut Welder, record: &[u8], place: Place) -> Result<(), ReadError> {
    let (floats, _) = record.as_chunks::<4>();
    let mut triangle = [0; 3];
    for (corner, xyz) in triangle.iter_mut().zip(floats[3..].chunks_exact(3)) {
        let position = std::array::from_fn(|axis| f64::from(f32::from_le_bytes(xyz[axis])));
        *corner = welder.vertex(position, place)?;
    }
    welder.builder.triangles.push(triangle);
    Ok(())
}
