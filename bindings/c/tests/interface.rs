//! The functions of the interface, called as C would.
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.
#![allow(clippy::undocumented_unsafe_blocks)] // The pointers are those of the lines above.

use lwc_c::*;
use std::ffi::CStr;
use std::path::Path;
use std::ptr::{null, null_mut};

fn last_error() -> String {
    unsafe { CStr::from_ptr(lwc_last_error()) }.to_str().unwrap().to_owned()
}

#[test]
fn every_golden_stream_has_its_checksum_after_each_pass() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../format/golden");
    let recorded = std::fs::read_to_string(folder.join("checksums.txt")).unwrap();
    let mut num_passes = 0;
    for line in recorded.lines().filter(|line| line.contains(" 0 base ")) {
        let name = line.split(' ').next().unwrap();
        let bytes = std::fs::read(folder.join(name)).unwrap();
        let mut found = Vec::new();
        unsafe {
            let decoder = lwc_decoder_new(null());
            assert_eq!(lwc_decoder_feed(decoder, bytes.as_ptr(), bytes.len()), Status::Ok);
            while lwc_decoder_step(decoder, null_mut()) == Status::Ok {
                found.push(format!("{:08x}", lwc_decoder_checksum(decoder)));
            }
            assert!(lwc_decoder_is_complete(decoder));
            assert_eq!(lwc_decoder_num_passes(decoder), found.len());
            lwc_decoder_free(decoder);
        }
        let expected: Vec<&str> = recorded
            .lines()
            .filter(|line| line.starts_with(&format!("{name} ")) && !line.contains(" whole "))
            .map(|line| line.rsplit(' ').next().unwrap())
            .collect();
        assert_eq!(found, expected, "{name}");
        num_passes += found.len();
    }
    assert!(num_passes > 50);
}

#[test]
fn errors_have_a_status_and_a_sentence() {
    let (positions, mut mesh) = ([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0], null_mut());
    unsafe {
        let status = lwc_mesh_new(positions.as_ptr(), 3, [0, 1, 7].as_ptr(), 1, &mut mesh);
        assert_eq!(status, Status::IndexOutOfRange);
        assert!(last_error().contains("vertex 7"), "{}", last_error());
        assert_eq!(lwc_mesh_new(null(), 3, null(), 0, &mut mesh), Status::NullPointer);
        assert_eq!(
            lwc_mesh_new(positions.as_ptr(), 3, [0, 1, 2].as_ptr(), 1, null_mut()),
            Status::NullPointer
        );
        assert_eq!(lwc_mesh_new(positions.as_ptr(), 3, [0, 1, 2].as_ptr(), 1, &mut mesh), Status::Ok);

        let mut encoded = null_mut();
        let mut options = lwc_encode_options_default();
        options.quantization = 99;
        assert_eq!(lwc_encode(mesh, &options, &mut encoded), Status::Option);
        assert!(last_error().contains("quantization is 99"), "{}", last_error());
        options = lwc_encode_options_default();
        options.descriptor = c"magic".as_ptr();
        assert_eq!(lwc_encode(mesh, &options, &mut encoded), Status::Option);
        assert_eq!(last_error(), "there is no descriptor magic");

        assert_eq!(lwc_encode(mesh, null(), &mut encoded), Status::Ok);
        let (bytes, size) = (lwc_encoded_bytes(encoded), lwc_encoded_num_bytes(encoded));
        let mut decoded = null_mut();
        assert_eq!(lwc_decode(bytes, 20, null(), &mut decoded), Status::NoMesh);
        let mut limits = lwc_decode_options_default();
        limits.max_vertices = 2;
        assert_eq!(lwc_decode(bytes, size, &limits, &mut decoded), Status::Limit);
        assert_eq!(lwc_decode(bytes, size, null(), &mut decoded), Status::Ok);
        assert_eq!((lwc_mesh_num_vertices(decoded), lwc_mesh_num_triangles(decoded)), (3, 1));
        lwc_mesh_free(decoded);
        lwc_encoded_free(encoded);
        lwc_mesh_free(mesh);
    }
}

#[test]
fn null_is_no_object() {
    unsafe {
        assert_eq!(lwc_decoder_feed(null_mut(), null(), 0), Status::NullPointer);
        assert_eq!(lwc_decoder_step(null_mut(), null_mut()), Status::NullPointer);
        assert_eq!(lwc_decoder_num_vertices(null()), 0);
        assert!(lwc_mesh_positions(null()).is_null());
        lwc_decoder_free(null_mut());
        lwc_mesh_free(null_mut());
        lwc_encoded_free(null_mut());
    }
}
