//! The statements of an OBJ file.

use crate::io::text::{Lines, words};
use std::borrow::Cow;

/// One statement: a line, with those that continue it.
pub(super) struct Statement<'a> {
    pub line: usize,
    pub text: Cow<'a, [u8]>,
}

impl Statement<'_> {
    pub fn words(&self) -> impl Iterator<Item = &[u8]> {
        words(&self.text)
    }

    pub fn keyword(&self) -> &[u8] {
        self.words().next().unwrap_or_default()
    }

    /// What follows the keyword, without white space around it. Text that is not UTF-8 is taken for Latin-1.
    pub fn name(&self) -> String {
        let name = self.text.trim_ascii()[self.keyword().len()..].trim_ascii();
        let latin1 = || name.iter().map(|&byte| char::from(byte)).collect();
        std::str::from_utf8(name).map_or_else(|_| latin1(), str::to_owned)
    }
}

/// The statements of a file without comments. A backslash at the end of a line continues it.
pub(super) struct Statements<'a> {
    lines: Lines<'a>,
}

impl<'a> Statements<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        let byte_order_mark = b"\xef\xbb\xbf";
        Self { lines: Lines::new(bytes.strip_prefix(byte_order_mark).unwrap_or(bytes)) }
    }
}

impl<'a> Iterator for Statements<'a> {
    type Item = Statement<'a>;

    fn next(&mut self) -> Option<Self::Item> {
        let (line, first) = self.lines.next()?;
        // A backslash in a comment is the end of a path more often than a continuation.
        let without_comment = first.split(|&b| b == b'#').next().unwrap_or_default();
        let Some(head) = without_comment.strip_suffix(b"\\") else {
            return Some(Statement { line, text: Cow::Borrowed(without_comment) });
        };
        let mut text = head.to_vec();
        for (_, next) in self.lines.by_ref() {
            let next = next.split(|&b| b == b'#').next().unwrap_or_default();
            let continued = next.strip_suffix(b"\\");
            text.push(b' ');
            text.extend_from_slice(continued.unwrap_or(next));
            if continued.is_none() {
                break;
            }
        }
        Some(Statement { line, text: Cow::Owned(text) })
    }
}
