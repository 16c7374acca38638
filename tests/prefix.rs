//! How good the beginnings of a stream are.
#![cfg(all(feature = "io", feature = "metrics", feature = "encoder"))]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

use lwc::metrics::{CompareOptions, compare};
use lwc::{DecodeOptions, EncodeOptions, Optimize, TriMesh, decode, encode};
use std::path::Path;

fn knot() -> TriMesh {
    lwc::io::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/knot.ply")).unwrap().mesh
}

/// Bytes of the stream, and the mean quality of its beginnings in dB. As many levels as there can be: in one piece a file
/// may be the smallest, but has no beginnings.
fn measure(mesh: &TriMesh, optimize: Optimize) -> (usize, f64) {
    let mut options = EncodeOptions::default();
    (options.optimize, options.levels) = (optimize, Some(128));
    let stream = encode(mesh, &options).unwrap().bytes;
    // The same numbers of bytes for every aim.
    let sizes = [500, 1000, 2000, 4000];
    let quality = |&size: &usize| {
        let early = decode(&stream[..size], DecodeOptions::new()).unwrap();
        compare(mesh, &early, &CompareOptions::new().samples(20_000)).unwrap().psnr_db()
    };
    (stream.len(), sizes.iter().map(quality).sum::<f64>() / sizes.len() as f64)
}

#[test]
fn each_aim_is_best_at_what_it_aims_at() {
    let mesh = knot();
    let [size, balanced, prefix] = Optimize::ALL.map(|aim| measure(&mesh, aim));
    assert!(size.0 < balanced.0 && size.0 < prefix.0, "bytes: {} {} {}", size.0, balanced.0, prefix.0);
    assert!(balanced.0 < size.0 * 3 / 2, "{} bytes, {} for size", balanced.0, size.0);
    assert!(balanced.1 > size.1 + 2.5, "dB: {:.1} {:.1} {:.1}", size.1, balanced.1, prefix.1);
    assert!(prefix.1 > balanced.1 - 0.5, "dB: {:.1} {:.1} {:.1}", size.1, balanced.1, prefix.1);
}

#[test]
fn the_smallest_file_may_be_in_one_piece() {
    let mesh = knot();
    let mut options = EncodeOptions::default();
    options.optimize = Optimize::Size;
    let smallest = encode(&mesh, &options).unwrap();
    options.levels = Some(0);
    let whole = encode(&mesh, &options).unwrap();
    assert_eq!(smallest.bytes, whole.bytes);
    assert!(whole.bytes.len() < measure(&mesh, Optimize::Size).0);
}
