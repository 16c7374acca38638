//! Attributes bit for bit, and those of what lies loose.
#![cfg(feature = "encoder")]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

mod common;

use common::attributed::{all, atlas, colours, flat_normals, materials, nasty, smooth_normals};
use common::kinds::every_kind;
use common::{build, sphere};
use lwc::mesh::{Attribute, Attributes, ComponentType, Domain, Semantic, Values};
use lwc::{Decoder, EncodeOptions, Limits, Profile, TriMesh, encode_with_attributes};

fn everything() -> EncodeOptions {
    let mut options = EncodeOptions::default();
    (options.keep_isolated, options.keep_degenerate) = (true, true);
    (options.lossless, options.keep_order) = (true, true);
    options
}

fn encode(mesh: &TriMesh, attributes: &Attributes, options: &EncodeOptions) -> Vec<u8> {
    let encoded = encode_with_attributes(mesh, attributes, options, &|_| {}).unwrap();
    if options.lossless && options.keep_order && options.keep_isolated && options.keep_degenerate {
        assert!(encoded.losses.is_empty(), "{}", encoded.losses);
    }
    encoded.bytes
}

fn decode(bytes: &[u8]) -> (TriMesh, Attributes) {
    let mut decoder = Decoder::new(Limits::default());
    decoder.push(bytes).unwrap();
    assert!(decoder.is_complete());
    decoder.to_tri_mesh_with_attributes().unwrap()
}

/// Names and bits of all values, element by element.
fn bits(mesh: &TriMesh, attributes: &Attributes) -> Vec<Vec<Vec<u64>>> {
    let of_row = |a: &Attribute, row: usize| -> Vec<u64> {
        match a.values.names() {
            Some(names) => names[row].bytes().map(u64::from).collect(),
            None => {
                (0..a.num_components).map(|k| a.values.bits(row * a.num_components + k).unwrap()).collect()
            }
        }
    };
    let of_one = |a: &Attribute| {
        assert_eq!(a.validate(mesh), Ok(()), "{}", a.name);
        let count = a.domain.num_elements(mesh);
        (0..count).map(|k| a.entry(k).map(|row| of_row(a, row)).unwrap_or_default()).collect()
    };
    attributes.list.iter().map(of_one).collect()
}

#[track_caller]
fn assert_lossless(mesh: &TriMesh, attributes: &Attributes, what: &str) {
    let stream = encode(mesh, attributes, &everything());
    let (decoded, found) = decode(&stream);
    let positions =
        |mesh: &TriMesh| -> Vec<_> { mesh.positions().iter().map(|p| p.map(f64::to_bits)).collect() };
    assert!(positions(mesh) == positions(&decoded), "{what}: positions");
    assert!(mesh.triangles() == decoded.triangles(), "{what}: triangles");
    let (wanted, got) = (bits(mesh, attributes), bits(&decoded, &found));
    for ((wanted, got), attribute) in wanted.iter().zip(&got).zip(&attributes.list) {
        let differs = wanted.iter().zip(got).position(|(a, b)| a != b);
        assert_eq!(differs, None, "{what}: {}", attribute.name);
        assert_eq!(wanted.len(), got.len());
    }
    assert!(encode(&decoded, &found, &everything()) == stream, "{what}: other bytes the second time");
    let mut options = everything();
    options.keep_order = false;
    let stream = encode(mesh, attributes, &options);
    let (decoded, found) = decode(&stream);
    assert!(encode(&decoded, &found, &options) == stream, "{what}: other bytes without the order");
}

#[test]
fn every_type_on_every_domain_returns_bit_for_bit() {
    let mesh = sphere(2);
    for (i, domain) in Domain::ALL.into_iter().enumerate() {
        for (seed, semantics) in [
            (0, [Semantic::Generic, Semantic::TexCoord(0)]),
            (1, [Semantic::Color(0), Semantic::Normal]),
            (3, [Semantic::Object, Semantic::Generic]),
        ] {
            let list = ComponentType::ALL.iter().zip(0..).flat_map(|(&scalar, k)| {
                let make = move |mesh, semantic, s| nasty(mesh, domain, scalar, semantic, s);
                let mesh = &mesh;
                semantics.map(|semantic| make(mesh, semantic, 6 * (k + 20 * i as u64) + seed))
            });
            assert_lossless(&mesh, &all(list.collect()), &format!("{domain}, {seed}"));
        }
    }
}

#[test]
fn usual_attributes_return_bit_for_bit() {
    let (mesh, uv) = atlas(30, 20);
    assert_lossless(&mesh, &all(vec![uv, colours(&mesh), flat_normals(&mesh), materials(&mesh)]), "atlas");
    let mesh = sphere(3);
    for normals in smooth_normals(&mesh) {
        assert_lossless(&mesh, &all(vec![normals]), "normals");
    }
}

#[test]
fn every_kind_of_mesh_returns_with_attributes() {
    for (name, mesh) in every_kind() {
        let mesh = with_loose_things(mesh);
        let list = Domain::ALL.into_iter().zip(0..).flat_map(|(domain, i)| {
            let make = |scalar, seed| nasty(&mesh, domain, scalar, Semantic::Generic, seed);
            [make(ComponentType::F32, 2 + i), make(ComponentType::U8, 9 + i), make(ComponentType::F64, 6 * i)]
        });
        assert_lossless(&mesh, &all(list.chain([materials(&mesh)]).collect()), name);
    }
}

/// A mesh with vertices without triangles and triangles that name a vertex twice.
fn with_loose_things(mesh: TriMesh) -> TriMesh {
    let (mut positions, mut triangles) = mesh.into_parts();
    let n = positions.len() as u32;
    let first = positions[0];
    positions.extend([first, first.map(|x| x + 0.001), first.map(|x| x * 0.5), first]);
    triangles.extend([[n, n, 0], [1, 2, 1], [n + 1, n + 1, n + 1]]);
    build(positions, triangles)
}

/// Without `lossless` what lies loose has the values that the same bits give to the surface.
#[test]
fn loose_things_have_values_to_their_bits() {
    let mesh = with_loose_things(sphere(2));
    let values: Vec<f64> = mesh.positions().iter().map(|p| p[0] + 2.0 * p[1]).collect();
    let smooth = Attribute::new("s", Semantic::Generic, Domain::Vertex, 1, Values::F64(values.clone()));
    let attributes = all(vec![smooth, materials(&mesh), colours(&mesh)]);
    let mut options = everything();
    options.lossless = false;
    let (decoded, found) = decode(&encode(&mesh, &attributes, &options));
    assert_eq!(found.list[0].validate(&decoded), Ok(()));
    let range = values.iter().fold(0.0, |m: f64, x| m.max(x.abs())) * 2.0;
    for (v, wanted) in values.iter().enumerate() {
        let got = found.list[0].number(found.list[0].entry(v).unwrap(), 0).unwrap();
        assert!((got - wanted).abs() < range / 4095.0, "vertex {v}: {got} for {wanted}");
    }
    let (wanted, got) = (bits(&mesh, &attributes), bits(&decoded, &found));
    assert_eq!((&wanted[1], &wanted[2]), (&got[1], &got[2]));
}

#[test]
fn profiles_and_cuts_keep_their_promises() {
    let (mesh, uv) = atlas(20, 12);
    let attributes = all(vec![uv, colours(&mesh)]);
    let mut options = everything();
    let small = encode(&mesh, &attributes, &options);
    options.profile = Some(Profile::Fast);
    let wanted = decode(&small);
    if Profile::Fast.is_supported() {
        assert_eq!(decode(&encode(&mesh, &attributes, &options)), wanted);
    }
    // Before its last chunks the stream has the values of the grid.
    for cut in (small.len() / 2..small.len()).step_by(13) {
        let mut decoder = Decoder::new(Limits::default());
        decoder.push(&small[..cut]).unwrap();
        let (mesh, attributes) = decoder.preview_with_attributes().unwrap();
        attributes.list.iter().for_each(|a| assert_eq!(a.validate(&mesh), Ok(()), "{cut} bytes"));
    }
}

/// Exact colours need no bytes but those of the passes.
#[test]
fn what_is_exact_already_costs_nothing() {
    let mesh = sphere(3);
    let mut options = EncodeOptions::default();
    let attributes = all(vec![colours(&mesh), materials(&mesh)]);
    let plain = encode(&mesh, &attributes, &options);
    options.lossless = true;
    let kinds = |bytes: &[u8]| -> Vec<&str> {
        let info = lwc::StreamInfo::read(bytes).unwrap().unwrap();
        info.trailing().iter().map(|t| t.kind.name()).collect()
    };
    assert_eq!(
        (kinds(&plain), kinds(&encode(&mesh, &attributes, &options))),
        (vec![], vec!["exact coordinates"])
    );
}
