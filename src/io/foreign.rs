//! Files that are no meshes, or none that a reader would know, under the ending of one.

use super::{Place, ReadError};

/// Bytes at the beginning of a file that say so.
pub(super) const HEAD_BYTES: usize = 512;

/// Looks at the beginning of a file.
///
/// # Errors
/// If it is of a kind that no reader here reads.
pub(super) fn check(head: &[u8]) -> Result<(), ReadError> {
    let message = match head {
        _ if head.starts_with(b"version https://git-lfs.github.com/spec/") => {
            "a pointer of Git LFS, not the file itself: `git lfs pull` fetches that"
        }
        _ if is_html(head) => "a page in HTML, not a mesh",
        _ if is_utf16(head) => "a text in UTF-16: save it as UTF-8",
        _ => return Ok(()),
    };
    Err(ReadError::Unsupported { place: Place::Line(1), message: message.to_owned() })
}

fn is_html(head: &[u8]) -> bool {
    let text = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head).trim_ascii_start();
    let begins = |word: &str| text.get(..word.len()).is_some_and(|t| t.eq_ignore_ascii_case(word.as_bytes()));
    begins("<!doctype html") || begins("<html")
}

/// Whether it is a byte order mark and letters of ASCII.
fn is_utf16(head: &[u8]) -> bool {
    let (letters, high) = match head {
        [0xff, 0xfe, rest @ ..] => (rest, 1),
        [0xfe, 0xff, rest @ ..] => (rest, 0),
        _ => return false,
    };
    let is_ascii = |pair: &[u8]| pair[high] == 0 && matches!(pair[1 - high], b'\t'..=b'~');
    letters.len() >= 4 && letters.chunks_exact(2).take(8).all(is_ascii)
}
