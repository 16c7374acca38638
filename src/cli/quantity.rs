//! Numbers as people write them.

/// A parser of numbers from `least` to `most`.
pub fn number(least: f64, most: f64) -> impl Fn(&str) -> Result<f64, String> + Clone + Send + Sync + 'static {
    move |text| match text.parse() {
        Ok(x) if (least..=most).contains(&x) => Ok(x),
        Ok(_) if least == f64::MIN_POSITIVE => Err(format!("it must be above 0 and at most {most}")),
        Ok(_) => Err(format!("it must be {least} to {most}")),
        Err(_) => Err("it is not a number".into()),
    }
}

/// Bytes: `5000`, `20K` and `20KiB` (20 · 1024), `20kB` (20 · 1000), `1.5G`.
pub fn bytes(text: &str) -> Result<u64, String> {
    let (number, unit) = split(text);
    let (prefix, base) = match unit.to_ascii_lowercase() {
        unit if unit == "b" => (String::new(), 1024.0),
        unit if unit.ends_with("ib") => (unit[..unit.len() - 2].into(), 1024.0),
        unit if unit.ends_with('b') => (unit[..unit.len() - 1].into(), 1000.0),
        unit => (unit, 1024.0),
    };
    scaled(number, &prefix, base)
        .filter(|&n| n < u64::MAX as f64)
        .map(|n| n as u64)
        .ok_or_else(|| "it is no number of bytes like 5000, 20K, 1.5GiB or 20MB".into())
}

/// Units of work: `5000`, `20k`, `1.5G`, powers of 1000.
pub fn units(text: &str) -> Result<u64, String> {
    let (number, unit) = split(text);
    scaled(number, &unit.to_ascii_lowercase(), 1000.0)
        .filter(|&n| n < u64::MAX as f64)
        .map(|n| n as u64)
        .ok_or_else(|| "it is no number of units like 5000, 20K or 1.5G".into())
}

/// A count: `5000`, `20k`, `1.5M`, powers of 1000, at most 2^32 − 1.
pub fn count(text: &str) -> Result<u32, String> {
    let (number, unit) = split(text);
    scaled(number, &unit.to_ascii_lowercase(), 1000.0)
        .filter(|&n| n <= f64::from(u32::MAX))
        .map(|n| n as u32)
        .ok_or_else(|| "it is no count like 5000, 20K or 1.5M, at most 4294967295".into())
}

fn split(text: &str) -> (&str, &str) {
    text.split_at(text.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(text.len()))
}

fn scaled(number: &str, prefix: &str, base: f64) -> Option<f64> {
    let power = ["", "k", "m", "g", "t"].iter().position(|&p| p == prefix)?;
    let number: f64 = number.trim_end().parse().ok().filter(|n| *n >= 0.0)?;
    Some((number * base.powi(power as i32)).round())
}

/// `1 vertex`, `2 vertices`.
pub fn counted(n: usize, one: &str, many: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_have_units() {
        for (text, expected) in [
            ("0", 0),
            ("17", 17),
            ("17B", 17),
            ("2K", 2048),
            ("2kB", 2000),
            ("1.5 MiB", 3 << 19),
            ("4G", 4 << 30),
        ] {
            assert_eq!(bytes(text), Ok(expected), "{text}");
        }
        for text in ["", "K", "-1", "1X", "1KK", "nan", "inf", "1e30", "99999999T", "1iB2"] {
            assert!(bytes(text).is_err(), "{text}");
        }
    }

    #[test]
    fn counts_have_units() {
        assert_eq!((count("12"), count("2M"), count("1.5k")), (Ok(12), Ok(2_000_000), Ok(1500)));
        assert!(count("5G").is_err() && count("1Mi").is_err() && count("-3").is_err());
    }

    #[test]
    fn numbers_stay_in_range() {
        let growth = number(1.0, 16.0);
        assert_eq!(growth("1.5"), Ok(1.5));
        assert!(growth("nan").is_err() && growth("inf").is_err() && growth("0.99").is_err());
        assert!(number(f64::MIN_POSITIVE, 1e6)("0").is_err());
    }
}
