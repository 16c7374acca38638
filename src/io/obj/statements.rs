//! The statements of an OBJ file.

use crate::io::{source::Source, text::words};

/// One statement: a line, with those that continue it.
pub(super) struct Statement<'a> {
    pub line: usize,
    pub text: &'a [u8],
}

impl Statement<'_> {
    pub fn words(&self) -> impl Iterator<Item = &[u8]> {
        words(self.text)
    }

    pub fn keyword(&self) -> &[u8] {
        self.words().next().unwrap_or_default()
    }

    /// What follows the keyword, without white space around it. Text that is not UTF-8 is read as Latin-1.
    pub fn name(&self) -> String {
        let name = self.text.trim_ascii()[self.keyword().len()..].trim_ascii();
        let latin1 = || name.iter().map(|&byte| char::from(byte)).collect();
        std::str::from_utf8(name).map_or_else(|_| latin1(), str::to_owned)
    }
}

/// The statements of a file without comments. A backslash at the end of a line continues it.
pub(super) struct Statements<'s, 'a> {
    source: &'s mut Source<'a>,
    text: Vec<u8>,
}

impl<'s, 'a> Statements<'s, 'a> {
    pub fn new(source: &'s mut Source<'a>) -> Self {
        let byte_order_mark = b"\xef\xbb\xbf";
        if source.peek(byte_order_mark.len()) == byte_order_mark {
            source.skip(byte_order_mark.len() as u64);
        }
        Self { source, text: Vec::new() }
    }

    pub fn next(&mut self) -> Option<Statement<'_>> {
        self.text.clear();
        self.source.skip_empty_lines();
        let first = self.source.line()?;
        let line = first.number;
        let mut is_continued = append(&mut self.text, first.text);
        while is_continued && let Some(next) = self.source.line() {
            self.text.push(b' ');
            is_continued = append(&mut self.text, next.text);
        }
        Some(Statement { line, text: &self.text })
    }
}

/// Adds a line to a statement, and returns whether another one follows.
fn append(text: &mut Vec<u8>, line: &[u8]) -> bool {
    // A backslash in a comment is the end of a path more often than a continuation.
    let without_comment = line.split(|&b| b == b'#').next().unwrap_or_default();
    let continued = without_comment.strip_suffix(b"\\");
    text.extend_from_slice(continued.unwrap_or(without_comment));
    continued.is_some()
}
