//! What fuzzing found, each with its story. Run with `--features fuzzing`.
#![cfg(feature = "fuzzing")]

use lwc::fuzzing;
use lwc::io::Format;
use std::path::Path;

fn finding(name: &str) -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz_regressions").join(name);
    std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Improbable ones coded to nothing but zeros; the encoder dropped more of them than a decoder may
/// read past the end of a payload.
#[test]
fn a_payload_of_zeros_is_not_damage() {
    fuzzing::range_coder(&finding("range_coder_payload_of_zeros.bin"));
}

/// Symbols in tables, random bytes, and payloads that look sound: a head of zeros is all defaults and tables of one symbol.
#[test]
fn symbols_in_tables_survive_random_bytes() {
    let mut seed = 11_u32;
    for i in 0..3000 {
        let bytes = (0..i % 300).map(|_| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 24) as u8
        });
        let bytes: Vec<u8> = bytes.collect();
        for kind in [0, 100, 200] {
            fuzzing::ans(&[&[kind], &bytes[..]].concat());
        }
        let [a, b] = [i as u8, (i / 7) as u8];
        fuzzing::ans(&[&[200, a, b, 8, 255, 255, 255, 255], &bytes[..], &[0; 40]].concat());
    }
}

/// A cut chunk of attributes that was nonsense left those behind it without any value.
#[test]
fn attributes_are_without_gaps_whatever_has_come() {
    fuzzing::decode(&finding("decode_attributes_of_nonsense.bin"));
}

/// Colours of ZBrush have 8 bits, and OBJ writes them as decimals: the same numbers in another type.
#[test]
fn colours_of_8_bits_are_the_same_numbers_in_decimals() {
    fuzzing::read_mesh(b"v 0 0 0\nv 1 0 0\nv 0 1 0\n#MRGB ff440099ff123456ff808080\nf 1 2 3\n", Format::Obj);
}

/// What PLY has in another type, under another name or not at all after writing is said, or the same numbers.
#[test]
fn what_a_writer_changes_is_said() {
    let header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty double z\n\
                  property double red\nproperty double green\nproperty double blue\nproperty double nx\n\
                  property double ny\nproperty double nz\nproperty float q\nproperty int q\nproperty ushort r\n\
                  property ushort g\nproperty ushort b\nelement face 1\nproperty list uchar int vertex_indices\n\
                  property list uchar double texcoord\nproperty int vertex_index\nend_header\n";
    let vertex = "0.1 2 0.3 0.2 0.4 0.1234 0 0 0.7 7 7 257 300 65535\n";
    let vertices = [vertex, &vertex.replace("0.1 2", "1 3"), &vertex.replace("0.3", "5")];
    let text = format!("{header}{}3 0 1 2 6 0.1 0.2 nan 0.4 1e300 0.6 9\n", vertices.concat());
    assert!(lwc::io::read_bytes(text.as_bytes(), Format::Ply).is_ok());
    fuzzing::read_mesh(text.as_bytes(), Format::Ply);
}

/// A few inputs of the fuzz targets that reach attributes, made up without a fuzzer.
#[test]
fn attributes_survive_random_meshes_and_damage() {
    let mut seed = 7_u64;
    let mut random = |count: usize| -> Vec<u8> {
        (0..count)
            .map(|_| {
                seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (seed >> 56) as u8
            })
            .collect()
    };
    for size in (20..900).step_by(9) {
        fuzzing::round_trip(&random(size));
    }
    // The number that asks for steps and lattices.
    for (size, grid) in (20..900).step_by(9).zip((9..15).cycle()) {
        let mut input = random(size);
        input[13] = grid + 45 * (input[13] % 5);
        fuzzing::round_trip(&input);
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("format/golden");
    for name in
        ["colours", "texture-seams", "flat-normals", "materials", "lattice-exact", "lattice-with-offset"]
    {
        let stream = std::fs::read(folder.join(name).with_extension("lwc")).unwrap_or_default();
        assert!(!stream.is_empty(), "{name}");
        for _ in 0..400 {
            let mut bad = stream.clone();
            let noise = random(9);
            for bite in noise.chunks_exact(3) {
                let at = (usize::from(bite[0]) << 8 | usize::from(bite[1])) % bad.len();
                bad[at] ^= bite[2];
            }
            bad.insert(0, 1);
            fuzzing::decode(&bad);
            fuzzing::split_independent(&[&noise[..8], &bad].concat());
        }
    }
}

/// A base mesh in tables that read behind its end: which error came depended on where slices of work ended.
#[test]
fn the_error_of_a_base_mesh_does_not_depend_on_slices() {
    fuzzing::split_independent(&finding("split_independent_base_behind_its_end.bin"));
}
