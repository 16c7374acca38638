//! Attributes through a stream: at the finest level every value is back, at all others none is missing.
#![cfg(feature = "encoder")]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

mod common;

use common::attributed::{all, atlas, colours, flat_normals, materials, positions};
use common::{grid, sphere, torus};
use lwc::losses::LossKind;
use lwc::mesh::{Attribute, Attributes, Domain, NO_ENTRY, Semantic, Values};
use lwc::{Decoder, EncodeOptions, Encoded, Limits, Optimize, Partition, TriMesh, encode_with_attributes};
use std::collections::HashMap;

fn encode(mesh: &TriMesh, attributes: &Attributes, options: &EncodeOptions) -> Encoded {
    encode_with_attributes(mesh, attributes, options, &|_| {}).unwrap()
}

/// Sixteen bits, so that no two vertices of the models here share a cell.
fn options() -> EncodeOptions {
    let mut options = EncodeOptions::default();
    options.quantization_bits = 16;
    options
}

fn decode(bytes: &[u8]) -> Decoder {
    let mut decoder = Decoder::new(Limits::default());
    decoder.push(bytes).unwrap();
    assert!(decoder.is_complete());
    decoder
}

/// The vertex of `mesh` that each vertex of the decoded mesh is.
fn sources(mesh: &TriMesh, decoder: &Decoder) -> Vec<u32> {
    let info = decoder.info().unwrap();
    let steps = f64::from((1_u32 << info.quantization_bits()) - 1);
    let cell = |p: &[f64; 3]| -> [i32; 3] {
        std::array::from_fn(|a| ((p[a] - info.origin()[a]) * steps / info.side() + 0.5).floor() as i32)
    };
    let places: HashMap<_, _> = mesh.positions().iter().map(cell).zip(0..).collect();
    assert_eq!(places.len(), mesh.num_vertices(), "vertices share a cell");
    decoder.mesh().unwrap().quantized_positions().iter().map(|cell| places[cell]).collect()
}

/// For each decoded triangle the triangle of `mesh` that it is, and by how much it is turned.
fn triangle_sources(mesh: &TriMesh, decoder: &Decoder) -> Vec<(usize, usize)> {
    let of = sources(mesh, decoder);
    let mut places = HashMap::new();
    for (t, &[a, b, c]) in mesh.triangles().iter().enumerate() {
        for (turn, key) in [[a, b, c], [b, c, a], [c, a, b]].into_iter().enumerate() {
            assert_eq!(places.insert(key, (t, turn)), None, "a triangle twice");
        }
    }
    decoder.mesh().unwrap().triangles().iter().map(|t| places[&t.map(|v| of[v as usize])]).collect()
}

/// Row of the source and of the decoded attribute, element by element.
fn pairs(
    mesh: &TriMesh,
    decoder: &Decoder,
    attribute: &Attribute,
    found: &Attribute,
) -> Vec<(Option<usize>, Option<usize>)> {
    let triangles = triangle_sources(mesh, decoder);
    let of = sources(mesh, decoder);
    let element = |k: usize| match attribute.domain {
        Domain::Vertex => of[k] as usize,
        Domain::Corner => {
            let (t, turn) = triangles[k / 3];
            3 * t + (k % 3 + turn) % 3
        }
        Domain::Triangle => triangles[k].0,
    };
    let count = attribute.domain.num_elements(mesh);
    (0..count).map(|k| (attribute.entry(element(k)), found.entry(k))).collect()
}

/// The largest difference of a number, exact for names and for what has no value.
fn deviation(mesh: &TriMesh, decoder: &Decoder, attribute: &Attribute, found: &Attribute) -> f64 {
    let decoded = decoder.mesh().unwrap().to_tri_mesh();
    assert_eq!(found.validate(&decoded), Ok(()));
    let kind = |a: &Attribute| {
        (a.name.clone(), a.semantic, a.domain, a.num_components, a.is_normalized, a.values.component_type())
    };
    assert_eq!(kind(attribute), kind(found));
    let mut most = 0.0_f64;
    for (wanted, got) in pairs(mesh, decoder, attribute, found) {
        let (Some(wanted), Some(got)) = (wanted, got) else {
            assert_eq!(wanted, got, "a value where there was none, or none where there was one");
            continue;
        };
        if let (Some(a), Some(b)) = (attribute.values.names(), found.values.names()) {
            assert_eq!(a[wanted], b[got]);
        }
        for k in 0..attribute.num_components {
            if let (Some(a), Some(b)) = (attribute.number(wanted, k), found.number(got, k)) {
                most = most.max((a - b).abs());
            }
        }
    }
    most
}

/// Encodes, decodes, and returns the deviation of each attribute.
fn deviations(mesh: &TriMesh, list: Vec<Attribute>, options: &EncodeOptions) -> Vec<f64> {
    let attributes = all(list);
    let encoded = encode(mesh, &attributes, options);
    let decoder = decode(&encoded.bytes);
    let found = decoder.attributes();
    assert_eq!(found.list.len(), attributes.list.len());
    attributes.list.iter().zip(&found.list).map(|(a, b)| deviation(mesh, &decoder, a, b)).collect()
}

#[test]
fn colours_of_8_bits_come_back_exactly() {
    for mesh in [sphere(3), torus(40, 20), grid(25, 30, |x, y| (x * 0.3).sin() + (y * 0.2).cos())] {
        assert_eq!(deviations(&mesh, vec![colours(&mesh)], &options()), [0.0]);
    }
}

#[test]
fn every_domain_and_type_comes_back_to_its_step() {
    let (mesh, uv) = atlas(36, 24);
    let n = mesh.num_vertices();
    let scalar = |values| Attribute::new("quality", Semantic::Generic, Domain::Vertex, 1, values);
    let height = || positions(&mesh).map(|p| p[2]);
    let smooth: Vec<f64> = positions(&mesh)
        .flat_map(|p| {
            let length = p.iter().map(|x| x * x).sum::<f64>().sqrt();
            p.map(|x| x / length)
        })
        .collect();
    let faces = mesh.num_triangles();
    let bytes = Values::I8((0..faces).map(|t| (t * 7 / faces) as i8 - 3).collect());
    let areas = Values::F32((0..faces).map(|t| (t as f32 * 0.01).sin()).collect());
    let list = vec![
        uv,
        colours(&mesh),
        Attribute::new("n", Semantic::Normal, Domain::Vertex, 3, Values::F64(smooth)),
        flat_normals(&mesh),
        materials(&mesh),
        scalar(Values::F64(height().collect())),
        scalar(Values::I32((0..n as i32).map(|v| v * 1_000_000 - 400_000_000).collect())),
        scalar(Values::U16(height().map(|z| ((z + 2.0) * 900.0) as u16).collect())),
        Attribute::new("part", Semantic::Generic, Domain::Triangle, 1, bytes),
        Attribute::new("area", Semantic::Generic, Domain::Triangle, 1, areas),
        Attribute {
            is_normalized: true,
            ..Attribute::new("w", Semantic::Generic, Domain::Vertex, 1, Values::U8(vec![200; n]))
        },
    ];
    let found = deviations(&mesh, list, &options());
    let half_step = |range: f64, bits: u32| 0.5 * range / (f64::from(1_u32 << bits) - 1.0) * 1.001;
    assert!(found[0] <= half_step(1.0, 10), "uv {}", found[0]);
    assert_eq!(found[1], 0.0, "colours");
    assert!(found[2] < 0.014 && found[3] < 0.014, "normals {} {}", found[2], found[3]);
    assert_eq!(found[4], 0.0);
    assert!(found[5] <= half_step(1.4, 12), "float64 {}", found[5]);
    assert!(found[6] <= half_step(864e6, 12) + 0.5, "int32 {}", found[6]);
    assert_eq!(found[7], 0.0, "range below 12 bits");
    assert_eq!(found[8], 0.0);
    assert!(found[9] <= half_step(2.0, 12), "of faces {}", found[9]);
    assert_eq!(found[10], 0.0);
}

#[test]
fn what_has_no_value_has_none_afterwards() {
    let (mesh, uv) = atlas(24, 16);
    let mut corners = Attribute { indices: Some((0..uv.num_entries() as u32).collect()), ..uv };
    let indices = corners.indices.as_mut().unwrap();
    for (t, triangle) in mesh.triangles().iter().enumerate() {
        if triangle.iter().any(|v| v % 16 < 4) {
            indices[3 * t..3 * t + 3].fill(NO_ENTRY);
        }
    }
    let mut quality: Vec<f32> = positions(&mesh).map(|p| p[0] as f32).collect();
    quality[7] = f32::NAN;
    let quality = Attribute::new("q", Semantic::Generic, Domain::Vertex, 1, Values::F32(quality));
    let nothing = Attribute {
        indices: Some(vec![NO_ENTRY; mesh.num_triangles()]),
        ..Attribute::new("g", Semantic::Group, Domain::Triangle, 1, Values::Names(vec![]))
    };
    let encoded = encode(&mesh, &all(vec![corners.clone(), quality.clone(), nothing.clone()]), &options());
    let dropped = encoded.losses.iter().find(|loss| loss.kind == LossKind::Dropped).unwrap();
    assert_eq!(
        (dropped.subject.as_str(), dropped.count),
        ("values of attributes that are not finite", Some(1))
    );
    let decoder = decode(&encoded.bytes);
    let found = decoder.attributes();
    assert!(deviation(&mesh, &decoder, &corners, &found.list[0]) < 0.0006);
    assert_eq!(found.list[1].indices.iter().flatten().filter(|&&row| row == NO_ENTRY).count(), 1);
    assert_eq!(deviation(&mesh, &decoder, &nothing, &found.list[2]), 0.0);
}

#[test]
fn every_way_of_choosing_levels_keeps_values() {
    let (mesh, uv) = atlas(30, 20);
    for optimize in Optimize::ALL {
        for partition in Partition::ALL {
            let mut options = options();
            (options.optimize, options.partition) = (optimize, partition);
            let list = vec![uv.clone(), materials(&mesh), flat_normals(&mesh)];
            let found = deviations(&mesh, list, &options);
            assert!(found[0] < 0.0006 && found[1] == 0.0 && found[2] < 0.014, "{found:?}");
        }
    }
}

/// Texture coordinates of neighbours lie close together on every level: no triangle spans the rectangle.
#[test]
fn charts_do_not_bleed_on_coarse_levels() {
    let (mesh, uv) = atlas(72, 36);
    let encoded = encode(&mesh, &all(vec![uv]), &options());
    let mut decoder = Decoder::new(Limits::default());
    decoder.feed(&encoded.bytes).unwrap();
    let mut passes = 0;
    while decoder.step().unwrap().is_some() {
        passes += 1;
        let level = decoder.mesh().unwrap();
        let mesh = level.to_tri_mesh();
        let found = decoder.attributes();
        assert_eq!(found.list[0].validate(&mesh), Ok(()));
        if level.num_vertices() < 100 {
            continue;
        }
        for t in 0..mesh.num_triangles() {
            let corners = [0, 1, 2].map(|c| found.list[0].entry_at_corner(&mesh, t, c).unwrap());
            for k in 0..2 {
                let [a, b, c] = corners.map(|row| found.list[0].number(row, k).unwrap());
                let span = a.max(b).max(c) - a.min(b).min(c);
                assert!(span < 0.45, "triangle {t} of {} vertices spans {span}", level.num_vertices());
            }
        }
    }
    assert!(passes > 5);
}

#[test]
fn every_cut_has_attributes_for_its_mesh() {
    let (mesh, uv) = atlas(20, 12);
    let encoded = encode(&mesh, &all(vec![uv, colours(&mesh), materials(&mesh)]), &options());
    for cut in (0..encoded.bytes.len()).step_by(7) {
        let mut decoder = Decoder::new(Limits::default());
        decoder.push(&encoded.bytes[..cut]).unwrap();
        let attributes = decoder.attributes();
        let Some(level) = decoder.mesh() else {
            assert!(attributes.is_empty());
            continue;
        };
        let level = level.to_tri_mesh();
        assert_eq!(attributes.list.len(), 3);
        attributes.list.iter().for_each(|a| assert_eq!(a.validate(&level), Ok(()), "{cut} bytes"));
        let (preview, attributes) = decoder.preview_with_attributes().unwrap();
        attributes.list.iter().for_each(|a| assert_eq!(a.validate(&preview), Ok(()), "{cut} bytes"));
        assert!(attributes.list.iter().all(|a| a.indices.iter().flatten().all(|&row| row != NO_ENTRY)));
    }
}

#[test]
fn pieces_and_slices_make_no_difference() {
    let (mesh, uv) = atlas(20, 12);
    let encoded = encode(&mesh, &all(vec![uv, colours(&mesh), flat_normals(&mesh)]), &options());
    let whole = decode(&encoded.bytes).attributes();
    let mut decoder = Decoder::new(Limits::default());
    for piece in encoded.bytes.chunks(11) {
        decoder.feed(piece).unwrap();
        loop {
            let step = decoder.step_within(50).unwrap();
            decoder.attributes().list.iter().for_each(|a| {
                assert_eq!(a.validate(&decoder.mesh().unwrap().to_tri_mesh()), Ok(()));
            });
            if step == lwc::Step::Waiting {
                break;
            }
        }
    }
    assert!(decoder.is_complete());
    assert_eq!(decoder.attributes(), whole);
}

/// The charts of an atlas: of each row of texture coordinates the piece of the surface that it belongs to.
#[cfg(feature = "io")]
fn charts(mesh: &TriMesh, uv: &Attribute) -> Vec<usize> {
    fn root(of: &mut [usize], mut k: usize) -> usize {
        while of[k] != k {
            of[k] = of[of[k]];
            k = of[k];
        }
        k
    }
    let mut of: Vec<usize> = (0..uv.num_entries()).collect();
    for t in 0..mesh.num_triangles() {
        let rows = [0, 1, 2].map(|c| uv.entry_at_corner(mesh, t, c).unwrap());
        for other in [rows[1], rows[2]] {
            let (a, b) = (root(&mut of, rows[0]), root(&mut of, other));
            of[a] = b;
        }
    }
    (0..of.len()).map(|k| root(&mut of, k)).collect()
}

/// On every level of a real model the corners of each triangle lie in one chart.
#[test]
#[cfg(feature = "io")]
fn the_charts_of_spot_stay_apart() {
    let Some(corpus) = common::corpus::corpus() else { return };
    let file = lwc::io::read(corpus.join("spot.obj")).unwrap();
    let uv = file.attributes.find(Semantic::TexCoord(0)).unwrap();
    let chart_of = charts(&file.mesh, uv);
    let mut fine = EncodeOptions::default();
    // So many bits that every row has a place of its own.
    fine.texcoord_bits = 20;
    let encoded = encode(&file.mesh, &all(vec![uv.clone()]), &fine);
    let place = |u: f64, v: f64| [u, v].map(|x| (x * 16384.0).round() as i64);
    let mut at: HashMap<_, Vec<usize>> = HashMap::new();
    for (row, &chart) in chart_of.iter().enumerate() {
        let [u, v] = [0, 1].map(|k| uv.number(row, k).unwrap());
        at.entry(place(u, v)).or_default().push(chart);
    }
    let mut decoder = Decoder::new(Limits::default());
    decoder.feed(&encoded.bytes).unwrap();
    let (mut apart, mut across) = (0, 0);
    while decoder.step().unwrap().is_some() {
        // The values of the pass come with the next step.
        let done = decoder.passes_done();
        let mut ahead = Decoder::new(Limits::default());
        ahead.push(&encoded.bytes[..encoded.info.passes()[done - 1].end as usize]).unwrap();
        let (mesh, found) = ahead.preview_with_attributes().unwrap();
        let found = &found.list[0];
        for t in 0..mesh.num_triangles() {
            let charts = [0, 1, 2].map(|c| {
                let row = found.entry_at_corner(&mesh, t, c).unwrap();
                let [u, v] = [0, 1].map(|k| found.number(row, k).unwrap());
                let [u, v] = place(u, v);
                // A value half way between two places may have gone to either.
                let near = (-1..=1).flat_map(|du| (-1..=1).map(move |dv| [u + du, v + dv]));
                near.filter_map(|place| at.get(&place)).flatten().copied().collect::<Vec<_>>()
            });
            let is_apart = charts[0].iter().any(|c| charts[1].contains(c) && charts[2].contains(c));
            *(if is_apart { &mut apart } else { &mut across }) += 1;
        }
    }
    assert_eq!(across, 0, "of {apart} triangles");
    assert!(apart > 10_000);
}
