//! Point clouds of terrain in LAS and LAZ.
#![cfg(feature = "las")]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

mod common;

use common::corpus::corpus;
use lwc::{
    io::{self, Format, MeshFile, Place, ReadError, TerrainOptions},
    mesh::{Attribute, Semantic, Values},
};
use std::path::Path;

/// x, y and z in steps, return number, number of returns, class.
type Point = ([i32; 3], u8, u8, u8);

/// A file of version 1.2, or 1.4 for the newer point formats; steps of 0.01 from (1000, 2000, -5).
fn las(format: u8, points: &[Point]) -> Vec<u8> {
    let is_old = format <= 5;
    let (minor, header_bytes) = if is_old { (2, 227) } else { (4, 375) };
    let record_bytes: u16 = [20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67][usize::from(format)];
    let mut bytes = vec![0; header_bytes];
    let mut put = |at: usize, field: &[u8]| bytes[at..at + field.len()].copy_from_slice(field);
    put(0, b"LASF");
    put(24, &[1, minor]);
    put(94, &(header_bytes as u16).to_le_bytes());
    put(96, &(header_bytes as u32).to_le_bytes());
    put(104, &[format]);
    put(105, &record_bytes.to_le_bytes());
    put(107, &(points.len() as u32).to_le_bytes());
    put(131, [0.01f64, 0.01, 0.01].map(f64::to_le_bytes).as_flattened());
    put(155, [1000.0f64, 2000.0, -5.0].map(f64::to_le_bytes).as_flattened());
    if !is_old {
        put(247, &(points.len() as u64).to_le_bytes());
    }
    let colour_at = [0, 0, 20, 28, 0, 28, 0, 30, 30, 0, 30][usize::from(format)];
    for (k, &(grid, number, of, class)) in points.iter().enumerate() {
        let mut record = vec![0; usize::from(record_bytes)];
        record[..12].copy_from_slice(grid.map(i32::to_le_bytes).as_flattened());
        record[12..14].copy_from_slice(&(1000 + k as u16).to_le_bytes());
        record[14] = if is_old { number | of << 3 } else { number | of << 4 };
        record[if is_old { 15 } else { 16 }] = class;
        if colour_at > 0 {
            let colour = [k as u16, 300, 65535].map(u16::to_le_bytes);
            record[colour_at..colour_at + 6].copy_from_slice(colour.as_flattened());
        }
        bytes.extend(record);
    }
    bytes
}

const SQUARE: [Point; 6] = [
    ([0, 0, 0], 1, 1, 2),
    ([100, 0, 50], 1, 2, 5),
    ([100, 0, 20], 2, 2, 2),
    ([100, 100, 0], 1, 1, 6),
    ([0, 100, 0], 1, 1, 2),
    ([40, 60, -7], 1, 3, 9),
];

fn read(bytes: &[u8]) -> Result<MeshFile, ReadError> {
    io::read_bytes(bytes, Format::Las)
}

fn read_with(bytes: &[u8], set: impl Fn(&mut TerrainOptions)) -> MeshFile {
    let mut options = TerrainOptions::default();
    set(&mut options);
    io::read_terrain_bytes(bytes, &options).unwrap()
}

fn named<'a>(file: &'a MeshFile, name: &str) -> &'a Attribute {
    file.attributes.list.iter().find(|attribute| attribute.name == name).unwrap()
}

/// Twice the area of a triangle in the plane, positive if it is counter-clockwise from above.
fn doubled_areas(file: &MeshFile) -> Vec<f64> {
    let area = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| file.mesh.positions()[v as usize]);
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    };
    file.mesh.triangles().iter().map(area).collect()
}

#[test]
fn points_of_all_formats_become_a_surface() {
    for format in 0..=10 {
        let file = read(&las(format, &SQUARE)).unwrap();
        let positions = file.mesh.positions();
        assert_eq!((positions.len(), file.mesh.num_triangles()), (5, 4), "format {format}");
        assert_eq!(positions[0], [1000.0, 2000.0, -5.0]);
        assert_eq!(positions[1], [1001.0, 2000.0, 0.2 - 5.0], "the lower of two");
        assert_eq!(file.report.points_left_out, 1);
        assert!(doubled_areas(&file).iter().all(|&area| area > 0.0), "counter-clockwise from above");
        assert!((doubled_areas(&file).iter().sum::<f64>() - 2.0).abs() < 1e-9);

        assert_eq!(named(&file, "classification").values, Values::U8(vec![2, 2, 6, 2, 9]));
        assert_eq!(named(&file, "intensity").values, Values::U16(vec![1000, 1002, 1003, 1004, 1005]));
        let colour = file.attributes.find(Semantic::Color(0));
        assert_eq!(colour.is_some(), [2, 3, 5, 7, 8, 10].contains(&format), "format {format}");
        if let Some(colour) = colour {
            assert!(colour.is_normalized);
            let expected = [0, 2, 3, 4, 5].map(|k| [k, 300, 65535]);
            assert_eq!(colour.values, Values::U16(expected.concat()));
        }
    }
}

/// The place of a record, whose flags are in byte 15.
fn record(bytes: &[u8], index: usize) -> usize {
    let start = u32::from_le_bytes(bytes[96..100].try_into().unwrap()) as usize;
    start + index * usize::from(u16::from_le_bytes([bytes[105], bytes[106]]))
}

#[test]
fn withheld_points_are_left_out_and_counted() {
    for (format, flag) in [(3, 0x80), (7, 0x04)] {
        let mut bytes = las(format, &SQUARE);
        let at = record(&bytes, 5) + 15;
        bytes[at] |= flag;
        let file = read(&bytes).unwrap();
        assert_eq!((file.mesh.num_vertices(), file.mesh.num_triangles()), (4, 2), "format {format}");
        assert_eq!((file.report.points_withheld, file.report.points_left_out), (1, 1));
    }
}

#[test]
fn classes_and_long_edges_are_left_out() {
    let file = read_with(&las(3, &SQUARE), |options| options.classes = Some(vec![2, 9]));
    assert_eq!(named(&file, "classification").values, Values::U8(vec![2, 2, 2, 9]));

    // Two groups of points, 10 units apart.
    let points: Vec<Point> = (0..8)
        .map(|k| ([k % 2 * 100, k / 2 % 2 * 100, 0], k / 4))
        .map(|([x, y, z], far)| ([x + far * 1000, y, z], 1, 1, 2))
        .collect();
    let all = read(&las(0, &points)).unwrap();
    assert_eq!(all.mesh.num_triangles(), 6);
    let file = read_with(&las(0, &points), |options| options.longest_edge = Some(2.0));
    assert_eq!((file.mesh.num_vertices(), file.mesh.num_triangles()), (8, 4));
}

#[test]
fn colours_of_8_bits_in_16_are_8_bits() {
    let mut bytes = las(2, &SQUARE);
    for k in 0..SQUARE.len() {
        let at = record(&bytes, k) + 20;
        bytes[at..at + 6].copy_from_slice([10u16, 255, 128].map(u16::to_le_bytes).as_flattened());
    }
    let file = read(&bytes).unwrap();
    let colour = file.attributes.find(Semantic::Color(0)).unwrap();
    assert!(colour.is_normalized);
    assert_eq!(colour.values, Values::U8([10, 255, 128].repeat(5)));
}

/// A described field: code of its type, name, bytes in record k, and, if it has one, its scale.
type Field = (u8, &'static str, fn(u8) -> Vec<u8>, Option<f64>);

/// The file with these fields after each record.
fn with_extra_bytes(bytes: &[u8], fields: &[Field]) -> Vec<u8> {
    let (start, record_bytes) = (record(bytes, 0), record(bytes, 1) - record(bytes, 0));
    let mut head = bytes[..start].to_vec();
    head.extend([0; 2]);
    head.extend(b"LASF_Spec\0\0\0\0\0\0\0");
    head.extend(4u16.to_le_bytes());
    head.extend((192 * fields.len() as u16).to_le_bytes());
    head.extend([0; 32]);
    for (code, name, _, scale) in fields {
        let mut description = [0; 192];
        description[2] = *code;
        description[3] = if scale.is_some() { 8 } else { 0 };
        description[4..4 + name.len()].copy_from_slice(name.as_bytes());
        description[112..120].copy_from_slice(&scale.unwrap_or(0.0).to_le_bytes());
        head.extend(description);
    }
    let new_start = head.len() as u32;
    head[96..100].copy_from_slice(&new_start.to_le_bytes());
    let more: usize = fields.iter().map(|(_, _, value, _)| value(0).len()).sum();
    head[105..107].copy_from_slice(&((record_bytes + more) as u16).to_le_bytes());
    for (k, record) in bytes[start..].chunks_exact(record_bytes).enumerate() {
        head.extend(record);
        fields.iter().for_each(|(_, _, value, _)| head.extend(value(k as u8)));
    }
    head
}

#[test]
fn extra_bytes_and_near_infrared_are_kept() {
    let plain = las(8, &SQUARE);
    let height: fn(u8) -> Vec<u8> = |k| (f32::from(k) * 0.5).to_le_bytes().to_vec();
    let width: fn(u8) -> Vec<u8> = |k| (-i16::from(k)).to_le_bytes().to_vec();
    let label: fn(u8) -> Vec<u8> = |k| (u64::from(k) << 33).to_le_bytes().to_vec();
    let fields: [Field; 3] =
        [(9, "height above", height, None), (4, "width", width, Some(0.25)), (7, "label", label, None)];
    let file = read(&with_extra_bytes(&plain, &fields)).unwrap();
    // The third point, at index 1 of the file, lies above another.
    assert_eq!(named(&file, "nir").values, Values::U16(vec![0; 5]));
    assert_eq!(named(&file, "height_above").values, Values::F32(vec![0.0, 1.0, 1.5, 2.0, 2.5]));
    assert_eq!(named(&file, "width").values, Values::F64(vec![0.0, -0.5, -0.75, -1.0, -1.25]));
    let labels = [0, 2, 3, 4, 5].map(|k| f64::from(k) * 2f64.powi(33));
    assert_eq!(named(&file, "label").values, Values::F64(labels.to_vec()));
    assert_eq!(file.report.ignored, [OF_POINTS]);

    let pairs: fn(u8) -> Vec<u8> = |k| vec![k, 2 * k];
    let bytes = with_extra_bytes(&plain, &[(11, "pairs", pairs, None), (1, "odd", |k| vec![k], None)]);
    let file = read(&bytes).unwrap();
    assert_eq!(named(&file, "odd").values, Values::U8(vec![0, 2, 3, 4, 5]));
    assert_eq!(file.report.ignored, [OF_POINTS, "extra bytes pairs"]);
}

/// The file with records of the user `LASF_Projection` in front of the points; those from `behind` on, behind them.
fn with_projection(bytes: &[u8], records: &[(u16, Vec<u8>)], behind: usize) -> Vec<u8> {
    let start = record(bytes, 0);
    let mut head = bytes[..start].to_vec();
    let user = b"LASF_Projection\0";
    for (id, data) in &records[..behind] {
        head.extend([0; 2]);
        head.extend(user);
        head.extend(id.to_le_bytes());
        head.extend((data.len() as u16).to_le_bytes());
        head.extend([0; 32]);
        head.extend(data);
    }
    let new_start = head.len() as u32;
    head[96..100].copy_from_slice(&new_start.to_le_bytes());
    head.extend(&bytes[start..]);
    if behind < records.len() {
        let end = head.len() as u64;
        head[235..243].copy_from_slice(&end.to_le_bytes());
        head[243..247].copy_from_slice(&((records.len() - behind) as u32).to_le_bytes());
    }
    for (id, data) in &records[behind..] {
        head.extend([0; 2]);
        head.extend(user);
        head.extend(id.to_le_bytes());
        head.extend((data.len() as u64).to_le_bytes());
        head.extend([0; 32]);
        head.extend(data);
    }
    head
}

fn projection() -> Vec<(u16, Vec<u8>)> {
    let keys = [1u16, 1, 0, 1, 3072, 0, 1, 32633].map(u16::to_le_bytes).concat();
    let doubles = [0.5f64, -1e-7].map(f64::to_le_bytes).concat();
    vec![
        (34735, keys),
        (34736, doubles),
        (34737, b"WGS 84|\0".to_vec()),
        (2112, "GEOGCS[\"H\u{f6}he\"]\0".into()),
    ]
}

#[test]
fn coordinate_reference_systems_are_metadata() {
    let expected = [
        ("crs.geokeys", "1 1 0 1 3072 0 1 32633"),
        ("crs.geokeys.doubles", "0.5 -0.0000001"),
        ("crs.geokeys.ascii", "WGS 84|"),
        ("crs.wkt", "GEOGCS[\"H\u{f6}he\"]"),
    ];
    let expected: Vec<(String, String)> = expected.map(|(key, text)| (key.into(), text.into())).to_vec();
    for (format, behind) in [(1, 4), (6, 4), (6, 0), (7, 2)] {
        let bytes = with_projection(&las(format, &SQUARE), &projection(), behind);
        let file = read(&bytes).unwrap();
        assert_eq!(file.attributes.metadata[..], expected, "{format} {behind}");
        for end in (0..bytes.len()).rev().step_by(3) {
            let _ = read(&bytes[..end]);
        }
    }
    // What came first holds; what is not known, or too long, is named.
    let mut records = projection();
    records.push((2112, b"another".to_vec()));
    records.push((2111, Vec::new()));
    records.insert(0, (34737, vec![b'x'; 70_000]));
    let file = read(&with_projection(&las(6, &SQUARE), &records, 0)).unwrap();
    assert_eq!(file.attributes.metadata[..], expected);
    let named = ["crs.geokeys.ascii of 70000 bytes", "record 2111 of LASF_Projection"];
    assert_eq!(file.report.ignored[..2], named);
}

#[cfg(feature = "encoder")]
#[test]
fn metadata_goes_through_a_stream_and_into_other_formats() {
    let file = read(&with_projection(&las(6, &SQUARE), &projection(), 4)).unwrap();
    let options = lwc::EncodeOptions::default();
    let encoded = lwc::encode_with_attributes(&file.mesh, &file.attributes, &options, &|_| {}).unwrap();
    assert_eq!(encoded.info.metadata(), &file.attributes.metadata[..]);
    let mut decoder = lwc::Decoder::new(lwc::Limits::default());
    decoder.feed(&encoded.bytes).unwrap();
    while decoder.step().unwrap().is_some() {}
    let (mesh, attributes) = decoder.preview_with_attributes().unwrap();
    assert_eq!(attributes.metadata, file.attributes.metadata);
    for format in [
        Format::Ply,
        #[cfg(feature = "gltf")]
        Format::Glb,
    ] {
        let mut bytes = Vec::new();
        io::write_with_attributes_to(&mut bytes, &mesh, &attributes, format).unwrap();
        let again = io::read_bytes(&bytes, format).unwrap();
        let sorted = |pairs: &[(String, String)]| {
            let mut pairs = pairs.to_vec();
            pairs.sort();
            pairs
        };
        assert_eq!(sorted(&again.attributes.metadata), sorted(&attributes.metadata), "{format:?}");
    }
    let report = io::write_with_attributes_to(Vec::new(), &mesh, &attributes, Format::Stl).unwrap();
    assert!(report.iter().any(|loss| loss.subject == "crs.wkt"), "{report}");
}

#[test]
fn names_of_extra_bytes_are_unique() {
    let one: fn(u8) -> Vec<u8> = |k| vec![k];
    let fields: [Field; 4] =
        [(1, "intensity", one, None), (1, "red", one, None), (1, "a b", one, None), (1, "a_b", one, None)];
    let file = read(&with_extra_bytes(&las(3, &SQUARE), &fields)).unwrap();
    let names: Vec<&str> = file.attributes.list.iter().map(|a| a.name.as_str()).collect();
    let expected = ["classification", "intensity", "red green blue", "intensity_2", "red_2", "a_b", "a_b_2"];
    assert_eq!(names, expected);
}

#[test]
fn returns_and_cells_choose_points() {
    let bytes = las(3, &SQUARE);
    let file = read_with(&bytes, |options| options.last_returns_only = true);
    assert_eq!(named(&file, "classification").values, Values::U8(vec![2, 2, 6, 2]));
    assert_eq!((file.mesh.num_triangles(), file.report.points_left_out), (2, 2));

    let grid: Vec<Point> = (0..2500).map(|k| ([k % 50 * 100, k / 50 * 100, k], 1, 1, 2)).collect();
    let bytes = las(0, &grid);
    let file = read_with(&bytes, |options| options.cell_size = Some(10.0));
    assert_eq!((file.mesh.num_vertices(), file.report.points_left_out), (25, 2475));
    let file = read_with(&bytes, |options| options.max_points = Some(400));
    assert!((200..=400).contains(&file.mesh.num_vertices()), "{}", file.mesh.num_vertices());
    let file = read_with(&bytes, |options| options.max_points = Some(0));
    assert_eq!(file.mesh.num_vertices(), 0);
}

#[test]
fn points_on_a_line_have_no_triangles() {
    let line: Vec<Point> = (0..9).map(|k| ([k, 2 * k, 0], 1, 1, 2)).collect();
    for points in [&line[..], &line[..1], &[]] {
        let file = read(&las(1, points)).unwrap();
        assert_eq!((file.mesh.num_vertices(), file.mesh.num_triangles()), (points.len(), 0));
    }
}

#[test]
fn extreme_coordinates_are_triangulated() {
    let far = [i32::MIN, i32::MAX].map(|x| [i32::MIN, i32::MAX].map(|y| ([x, y, 0], 1, 1, 2)));
    let file = read(&las(0, &[far.concat(), vec![([1, 1, 0], 1, 1, 2)]].concat())).unwrap();
    assert_eq!((file.mesh.num_vertices(), file.mesh.num_triangles()), (5, 4));
}

#[test]
fn refusals_name_the_byte_and_the_cause() {
    let good = las(3, &SQUARE);
    let with = |at: usize, field: &[u8]| {
        let mut bytes = good.clone();
        bytes[at..at + field.len()].copy_from_slice(field);
        read(&bytes).expect_err("accepted").to_string()
    };
    assert_eq!(with(0, b"LAZF"), "byte 0: not a LAS file: it does not begin with `LASF`");
    assert_eq!(with(25, &[5]), "byte 24: LAS version 1.5");
    assert_eq!(with(104, &[11]), "byte 104: point format 11");
    assert_eq!(with(105, &[33]), "byte 105: points of 33 bytes, but format 3 has 34");
    assert_eq!(with(107, &[7]), "byte 431: the file ends in point 7 of 7");
    assert_eq!(with(107, &[0xff; 4]), "byte 431: the file ends in point 7 of 4294967295");
    assert!(with(96, &[0xff; 4]).starts_with("byte 96: points at byte 4294967295"));
    assert!(with(131, &0f64.to_le_bytes()).starts_with("byte 131: a scale that is not a positive number"));
    assert!(with(139, &f64::NAN.to_le_bytes()).starts_with("byte 131: a scale"));
    assert!(with(131, &1e300f64.to_le_bytes()).starts_with("byte 131: a scale"), "overflows");
    assert!(with(131, &1e200f64.to_le_bytes()).starts_with("byte 131: scales of"));
    assert!(with(171, &f64::INFINITY.to_le_bytes()).starts_with("byte 155: an offset"));
    assert_eq!(with(104, &[0x83]), "byte 227: compressed, but it does not say how");
    for end in 0..good.len() {
        assert!(matches!(read(&good[..end]), Err(ReadError::Syntax { .. })), "{end}");
        for flip in [0x01, 0x10, 0x80, 0xff] {
            let mut damaged = good.clone();
            damaged[end] ^= flip;
            let _ = read(&damaged);
        }
    }
}

// --- LAZ -----------------------------------------------------------------------------------------------

/// The same file compressed, as versions 1 to 3 of the compressor do it.
fn laz(format: u8, points: &[Point]) -> Vec<u8> {
    laz_in_chunks(format, points, Chunks::OfPoints(50_000))
}

/// The points of a chunk: one number for all, or several in turn.
#[derive(Clone, Copy, Debug)]
enum Chunks {
    OfPoints(u32),
    OfSeveralSizes(&'static [usize]),
}

fn laz_in_chunks(format: u8, points: &[Point], chunks: Chunks) -> Vec<u8> {
    let plain = las(format, points);
    let data_offset = u32::from_le_bytes(plain[96..100].try_into().unwrap()) as usize;
    let items = laz::LazItemRecordBuilder::default_for_point_format_id(format, 0).unwrap();
    let builder = laz::LazVlrBuilder::new(items);
    let vlr = match chunks {
        Chunks::OfPoints(size) => builder.with_fixed_chunk_size(size).build(),
        Chunks::OfSeveralSizes(_) => builder.with_variable_chunk_size().build(),
    };
    let mut data = std::io::Cursor::new(Vec::new());
    vlr.write_to(&mut data).unwrap();
    let data = data.into_inner();
    let mut bytes = plain[..data_offset].to_vec();
    bytes[96..100].copy_from_slice(&((data_offset + 54 + data.len()) as u32).to_le_bytes());
    bytes[100] = 1;
    bytes[104] |= 0x80;
    let mut head = [0; 54];
    head[2..16].copy_from_slice(b"laszip encoded");
    head[18..20].copy_from_slice(&22204u16.to_le_bytes());
    head[20..22].copy_from_slice(&(data.len() as u16).to_le_bytes());
    bytes.extend(head);
    bytes.extend(data);
    let mut out = std::io::Cursor::new(bytes);
    out.set_position(out.get_ref().len() as u64);
    let mut compressor = laz::LasZipCompressor::new(out, vlr).unwrap();
    let Chunks::OfSeveralSizes(sizes) = chunks else {
        compressor.compress_many(&plain[data_offset..]).unwrap();
        compressor.done().unwrap();
        return compressor.into_inner().into_inner();
    };
    let mut records = plain[data_offset..].chunks(usize::from(u16::from_le_bytes([plain[105], plain[106]])));
    for &size in sizes {
        for record in records.by_ref().take(size) {
            compressor.compress_one(record).unwrap();
        }
        compressor.finish_current_chunk().unwrap();
    }
    compressor.done().unwrap();
    compressor.into_inner().into_inner()
}

#[test]
fn compressed_points_are_the_same() {
    for format in [0, 1, 2, 3, 6, 7, 8] {
        let compressed = laz(format, &SQUARE);
        let file =
            io::read_bytes(&compressed, Format::Laz).unwrap_or_else(|e| panic!("format {format}: {e}"));
        assert_eq!(file, read(&las(format, &SQUARE)).unwrap(), "format {format}");
    }
}

#[test]
fn chunks_of_all_sizes_are_read() {
    let grid: Vec<Point> = (0..300).map(|k| ([k % 17 * 90, k / 17 * 110, k % 40], 1, 1, 2)).collect();
    for format in [0, 1, 2, 3, 6, 7, 8] {
        let several = Chunks::OfSeveralSizes(&[1, 100, 7, 192]);
        for chunks in [Chunks::OfPoints(1), Chunks::OfPoints(7), Chunks::OfPoints(300), several] {
            let file = io::read_bytes(&laz_in_chunks(format, &grid, chunks), Format::Laz);
            let file = file.unwrap_or_else(|e| panic!("format {format}, {chunks:?}: {e}"));
            assert_eq!(file, read(&las(format, &grid)).unwrap(), "format {format}, {chunks:?}");
        }
    }
    let too_few = laz_in_chunks(1, &grid, Chunks::OfSeveralSizes(&[100, 7]));
    let error = read(&too_few).expect_err("accepted").to_string();
    assert!(error.contains("the chunks have fewer points than the header says"), "{error}");
}

/// The same file as LASzip before 2011 wrote it: one chunk without a table, and any number for its size.
fn point_wise(format: u8, points: &[Point], chunk_size: u32) -> Vec<u8> {
    let mut bytes = laz(format, points);
    let start = u32::from_le_bytes(bytes[96..100].try_into().unwrap()) as usize;
    let table = u64::from_le_bytes(bytes[start..start + 8].try_into().unwrap()) as usize;
    bytes.truncate(table);
    bytes.drain(start..start + 8);
    let header_bytes = u16::from_le_bytes(bytes[94..96].try_into().unwrap()) as usize;
    let record = header_bytes + 54;
    bytes[record..record + 2].copy_from_slice(&1u16.to_le_bytes());
    bytes[record + 12..record + 16].copy_from_slice(&chunk_size.to_le_bytes());
    bytes
}

#[test]
fn points_without_chunks_are_read() {
    let grid: Vec<Point> = (0..300).map(|k| ([k % 17 * 90, k / 17 * 110, k % 40], 1, 1, 2)).collect();
    for format in 0..=3 {
        for chunk_size in [0, 1, 100, u32::MAX] {
            let file = io::read_bytes(&point_wise(format, &grid, chunk_size), Format::Laz);
            let file = file.unwrap_or_else(|e| panic!("format {format}, chunks of {chunk_size}: {e}"));
            assert_eq!(file, read(&las(format, &grid)).unwrap(), "format {format}");
        }
    }
}

/// Chunks of several sizes, and no chunk in the table: `laz` looks for the first and panics.
#[test]
fn a_panic_of_the_decompressor_is_an_error() {
    let mut bytes = laz(7, &SQUARE);
    let start = u32::from_le_bytes(bytes[96..100].try_into().unwrap()) as usize;
    let table = u64::from_le_bytes(bytes[start..start + 8].try_into().unwrap()) as usize;
    bytes[table + 4..table + 8].copy_from_slice(&0u32.to_le_bytes());
    let header_bytes = u16::from_le_bytes(bytes[94..96].try_into().unwrap()) as usize;
    bytes[header_bytes + 54 + 12..][..4].copy_from_slice(&u32::MAX.to_le_bytes());
    let error = read(&bytes).expect_err("accepted");
    assert!(matches!(error, ReadError::Syntax { .. }), "{error}");
    assert!(error.to_string().contains("damaged LAZ data: the decoder gave up"), "{error}");
}

#[test]
fn damaged_compression_is_refused_without_harm() {
    for format in [3, 7] {
        let grid: Vec<Point> =
            (0..300).map(|k| ([k % 17 * 90 + k % 5, k / 17 * 110, k % 40], 1, 1, 2)).collect();
        let good = laz(format, &grid);
        for end in (0..good.len()).step_by(7) {
            let _ = read(&good[..end]);
            for flip in [0x01, 0x80, 0xff] {
                let mut damaged = good.clone();
                damaged[end] ^= flip;
                let _ = read(&damaged);
            }
        }
        let mut many = good.clone();
        let count = if format == 3 { 107 } else { 247 };
        many[count..count + 4].copy_from_slice(&0x7fff_ffffu32.to_le_bytes());
        assert!(matches!(read(&many), Err(ReadError::TooLarge { .. })));
    }
    // Layers that are longer than the file.
    let mut long = laz(7, &SQUARE);
    let start = u32::from_le_bytes(long[96..100].try_into().unwrap()) as usize;
    let lengths = start + 8 + 36 + 4;
    long[lengths + 8..lengths + 12].copy_from_slice(&u32::MAX.to_le_bytes());
    match read(&long) {
        Err(ReadError::Syntax { place: Place::Byte(at), message }) => {
            assert_eq!(at, lengths);
            assert!(message.contains("longer than the file"), "{message}");
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn stored_files_are_read_alike() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let plain = io::read(folder.join("terrain.las")).unwrap();
    assert_eq!((plain.mesh.num_vertices(), plain.mesh.num_triangles()), (40, 64));
    assert_eq!(io::read(folder.join("terrain.laz")).unwrap(), plain);
    assert_eq!(io::read(folder.join("terrain-layered.laz")).unwrap(), plain);
}

// --- The corpus ----------------------------------------------------------------------------------------

#[test]
fn a_real_scan_is_the_surface_that_others_make_of_it() {
    let Some(directory) = corpus() else { return };
    let path = directory.join("dem/autzen_trim.laz");
    let mut options = TerrainOptions::default();
    options.last_returns_only = true;
    let ours = io::read_terrain(&path, &options).unwrap();
    let theirs = io::read(directory.join("autzen-tin.ply.zst")).unwrap();
    // Theirs lacks the few points that qhull leaves out.
    let (n, m) = (ours.mesh.num_vertices(), theirs.mesh.num_vertices());
    assert!(n >= m && n - m <= m / 1000, "{n} vertices, {m}");
    let (a, b) = (ours.mesh.num_triangles(), theirs.mesh.num_triangles());
    assert!(a.abs_diff(b) <= b / 500, "{a} triangles, {b}");
    assert!(doubled_areas(&ours).iter().all(|&area| area > 0.0));
    assert!(ours.attributes.find(Semantic::Color(0)).is_some());

    options.max_points = Some(20_000);
    let thinned = io::read_terrain(&path, &options).unwrap();
    assert!((15_000..=20_000).contains(&thinned.mesh.num_vertices()), "{}", thinned.mesh.num_vertices());
}

/// A variable length record of the file that `las` makes.
fn with_record(mut bytes: Vec<u8>, user: &[u8], id: u16, declared: u16, data: &[u8]) -> Vec<u8> {
    let mut record = vec![0; 54];
    record[2..2 + user.len()].copy_from_slice(user);
    record[18..20].copy_from_slice(&id.to_le_bytes());
    record[20..22].copy_from_slice(&declared.to_le_bytes());
    record.extend(data);
    let start = u32::from_le_bytes(bytes[96..100].try_into().unwrap());
    bytes[96..100].copy_from_slice(&(start + record.len() as u32).to_le_bytes());
    bytes.splice(start as usize..start as usize, record);
    bytes
}

const OF_POINTS: &str = "returns, angles, times, sources, flags and user data of points";

#[test]
fn what_is_not_kept_of_a_cloud_is_named() {
    let ignored = |bytes: &[u8]| read(bytes).unwrap().report.ignored;
    let plain = las(0, &SQUARE);
    assert_eq!(ignored(&plain), [OF_POINTS]);
    let other = with_record(plain.clone(), b"me", 1, 2, b"ab");
    assert_eq!(ignored(&other), [OF_POINTS, "other variable length records"]);
    let known = with_record(plain.clone(), b"LASF_Projection", 2112, 2, b"ab");
    assert_eq!(ignored(&known), [OF_POINTS]);
    let cut = with_record(plain, b"LASF_Projection", 2112, 60_000, b"ab");
    assert_eq!(ignored(&cut), ["record 2112 of LASF_Projection, in which the file ends", OF_POINTS]);
}

#[test]
fn fields_that_are_renamed_or_left_out_are_named() {
    let mut description = vec![0; 192];
    description[2] = 1;
    description[4..16].copy_from_slice(b"height above");
    let mut bytes = las(0, &SQUARE);
    let start = u32::from_le_bytes(bytes[96..100].try_into().unwrap()) as usize;
    for point in (0..SQUARE.len()).rev() {
        let at = start + 20 * point + 20;
        bytes.splice(at..at, [7, 8]);
    }
    bytes[105..107].copy_from_slice(&22u16.to_le_bytes());
    let file = read(&with_record(bytes.clone(), b"LASF_Spec", 4, 192, &description)).unwrap();
    assert_eq!(file.report.renamed, ["height above (height_above)"]);
    assert_eq!(file.report.ignored[1..], ["extra bytes that nothing describes"]);
    // Two bytes of which only the name is known.
    description[2..4].copy_from_slice(&[0, 2]);
    let file = read(&with_record(bytes, b"LASF_Spec", 4, 192, &description)).unwrap();
    assert_eq!(file.report.ignored[1..], ["extra bytes height above"]);
}

#[test]
fn colours_of_8_bits_are_counted() {
    let mut bytes = las(2, &SQUARE);
    assert_eq!(read(&bytes).unwrap().report.colours_of_8_bits, 0);
    for point in 0..SQUARE.len() {
        let at = record(&bytes, point) + 20;
        bytes[at..at + 6].copy_from_slice([200u16, 0, 255].map(u16::to_le_bytes).as_flattened());
    }
    let file = read(&bytes).unwrap();
    assert_eq!(file.report.colours_of_8_bits, file.mesh.num_vertices());
}
