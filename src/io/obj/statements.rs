//! The statements of an OBJ file.

use crate::io::{
    source::Source,
    text::{old_kind, words},
};

/// What ZBrush puts in front of colours, in what is a comment to all others.
pub(super) const COLOURS: &[u8] = b"#MRGB";

/// Keywords that a name follows.
const BEFORE_NAMES: [&[u8]; 4] = [b"usemtl", b"o", b"g", b"mtllib"];

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
        if is_colours(first.text) {
            self.text.extend_from_slice(first.text);
            return Some(Statement { line, text: &self.text });
        }
        let mut is_continued = append(&mut self.text, first.text);
        while is_continued && let Some(next) = self.source.line() {
            if !self.text.is_empty() {
                self.text.push(b' ');
            }
            is_continued = append(&mut self.text, next.text);
        }
        Some(Statement { line, text: &self.text })
    }
}

fn is_colours(line: &[u8]) -> bool {
    line.strip_prefix(COLOURS).is_some_and(|rest| rest.first().is_none_or(u8::is_ascii_whitespace))
}

/// Adds a line to a statement, and returns whether another one follows.
fn append(text: &mut Vec<u8>, line: &[u8]) -> bool {
    // So that the keyword is where the text begins, however many lines there are.
    let line = if text.is_empty() { line.trim_ascii_start() } else { line };
    // A backslash in a comment is the end of a path more often than a continuation.
    let without_comment = without_comment(text, line);
    let continued = without_comment.strip_suffix(b"\\");
    text.extend_from_slice(continued.unwrap_or(without_comment));
    continued.is_some()
}

/// A line, which continues the statement `text`, up to its comment. Names may have a `#`.
fn without_comment<'l>(text: &[u8], line: &'l [u8]) -> &'l [u8] {
    let Some(first) = line.iter().position(|&byte| byte == b'#') else { return line };
    if line[..first].trim_ascii_start().is_empty() {
        return &line[..first];
    }
    if takes_name(if text.is_empty() { line } else { text }) {
        return line;
    }
    let begins_comment = |&at: &usize| line[at] == b'#' && old_kind(&line[at.saturating_sub(2)..]).is_none();
    (first..line.len()).find(begins_comment).map_or(line, |at| &line[..at])
}

/// Whether a statement that begins so has a name in it.
fn takes_name(text: &[u8]) -> bool {
    let is_next = |keyword: &&[u8]| {
        let rest = text.strip_prefix(*keyword);
        rest.is_some_and(|rest| rest.first().is_none_or(u8::is_ascii_whitespace))
    };
    BEFORE_NAMES.iter().any(is_next)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_begin_where_names_and_numbers_end() {
        for (text, line, expected) in [
            ("", "v 1 2 3#x", "v 1 2 3"),
            ("", "# usemtl a", ""),
            ("", "#usemtl a", ""),
            ("", "usemtl Grey #1 # x", "usemtl Grey #1 # x"),
            ("", "usemtl #1", "usemtl #1"),
            ("", "usemtl#1", "usemtl"),
            ("g ", "a#b", "a#b"),
            ("g ", " # b", " "),
            ("", "s 1 # on", "s 1 "),
            ("", "vt 1.#QNAN -1.#ind00#x", "vt 1.#QNAN -1.#ind00"),
            ("", "v 0 0 1.#x", "v 0 0 1."),
        ] {
            let found = without_comment(text.as_bytes(), line.as_bytes());
            assert_eq!(String::from_utf8_lossy(found), expected, "{text}{line}");
        }
    }
}
