//! Factors for ranges of levels, as they are typed.

use std::fmt;
use std::ops::RangeInclusive;

/// `LEVELS=FACTOR`.
#[derive(Clone, Debug, PartialEq)]
pub struct Gain {
    first: Option<usize>,
    last: Option<usize>,
    pub factor: f64,
}

impl Gain {
    /// Reads `7=0`, `5..=0`, `..3=2`, `2..4=1.5` or `2..=4=1.5`; both ends belong to a range.
    ///
    /// # Errors
    /// If it is none of these.
    pub fn parse(text: &str) -> Result<Self, String> {
        let wrong = || "it is not like 7=0, 5..=0, ..3=2 or 2..4=1.5".to_owned();
        let (levels, factor) = text.rsplit_once('=').ok_or_else(wrong)?;
        let factor: f64 = factor.trim().parse().map_err(|_| wrong())?;
        if !(-1000.0..=1000.0).contains(&factor) {
            return Err("the factor must be -1000 to 1000".into());
        }
        let end = |text: &str| match text.trim() {
            "" => Ok(None),
            digits => digits.parse().map(Some).map_err(|_| wrong()),
        };
        let (first, last) = match levels.split_once("..") {
            Some((first, last)) => (end(first)?, end(last.strip_prefix('=').unwrap_or(last))?),
            None => {
                let level = end(levels)?.ok_or_else(wrong)?;
                (Some(level), Some(level))
            }
        };
        let is_backwards = first.zip(last).is_some_and(|(first, last)| first > last);
        if is_backwards || first == Some(0) || last == Some(0) {
            return Err("levels of details begin at 1, and a range goes up".into());
        }
        Ok(Self { first, last, factor })
    }

    /// The levels it is for, of those from 1 to `num_levels`; may be empty.
    pub fn levels(&self, num_levels: usize) -> RangeInclusive<usize> {
        self.first.unwrap_or(1)..=self.last.unwrap_or(num_levels).min(num_levels)
    }
}

impl fmt::Display for Gain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let end = |level: Option<usize>| level.map_or(String::new(), |level| level.to_string());
        if self.first == self.last && self.first.is_some() {
            write!(f, "{}={}", end(self.first), self.factor)
        } else {
            write!(f, "{}..{}={}", end(self.first), end(self.last), self.factor)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_have_both_ends() {
        for (text, levels, factor) in [
            ("7=0", 7..=7, 0.0),
            ("5..=0", 5..=9, 0.0),
            ("..3=2", 1..=3, 2.0),
            ("2..4=1.5", 2..=4, 1.5),
            ("2..=4=-1", 2..=4, -1.0),
            ("..=0.5", 1..=9, 0.5),
        ] {
            let gain = Gain::parse(text).unwrap();
            assert_eq!((gain.levels(9), gain.factor), (levels, factor), "{text}");
            assert_eq!(Gain::parse(&gain.to_string()), Ok(gain), "{text}");
        }
        assert!(Gain::parse("12=0").unwrap().levels(9).is_empty());
        for text in ["", "5", "=2", "a=1", "5=", "0=1", "4..2=1", "1=nan", "1=1e9", "1..2..3=1", "-1=2"] {
            assert!(Gain::parse(text).is_err(), "{text}");
        }
    }
}
