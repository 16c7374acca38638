//! Chunk `k` (`format/SPEC.md`, section 4.9): what else is known of the whole.

use crate::util::budget::Budget;
use crate::util::bytes::Reader;
#[cfg(any(feature = "encoder", test))]
use crate::util::bytes::write_varint;
use std::collections::HashSet;

/// Fewest bytes of a pair: the lengths of key and text.
const MIN_PAIR: usize = 2;

/// `None` if the payload breaks a rule or the memory is used up.
pub(crate) fn read(payload: &[u8], budget: &mut Budget) -> Option<Vec<(String, String)>> {
    let mut reader = Reader::new(payload);
    let num_pairs = reader.count(MIN_PAIR)?;
    budget.take(num_pairs, size_of::<(String, String)>() + size_of::<&str>())?;
    let mut pairs = Vec::with_capacity(num_pairs);
    for _ in 0..num_pairs {
        pairs.push((reader.string(budget)?, reader.string(budget)?));
    }
    let mut known = HashSet::with_capacity(num_pairs);
    let is_unique = pairs.iter().all(|(key, _)| known.insert(key.as_str()));
    (reader.is_empty() && is_unique).then_some(pairs)
}

#[cfg(any(feature = "encoder", test))]
pub(crate) fn write(pairs: &[(String, String)]) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_varint(&mut bytes, pairs.len() as u32);
    for text in pairs.iter().flat_map(|(key, text)| [key, text]) {
        write_varint(&mut bytes, text.len() as u32);
        bytes.extend(text.as_bytes());
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::{read as read_within, *};

    fn read(payload: &[u8]) -> Option<Vec<(String, String)>> {
        read_within(payload, &mut Budget::new(0, u64::MAX))
    }

    fn pairs(texts: &[(&str, &str)]) -> Vec<(String, String)> {
        texts.iter().map(|&(key, text)| (key.to_owned(), text.to_owned())).collect()
    }

    #[test]
    fn pairs_come_back_and_cuts_are_refused() {
        for pairs in [pairs(&[]), pairs(&[("crs.wkt", "PROJCS[…]"), ("", "")])] {
            let bytes = write(&pairs);
            assert_eq!(read(&bytes), Some(pairs));
            for end in 0..bytes.len() {
                assert_eq!(read(&bytes[..end]), None);
            }
            assert_eq!(read(&[&bytes[..], &[0]].concat()), None);
        }
    }

    #[test]
    fn keys_are_unique_and_memory_is_limited() {
        assert_eq!(read(&write(&pairs(&[("a", "1"), ("a", "2")]))), None);
        let bytes = write(&pairs(&[("a", "1")]));
        assert_eq!(read_within(&bytes, &mut Budget::new(0, 10)), None);
        assert_eq!(read(&[0xff, 0xff, 0xff, 0x7f]), None);
    }
}
