//! What fuzzing found, each with its story. Run with `--features fuzzing`.
#![cfg(feature = "fuzzing")]

use lwc::fuzzing;
use std::path::Path;

fn finding(name: &str) -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/findings").join(name);
    std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Improbable ones coded to nothing but zeros; the encoder dropped more of them than a decoder may
/// read past the end of a payload.
#[test]
fn a_payload_of_zeros_is_not_damage() {
    fuzzing::range_coder(&finding("range_coder_payload_of_zeros.bin"));
}
