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
            .filter(|line| {
                line.starts_with(&format!("{name} "))
                    && ![" whole ", " shown "].iter().any(|kind| line.contains(kind))
            })
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
        options.quantization_bits = 99;
        assert_eq!(lwc_encode(mesh, &options, &mut encoded), Status::Option);
        assert!(last_error().contains("quantization bits is 99"), "{}", last_error());
        options = lwc_encode_options_default();
        options.step = [1.0, -1.0, 1.0];
        assert_eq!(lwc_encode(mesh, &options, &mut encoded), Status::Option);
        options.step = [1.0, 1e-30, 1.0];
        assert_eq!(lwc_encode(mesh, &options, &mut encoded), Status::Option);
        assert!(last_error().contains("too small for this mesh"), "{}", last_error());
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
fn a_mesh_comes_back_on_the_lattice_that_is_asked_for() {
    let mesh = square();
    let (mut encoded, mut decoded) = (null_mut(), null_mut());
    let mut positions = [0.0; 12];
    unsafe {
        let mut options = lwc_encode_options_default();
        (options.step, options.grid_origin) = ([0.75, 0.5, 1.0], [0.25, 10.0, 0.0]);
        assert_eq!(lwc_encode(mesh, &options, &mut encoded), Status::Ok);
        let (bytes, size) = (lwc_encoded_bytes(encoded), lwc_encoded_num_bytes(encoded));
        assert_eq!(lwc_decode(bytes, size, null(), &mut decoded), Status::Ok);
        positions.copy_from_slice(std::slice::from_raw_parts(lwc_mesh_positions(decoded), 12));
        lwc_mesh_free(decoded);
        lwc_encoded_free(encoded);
        lwc_mesh_free(mesh);
    }
    for position in positions.chunks(3) {
        assert!([0.25, 1.0].contains(&position[0]) && [0.0, 1.0].contains(&position[1]), "{positions:?}");
    }
}

/// A square of two triangles.
fn square() -> *mut Mesh {
    let positions = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0];
    let mut mesh = null_mut();
    let status = unsafe { lwc_mesh_new(positions.as_ptr(), 4, [0, 1, 2, 0, 2, 3].as_ptr(), 2, &mut mesh) };
    assert_eq!(status, Status::Ok);
    mesh
}

fn what(
    name: &CStr,
    semantic: Semantic,
    domain: AttributeDomain,
    component_type: ComponentType,
) -> Attribute {
    Attribute {
        name: name.as_ptr(),
        semantic: semantic as u32,
        set_index: 0,
        domain: domain as u32,
        component_type: component_type as u32,
        num_components: 1,
        normalized: false,
        num_entries: 0,
    }
}

#[test]
fn attributes_go_through_a_stream() {
    let mesh = square();
    let uv = [[0.0_f32, 0.0], [1.0, 0.0], [1.0, 1.0], [0.5, 0.5], [0.75, 0.25]];
    let entries = [0, 1, 2, 3, 4, LWC_NO_ENTRY];
    let names = [c"left".as_ptr(), c"right".as_ptr()];
    unsafe {
        let place = what(c"uv", Semantic::Texcoord, AttributeDomain::Corner, ComponentType::F32);
        let place = Attribute { set_index: 3, num_components: 2, num_entries: 5, ..place };
        assert_eq!(lwc_mesh_add_attribute(mesh, &place, uv.as_ptr().cast(), entries.as_ptr()), Status::Ok);
        let part = what(c"part", Semantic::Group, AttributeDomain::Triangle, ComponentType::Names);
        let part = Attribute { num_entries: 2, ..part };
        assert_eq!(lwc_mesh_add_attribute(mesh, &part, names.as_ptr().cast(), null()), Status::Ok);
        let heat = what(c"heat", Semantic::Generic, AttributeDomain::Vertex, ComponentType::I16);
        let heat = Attribute { num_entries: 4, normalized: true, ..heat };
        let heats = [-300_i16, 0, 7, 1000];
        assert_eq!(lwc_mesh_add_attribute(mesh, &heat, heats.as_ptr().cast(), null()), Status::Ok);

        let mut options = lwc_encode_options_default();
        (options.lossless, options.keep_order, options.texcoord_bits) = (true, true, 16);
        let (mut encoded, mut decoded) = (null_mut(), null_mut());
        assert_eq!(lwc_encode(mesh, &options, &mut encoded), Status::Ok);
        let (bytes, size) = (lwc_encoded_bytes(encoded), lwc_encoded_num_bytes(encoded));
        let decoder = lwc_decoder_new(null());
        assert_eq!(lwc_decoder_mesh(decoder, &mut decoded), Status::NoMesh);
        assert_eq!(lwc_decoder_feed(decoder, bytes, size), Status::Ok);
        while lwc_decoder_step(decoder, null_mut()) == Status::Ok {}
        assert_eq!(lwc_decoder_mesh(decoder, &mut decoded), Status::Ok);
        assert_ne!(lwc_decoder_attribute_checksum(decoder), 0);
        lwc_decoder_free(decoder);
        check_square(decoded, &uv, &heats);
        lwc_mesh_free(decoded);
        assert_eq!(lwc_decode(bytes, size, null(), &mut decoded), Status::Ok);
        check_square(decoded, &uv, &heats);
        lwc_mesh_free(decoded);
        lwc_encoded_free(encoded);
        lwc_mesh_free(mesh);
    }
}

unsafe fn check_square(mesh: *const Mesh, uv: &[[f32; 2]], heats: &[i16; 4]) {
    let (mut found, mut index) =
        (what(c"", Semantic::Generic, AttributeDomain::Triangle, ComponentType::U8), 9);
    unsafe {
        assert_eq!((lwc_mesh_num_attributes(mesh), lwc_mesh_num_triangles(mesh)), (3, 2));
        assert_eq!(lwc_mesh_find_attribute(mesh, c"uv".as_ptr(), &mut index), Status::Ok);
        assert_eq!(lwc_mesh_attribute(mesh, index, &mut found), Status::Ok);
        assert_eq!(CStr::from_ptr(found.name), c"uv");
        assert_eq!(
            (found.semantic, found.set_index, found.domain, found.component_type, found.num_components),
            (2, 3, 1, 6, 2)
        );
        let (mut values, mut entries) = (vec![[0.0_f32; 2]; found.num_entries], [0; 6]);
        let num_bytes = size_of_val(&values[..]);
        assert_eq!(lwc_mesh_attribute_values(mesh, index, values.as_mut_ptr().cast(), num_bytes), Status::Ok);
        assert_eq!(lwc_mesh_attribute_indices(mesh, index, entries.as_mut_ptr(), 6), Status::Ok);
        assert_eq!(entries[5], LWC_NO_ENTRY);
        for corner in 0..5 {
            let [u, v] = values[entries[corner] as usize];
            assert!((u - uv[corner][0]).abs() < 1e-4 && (v - uv[corner][1]).abs() < 1e-4);
        }
        assert_eq!(lwc_mesh_find_attribute(mesh, c"part".as_ptr(), &mut index), Status::Ok);
        let mut of = [0; 2];
        assert_eq!(lwc_mesh_attribute_indices(mesh, index, of.as_mut_ptr(), 2), Status::Ok);
        let name = |entry: u32| CStr::from_ptr(lwc_mesh_attribute_name(mesh, index, entry as usize));
        assert_eq!(of.map(name), [c"left", c"right"]);
        assert!(lwc_mesh_attribute_name(mesh, index, 2).is_null());
        let status = lwc_mesh_attribute_values(mesh, index, null_mut(), 0);
        assert_eq!((status, last_error()), (Status::Attribute, "names are no numbers".to_owned()));

        assert_eq!(lwc_mesh_find_attribute(mesh, c"heat".as_ptr(), &mut index), Status::Ok);
        assert_eq!(lwc_mesh_attribute(mesh, index, &mut found), Status::Ok);
        assert!(found.normalized && found.component_type == ComponentType::I16 as u32);
        let (mut values, mut entries) = (vec![0_i16; found.num_entries], [0; 4]);
        let num_bytes = size_of_val(&values[..]);
        assert_eq!(lwc_mesh_attribute_values(mesh, index, values.as_mut_ptr().cast(), num_bytes), Status::Ok);
        assert_eq!(lwc_mesh_attribute_indices(mesh, index, entries.as_mut_ptr(), 4), Status::Ok);
        assert_eq!(entries.map(|entry| values[entry as usize]), *heats);
        assert_eq!(lwc_mesh_attribute_indices(mesh, index, entries.as_mut_ptr(), 3), Status::Attribute);
        assert_eq!(lwc_mesh_attribute_values(mesh, index, values.as_mut_ptr().cast(), 1), Status::Attribute);
    }
}

#[test]
fn attributes_that_fit_nothing_are_refused() {
    let mesh = square();
    let good = what(c"a", Semantic::Generic, AttributeDomain::Vertex, ComponentType::F64);
    let good = Attribute { num_entries: 4, ..good };
    let values = [0.0_f64; 16];
    let add =
        |what: Attribute| unsafe { lwc_mesh_add_attribute(mesh, &what, values.as_ptr().cast(), null()) };
    for bad in [
        Attribute { num_entries: 3, ..good },
        Attribute { num_components: 0, ..good },
        Attribute { semantic: 7, ..good },
        Attribute { domain: 3, ..good },
        Attribute { component_type: 9, ..good },
        Attribute { num_entries: usize::MAX, num_components: 2, ..good },
    ] {
        assert_eq!(add(bad), Status::Attribute, "{bad:?}");
    }
    assert_eq!(add(Attribute { name: null(), ..good }), Status::NullPointer);
    unsafe {
        assert_eq!(lwc_mesh_num_attributes(mesh), 0);
        let mut index = 0;
        assert_eq!(lwc_mesh_find_attribute(mesh, c"a".as_ptr(), &mut index), Status::NothingToDo);
        assert_eq!(lwc_mesh_add_attribute(mesh, &good, null(), null()), Status::NullPointer);
        assert_eq!(
            lwc_mesh_add_attribute(mesh, &good, values.as_ptr().cast(), [0, 1, 2, 4].as_ptr()),
            Status::Attribute
        );
        assert!(last_error().contains("element 3 has entry 4"), "{}", last_error());
        lwc_mesh_free(mesh);
    }
}

#[test]
fn every_option_reaches_the_encoder() {
    let mesh = square();
    let refused = |change: fn(&mut EncodeOptions)| unsafe {
        let (mut options, mut encoded) = (lwc_encode_options_default(), null_mut());
        change(&mut options);
        assert_eq!(lwc_encode(mesh, &options, &mut encoded), Status::Option);
        last_error()
    };
    assert_eq!(refused(|o| o.profile = c"slow".as_ptr()), "there is no profile slow");
    for (name, message) in [
        ("effort", refused(|o| o.effort = 10)),
        ("normal bits", refused(|o| o.normal_bits = 1)),
        ("texcoord bits", refused(|o| o.texcoord_bits = 0)),
        ("color bits", refused(|o| o.color_bits = 31)),
        ("generic bits", refused(|o| o.generic_bits = 0)),
    ] {
        assert!(message.starts_with(name), "{message}");
    }
    unsafe { lwc_mesh_free(mesh) };
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

/// What a caller's −1 or a pointer into the middle of a number would be: undefined if it were believed.
#[test]
fn arrays_that_cannot_be_are_refused() {
    let (positions, triangles, mut mesh) = ([0.0; 9], [0u32, 1, 2], null_mut());
    let out_of_line = unsafe { positions.as_ptr().byte_add(1) };
    unsafe {
        for (at, length, cause) in [
            (positions.as_ptr(), usize::MAX, "larger than memory"),
            (positions.as_ptr(), isize::MAX as usize / 24 + 1, "larger than memory"),
            (out_of_line, 2, "is not a multiple of 8"),
        ] {
            assert_eq!(lwc_mesh_new(at, length, triangles.as_ptr(), 1, &mut mesh), Status::Array);
            assert!(last_error().contains(cause), "{}", last_error());
        }
        let faces = triangles.as_ptr().byte_add(2);
        assert_eq!(lwc_mesh_new(positions.as_ptr(), 3, faces, 1, &mut mesh), Status::Array);
        assert!(last_error().contains("is not a multiple of 4"), "{}", last_error());
        let mut places = [null_mut::<Mesh>(); 2];
        let place = places.as_mut_ptr().byte_add(1);
        assert_eq!(lwc_mesh_new(positions.as_ptr(), 3, triangles.as_ptr(), 1, place), Status::Array);

        let decoder = lwc_decoder_new(null());
        assert_eq!(lwc_decoder_feed(decoder, positions.as_ptr().cast(), usize::MAX), Status::Array);
        assert_eq!(lwc_decoder_feed(decoder, null(), 1), Status::NullPointer);
        assert_eq!(lwc_decoder_feed(decoder, null(), 0), Status::Ok, "it has not failed");
        lwc_decoder_free(decoder);
        let mut decoded = null_mut();
        assert_eq!(lwc_decode(positions.as_ptr().cast(), usize::MAX, null(), &mut decoded), Status::Array);
        assert!(mesh.is_null() && decoded.is_null());
    }
}

#[test]
fn work_beyond_the_limit_has_its_status() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../format/golden/torus.lwc");
    let bytes = std::fs::read(path).unwrap();
    let decode = |max_work| unsafe {
        let options = DecodeOptions { max_work, ..lwc_decode_options_default() };
        let decoder = lwc_decoder_new(&options);
        assert_eq!(lwc_decoder_feed(decoder, bytes.as_ptr(), bytes.len()), Status::Ok);
        let status = lwc_decoder_step(decoder, null_mut());
        lwc_decoder_free(decoder);
        status
    };
    assert_eq!(lwc_decode_options_default().max_work, 0);
    assert_eq!((decode(0), decode(1 << 40)), (Status::Ok, Status::Ok));
    assert_eq!(decode(10), Status::Limit);
    assert!(last_error().contains("work"), "{}", last_error());
}

/// What a host may have set for the whole thread: other rounding, subnormal numbers taken for zero.
#[cfg(all(target_arch = "x86_64", not(miri)))]
#[test]
fn a_thread_that_computes_otherwise_is_told_so_and_streams_are_not_called_damaged() {
    fn control() -> u32 {
        let mut value = 0_u32;
        unsafe { std::arch::asm!("stmxcsr [{}]", in(reg) &mut value) };
        value
    }
    fn set_control(value: u32) {
        unsafe { std::arch::asm!("ldmxcsr [{}]", in(reg) &value) };
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../format/golden/exact-values.lwc");
    let bytes = std::fs::read(path).unwrap();
    let decode = |bits| unsafe {
        let decoder = lwc_decoder_new(null());
        assert_eq!(lwc_decoder_feed(decoder, bytes.as_ptr(), bytes.len()), Status::Ok);
        let usual = control();
        set_control(usual | bits);
        let status = lwc_decoder_step(decoder, null_mut());
        set_control(usual);
        lwc_decoder_free(decoder);
        status
    };
    assert_eq!(decode(0), Status::Ok);
    // Flush to zero, subnormals are zero, both; rounding down, up, towards zero.
    for bits in [0x8000, 0x0040, 0x8040, 0x2000, 0x4000, 0x6000] {
        assert_eq!(decode(bits), Status::FloatingPoint, "{bits:#x}");
        assert!(last_error().contains("floating-point"), "{}", last_error());
    }
}

#[test]
fn losses_are_told_of_streams_and_meshes() {
    let positions: Vec<f64> = (0..400).flat_map(|v| [f64::from(v / 20), f64::from(v % 20), 0.0]).collect();
    let quad = |v: u32| [v, v + 1, v + 21, v, v + 21, v + 20];
    let triangles: Vec<u32> = (0..379).filter(|v| v % 20 < 19).flat_map(quad).collect();
    let (mut mesh, mut encoded, mut decoded, mut loss) = (null_mut(), null_mut(), null_mut(), None);
    unsafe {
        let made = lwc_mesh_new(positions.as_ptr(), 400, triangles.as_ptr(), triangles.len() / 3, &mut mesh);
        assert_eq!((made, lwc_mesh_num_losses(mesh)), (Status::Ok, 0));
        assert_eq!(lwc_encode(mesh, null(), &mut encoded), Status::Ok);
        let mut found = |index| {
            let mut one: Loss = std::mem::zeroed();
            let status = lwc_encoded_loss(encoded, index, &mut one);
            loss = (status == Status::Ok).then_some(one);
            loss
        };
        let last = found(lwc_encoded_num_losses(encoded) - 1).unwrap();
        assert_eq!((last.stage, last.kind), (LossStage::Encoding as u32, LossKind::Reordered as u32));
        assert_eq!((last.count, last.largest_error.is_nan()), (-1, true));
        let message = CStr::from_ptr(last.message).to_str().unwrap();
        assert_eq!(message, "vertices and triangles in another order: `--keep-order` keeps them");
        assert!(found(99).is_none() && last_error().contains("no loss 99"));
        assert_eq!(lwc_encoded_num_losses(null()), 0);

        let mut options = lwc_decode_options_default();
        options.level = 0;
        let (bytes, num_bytes) = (lwc_encoded_bytes(encoded), lwc_encoded_num_bytes(encoded));
        assert_eq!(lwc_decode(bytes, num_bytes, &options, &mut decoded), Status::Ok);
        assert_eq!(lwc_mesh_num_losses(decoded), 1);
        let mut one: Loss = std::mem::zeroed();
        assert_eq!(lwc_mesh_loss(decoded, 0, &mut one), Status::Ok);
        assert_eq!((one.stage, one.kind), (LossStage::Decoding as u32, LossKind::Coarser as u32));
        lwc_mesh_free(decoded);
        lwc_encoded_free(encoded);
        lwc_mesh_free(mesh);
    }
}
