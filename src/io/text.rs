//! Lines and words of text that need not be UTF-8.

/// The lines of a text: number from 1, and the line without its end (LF, CR LF or CR alone).
#[derive(Clone)]
pub(super) struct Lines<'a> {
    bytes: &'a [u8],
    offset: usize,
    number: usize,
}

impl<'a> Lines<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, offset: 0, number: 0 }
    }

    /// Where the next line starts.
    pub fn offset(&self) -> usize {
        self.offset
    }

    /// How many bytes there are from the next line on.
    pub fn num_left(&self) -> usize {
        self.bytes.len() - self.offset
    }

    /// The number of the line last returned, 0 before the first.
    pub fn number(&self) -> usize {
        self.number
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        let rest = &self.bytes[self.offset..];
        if rest.is_empty() {
            return None;
        }
        let length = rest.iter().position(|&b| b == b'\n' || b == b'\r').unwrap_or(rest.len());
        let end_length = match rest[length..] {
            [b'\r', b'\n', ..] => 2,
            [_, ..] => 1,
            [] => 0,
        };
        self.offset += length + end_length;
        self.number += 1;
        Some((self.number, &rest[..length]))
    }
}

/// The words of a line, separated by ASCII white space.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// A number written in decimal. `nan` and `inf` are numbers here; readers check for them.
pub(super) fn parse_number(word: &[u8]) -> Option<f64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// Text from a file, fit for an error message: control characters replaced, and not too long.
pub(super) fn quoted(text: &[u8]) -> String {
    const MAX_CHARS: usize = 60;
    let clean = |c: char| if c.is_control() { '\u{fffd}' } else { c };
    let head = String::from_utf8_lossy(&text[..text.len().min(4 * MAX_CHARS)]);
    let mut quote: String = head.trim().chars().take(MAX_CHARS).map(clean).collect();
    if head.trim().chars().count() > MAX_CHARS {
        quote.push('…');
    }
    format!("`{quote}`")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_in_any_way() {
        let lines: Vec<_> = Lines::new(b"a\nb\r\n\rd\n\ne").collect();
        let expected: [(usize, &[u8]); 6] = [(1, b"a"), (2, b"b"), (3, b""), (4, b"d"), (5, b""), (6, b"e")];
        assert_eq!(lines, expected);
        assert_eq!(Lines::new(b"").count(), 0);
        assert_eq!(Lines::new(b"\n").count(), 1);
    }

    #[test]
    fn quotes_are_short_and_printable() {
        assert_eq!(quoted(b" v 0 0\0\t"), "`v 0 0\u{fffd}`");
        assert_eq!(quoted(&[b'x'; 1000]), format!("`{}…`", "x".repeat(60)));
        assert_eq!(quoted(b"\xff"), "`\u{fffd}`");
    }
}
