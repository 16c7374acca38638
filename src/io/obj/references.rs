//! What corners refer to, which may be further down in the file.

use crate::mesh::NO_ENTRY;

/// References to values that had not been read yet.
#[derive(Default)]
pub(super) struct References {
    /// Line and index from 1, each index above the one before: of all others an earlier line has as high an index.
    ahead: Vec<(usize, u64)>,
}

impl References {
    /// The value from 0 that `word` means after `num_so_far` values: an index from 1, or one that counts back.
    ///
    /// `None` if it is not a whole number, `Some(None)` if there is no such value. A place beyond 32 bits is
    /// [`NO_ENTRY`], which [`References::first_beyond`] finds.
    pub fn resolve(&mut self, word: &[u8], num_so_far: usize, line: usize) -> Option<Option<u32>> {
        let index: i64 = match word {
            // A corner without position, as `/1`.
            b"" => 0,
            _ => std::str::from_utf8(word).ok()?.parse().ok()?,
        };
        let from_1 = if index < 0 { (num_so_far as i64 + 1).saturating_add(index) } else { index };
        let Ok(from_1 @ 1..) = u64::try_from(from_1) else { return Some(None) };
        if from_1 > num_so_far as u64 && self.ahead.last().is_none_or(|&(_, highest)| highest < from_1) {
            self.ahead.push((line, from_1));
        }
        Some(Some(u32::try_from(from_1 - 1).unwrap_or(NO_ENTRY)))
    }

    /// The line and the index of the first reference beyond the last of `num` values.
    pub fn first_beyond(&self, num: usize) -> Option<(usize, u64)> {
        self.ahead.iter().copied().find(|&(_, index)| index > num as u64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_reference_to_nothing_is_found() {
        let mut references = References::default();
        for (line, word) in [(1, "2"), (2, "7"), (3, "6"), (4, "+9"), (5, "5"), (6, "99999999999")] {
            assert!(references.resolve(word.as_bytes(), 4, line).flatten().is_some());
        }
        let expected =
            [(4, Some((2, 7))), (6, Some((2, 7))), (7, Some((4, 9))), (9, Some((6, 99_999_999_999)))];
        for (num, first) in expected {
            assert_eq!(references.first_beyond(num), first);
        }
    }

    #[test]
    fn indices_count_from_either_end() {
        let resolve = |word: &str| References::default().resolve(word.as_bytes(), 4, 1);
        assert_eq!(
            [resolve("1"), resolve("-1"), resolve("5")],
            [Some(Some(0)), Some(Some(3)), Some(Some(4))]
        );
        assert_eq!([resolve("0"), resolve("-5"), resolve("")], [Some(None); 3]);
        assert_eq!([resolve("x"), resolve("1.0"), resolve("99999999999999999999")], [None; 3]);
        assert_eq!(resolve("-9223372036854775808"), Some(None));
        assert_eq!(resolve("9223372036854775807"), Some(Some(NO_ENTRY)));
    }
}
