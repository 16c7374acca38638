//! Words of text that need not be UTF-8.

/// The words of a line, separated by ASCII white space.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// A number written in decimal. `nan` and `inf` are numbers here, in all spellings; readers check for them.
pub(super) fn parse_number(word: &[u8]) -> Option<f64> {
    let word = std::str::from_utf8(word).ok()?;
    word.parse().ok().or_else(|| parse_not_finite(word))
}

/// What C libraries print for what is no finite number: `1.#INF`, `1.#QNAN` and `-1.#IND00` of Microsoft's until
/// 2013, `-nan(ind)` of those that followed, `nan(0x1)`.
#[cold]
fn parse_not_finite(word: &str) -> Option<f64> {
    let unsigned = word.strip_prefix(['-', '+']).unwrap_or(word);
    if is_nan_with_payload(unsigned) {
        return Some(f64::NAN);
    }
    let is_infinite = old_kind(unsigned.as_bytes())? == "inf";
    let sign = if word.starts_with('-') { -1.0 } else { 1.0 };
    Some(if is_infinite { sign * f64::INFINITY } else { f64::NAN })
}

fn is_nan_with_payload(word: &str) -> bool {
    let Some((name, rest)) = word.split_once('(') else { return false };
    let is_payload = |text: &str| text.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_');
    name.eq_ignore_ascii_case("nan") && rest.strip_suffix(')').is_some_and(is_payload)
}

/// The kind that old compilers name behind `1.#`, at the beginning of `text`.
pub(super) fn old_kind(text: &[u8]) -> Option<&'static str> {
    let rest = text.strip_prefix(b"1.#")?;
    let is_kind =
        |kind: &&str| rest.get(..kind.len()).is_some_and(|r| r.eq_ignore_ascii_case(kind.as_bytes()));
    ["inf", "ind", "qnan", "snan"].into_iter().find(is_kind)
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
    fn what_is_no_finite_number_is_known_in_all_spellings() {
        for word in [
            "nan",
            "-NaN",
            "1.#QNAN",
            "-1.#IND",
            "1.#SNAN00",
            "-1.#IND00e+000",
            "nan(ind)",
            "-nan(0x7_f)",
            "NAN()",
        ] {
            assert!(parse_number(word.as_bytes()).is_some_and(f64::is_nan), "{word}");
        }
        assert_eq!(parse_number(b"1.#INF"), Some(f64::INFINITY));
        assert_eq!(parse_number(b"-1.#INF00"), Some(f64::NEG_INFINITY));
        for word in [
            "",
            "-",
            "n",
            "nan(",
            "nan()x",
            "nan(a b)",
            "nah(ind)",
            "1.#",
            "1.#I",
            "2.#INF",
            "--1.#INF",
            "n\u{e4}n()",
        ] {
            assert_eq!(parse_number(word.as_bytes()), None, "{word}");
        }
    }

    #[test]
    fn quotes_are_short_and_printable() {
        assert_eq!(quoted(b" v 0 0\0\t"), "`v 0 0\u{fffd}`");
        assert_eq!(quoted(&[b'x'; 1000]), format!("`{}…`", "x".repeat(60)));
        assert_eq!(quoted(b"\xff"), "`\u{fffd}`");
    }
}
