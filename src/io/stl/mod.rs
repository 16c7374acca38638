//! STL, text and binary.
//!
//! STL has no shared vertices: corners at exactly the same place become one vertex. Normals are not read,
//! as the order of the corners says the same.

mod binary;
mod text;
mod weld;
mod write;

pub(super) use write::Plan;

use super::{MeshFile, Place, ReadError, source::Source};
use binary::HEADER_BYTES;

/// Bytes of a file that are looked at to tell a text from a binary file.
const HEAD_BYTES: usize = 4096;

/// Reads an STL file.
pub(super) fn read(source: &mut Source) -> Result<MeshFile, ReadError> {
    let head = source.peek(HEAD_BYTES);
    let begins_as_text = begins_as_text(head);
    let Some(&header) = head.first_chunk::<HEADER_BYTES>() else {
        return if begins_as_text { text::read(source) } else { Err(neither(source)) };
    };
    let is_printable = head.iter().all(|&byte| byte >= b' ' || (b'\t'..=b'\r').contains(&byte));
    let num_triangles = binary::num_triangles(&header);
    let declared = binary::num_bytes(num_triangles);
    // Binary files may begin with `solid` as well, and may have bytes behind the last triangle. Where the size is
    // not known: a text has no control character in the place where a count below 150 million has one.
    let is_text = begins_as_text
        && source.num_bytes().map_or(header[HEADER_BYTES - 1] >= b'\t', |found| {
            found < declared || (found > declared && is_printable)
        });
    if is_text { text::read(source) } else { binary::read(source, num_triangles) }
}

/// Whether the first word is `solid`, in any case.
fn begins_as_text(head: &[u8]) -> bool {
    head.trim_ascii_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
}

fn neither(source: &mut Source) -> ReadError {
    source.skip(u64::MAX);
    let message = "not an STL file: neither `solid` nor a binary header";
    ReadError::syntax(Place::Byte(source.offset()), message)
}
