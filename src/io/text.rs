//! Words of text that need not be UTF-8.

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
    fn quotes_are_short_and_printable() {
        assert_eq!(quoted(b" v 0 0\0\t"), "`v 0 0\u{fffd}`");
        assert_eq!(quoted(&[b'x'; 1000]), format!("`{}…`", "x".repeat(60)));
        assert_eq!(quoted(b"\xff"), "`\u{fffd}`");
    }
}
